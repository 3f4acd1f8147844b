"""Finalists put to the test: the filter itself, run many times on a constellation."""

from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from math import ceil
from typing import Any

import numpy as np
from numpy.typing import NDArray

from compass.cores import cores
from compass.entry.beacons import Beacons, orbiting_beacons
from compass.entry.campaign import Campaign
from compass.entry.carried import CarriedFilter
from compass.entry.consistency import FALSE_ALARM, nees_bounds
from compass.entry.dispersed import Dispersed, fly_dispersed
from compass.entry.ground import Ground
from compass.entry.guidance import Dispersion, with_bank
from compass.entry.layout import Part
from compass.entry.model import EntryModel
from compass.entry.navigation import MonteCarlo, run_monte_carlo
from compass.entry.radio import WAKE, ElectronModel, ElectronTable
from compass.entry.trajectory import fly
from compass.entry.unknowns import NOTHING, Unknowns
from compass.entry.views import spherical_of
from compass.errors import ArgumentError
from compass.frames import Figure, latitude_longitude, prime_meridian_angle
from compass.inputs.scenario import Scenario
from compass.orbits import Constellation, states_mci
from compass.quantities.draws import percentiles
from compass.sites import Mask
from compass.study.judge import air_not_known, campaign_of, due, judge_entries
from compass.study.judgement import Judgement

#: Entries over which the runs are spread.
ENTRIES = 64

#: Figures of a design whose filter is not run.
NOT_RUN: dict[str, Any] = {
    "ekf_position_m": {"p50": None, "p95": None},
    "ekf_velocity_m_s": {"p50": None, "p95": None},
    "nees": None,
    "believed": None,
    "rms_over_bound": None,
}


