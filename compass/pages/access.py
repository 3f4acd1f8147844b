"""The access section of a page: timelines of sight, and what they come to."""

from compass.api.access_result import AccessResult
from compass.document.blocks import Section, arranged
from compass.document.numbers import significant
from compass.pictures.access import in_sight, link_budget, served, timeline

_KINDS = ("station", "moon", "earth")


def access_section(result: AccessResult) -> Section:
    """Timelines and tables of everything that was linked."""
    survey = result.survey
    pictures = [
        timeline(survey, node.name)
        for node in survey.nodes
        if node.kind in _KINDS and in_sight(survey, node.name)
    ]
    pictures += [
        link_budget(survey, radio) for radio in result.design.radios if served(survey, radio)
    ]
    summary = f"Over {significant(survey.sols, 4)} sols: " + " ".join(result.summary())
    return arranged("Access", (summary, *result.notes()), pictures, result.tables())
