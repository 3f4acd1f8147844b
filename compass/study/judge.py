"""A constellation judged as radio beacons of a lander, anywhere and at any time."""

from collections import OrderedDict
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from compass.core.entry.information import Limb, Receiver, Satellites, information
from compass.core.entry.many import Flights, Worlds, bounds, count_in_view
from compass.core.entry.own_information import Readings, own_information
from compass.cores import in_blocks
from compass.coverage.region import read_regions
from compass.digest import digest_of
from compass.entry.arrivals import Arrivals, draw_arrivals
from compass.entry.campaign import (
    Campaign,
    check_sigmas,
    fly_campaign,
    moved_starts,
    moved_targets,
)
from compass.entry.doubts import Doubts
from compass.entry.ground import Ground, aimed
from compass.entry.guidance import Dispersion
from compass.entry.layout import block
from compass.entry.radio import WAKE, ElectronModel, ElectronTable
from compass.entry.unknowns import NOTHING, Unknowns
from compass.errors import ArgumentError
from compass.frames import Figure, latitude_longitude, prime_meridian_angle
from compass.inputs.scenario import Scenario
from compass.orbits import Constellation, repeat_period, states_mci
from compass.sites import Mask, Site
from compass.study.judgement import Judgement, unpacked

Array = NDArray[np.float64]

#: Seconds between the nodes from which satellites are interpolated.
NODE_STEP = 30.0

#: Entries handed to a thread at once.
BLOCK = 64


@dataclass(frozen=True)
class _Request:
    """What a campaign depends on, so that one is flown for all constellations."""

    scenario: Scenario
    electrons: ElectronModel | ElectronTable | None
    samples: int
    seed: int
    density_sigma: float
    lift_sigma: float
    ground: Ground | None


#: The last campaigns flown, by their requests' digests.
_FLOWN: OrderedDict[str, Campaign] = OrderedDict()

#: How many campaigns are kept.
MOST_FLOWN = 4


def _flown(request: _Request) -> Campaign:
    """Campaign of a request, flown unless one of the same content was."""
    try:
        key = digest_of(request)
    except TypeError:  # electrons by a function of the user's, which may be another tomorrow
        return _fly(request)
    if key not in _FLOWN:
        _FLOWN[key] = _fly(request)
        while len(_FLOWN) > MOST_FLOWN:
            _FLOWN.popitem(last=False)
    _FLOWN.move_to_end(key)
    return _FLOWN[key]


def _fly(request: _Request) -> Campaign:
    scenario, ground = request.scenario, request.ground
    check_sigmas(request.density_sigma, request.lift_sigma)

    def fly(arrivals: Arrivals, electrons: Any, dispersion: Dispersion | None) -> Campaign:
        return fly_campaign(
            scenario.model,
            scenario.state,
            scenario.settings.covariance0,
            scenario.times,
            arrivals,
            trigger=scenario.deployment,
            electrons=electrons,
            density_sigma=request.density_sigma,
            lift_sigma=request.lift_sigma,
            dispersion=dispersion,
            guidance=scenario.guidance,
            seed=request.seed,
        )

    def place(tried: Arrivals) -> tuple[Array, Array]:
        if scenario.guidance is None:
            return fly(tried, None, None).deployment_place
        starts = moved_starts(scenario.state, tried)
        return latitude_longitude(moved_targets(scenario.state, scenario.guidance, starts))

    def to(goals: Arrivals) -> Campaign:
        entries = aimed(place, goals)
        flown = fly(entries, request.electrons, scenario.dispersion)
        return replace(flown, again=to, ground=ground, goals=goals)

    try:
        if ground is not None:
            return to(ground.draw(request.samples, request.seed))
        drawn = draw_arrivals(request.samples, request.seed)
        return fly(drawn, request.electrons, scenario.dispersion)
    except ArgumentError as error:  # what is left is the lander's fault
        raise ArgumentError(f"{scenario.label}: {error}") from error


