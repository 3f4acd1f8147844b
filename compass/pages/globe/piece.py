"""The piece of page that draws the globe, and the still picture for where scripts do not run."""

import json
from functools import cache
from importlib.resources import files

from jinja2 import Environment, PackageLoader

from compass.design import Design
from compass.document.blocks import Interactive, Picture
from compass.pages.globe.scene import scene

_CAPTION = (
    "What the satellites see at the moment of the slider, computed in the page. Red: fewer in view "
    "than wanted. Squares: stations, green while they see enough."
)
_HINT = (
    "Point at a place for its values; drag to turn, or use the arrow keys; "
    "once clicked, the wheel zooms."
)


def globe(design: Design, still: Picture | None = None) -> Interactive:
    """Return the globe of a design as a block; `still` stands for it on paper."""
    shown = scene(design)
    # no "<" of a name can end the script that carries it
    values = json.dumps(shown, allow_nan=False).replace("<", "\\u003c")
    drawn = Environment(autoescape=True, loader=PackageLoader("compass.pages", "globe"))
    html = drawn.get_template("globe.html").render(
        values=values, duration=shown["duration_s"], gaps=bool(shown["gaps"]), name=design.name,
        fields=shown["fields"], hint=_HINT,
    )  # fmt: skip
    note = "" if design.mask.is_constant else " The mask is taken at its highest all around."
    title = f"Globe of {design.name}"
    return Interactive(
        stem="globe", title=title, caption=_CAPTION + note, html=html, script=script(), still=still
    )


@cache
def script() -> str:
    """Return the globe's script, once a page, in a scope of its own."""
    folder = files("compass.pages") / "globe"
    parts = (folder / name for name in ("sight.js", "drawing.js", "globe.js"))
    told = "\n".join(part.read_text(encoding="utf-8") for part in parts)
    return f"(() => {{\n{told}}})();\n"