def judge_filter(
    constellation: Constellation,
    scenario: Scenario,
    *,
    samples: int,
    runs: int = 512,
    seed: int = 0,
    figure: Figure,
    mask: Mask,
    electrons: ElectronModel | ElectronTable | None = WAKE,
    density_sigma: float = 0.0,
    lift_sigma: float = 0.0,
    unknowns: Unknowns = NOTHING,
    ground: Ground | None = None,
    threads: int | None = None,
    progress: Callable[..., Iterable[Any]] = lambda items, **_: items,
) -> dict[str, Any]:
    """Errors of the scenario's filter at deployment and their consistency, as plain values.

    Parameters
    ----------
    constellation, scenario, figure, mask
        As in `compass.study.judge.judge`; the truth is the scenario's, with its biases.
    samples, runs
        Entries of the campaign, of which the first `ENTRIES` are flown, and how many runs at
        least, the same number in each entry, with its own errors, noise and arrivals.
    seed
        Of the entries and of the runs.
    electrons, ground
        As in `compass.study.judge.campaign_of`.
    density_sigma, lift_sigma, unknowns
        What is not known: the filter estimates density, L/D and its clock, and considers errors of
        the satellites, as a bias of the ranges to each: the size of its error along the line of
        sight in mid-flight, which hardly turns in an entry.
    threads
        Threads; one a processor if left out. The numbers do not depend on them.
    progress
        Wraps the entries in work, called with ``total``, as tqdm is.

    Returns
    -------
    dict
        ``ekf_position_m``, ``ekf_velocity_m_s``: percentiles and root mean square of the error;
        ``nees``: mean normalised estimation error squared; ``nees_interval``: low and high, which
        hold the mean of a consistent filter in 95 of 100 cases (chi-squared with 6 degrees of
        freedom a run); ``consistent``: whether they do; ``believed``: whether no run diverged and
        an interval that leaves out one consistent filter in a thousand holds the mean;
        ``errors_over_claim``: root of its ratio to 6; ``rms_over_bound``: root mean square
        error over that of the bound on the same entries; ``runs``, ``diverged``. Of a guided lander
        ``delivery_m`` besides: see `_delivery`.
    """
    from scipy.stats import chi2

    if runs < 1:
        raise ArgumentError(f"runs = {runs}: must be at least 1")
    entries = min(ENTRIES, samples, runs)
    density_sigma, lift_sigma = air_not_known(scenario, density_sigma, lift_sigma)
    campaign = campaign_of(
        scenario,
        entries,
        seed,
        electrons=electrons,
        density_sigma=density_sigma,
        lift_sigma=lift_sigma,
        ground=ground,
    )
    air = (("air", density_sigma), ("lift", lift_sigma * abs(scenario.model.vehicle.lift_to_drag)))
    own = tuple(p for p in scenario.settings.parts if p.name in ("imu", "attitude", "gyro"))
    own_parts = (*(Part(name, (sigma,)) for name, sigma in air if sigma), *own)
    each = ceil(runs / campaign.size)
    found = judge_entries(
        constellation, campaign, scenario, figure=figure, mask=mask, unknowns=unknowns
    )
    streams = np.random.SeedSequence(seed).spawn(campaign.size)
    with ThreadPoolExecutor(cores(threads)) as pool:
        work = pool.map(
            lambda m: _run(found, scenario, m, each, streams[m], own_parts), range(campaign.size)
        )
        parts, landings = zip(*progress(work, total=campaign.size), strict=True)
    errors = np.concatenate([part.errors[:, -1] for part in parts])
    nees = np.concatenate([part.nees[:, -1] for part in parts])
    good = ~np.concatenate([part.diverged for part in parts]) & np.isfinite(nees)
    position = np.linalg.norm(errors[good, :3], axis=1)
    velocity = np.linalg.norm(errors[good, 3:], axis=1)
    count = int(good.sum())
    if not count:
        nothing = {"p50": np.nan, "p95": np.nan, "rms": np.nan}
        low = high = np.nan
        result: dict[str, Any] = {"ekf_position_m": nothing, "ekf_velocity_m_s": nothing}
    else:
        low, high = chi2.ppf([0.025, 0.975], 6 * count) / count
        # several runs of one entry are no independent draws: the first of each are
        first = np.tile(np.arange(each) == 0, campaign.size)[good]
        result = {
            "ekf_position_m": _errors(position, first),
            "ekf_velocity_m_s": _errors(velocity, first),
        }
    mean = float(nees[good].mean()) if count else np.nan
    least, most = nees_bounds(6, max(1, count), 1.0 - FALSE_ALARM)
    bound = np.sqrt(np.mean(found.position_sigma**2))
    return {
        **result,
        "nees": mean,
        "nees_interval": {"low": float(low), "high": float(high)},
        "consistent": bool(low <= mean <= high),
        "believed": bool(count == good.size and least <= mean <= most),
        "errors_over_claim": float(np.sqrt(mean / 6)),
        "rms_over_bound": float(result["ekf_position_m"]["rms"] / bound),
        "runs": int(good.size),
        "diverged": int(good.size - count),
        **({} if scenario.guidance is None else {"delivery_m": _delivery(landings)}),
    }


def _delivery(landings: Sequence[Dispersed]) -> dict[str, Any]:
    """Distances from the targets at which guided entries deploy by what the filter knows, m.

    One flight an entry in closed loop. Those that never deploy are infinitely far;
    ``deployed`` says how many do, ``nees`` how good what guidance knew was, 6 if as it said.
    """
    misses = np.array([one.within(100.0) for one in landings])
    told = np.array([one.nees[0] for one in landings if one.nees is not None and one.reached[0]])
    return {
        **percentiles(misses),
        "entries": misses.size,
        "deployed": int(np.isfinite(misses).sum()),
        "nees": float(told.mean()) if told.size else np.nan,
    }


def _errors(values: NDArray[np.float64], first: NDArray[np.bool_]) -> dict[str, Any]:
    """Percentiles of all runs, with the bounds that the first of every entry leaves them."""
    known = percentiles(values[first] if first.any() else np.array([np.nan]))
    ends = {key: one for key, one in known.items() if key.endswith("interval")}
    return percentiles(values) | ends | {"rms": float(np.sqrt(np.mean(values**2)))}


def entry_beacons(judgement: Judgement, entry: int) -> Beacons:
    """Satellites as beacons of one entry of a judgement, up to its deployment."""
    campaign, c = judgement.campaign, judgement.constellation
    times = campaign.times[: campaign.stops[entry] + 1]
    start = float(judgement.epochs[entry])
    r, v = states_mci(c, start + times)
    return orbiting_beacons(
        r,
        v,
        times,
        omega=campaign.model.omega,
        angle=float(prime_meridian_angle(c.epoch, start)),
        planet_radius=0.0,  # checked by the judge
        names=c.satellite_names,
    )