def campaign_of(
    scenario: Scenario,
    samples: int,
    seed: int = 0,
    *,
    electrons: ElectronModel | ElectronTable | None = WAKE,
    density_sigma: float = 0.0,
    lift_sigma: float = 0.0,
    ground: Ground | None = None,
) -> Campaign:
    """Entries of the scenario's lander spread over sites, azimuths and time; kept for reuse.

    With a ground they are aimed so as to deploy there. Guided ones fly to a target that is moved
    with them.

    The scenario's own site, its beacons and the bias of its truth play no role. Where its link
    counts plasma itself, signals are lost by that alone. Each differs by the scenario's dispersion.

    Parameters
    ----------
    scenario
        The lander, what it knows on arrival, and its deployment.
    samples, seed
        How many entries, and the seed of where and when they begin.
    electrons, density_sigma, lift_sigma
        As in `compass.entry.campaign.fly_campaign`.
    ground
        Where they deploy; anywhere if left out.
    """
    density_sigma, lift_sigma = air_not_known(scenario, density_sigma, lift_sigma)
    link = scenario.measurements.link
    if link is not None and link.electrons is not None:
        electrons = None
    return _flown(_Request(scenario, electrons, samples, seed, density_sigma, lift_sigma, ground))


def air_not_known(
    scenario: Scenario, density_sigma: float, lift_sigma: float
) -> tuple[float, float]:
    """Relative sigmas of density and L/D: of the scenario's own filter, else as asked for."""
    own = {part.name: part.sigma for part in scenario.settings.parts}
    ratio = abs(scenario.model.vehicle.lift_to_drag)
    if "lift" in own and ratio == 0:
        raise ArgumentError(
            f"{scenario.label}: filter.lift_to_drag: judged is a share of L/D, which is 0; leave "
            "the table out"
        )
    density = own["air"][0] if "air" in own else density_sigma
    return density, own["lift"][0] / ratio if "lift" in own else lift_sigma


def doubts_of(scenario: Scenario, doubts: Doubts) -> Doubts:
    """What is not known of clock and ranges: of the scenario's own filter, else as asked for."""
    own = {part.name: part.sigma for part in scenario.settings.parts}
    if "clock" in own:
        doubts = replace(doubts, clock_m=own["clock"][0], clock_drift_m_s=own["clock"][1])
    if "bias" in own:
        doubts = replace(doubts, range_bias_m=own["bias"][0])
    return doubts


def instrument_errors(scenario: Scenario) -> Array:
    """One sigma of biases of accelerometers, of axes and of the gyros that hold them, (9,)."""
    own = {part.name: part.sigma for part in scenario.settings.parts}
    return np.concatenate([own.get(name, (0.0,) * 3) for name in ("imu", "attitude", "gyro")])


def ground_of(sites: Sequence[Site], regions: Sequence[str]) -> Ground | None:
    """Ground of sites, and of regions as `compass.coverage.region.read_regions` reads them.

    None without any, and where one is the globe and nothing else is named: anywhere.
    """
    if not sites and set(regions) <= {"globe"}:
        return None
    return Ground(
        (*(site.name for site in sites), *regions),
        (*((site.latitude, site.longitude) for site in sites), *(None for _ in regions)),
        (*(() for _ in sites), *(read_regions(text) for text in regions)),
    )


def judge(
    constellation: Constellation,
    scenario: Scenario,
    *,
    samples: int,
    seed: int = 0,
    figure: Figure,
    mask: Mask,
    goal: float = 10.0,
    unknowns: Unknowns = NOTHING,
    **campaign: Any,
) -> dict[str, Any]:
    """Figures of merit of a constellation for the landers of a scenario, as plain values.

    Parameters and errors as in `campaign_of` (with its keywords), `judge_entries` and
    `Judgement.figures`.
    """
    flown = campaign_of(scenario, samples, seed, **campaign)
    place: dict[str, Any] = {"figure": figure, "mask": mask, "unknowns": unknowns}
    return judge_entries(constellation, flown, scenario, **place).figures(goal)


