"""Every command: the arguments and options that it takes, in the order of its help, and the help.

A command is called as the function of `compass` that it runs (`compass.cli.running`).
"""

#: Options of whatever says figures at sites and in regions, of whatever is found between proven
#: bounds, and of whatever a Dask cluster can do.
AREAS = "sites regions"
BOUNDS = "width budget_s leaves"
CLUSTER = "scheduler tls_ca tls_cert tls_key"

COMMANDS = {
    "access": (
        "design duration_sols stations moons earth crosslinks eclipse motion start_day "
        "moon_model pairs output",
        """Find access windows: stations, Mars's moons, the Earth, and links between satellites.

        Rise, set and culmination are found by root isolation, not by sampling, to 1 ms of the
        motion modelled. Times are seconds after the design's epoch, or after its --start-day.
        """,
    ),
    "check": (
        f"designs beacons days start_day motion {BOUNDS}",
        """Settle every [[requirement]] of DESIGNS: met or missed, proven or with a bracket.

        Several DESIGNS are one network: their satellites together, asked for the requirements of
        all.

        Exit status 0 all met, 1 one missed or undecided, 2 bad input.
        """,
    ),
    "deploy": (
        "designs launch_altitude_km longest_wait_days satellites_a_launch",
        """Weigh waiting for planes, whose nodes Mars's flattening turns apart, against delta-v.

        Several DESIGNS are one network. Exit status 0 if waiting reaches every plane in time, 1 if
        not.
        """,
    ),
    "determine": (
        "design days update_h motion output picture name",
        """Covariance of the orbits and clocks of a DESIGN, tracked as its [tracking] says.

        Radial, along, cross and clock sigma of every satellite against time, what each kind of
        tracking buys, and the [signal] for the users that follows.
        """,
    ),
    "drift": (
        "designs days start_day step_days fold mask_deg region trimmed radius_km avoid_km "
        "output elements oem",
        """Follow DESIGNS that are left alone: margin and room over time, the first loss, proven.

        Several DESIGNS are one network: their satellites together.

        Exit status 0 if what the design requires (without requirements the fold) is proven for all
        the days, 1 if it is lost, undecided or cannot be followed.
        """,
    ),
    "export": (
        "design format output duration_h step_s motion start_day",
        """Write a DESIGN down for other programs.

        OEM: states in ICRF about Mars, TDB, one message a satellite. CZML: satellites, paths and
        stations on the Mars ellipsoid. GeoJSON: ground tracks, and sub-satellite points,
        footprints and gaps at the first moment. TOML: the design file itself, every pattern and
        unit made plain.
        """,
    ),
    "fold": (
        "design fold mask_deg losses region duration_h days start_day motion",
        """Prove continuous k-fold coverage, or refute it with a witness; no grid, no time steps.

        Exit status 0 proven, 1 refuted or undecided, 2 bad input.
        """,
    ),
    "horizon": (
        "design terrain variable latitude_kind above_m azimuths output",
        """Draw the horizon of every station from terrain, and write it into a design file.""",
    ),
    "judge": (
        f"designs {AREAS} scenario samples seed goal_m density_sigma lift_sigma clock_m "
        "clock_drift_m_s orbit_m satellite_clock_m range_bias_m finalists runs rival "
        "rival_radius_km start_day workers folder",
        """Judge constellations as beacons of a lander: anywhere, along any azimuth, at any time.

        The lander of the scenario is flown to parachute deployment (its trigger of that name, or
        the end of the scenario) at sites over the whole globe, or at those named, at moments over
        the repeat period. Ranked by the 95th percentile of the Cramer-Rao bound of position there,
        blackout taken into account.
        """,
    ),
    "keep": (
        "designs years box_deg fold mask_deg specific_impulse_s dry_mass_kg smallest_burn_m_s "
        "execution_error navigation_error_m seed radius_km",
        """Simulate impulsive station-keeping of every satellite of DESIGNS in its slot.

        Several DESIGNS are one network: their satellites together.

        Exit status 0 if all stay within the margin, 1 if not.
        """,
    ),
    "land": (
        "scenario output figures runs start_day strict",
        """Fly a SCENARIO and navigate it: trajectory, view, observability, bound and filter.

        A scenario with a table [fusion] is also flown with accelerometers and ranges in
        centralised and distributed filters, through plasma and faults if it has them.
        """,
    ),
    "locate": (
        "design site satellites hours step_s start_day goal_m height_m doppler_m_s clock",
        """Find how well a user who stands still knows his place from ranges and Doppler over time.

        With one to three satellites of a DESIGN in view there is no fix at a moment, but hours of
        standing make one. Exit status 0 if the goal is met with a held clock and a known height.
        """,
    ),
    "map": (
        f"designs {AREAS} beacons output picture name step_deg grid epochs altitude_km mask_deg "
        "beam_deg fold pdop_max motion start_day duration_h error_max_m weights each_loss "
        f"{BOUNDS} workers {CLUSTER} time_series",
        """Count and DOP maps of DESIGNS over the sphere and one repeat period.

        Several DESIGNS are one network: their satellites together.

        A dilution of precision is infinite with fewer than four satellites in view; infinities
        count in every percentile (JSON: null) and against availability.
        """,
    ),
    "new": (
        "kind like output",
        """Write a commented file to start from: every key, its unit, range and default.

        It runs as it is. Files that it names are written beside it.
        """,
    ),
    "optimize": (
        "scenario figures",
        """Search for the best beacons or orbits, as the SCENARIO's [optimize] table asks.""",
    ),
    "report": (
        f"designs {AREAS} beacons output step_deg epochs store",
        """Report on a design, a scenario, a study or a paper: one HTML page that needs no network.

        Several DESIGNS are one network of satellites: theirs together.

        A file with a table [study] is a study, and its page is made from the store of `compass
        trade`; one with a table [vehicle] is a scenario of landing; all else is a design. The name
        of a source paper, as of `compass reproduce`, is a page of its numbers beside the computed
        ones.

        The maps of a design's page are of users on the ground, as its caps, passes and stations
        are; it shows those in orbit where a [[requirement]] with altitude_km asks for them.
        """,
    ),
    "reproduce": (
        "paper output",
        """Every number of a source PAPER: published, computed, and who is right.

        Exit status 1 if a number differs and the paper is not shown to be wrong.
        """,
    ),
    "schema": (
        "kind",
        """Print the JSON Schema of a design, scenario or study file.

        Editors complete and check a TOML file by it: write it to a file, and name that in the
        first line, `#:schema design.json`.
        """,
    ),
    "search": (
        "require fold region pdop_at_most gdop_at_most share share_of least_approach_deg "
        "mask_deg radius_km altitude_km orbit repeat max_satellites beyond pattern figure "
        "finalists days budget_s workers output",
        """Find the smallest pattern that meets requirements, or covers the whole sphere k-fold.

        Requirements are those of a file (--require), or --fold, --region and limits on geometry;
        size after size is tried. Ends with the sentence that says what to build. Exit status 1 if
        there is none.
        """,
    ),
    "series": (
        "designs stations beacons routes orbiters beam_deg fold mask_deg days start_day "
        "epochs motion output picture name",
        """Follow what users see over time: satellites in view, dilutions, gaps, errors in metres.

        Several DESIGNS are one network. Gaps are found by rise and set, dilutions at moments.

        Exit status 0 no gap, 1 a station has one, 2 bad input.
        """,
    ),
    "show": (
        "design",
        """Analytic geometry of a DESIGN: caps, gaps, totals; published against exact.""",
    ),
    "trade": (
        f"study store budget_s workers {CLUSTER}",
        """Judge every candidate of a STUDY: an exact screen first, then maps, then entries.

        Every finished batch is stored at once; the same command resumes a run that was killed.
        Exit status 1 if no candidate meets every constraint and has a value for every objective,
        or some were not looked at: workers died of them, or the time allowed was over.
        """,
    ),
    "version": (
        "",
        """Print the versions of compass and of what it runs on.""",
    ),
    "view": (
        "design output opened",
        """Show a DESIGN on a globe: one page, without a network, opened in a browser.

        Satellites move with a slider; every place shows how many it sees, its GDOP or, of a design
        with a table [signal], how many metres a fix errs there.
        """,
    ),
    "warm": (
        "workers",
        """Compile the commands' kernels now, by small jobs of them.

        For images of containers, for clusters, and before a lecture. Rarer options compile theirs
        when they are first asked for.
        """,
    ),
}
