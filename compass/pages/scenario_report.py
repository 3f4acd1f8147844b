"""The report of one scenario: the entry, and the filters compared if it asks for them."""

from compass.document.blocks import Section
from compass.inputs.fusion import fusion_plan
from compass.inputs.scenario import Scenario, provenance
from compass.pages.entry import assess_scenario, entry_section
from compass.pages.fusion import fusion_section
from compass.pages.page import render
from compass.study.fusion import run_fusion


def scenario_report(
    scenario: Scenario, command: str = "", runs: int | None = None
) -> tuple[str, list[Section]]:
    """Make the page (HTML text) and the sections of a scenario's report.

    Parameters
    ----------
    scenario
        The scenario.
    command
        The command line, for provenance.
    runs
        Monte Carlo runs instead of the scenario's.
    """
    plan = fusion_plan(scenario)
    sections = [entry_section(scenario, assess_scenario(scenario, runs))]
    if plan is not None:
        sections.append(fusion_section(run_fusion(plan, runs)))
    made = provenance(scenario, command)
    rows = [
        ("command", command or "made from Python"),
        ("made", made["history"].split(" ")[0]),
        ("version", made["source"]),
        ("scenario file", made["scenario_file"]),
        ("SHA-256 of the scenario", made["scenario_sha256"]),
    ]
    subtitle = made["references"] or "No source given."
    return render(scenario.name, subtitle, sections, rows, scenario.text), sections