def judge_entries(
    constellation: Constellation,
    campaign: Campaign,
    scenario: Scenario,
    *,
    figure: Figure,
    mask: Mask,
    unknowns: Unknowns = NOTHING,
    threads: int = 1,
) -> Judgement:
    """Information and posterior Cramer-Rao bound in each entry of a campaign.

    A range that arrives with probability lambda is worth ``lambda h^T h / sigma^2`` in
    expectation. The entries begin at their phases of the ground tracks' repeat period.

    Instruments that need no beacon count in full, and features lie about every entry as they do
    about the scenario's own. Noise is white. What the lander does not know of clocks, orbits and
    biases is constant through an entry, and counted as far as `unknowns` says. Light time is known,
    so it changes nothing. What of this does not hold makes errors larger than the bound.

    Parameters
    ----------
    constellation
        The beacons, in two-body motion.
    campaign
        The entries, of `campaign_of`.
    scenario
        What is measured, and how well.
    figure
        Its equatorial radius is that of the sphere that blocks the view.
    mask
        Elevation over the limb below which a satellite is not heard; of one that depends on
        azimuth the highest, for a lander knows no horizon of hills.
    unknowns
        Clocks, orbits and biases that the lander does not know.
    threads
        Threads; the result does not depend on them.

    Raises
    ------
    ArgumentError
        Measurements in turn, process noise, or a satellite that comes down to the surface.
    """
    check_measurements(scenario)
    _check_height(constellation, figure)
    size, n = campaign.size, constellation.size
    epochs = campaign.arrivals.phase * repeat_period(constellation).duration
    angles = prime_meridian_angle(constellation.epoch, epochs)
    flown = int(campaign.stops.max())
    nodes = int(np.ceil(campaign.times[flown] / NODE_STEP)) + 1
    weights = campaign.arrival_probability * due(scenario, campaign.times)
    measurements, planet = scenario.measurements, campaign.model.planet_radius
    variances, link = measurements.radio_variances(), measurements.link
    radio = np.empty(0) if link is None else link.numbers()
    dimmed = np.zeros(campaign.paths.shape[:2])
    if link is not None:
        dimmed = link.dimmed(campaign.paths_to_stops, campaign.model.atmosphere, planet)
    seen = np.zeros((size, campaign.times.size, n), dtype=bool)
    clock = unknowns.clock_sigmas()
    roots = unknowns.roots(n, one_way=bool(np.isfinite(variances[:2]).any()))
    motions, turns = campaign.gains.shape[3], 3 if unknowns.turn else 0
    d = motions + turns + clock.size
    packed = d * (d + 1) // 2
    shares, sigma = np.zeros((size, n, packed)), np.empty((size, 1 + n, 2))
    sums, ends = np.zeros((size, 4, packed)), np.zeros((size, 6, d))
    own = np.zeros((size, 1, packed))
    sources, readings, kinds = _own_readings(scenario, campaign)
    dt = float(campaign.times[1])
    limb = Limb(figure.equatorial_radius, np.sin(mask.highest), np.cos(mask.highest))
    ends[:, :, :motions] = campaign.gains[np.arange(size), campaign.stops]

    def work(part: slice) -> None:
        when = epochs[part, None] + NODE_STEP * np.arange(nodes)
        r, v = states_mci(constellation, when.ravel())
        flights = Flights(campaign.paths[part], campaign.gains[part], campaign.stops[part])
        turned = turned_gains(flights.paths, flights.gains, unknowns.turn)
        information(
            flights._replace(gains=turned),
            Receiver(dt, weights[part], variances, radio, dimmed[part], clock),
            Satellites(r, v, angles[part], campaign.model.omega, NODE_STEP, roots),
            limb,
            seen[part],
            shares[part],
            sums[part],
        )
        if kinds.size:
            own_information(
                flights,
                Worlds(campaign.worlds[part], campaign.spreads[part], campaign.banks[part]),
                campaign.model.flight_parameters(),
                campaign.times,
                Readings(sources[part], readings[part], kinds, instrument_errors(scenario)),
                own[part],
            )
        bounds(shares[part], own[part], ends[part], sigma[part])

    in_blocks(work, size, BLOCK, threads)
    counts = np.zeros((1 + n, 1 + n), dtype=np.int64)
    count_in_view(seen, campaign.stops, counts)
    total = unpacked(shares.sum(axis=1) + own[:, 0])
    return Judgement(
        constellation, campaign, unknowns, epochs, seen, counts, total, shares, own[:, 0], sigma,
        ends, sums,
    )  # fmt: skip


