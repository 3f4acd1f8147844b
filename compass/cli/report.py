"""``compass report``: one self-contained HTML page about a design or a study."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from compass.cli.shared import (
    announce_compilation,
    command_line,
    design_argument,
    emit_json,
    json_option,
)

if TYPE_CHECKING:
    from compass.document.blocks import Section


@click.command("report")
@design_argument
@click.option(
    "-o",
    "--output",
    type=click.Path(path_type=Path),
    help="Folder for the page and its pictures; by default reports/NAME-OF-THE-FILE.",
)
@click.option(
    "--step-deg",
    type=float,
    help="Cell size of a design's maps, 0.05 to 90 degrees.  [default: 1.0]",
)
@click.option(
    "--epochs",
    type=int,
    help="Epochs in the period of a design's maps, from 1; a prime number meets moments of "
    "symmetry least.  [default: 109]",
)
@click.option(
    "--store",
    type=click.Path(path_type=Path),
    help="Folder of a study's store; by default trades/NAME-OF-THE-FILE.",
)
@json_option
def command(
    design: Path,
    output: Path | None,
    step_deg: float | None,
    epochs: int | None,
    store: Path | None,
    as_json: bool,
) -> None:
    """Report on a DESIGN, a scenario or a study: one HTML page that needs no network.

    A file with a table [study] is a study, and its page is made from the store of `compass
    trade`; one with a table [vehicle] is a scenario of landing; all else is a design.
    """
    announce_compilation()
    from compass.errors import ArgumentError
    from compass.inputs.reading import read_text
    from compass.pages.page import check_page_folder

    tables = _tables(read_text(design))
    folder = output or Path("reports") / design.stem
    check_page_folder(folder)
    finer = {"step_deg": step_deg, "epochs": epochs}
    options = {name: value for name, value in finer.items() if value is not None}
    if options and tables & {"study", "vehicle"}:
        option = "--" + next(iter(options)).replace("_", "-")
        raise ArgumentError(
            f"{option}: {design} is not a design, and says itself how finely it is looked at; "
            "leave it out"
        )
    if "study" in tables:
        _trade(design, folder, store or Path("trades") / design.stem, as_json)
        return
    if store is not None:
        raise ArgumentError(f"--store: {design} is not a study; leave it out")
    if "vehicle" in tables:
        _scenario(design, folder, as_json)
    else:
        _design(design, folder, options, as_json)


def _tables(text: str) -> set[str]:
    """Names at the top of a TOML text; none if it is no TOML, which its reader will say."""
    import tomllib

    try:
        return set(tomllib.loads(text))
    except (ValueError, RecursionError):
        return set()


def _design(path: Path, folder: Path, given: dict[str, Any], as_json: bool) -> None:
    """Make the report of a design."""
    from tqdm import tqdm

    from compass.inputs import read_design
    from compass.pages.design_report import design_report
    from compass.study.mapping import MapOptions

    chosen = read_design(path)
    with tqdm(total=8, desc="report", unit="part", disable=None, leave=False) as bar:

        def step(name: str) -> None:
            bar.set_postfix_str(name)
            bar.update()

        options = MapOptions(**given)
        page, sections = design_report(chosen, command_line(), options, progress=step)
    _write(folder, page, sections, as_json)


def _scenario(path: Path, folder: Path, as_json: bool) -> None:
    """Make the report of a scenario."""
    import compass
    from compass.pages.landing_report import landing_report

    page, sections = landing_report(compass.land(path, command=command_line(), progress=True))
    _write(folder, page, sections, as_json)


def _write(folder: Path, page: str, sections: "Sequence[Section]", as_json: bool) -> None:
    from compass.pages.page import write_page

    path = write_page(folder, page, sections)
    if as_json:
        pictures = [f"{p.stem}.png" for section in sections for p in section.pictures]
        emit_json({"page": str(path), "pictures": [str(folder / name) for name in pictures]})
    else:
        click.echo(f"report: {path}")


def _trade(study: Path, folder: Path, store: Path, as_json: bool) -> None:
    """Make the trade report of a study."""
    import json

    from tqdm import tqdm

    from compass.document.plain import plain
    from compass.inputs.study import read_study
    from compass.pages.page import write_page
    from compass.pages.trade import trade_report
    from compass.saving import write_files

    chosen = read_study(study)
    with tqdm(desc="report", unit="part", disable=None, leave=False) as bar:

        def step(name: str) -> None:
            bar.set_postfix_str(name)
            bar.update()

        made = trade_report(chosen, store, command_line(), progress=step)
    path = write_page(folder, made.page, made.sections)
    summary = json.dumps(plain(made.summary), indent=2, allow_nan=False, ensure_ascii=False)
    write_files(folder, {"summary.json": summary + "\n", **made.files})
    if as_json:
        emit_json({"page": str(path)} | made.summary)
    else:
        click.echo(f"report: {path}")