def _with_air(model: EntryModel, thicker: float, lift: float) -> EntryModel:
    """Return a world with so much added to its logarithm of the density and to its L/D."""
    world = model.truth(density_bias=float(np.expm1(thicker)))
    craft = world.vehicle
    return replace(world, vehicle=replace(craft, lift_to_drag=craft.lift_to_drag + float(lift)))


def _run(
    judgement: Judgement,
    scenario: Scenario,
    entry: int,
    runs: int,
    stream: np.random.SeedSequence,
    own_parts: tuple[Part, ...],
) -> tuple[MonteCarlo, Dispersed | None]:
    """Run the filter in one entry, each run with arrivals of its own; and let it guide a lander."""
    campaign, beacons = judgement.campaign, entry_beacons(judgement, entry)
    count = beacons.times.size
    spread = campaign.spreads[entry, :6, :6]
    path = campaign.paths[entry, :count]
    measurements = scenario.measurements
    one_way = measurements.range_sigma is not None or measurements.rate_sigma is not None
    parts = judgement.unknowns.parts(beacons, path, campaign.model.omega, one_way=one_way)
    if measurements.features.names:
        radius, turn = campaign.model.planet_radius, campaign.turns(scenario.state)[entry]
        measurements = replace(measurements, features=measurements.features.moved(radius, turn))
    settings = replace(scenario.settings, covariance0=spread @ spread.T, parts=(*own_parts, *parts))
    thicker, lift = campaign.worlds[entry]
    # what the filter estimates is drawn about the truth, so it knows the truth but for that draw
    estimated = np.isin(["air", "lift"], [part.name for part in own_parts])
    world, known = (
        with_bank(_with_air(one, *off), campaign.banks[entry])
        for one, off in (
            (scenario.truth, (thicker, lift)),
            (scenario.model, np.where(estimated, (thicker, lift), 0.0)),
        )
    )
    truth = fly(world, spherical_of(campaign.paths[entry, 0]), beacons.times)
    if truth.times.size < count:
        raise ArgumentError(
            f"{scenario.label}: entry {entry + 1}: {truth.ending}, before its deployment at "
            f"{beacons.times[-1]:g} s in the air that the filter knows"
        )
    possible = judgement.seen[entry, :count] & due(scenario, beacons.times)[:, None]
    spawned = stream.spawn(runs)
    arrived = np.stack([np.random.default_rng(own).random(possible.shape) for own in spawned])
    taken = possible & (arrived < campaign.arrival_probability[entry, :count, None])
    many = run_monte_carlo(
        known,
        truth,
        beacons,
        taken,
        measurements,
        settings,
        runs=runs,
        streams=[_errors_stream(own) for own in spawned],
        threads=1,
    )
    if scenario.guidance is None:
        return many, None
    carried = CarriedFilter(truth, beacons, taken[-1], measurements, settings)
    return many, _landing(campaign, scenario, entry, carried, int(spawned[-1].generate_state(2)[1]))


def _errors_stream(run: np.random.SeedSequence) -> np.random.SeedSequence:
    """Stream of a run's errors and noise, independent of that of its arrivals."""
    (own,) = np.random.SeedSequence(int(run.generate_state(1, np.uint64)[0])).spawn(1)
    return own


def _landing(
    campaign: Campaign, scenario: Scenario, entry: int, carried: CarriedFilter, seed: int
) -> Dispersed:
    """Guide one entry to its target by what a filter knows, of the air first what is planned."""
    assert scenario.guidance is not None
    latitude, longitude = map(float, latitude_longitude(campaign.targets[entry]))
    return fly_dispersed(
        _with_air(scenario.truth, *campaign.worlds[entry]),
        scenario.model,
        spherical_of(campaign.paths[entry, 0]),
        Dispersion(entries=1),
        float(scenario.times[-1]),
        trigger=scenario.deployment,
        guidance=replace(scenario.guidance, latitude=latitude, longitude=longitude),
        carried=carried,
        seed=seed,
        threads=1,
    )
