"""``compass reproduce``: a source paper, number by number."""

import click

from compass.cli.shared import announce_compilation, emit_json, json_option, print_table

PAPERS = ("kelly2018", "ballard1980", "yu2018", "lou2017", "lou2019")


@click.command("reproduce")
@click.argument("paper", type=click.Choice(PAPERS))
@json_option
@click.pass_context
def command(ctx: click.Context, paper: str, as_json: bool) -> None:
    """Every number of a source PAPER: published, computed, and who is right.

    Exit status 1 if a number differs without an erratum on record.
    """
    announce_compilation()
    from importlib import import_module

    module = import_module(f"compass.papers.{paper}")
    rows = module.rows()
    failed = [row for row in rows if not row.holds]
    if as_json:
        emit_json(
            {
                "paper": paper,
                "title": module.TITLE,
                "rows": [row.as_dict() for row in rows],
                "reproduced": sum(row.verdict == "reproduced" for row in rows),
                "errata": sum(row.verdict.startswith("erratum") for row in rows),
                "differs": len(failed),
            }
        )
    else:
        print_table(
            module.TITLE,
            [
                (row.where, row.item, row.published or "-", row.computed, row.unit, row.verdict)
                for row in rows
            ],
            ("where", "item", "published", "computed", "unit", "verdict"),
        )
        click.echo(f"\n{len(rows)} rows, {len(failed)} unexplained.")
    if failed:
        ctx.exit(1)
