"""Every option of every command: what it takes, says and is by default.

An option is called as the argument of the library's function is that it gives; where a command
means something else by a name, that stands behind ``command.name``. Ranges are those of
`compass.allowed`.
"""

from compass.allowed import RANGES
from compass.cli.parameters import (
    Told,
    Word,
    argument,
    choice,
    flag,
    folder,
    listed,
    new_folder,
    output,
    path,
    radii,
    radius,
    real,
    several,
    shipped,
    source,
    text,
    whole,
)
from compass.papers import PAPERS
from compass.saving import ENDINGS
from compass.tracking import PICTURES

_DRAWING = ("picture", "a picture; add --figure FILE.png")
_TRIMMED = ("trimmed", "the orbits of a trim; add --trim")
_PRIME = "a prime number meets moments of symmetry least."
_MOTIONS = ["two-body", "j2", "numerical"]
_DRAWN = "count gdop pdop hdop vdop tdop age_h"
_ERRORS = "error_horizontal_m error_vertical_m error_position_m error_time_m"

#: Arguments and options by the argument of the function that they give.
OPTIONS: dict[str, Told] = {
    # without a name
    "design": argument(),
    "designs": argument(nargs=-1, required=True),
    "kind": argument(type=Word(["design", "scenario", "study"])),
    "paper": argument(type=Word(PAPERS)),
    "scenario": argument(),
    "study": argument(),
    # by name
    "above_m": real("Height of stations over the ground, m.", 0.0),
    "altitude_km": real("Orbit altitude over the equator."),
    "avoid_km": real("Distance to keep from the moons' centres."),
    "azimuths": whole("Steps all around.", 360),
    "beacons": several(
        "--beacon SITE",
        "A beacon on the ground, counted at sites as a satellite is: the name of a [[station]], or "
        "NAME=LAT,LON[,MASK], degrees; also many.",
    ),
    "beam_deg": real("Half angle of the satellites' antennas."),
    "beyond": whole("Sizes to try beyond the smallest that has the fold.", 0),
    "box_deg": real("Half width of the box along the track; else half the margin."),
    "budget_s": real("Seconds for each figure between bounds; compiling does not count."),
    "clock": text("The user's clock where it is held.", "uso"),
    "clock_drift_m_s": real("Its drift, m/s.", 0.3),
    "clock_m": real("Lander's clock at first, m.", 3e4),
    "crosslinks": flag("Link satellites with each other."),
    "density_sigma": real("Unknown density, relative; known if left out.", 0.0),
    "doppler_m_s": real("One sigma of a range rate.", 0.001),
    "dry_mass_kg": real("Without propellant; else the design's, 100."),
    "each_loss": flag(
        "Also protection after the loss of any one satellite; needs [signal] and [integrity]."
    ),
    "earth": flag("Link with the Earth."),
    "eclipse": flag("Find when satellites and moons are in shadow."),
    "error_max_m": real(
        "Largest error of a fix that counts as within, m; of designs with a [signal].", 30.0
    ),
    "execution_error": real("Relative; else the design's, 0.01."),
    "figures": folder("Folder to write the pictures (SVG, maps PNG) into."),
    "fold": whole("Satellites in view at once; else the design's."),
    "gdop_at_most": real("Largest GDOP allowed there."),
    "goal_m": real("Position wanted, m.", 10.0),
    "grid": choice(["equal-angle", "equal-area"], "Kind of cells.", "equal-angle"),
    "height_m": real("One sigma of the height where it is known.", 10.0),
    "hours": real("How long the user stands.", 6.0),
    "latitude_kind": choice(
        ["planetocentric", "planetographic"], "Kind of latitude of a netCDF grid.", "planetocentric"
    ),
    "launch_altitude_km": real("Orbit launched into; else the design's."),
    "least_approach_deg": real("Least angle between two satellites at any time.", 1.0),
    "leaves": output(
        "File of open boxes: what it holds of the same question is gone on from, and what is left "
        "open is kept there."
    ),
    "lift_sigma": real("Unknown L/D, relative; known if left out.", 0.0),
    "like": text(
        "A design, scenario or study that comes with compass, by name, or any file.",
        flags="--from",
        metavar="NAME",
        shell_complete=shipped,
    ),
    "longest_wait_days": real("For the last plane; else the design's."),
    "losses": whole("Also what is left after so many failures.", 0),
    "mask_deg": real("Elevation mask, degrees; else the design's."),
    "max_satellites": whole("Largest size to try.", required=True),
    "moon_model": choice(["precessing", "circular"], "How moons move.", "precessing"),
    "moons": choice(["phobos", "deimos"], "Link with a moon.", flags="--moon", multiple=True),
    "motion": choice(_MOTIONS, "How the satellites move; else as the design says."),
    "navigation_error_m": real("Along the track; else the design's, 1000."),
    "opened": {
        **text(
            "Open it in a browser; by default where a person sits at the terminal.",
            flags="--open/--no-open",
        ),
        "default": None,
    },
    "orbit": choice(["areosynchronous"], "An orbit by name."),
    "orbit_m": real("Broadcast orbits: radial, along, cross, m.", (2.0, 8.0, 5.0), nargs=3),
    "orbiters": several(
        "--orbiter NAME=KM,E,INC,RAAN,ARGP,M",
        "A user in orbit: semi-major axis, eccentricity, degrees at the epoch; needs a [signal].",
    ),
    "pairs": flag("Print a line for every pair."),
    "pdop_at_most": real("Largest PDOP allowed there."),
    "pdop_max": real("Largest PDOP that counts as available.", 6.0),
    "radius_km": text(
        "Also how long it lasts at other radii: FIRST..LAST:STEP, or A,B,C, km.", callback=radii
    ),
    "range_bias_m": real("Of each range, m.", 1.0),
    "region": text("lat:MIN:MAX or polygon:LAT,LON;LAT,LON;..., degrees; else everywhere."),
    "regions": several(
        "--region REGION",
        "A region: globe, lat:MIN:MAX or polygon:LAT,LON;LAT,LON;..., degrees; also many.",
    ),
    "repeat": whole(
        "Revolutions and rotations of Mars after which the ground track closes.", nargs=2
    ),
    "require": source("File with [[requirement]], or a design."),
    "rival": output("Find the best Walker delta of the first design's size, and write it there."),
    "rival_radius_km": real("Its orbits' radius; the first design's if left out."),
    "routes": several(
        "--route NAME=LAT,LON;...",
        "A rover that goes through these places, evenly over the span; needs a [signal].",
    ),
    "samples": whole("Entries to judge on.", 1024),
    "satellite_clock_m": real("Their clocks, m.", 3.0),
    "satellites": text("Those that are there already: A,B,C; all if left out.", callback=listed),
    "satellites_a_launch": whole("At most; else the design's, or all."),
    "scheduler": text("Address of a Dask scheduler, such as tcp://host:8786."),
    "seed": whole("Of the errors.", 0),
    "share": real("For how much of it: 0.95 is 95 %.", 1.0),
    "share_of": choice(
        ["time", "area-time"], "Of the time at the worst place, or of area and time.", "time"
    ),
    "site": text("A station of the design, or NAME=LAT,LON in degrees.", required=True),
    "sites": several(
        "--site SITE",
        "A site: the name of a [[station]], or NAME=LAT,LON[,MASK], degrees; also many.",
    ),
    "smallest_burn_m_s": real("Least impulse; else the design's, 0.005."),
    "specific_impulse_s": real("Else the design's, 220."),
    "start_day": real("Day after the epoch to begin at.", 0.0),
    "stations": several(
        "--station NAME=LAT,LON[,MASK]",
        "A station beside the designs': planetocentric latitude, east longitude, mask; degrees.",
    ),
    "step_days": real("Between the moments that are listed."),
    "store": path("Folder of a study's store; by default trades/NAME-OF-THE-FILE."),
    "strict": flag("Exit with 1 if a filter is inconsistent."),
    "terrain": source("GeoTIFF or netCDF grid of heights.", required=True),
    "time_series": flag(
        "Also write every epoch's counts and DOPs.",
        needs=("output", "a file to write to; add -o FILE.nc"),
    ),
    "tls_ca": source("Certificate of the cluster's authority (PEM)."),
    "tls_cert": source("Own certificate (PEM)."),
    "tls_key": source("Own key (PEM)."),
    "trimmed": flag("Trim the initial axes first.", flags="--trim"),
    "update_h": real("Hours between uploads, the prediction; else the design's."),
    "variable": text("Name of the heights in a netCDF file that has several."),
    "weights": choice(["variance", "equal"], "How a fix weighs its ranges.", "variance"),
    "width": real("How near bounds of a share are to come, such as 1e-5 for 0.001 %."),
    "workers": whole("Threads of this machine; by default one a core."),
    "years": real("Time to simulate; else the design's, 1."),
    # what one command means by a name
    "access.duration_sols": real("Span from the design's epoch.  [default: the design's, else 10]"),
    "access.output": output("Write all windows to a file", ENDINGS["access"]),
    "check.days": real("Days to settle it for, at the places; else for ever."),
    "determine.days": real("Arc of tracking from the epoch; else the design's."),
    "determine.output": output("Design file to write, with the [signal] that follows."),
    "determine.picture": output("PNG of sigma against time, or of who tracks whom when."),
    "determine.name": choice(
        PICTURES,
        "What the picture shows: sigma by tracking, by component, or the schedule.",
        "tracking",
        flags="--of",
        needs=_DRAWING,
    ),
    "drift.days": real("Length of the span.", 687.0),
    "drift.elements": output(
        "Write the elements to inject as a design file (with --trim).", needs=_TRIMMED
    ),
    "drift.oem": new_folder(
        "Write the orbits of these elements as OEM, a new folder (with --trim).", needs=_TRIMMED
    ),
    "drift.output": output("Write margin, room and places in the slots over time: .nc."),
    "export.duration_h": real("Time span, hours; by default until the ground tracks repeat."),
    "export.format": choice(
        ["oem", "czml", "geojson", "toml"],
        "CCSDS OEM 2.0, CZML, GeoJSON on the Mars sphere, or a design file.",
        required=True,
    ),
    "export.motion": choice(_MOTIONS, "How they move; else as the design says."),
    "export.output": path(
        "File to write; for OEM, which takes one satellite a message, a new folder of files.",
        required=True,
    ),
    "export.step_s": real(
        "Seconds between states; by default close enough for interpolation to a millimetre."
    ),
    "fold.days": real("Days to prove it for, along the satellites' paths."),
    "fold.duration_h": real("Hours from the epoch to look at, not all time."),
    "horizon.output": output("Write the design with the horizons."),
    "judge.finalists": whole("Run the filter on them.", 3),
    "judge.folder": path(
        "Folder for an HTML page with maps and distributions; none is made if left out.",
        flags="-o --report",
    ),
    "judge.runs": whole("Filter runs of each.", 512),
    "judge.scenario": source("Scenario file of the lander.", flags="-s --scenario", required=True),
    "judge.seed": whole("Of sites, times and noise.", 0),
    "land.output": output("netCDF file to write."),
    "land.runs": whole("Monte Carlo runs."),
    "land.start_day": real(
        "Day after the beacons' epoch at which entry begins; else the scenario's."
    ),
    "locate.goal_m": real("One sigma of the place that is wanted.", 10.0),
    "locate.step_s": real("Between measurements, s.", 60.0),
    "map.duration_h": real("Period to map, hours; by default until the ground tracks repeat."),
    "map.epochs": whole(f"Epochs in the period; {_PRIME}", 109),
    "map.name": text(
        "What the PNG map shows: gdop, error_horizontal_m, count_min, ...",
        "gdop",
        flags="--of",
        needs=_DRAWING,
    ),
    "map.output": output("netCDF file to write."),
    "map.picture": output("PNG map to draw."),
    "map.step_deg": real("Cell size.", 1.0),
    "new.output": path("File to write, else stdout."),
    "report.epochs": whole(f"Epochs in the period of a design's maps; {_PRIME}  [default: 109]"),
    "report.output": path(
        "Folder for the page and its pictures; by default reports/NAME-OF-THE-FILE."
    ),
    "report.step_deg": real("Cell size of a design's maps.  [default: 1.0]"),
    "reproduce.output": folder(
        "Folder for the rows (CSV) and the paper's figures, each as picture and data."
    ),
    "map.altitude_km": real(
        "Height of the users above the ground; in orbit they may look down: mask-deg below 0.", 0.0
    ),
    "map.beam_deg": real("Half angle of the satellites' antennas; all around if left out."),
    "map.mask_deg": real("Elevation mask, degrees; else the design's; below 0 in orbit alone."),
    "search.budget_s": real("Seconds for each share of geometry wanted; compiling does not count."),
    "search.days": real("Days for which it must hold on real orbits that nobody steers, too."),
    "search.figure": choice(
        ["iau-sphere", "kelly2018-sphere"], "Sphere that is to be covered.", "iau-sphere"
    ),
    "search.finalists": whole("How many to certify.", 10),
    "search.fold": whole("Satellites to be in view at once."),
    "search.mask_deg": real("Elevation mask, degrees.", 0.0),
    "search.output": output("Write the best as a design."),
    "search.radius_km": text(
        "Orbit radius from Mars's centre; of requirements also a range, nine radii of it.",
        metavar="R or LEAST:MOST",
        callback=radius,
    ),
    "search.region": text("globe, lat:MIN:MAX or polygon:LAT,LON;..., degrees.", multiple=True),
    "series.days": real("Length of the span.", 10.0),
    "series.name": choice(
        f"{_DRAWN} {_ERRORS}".split(),
        "What the curve shows.",
        "count",
        flags="--of",
        needs=_DRAWING,
    ),
    "series.epochs": whole("Moments at which dilutions are looked at.", 1009),
    "series.mask_deg": real(
        "Elevation mask, degrees; the higher of it and a station's own horizon."
    ),
    "series.output": output("Write counts and dilutions over time", ENDINGS["series"]),
    "series.picture": output("PNG curve to draw."),
    "trade.budget_s": real(
        "Seconds of work after which the run ends; what the default leaves brings bounds nearer."
    ),
    "trade.store": path(
        "Folder of the study's store; by default trades/NAME-OF-THE-FILE.", flags="-o --store"
    ),
    "trade.workers": whole("Processes on this machine; by default one a core."),
    "view.output": path("Page to write; by default views/NAME-OF-THE-FILE.html."),
    "warm.workers": whole("Commands run at a time; else one a core."),
}


def told_of(name: str, command: str) -> Told:
    """Tell of an argument or option as a command means it, with the range of a number."""
    if name == "pattern":  # its words need an import
        from compass.orbits.kinds import KIND_NAMES

        return choice(KIND_NAMES, "Kind of pattern.", KIND_NAMES[0])
    told = OPTIONS.get(f"{command}.{name}") or OPTIONS[name]
    allowed = RANGES.get(f"{command}.{name}") or RANGES.get(name)
    return {**told, "help": f"{told['help']}  [{allowed}]"} if allowed else told
