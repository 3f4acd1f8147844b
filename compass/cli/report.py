"""``compass report``: one self-contained HTML page about a design."""

from pathlib import Path

import click

from compass.cli.shared import command_line, design_argument, emit_json, json_option, say


@click.command("report")
@design_argument
@click.option(
    "-o",
    "--output",
    type=click.Path(path_type=Path),
    help="Folder for the page and its pictures; by default reports/NAME-OF-THE-FILE.",
)
@click.option("--step-deg", default=1.0, show_default=True, help="Cell size, 0.05 to 90 degrees.")
@click.option("--epochs", default=96, show_default=True, help="Epochs in the period, from 1.")
@json_option
def command(design: Path, output: Path | None, step_deg: float, epochs: int, as_json: bool) -> None:
    """Report on a DESIGN: pictures and tables in one HTML page that needs no network."""
    from tqdm import tqdm

    from compass.inputs import read_design
    from compass.report.compiling import announce_compilation
    from compass.report.design_report import design_report
    from compass.report.page import write_page
    from compass.study.mapping import MapOptions

    chosen = read_design(design)
    folder = output or Path("reports") / design.stem
    announce_compilation(say)
    with tqdm(total=8, desc="report", unit="part", disable=None, leave=False) as bar:

        def step(name: str) -> None:
            bar.set_postfix_str(name)
            bar.update()

        options = MapOptions(step_deg=step_deg, epochs=epochs)
        page, sections = design_report(chosen, command_line(), options, progress=step)
    path = write_page(folder, page, sections)
    if as_json:
        pictures = [f"{p.stem}.png" for section in sections for p in section.pictures]
        emit_json({"page": str(path), "pictures": [str(folder / name) for name in pictures]})
    else:
        click.echo(f"report: {path}")