def turned_gains(paths: Array, gains: Array, turn: float) -> Array:
    """Gains (m, t, 6, d) and behind them what turns of the satellites' frame do, (m, t, 6, d + 3).

    Of one sigma about each axis; none for 0. Measured is how lander and satellites stand to each
    other: satellites turned by w look as they do to one whose flight is turned by -w.
    """
    if not turn:
        return gains
    vectors = paths.reshape(*paths.shape[:2], 2, 1, 3)
    turned = np.cross(vectors, turn * np.eye(3)).swapaxes(-1, -2)
    return np.concatenate([gains, turned.reshape(*paths.shape[:2], 6, 3)], axis=-1)


def _own_readings(scenario: Scenario, campaign: Campaign) -> tuple[Array, Array, NDArray[np.int64]]:
    """Sources (m, k + 1, 6), variances (m, t, k + 1, c) and kinds of what needs no beacon.

    Features lie about every entry as they do about the scenario's own.
    """
    measurements, planet = scenario.measurements, campaign.model.planet_radius
    places = measurements.features.places(planet)
    at = np.einsum("mij,kj->mki", campaign.turns(scenario.state), places)
    sources = np.zeros((campaign.size, len(places) + 1, 6))
    sources[:, :-1, :3] = at
    paths = campaign.paths_to_stops
    return sources, *measurements.own_readings(campaign.times, paths, at, planet)


def due(scenario: Scenario, times: Array) -> NDArray[np.bool_]:
    """Whether measurements are taken at `times` (s), if anything is in view."""
    return scenario.measurements.taken(np.ones((times.size, 1), dtype=bool), times)[:, 0]


def check_lander(scenario: Scenario, samples: int, seed: int = 0) -> None:
    """Refuse a lander that cannot be judged, before work is spent on constellations for it.

    The first of its entries are flown: one that never deploys does so nowhere.

    Raises
    ------
    ArgumentError
        As `check_measurements` and `compass.entry.campaign.fly_campaign`.
    """
    check_measurements(scenario)
    campaign_of(scenario, min(samples, BLOCK), seed)


def check_measurements(scenario: Scenario) -> None:
    """Refuse what the bound does not cover.

    Raises
    ------
    ArgumentError
        Measurements in turn, process noise, a density or axes that wander, or quantities that
        the filter only considers.
    """
    if scenario.measurements.in_turn:
        raise ArgumentError(
            f"{scenario.label}: measurements.in_turn = true: judged is what all satellites in "
            "view tell at once; set it to false"
        )
    if np.any(scenario.settings.noise):
        raise ArgumentError(
            f"{scenario.label}: filter.process_noise_si: judged is the bound without process "
            "noise: leave it out, or fly single entries with it, `compass land`"
        )
    for part in scenario.settings.parts:
        if part.scales or part.walk:
            raise ArgumentError(
                f"{scenario.label}: filter: {block(part.name).title}: wanders; judged are sums of "
                "information, which hold of what is constant through an entry: leave the scales "
                "(or the walk) out, or fly single entries with them, `compass land`"
            )
        if part.considered and part.name != "bias":
            raise ArgumentError(
                f"{scenario.label}: filter: {block(part.name).title}: only considered; judged is "
                "the bound, in which all is found out as far as it can be: set considered = false "
                "(range_bias may be considered), or fly single entries with it, `compass land`"
            )


def _check_height(constellation: Constellation, figure: Figure) -> None:
    lowest = constellation.periapsis_radius.min(initial=np.inf)
    if lowest <= figure.equatorial_radius:
        raise ArgumentError(
            f"{constellation.name}: comes down to radius {lowest / 1e3:g} km; must stay above the "
            f"surface, {figure.equatorial_radius / 1e3:g} km"
        )
