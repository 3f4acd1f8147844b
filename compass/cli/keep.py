"""``compass keep``: station-keeping of a design, simulated."""

from typing import Any

import click

import compass
from compass.cli.options import (
    design_argument,
    fold_option,
    mask_option,
    radii_option,
    real,
    whole,
)
from compass.cli.shared import watched


@click.command()
@design_argument
@real("--years", help="Time to simulate; else the design's, 1.")
@real("--box-deg", help="Half width of the box along the track; else half the margin.")
@fold_option
@mask_option
@real("--specific-impulse-s", help="Else the design's, 220.")
@real("--dry-mass-kg", help="Without propellant; else the design's, 100.")
@real("--smallest-burn-m-s", help="Least impulse; else the design's, 0.005.")
@real("--execution-error", help="Relative; else the design's, 0.01.")
@real("--navigation-error-m", help="Along the track; else the design's, 1000.")
@whole("--seed", default=0, help="Of the errors.")
@radii_option
def command(**options: Any) -> object:
    """Simulate impulsive station-keeping of every satellite of a DESIGN in its slot.

    Exit status 0 if all stay within the margin, 1 if not.
    """
    return compass.keep(progress=watched(), **options)
