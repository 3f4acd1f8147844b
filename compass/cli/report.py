"""``compass report``: one self-contained HTML page about a design, scenario, study or paper."""

from pathlib import Path
from typing import Any

import compass
from compass.cli.options import AREAS, takes
from compass.cli.shared import command_line, watched


@takes(f"design {AREAS} output step_deg epochs store")
def command(design: Path, **options: Any) -> object:
    """Report on a DESIGN, a scenario, a study or a paper: one HTML page that needs no network.

    A file with a table [study] is a study, and its page is made from the store of `compass
    trade`; one with a table [vehicle] is a scenario of landing; all else is a design. The name
    of a source paper, as of `compass reproduce`, is a page of its numbers beside the computed ones.
    """
    return compass.report(design, **options, command=command_line(), progress=watched())
