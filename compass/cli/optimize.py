"""``compass optimize``: the best beacons or orbits for a lander."""

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


@click.command("optimize")
@click.argument("scenario", type=click.Path(path_type=Path))
@click.option(
    "--figures", type=click.Path(path_type=Path), help="Folder to write the pictures (PNG) into."
)
@json_option
def command(scenario: Path, figures: Path | None, as_json: bool) -> None:
    """Search for the best beacons or orbits, as the SCENARIO's [optimize] table asks."""
    announce_compilation()
    from tqdm import tqdm

    from compass.inputs.scenario import provenance, read_scenario
    from compass.pages.best_beacons import (
        best_beacons_facts,
        best_beacons_section,
        search_scenario,
    )
    from compass.pages.pictures import check_folder, write_pictures

    chosen = read_scenario(scenario)
    if figures:
        check_folder(figures)
    starts = chosen.optimize.starts if chosen.optimize else None
    with tqdm(total=starts, desc="search", unit="start", disable=None, leave=False) as bar:
        flight, found = search_scenario(chosen, progress=bar.update)
    section = best_beacons_section(chosen, flight, found)
    if figures:
        write_pictures(section.pictures, figures)
        say(f"wrote {len(section.pictures)} pictures into {figures}")
    if as_json:
        facts = best_beacons_facts(chosen, flight, found)
        emit_json(facts | {"provenance": provenance(chosen, command_line())})
        return
    click.echo(chosen.name)
    for paragraph in section.paragraphs:
        click.echo(f"\n{paragraph}")
    for table in section.tables:
        print_table(table.title, table.rows, table.header)
