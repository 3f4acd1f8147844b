"""The page of a scenario: the entry, and the filters compared if it asks for them."""

from compass.api.land import LandResult
from compass.document import Section
from compass.inputs.scenario import provenance
from compass.pages.page import render


def landing_report(found: LandResult) -> tuple[str, tuple[Section, ...]]:
    """Make the page (HTML text) and the sections of a flown scenario."""
    scenario, sections = found.scenario, found.sections()
    made = provenance(scenario, found.command)
    rows = [
        ("command", found.command or "made from Python"),
        ("made", made["history"].split(" ")[0]),
        ("version", made["source"]),
        ("scenario file", made["scenario_file"]),
        ("SHA-256 of the scenario", made["scenario_sha256"]),
    ]
    subtitle = made["references"] or "No source given."
    return render(scenario.name, subtitle, sections, rows, scenario.text), sections
