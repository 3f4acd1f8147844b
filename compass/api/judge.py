"""Candidate constellations ranked by landing-navigation quality."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from compass.api.given import given_in_metres, given_places, given_scenario
from compass.api.judge_tables import (
    budget_table,
    delivery_words,
    filter_table,
    not_told_apart,
    ranking_table,
    surface_table,
    unknown_air,
    with_bounds,
)
from compass.api.map_areas import area_blocks
from compass.api.progress import bar
from compass.api.results import Result
from compass.arguments import checked
from compass.cores import cores
from compass.design import Design
from compass.document import Page, Sentence, Verdict
from compass.document.blocks import Block
from compass.document.plain import plain
from compass.entry.doubts import Doubts
from compass.errors import ArgumentError, DesignError
from compass.frames import SECONDS_PER_DAY
from compass.inputs import read_design
from compass.inputs.scenario import Scenario
from compass.orbits.motion import Motion
from compass.orbits.patterns import FARTHEST_KM
from compass.orbits.touching import touching
from compass.saving import check_writable, replacing
from compass.sites import Site
from compass.study.judge import campaign_of, doubts_of, ground_of
from compass.study.ranking import Ranking, ground_words, rank_designs
from compass.study.rival import best_rival, rival_toml

if TYPE_CHECKING:
    from matplotlib.axes import Axes


@dataclass(frozen=True, repr=False)
class JudgeResult(Result):
    """Designs ranked for a lander.

    Attributes
    ----------
    designs
        As given, and the rival if one was asked for.
    scenario
        The lander.
    ranking
        The best first: plain values, and the judgements they come from.
    start_day
        Day after the designs' epochs on whose orbits they were judged.
    """

    designs: tuple[Design, ...] = field(repr=False)
    scenario: Scenario = field(repr=False)
    ranking: Ranking = field(repr=False)
    start_day: float = 0.0

    def to_dict(self) -> dict[str, Any]:
        """Plain values for JSON."""
        known = {"evidence": self.evidence(), "start_day": self.start_day}
        return plain(self.ranking.record | known)

    def evidence(self) -> dict[str, str]:
        """How well the numbers of a design are known, by where they stand in the JSON."""
        return {
            "entries": (
                f"percentiles and shares over {self.ranking.record['samples']} entries drawn; "
                "beside percentiles as _interval: bounds that hold that of all entries in 95 of "
                "100 cases"
            ),
            **dict.fromkeys(
                ("ekf_position_m", "ekf_velocity_m_s"),
                "percentiles over `runs` runs; beside them as _interval the bounds that one run of "
                "each entry leaves: several of one are no independent draws",
            ),
            "worst_found": "a search's, and no bound: another entry may be worse",
            "filter": "of as many runs as `runs` says; nees_interval as the percentiles' bounds",
        }

    def document(self) -> Page:
        """The best and its bound, an answer a design, then the tables."""
        record = self.ranking.record
        rows, goal = record["designs"], record["goal_m"]
        best, unknown = rows[0], unknown_air(record)
        claim = (
            f"{best['design']} is best of {len(rows)}: position bound "
            f"{with_bounds(best['crlb_position_m'], 'p95')} m in 95 % of {record['samples']} "
            f"entries, at {record['deployment']}" + "".join(f", {text}" for text in unknown)
        )
        run = [row for row in rows if row["nees"] is not None]
        return Page(
            self.scenario.name,
            (
                Verdict("", claim),
                Sentence(
                    f"Within {goal:g} m at deployment, {ground_words(record)} and at any time?"
                ),
                *(Sentence(f"{row['design']}: {row['answer']}") for row in rows),
                *(Sentence(said) for said in not_told_apart(rows)),
                ranking_table(rows),
                budget_table(rows),
                *([filter_table(run)] if run else []),
                *(Sentence(said) for said in delivery_words(run)),
                surface_table(rows),
                *self._areas(),
                *([Sentence(_ON_DAY.format(self.start_day))] if self.start_day else []),
                Sentence(f"{record['counted']} {_MEANING}"),
            ),
        )

    def _areas(self) -> list[Block]:
        """What users at the sites and in the regions have of each design."""
        blocks: list[Block] = []
        for row, areas in zip(self.ranking.record["designs"], self.ranking.areas, strict=True):
            if areas:
                said = Sentence(f"Users on the ground, by {row['design']}:")
                blocks += [said, *area_blocks(areas)]
        return blocks

    def plot(self, *, axes: "Axes | None" = None) -> "Axes":
        """Draw which share of entries is within which bound, and after the worst loss.

        Parameters
        ----------
        axes
            Where to; new ones without.
        """
        from compass.pictures.judge import draw_distributions
        from compass.pictures.style import axes_or_new

        record = self.ranking.record
        names = [row["design"] for row in record["designs"]]
        drawn = axes_or_new(axes, 8.0, 4.6)
        draw_distributions(drawn, names, self.ranking.judgements, record["goal_m"])
        return drawn


_MEANING = (
    "p50, p95: Cramer-Rao sigma of the position in space over the entries; worst: that a search "
    "finds. In brackets: bounds that hold what all entries have in 95 of 100 cases. "
    "In view: fewest. After worst loss: of the one satellite that matters most. Blind: "
    "entries whose measurements alone do not determine the state. NEES: 6 if the filter is "
    "consistent, which in 95 of 100 cases puts it between the bounds. Budget: root mean squares "
    "over the entries, whose squares add up; ignored: for a filter that is blind to the errors of "
    "the satellites (their classical consider covariance)."
)
_ON_DAY = "On the ellipses that touch the orbits on day {:g} after the epoch."


@checked
def judge(
    designs: Design | str | Path | Sequence[Design | str | Path],
    *,
    scenario: Scenario | str | Path,
    samples: int = 1024,
    seed: int = 0,
    goal_m: float = 10.0,
    density_sigma: float = 0.0,
    lift_sigma: float = 0.0,
    clock_m: float = Doubts.clock_m,
    clock_drift_m_s: float = Doubts.clock_drift_m_s,
    orbit_m: Sequence[float] = Doubts.orbit_m,
    satellite_clock_m: float = Doubts.satellite_clock_m,
    range_bias_m: float = Doubts.range_bias_m,
    finalists: int = 3,
    runs: int = 512,
    sites: Site | str | Sequence[Site | str] = (),
    regions: str | Sequence[str] = (),
    rival: str | Path | None = None,
    rival_radius_km: float | None = None,
    start_day: float = 0.0,
    workers: int | None = None,
    command: str = "",
    progress: bool = False,
) -> JudgeResult:
    """Judge constellations as beacons of a lander: anywhere, along any azimuth, at any time.

    The lander of the scenario is flown to parachute deployment (its trigger of that name, or the
    end of the scenario) at sites over the whole globe, or at those named, at moments over the
    repeat period. Ranked by the 95th percentile of the Cramer-Rao bound of position there,
    blackout taken into account.

    Parameters
    ----------
    designs
        Candidates, or the paths of their files; one or several.
    scenario
        The lander, or the path of its file.
    samples, seed
        Entries to judge on, and the seed of sites, times and noise.
    goal_m
        Position wanted, m.
    density_sigma, lift_sigma
        Unknown density and L/D, relative; 0 where they are known.
    clock_m, clock_drift_m_s
        One sigma of the lander's clock and its drift, which are estimated; 0 and 0 for a clock
        that agrees with the satellites', or two-way ranges.
    orbit_m, satellite_clock_m
        One sigma of broadcast orbits (radial, along, cross) and clocks; a design with a table
        [signal] has its own.
    range_bias_m
        One sigma of a bias of the ranges to each satellite.
    finalists, runs
        On how many of the best to run the filter, and how often on each.
    sites, regions
        Where the landers deploy, by turns, along any azimuth: sites, names of the designs'
        stations, or ``NAME=LAT,LON[,MASK]``; ``lat:MIN:MAX`` or ``polygon:LAT,LON;...``, degrees.
        What users on the ground have there is proven or bracketed besides.
    rival
        Find the best Walker delta of the first design's size, write it there, and rank it too.
    rival_radius_km
        Its orbits' radius; the first design's if left out.
    start_day
        Day after the designs' epochs: the beacons fly on the ellipses that touch the orbits then,
        as do those of designs that do not move on ellipses.
    workers
        Threads; by default one a core. The numbers do not depend on them.
    command
        What to write into the rival's file as its source.
    progress
        Show bars on stderr.

    Raises
    ------
    ArgumentError, DesignError, OutputError
        An option, a file or the rival's place is not allowed.

    Examples
    --------
    >>> import compass
    >>> few = {"samples": 8, "finalists": 0}
    >>> design, lander = "designs/compass-15-5-1.toml", "designs/landing.toml"
    >>> found = compass.judge(design, scenario=lander, **few)
    >>> found.to_dict()["designs"][0]["in_view"]["min"] >= 4
    True
    """
    if start_day and rival is not None:
        raise ArgumentError("start_day: a rival is sought as patterns are drawn; leave one out")
    lander, candidates = _read(designs, scenario)
    candidates = [_on_day(design, start_day) for design in candidates]
    places = given_places(sites, regions, _with_all_stations(candidates))
    unknown: dict[str, Any] = {"density_sigma": density_sigma, "lift_sigma": lift_sigma}
    radial, along, cross = _three(orbit_m)
    doubts = Doubts(
        clock_m, clock_drift_m_s, (radial, along, cross), satellite_clock_m, range_bias_m
    )
    threads = cores(workers)

    def bars(work: Iterable[Any], total: int, desc: str) -> Iterable[Any]:
        return bar(progress, desc, work, total=total)

    radius = _rival_radius(rival_radius_km, rival, candidates)
    if rival is not None:
        place = Path(rival)
        labels = [lander.label, *(design.label for design in candidates)]
        check_writable(place, [Path(label) for label in labels])
        campaign = campaign_of(lander, samples, seed, ground=ground_of(*places), **unknown)
        better = best_rival(
            candidates[0],
            lander,
            campaign,
            radius=radius,
            unknowns=doubts_of(lander, doubts).of(
                candidates[0].signal, candidates[0].constellation.size
            ),
            threads=threads,
            progress=bars,
        )
        with replacing(place) as temporary:
            temporary.write_text(rival_toml(better, candidates[0], command), encoding="utf-8")
        candidates.append(read_design(place))
    ranking = rank_designs(
        candidates,
        lander,
        samples=samples,
        seed=seed,
        goal=goal_m,
        doubts=doubts,
        finalists=finalists,
        runs=runs,
        sites=places[0],
        regions=places[1],
        threads=threads,
        progress=bars,
        **unknown,
    )
    return JudgeResult(tuple(candidates), lander, ranking, start_day)


def _on_day(design: Design, day: float) -> Design:
    """Return the design on the ellipses that touch its orbits on a day after its epoch."""
    if day == 0.0 and design.motion.is_closed_form:
        return design
    flown = touching(design.constellation, design.motion, day * SECONDS_PER_DAY)
    return replace(design, constellation=flown, motion=Motion())


def _with_all_stations(designs: Sequence[Design]) -> Design:
    """Return the first design with the stations of all; of one name those of the first."""
    named: dict[str, Site] = {}
    for design in designs:
        named = {site.name: site for site in design.stations} | named
    return replace(designs[0], stations=tuple(named.values()))


def _three(orbit_m: Sequence[float]) -> Sequence[float]:
    if len(orbit_m) != 3:
        raise ArgumentError(f"orbit_m = {list(orbit_m)}: give radial, along and cross, m")
    return orbit_m


def _read(
    designs: Design | str | Path | Sequence[Design | str | Path], scenario: Scenario | str | Path
) -> tuple[Scenario, list[Design]]:
    """Read all files; the faults of all are said at once."""
    faults: list[str] = []

    def read(reader: Callable[[Any], Any], thing: object) -> Any:
        try:
            return reader(thing)
        except DesignError as error:
            faults.extend(error.faults)

    several = (
        designs if isinstance(designs, Sequence) and not isinstance(designs, str) else [designs]
    )
    lander = read(given_scenario, scenario)
    candidates = [read(given_in_metres, each) for each in several]
    if faults:
        raise DesignError(list(dict.fromkeys(faults)))
    return lander, candidates


def _rival_radius(
    radius_km: float | None, rival: str | Path | None, designs: Sequence[Design]
) -> float | None:
    """Radius of the rival's orbits, metres, or None for the first design's."""
    if radius_km is None or not designs:
        return None
    if rival is None:
        raise ArgumentError("rival_radius_km: says where --rival is to look; give --rival too")
    surface = designs[0].figure.equatorial_radius / 1e3
    if not surface < radius_km <= FARTHEST_KM:
        raise ArgumentError(
            f"rival_radius_km = {radius_km:g}: allowed above the surface ({surface:g} km) to "
            f"{FARTHEST_KM:g} km"
        )
    return radius_km * 1e3
