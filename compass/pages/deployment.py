"""The section on deployment of a design's page."""

from compass.api.deploy import deploy
from compass.coverage.room import has_slots
from compass.design import Design
from compass.document.blocks import Section, Sentence
from compass.pictures.style import HALF, look, new_figure, picture


def deployment_section(design: Design) -> Section | None:
    """Waiting against delta-v for the planes of a launch; None where there is one plane or none."""
    if not has_slots(design.constellation):
        return None
    result = deploy(design)
    if not result.deployment.planes:
        return None
    with look():
        figure = new_figure(*HALF)
        result.plot(axes=figure.add_subplot())
    drawn = picture(
        figure,
        "deployment",
        "Delta-v against waiting",
        "What one satellite costs from the orbit launched into to its plane and radius, against "
        "the wait for the last plane of a launch; the dotted line is the longest wait allowed.",
    )
    prove = Sentence(f"The same by a command: compass deploy {design.typed}")
    return Section("Deployment", (*result.document().blocks, drawn, prove))
