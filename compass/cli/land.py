"""``compass land``: how well a lander navigates on radio beacons."""

from pathlib import Path

import click

from compass.cli.shared import (
    announce_compilation,
    command_line,
    emit_json,
    json_option,
    print_table,
    say,
)

#: Filter runs that take longer (s) are announced.
LONG = 10.0


@click.command("land")
@click.argument("scenario", type=click.Path(path_type=Path))
@click.option("-o", "--output", type=click.Path(path_type=Path), help="netCDF file to write.")
@click.option(
    "--figures", type=click.Path(path_type=Path), help="Folder to write the pictures (PNG) into."
)
@click.option("--runs", type=click.IntRange(1, 100_000), help="Monte Carlo runs, 1 to 100000.")
@click.option("--strict", is_flag=True, help="Exit with 1 if the filter is inconsistent.")
@json_option
def command(
    scenario: Path,
    output: Path | None,
    figures: Path | None,
    runs: int | None,
    strict: bool,
    as_json: bool,
) -> None:
    """Fly a SCENARIO and navigate it: trajectory, view, observability, bound and filter.

    A scenario with a table [fusion] is also flown with accelerometers and ranges in centralised
    and distributed filters, through plasma and faults if it has them.
    """
    announce_compilation()
    from compass.entry.assess import assessment_dataset
    from compass.inputs.fusion import fusion_plan
    from compass.inputs.scenario import provenance, read_scenario
    from compass.pages.entry import assess_scenario, check_cost, entry_facts, entry_section
    from compass.pages.fusion import fusion_facts, fusion_section
    from compass.pages.pictures import check_folder, write_pictures
    from compass.saving import check_writable, save_netcdf
    from compass.study.fusion import run_fusion

    chosen = read_scenario(scenario)
    plan = fusion_plan(chosen)
    if output:
        check_writable(output, [scenario])
    if figures:
        check_folder(figures)
    for warning in plan.case.visibility_report() if plan else ():
        say(warning)
    seconds = check_cost(chosen, runs or chosen.runs)
    if seconds > LONG:
        say(f"filter runs: about {seconds:.0f} s")
    found = assess_scenario(chosen, runs)
    sections = [entry_section(chosen, found)]
    facts = entry_facts(chosen, found)
    fused = run_fusion(plan, runs) if plan else None
    if fused:
        sections.append(fusion_section(fused))
        facts["fusion"] = fusion_facts(fused)
    if output:
        data = assessment_dataset(found)
        data.attrs |= provenance(chosen, command_line())
        save_netcdf(output, data, fused.groups() if fused else ())
        say(f"wrote {output}")
    if figures:
        pictures = [image for section in sections for image in section.pictures]
        write_pictures(pictures, figures)
        say(f"wrote {len(pictures)} pictures into {figures}")
    if as_json:
        emit_json(facts | {"provenance": provenance(chosen, command_line())})
    else:
        click.echo(chosen.name)
        for section in sections:
            for paragraph in section.paragraphs:
                click.echo(f"\n{paragraph}")
            for table in section.tables:
                print_table(table.title, table.rows, table.header)
    if strict and not found.consistency.holds:
        raise click.exceptions.Exit(1)
