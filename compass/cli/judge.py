"""``compass judge``: candidate constellations ranked by landing-navigation quality."""

from pathlib import Path
from typing import Any

import compass
from compass.cli.options import AREAS, takes
from compass.cli.shared import command_line, say, watched


@takes(
    f"designs {AREAS} scenario samples seed goal_m density_sigma lift_sigma clock_m "
    "clock_drift_m_s orbit_m satellite_clock_m range_bias_m finalists runs rival "
    "rival_radius_km start_day folder"
)
def command(designs: tuple[Path, ...], folder: Path | None, **options: Any) -> object:
    """Judge constellations as beacons of a lander: anywhere, along any azimuth, at any time.

    The lander of the scenario is flown to parachute deployment (its trigger of that name, or the
    end of the scenario) at sites over the whole globe, or at those named, at moments over the
    repeat period. Ranked by the 95th percentile of the Cramer-Rao bound of position there,
    blackout taken into account.
    """
    from compass.pages.page import check_page_folder

    if folder is not None:
        check_page_folder(folder)
    found = compass.judge(designs, **options, command=command_line(), progress=watched())
    if options["rival"] is not None:
        say(f"wrote {options['rival']}")
    if folder is not None:
        made = compass.report(found, output=folder, command=command_line(), progress=watched())
        say(f"report: {made.page}")
    return found
