"""A survey as plain values with units in their names: what the command line and reports show."""

from collections.abc import Sequence
from dataclasses import asdict
from itertools import combinations
from typing import Any

import numpy as np

from compass.contacts.nodes import Node, find_node, sun_node
from compass.contacts.radio import Track, carrier_to_noise, track
from compass.contacts.relay import Contacts, contacts, latency, reach
from compass.contacts.spans import all_of, any_of, outside, total
from compass.contacts.statistics import statistics
from compass.contacts.survey import Survey
from compass.contacts.windows import Windows, eclipses
from compass.frames import DEFAULT_FIGURE, HOUR, SECONDS_PER_DAY, Figure
from compass.links import Radio
from compass.planets import conjunction_seasons, sun_earth_mars_angle

#: Range is taken this often in a turn of the faster node, and at most so often in all.
POINTS_PER_TURN, MAX_POINTS = 64, 20_000

#: Stations between which waiting times are worked out, at most: they grow with the square.
MAX_MAIL_STATIONS = 20

#: Nodes times intervals of a graph of links that is searched, at most: some 500 MB.
MAX_GRAPH = 20_000_000


def pair_track(survey: Survey, windows: Windows) -> Track:
    """Range, range rate and light time of a pair along its windows, their ends included."""
    one, two = find_node(survey.nodes, windows.first), find_node(survey.nodes, windows.second)
    step = 2 * np.pi / (POINTS_PER_TURN * max(one.rate, two.rate))
    grid = np.arange(0.0, windows.duration, max(step, windows.duration / MAX_POINTS))
    window = np.searchsorted(windows.start, grid, side="right") - 1
    inside = (window >= 0) & (grid < np.append(windows.end, 0.0)[window])
    return track(one, two, np.sort(np.concatenate([windows.start, grid[inside], windows.end])))


def pair_record(survey: Survey, windows: Windows) -> dict[str, Any]:
    """Return windows, statistics and the extremes of the range of a pair."""
    path = pair_track(survey, windows) if windows.count else None
    numbers = statistics(windows.spans, windows.duration)
    rows = zip(
        windows.start,
        windows.end,
        windows.length,
        windows.culmination,
        windows.max_elevation,
        strict=True,
    )
    return {
        "first": windows.first,
        "second": windows.second,
        "windows": [
            {
                "start_s": start,
                "end_s": end,
                "duration_s": length,
                "culmination_s": culmination,
                "max_elevation_deg": np.degrees(elevation),
            }
            for start, end, length, culmination, elevation in rows
        ],
        "count": numbers.count,
        "share": numbers.share,
        "mean_duration_h": numbers.mean_duration / HOUR,
        "longest_gap_h": numbers.longest_gap / HOUR,
        "passes_per_sol": numbers.passes_per_sol,
        "least_range_km": path.distance.min() / 1e3 if path else None,
        "largest_range_km": path.distance.max() / 1e3 if path else None,
        "largest_range_rate_km_s": np.abs(path.range_rate).max() / 1e3 if path else None,
        "largest_light_time_s": path.light_time.max() if path else None,
    }


def node_record(survey: Survey, node: Node) -> dict[str, Any] | None:
    """How a station, a moon or the Earth sees the satellites; None if it links with none."""
    own = survey.of(node.name)
    if not own:
        return None
    each = [statistics(w.spans, w.duration) for w in own]
    lengths = np.concatenate([w.length for w in own])
    gaps = np.array([one.longest_gap for one in each])
    merged = statistics(any_of([w.spans for w in own]), survey.duration)
    return {
        "node": node.name,
        "satellites": len(own),
        "seen": sum(w.count > 0 for w in own),
        "mean_share": float(np.mean([one.share for one in each])),
        "least_share": min(one.share for one in each),
        "passes_per_sol": sum(one.passes_per_sol for one in each) / len(each),
        "mean_pass_h": float(lengths.mean()) / HOUR if lengths.size else None,
        "longest_gap_h": float(gaps.max()) / HOUR,
        "any_share": merged.share,
        "any_longest_gap_h": merged.longest_gap / HOUR,
    }


def earth_record(survey: Survey, epoch: float, threshold: float) -> dict[str, Any]:
    """How stations reach the Earth, alone and through the network, and the Sun's part in it.

    Where the graph of links is too large to search (`MAX_GRAPH`), what would go through the
    network is None and the rest is for direct sight.

    Parameters
    ----------
    survey
        With the Earth among its nodes.
    epoch
        TDB seconds past J2000.
    threshold
        Sun-Earth-Mars angle below which links to the Earth are lost, radians.
    """
    duration = survey.duration
    begins, ends = conjunction_seasons(epoch, duration, threshold)
    lost = np.stack([begins, ends], axis=1)
    clear = outside(lost, duration)
    days = np.append(np.arange(0.0, duration, SECONDS_PER_DAY), duration)
    angles = np.degrees(sun_earth_mars_angle(epoch + days))
    graph = _graph(survey.windows)
    stations = []
    for name in survey.names("station"):
        direct = any_of([w.spans for w in survey.of(name, "earth")])
        through = reach(graph, name, "Earth") if graph else None
        spans = through.spans if through else direct
        stations.append(
            {
                "station": name,
                "direct_share": total(direct) / duration,
                "share": through.share if through else None,
                "by_hops": through.by_hops if through else None,
                "share_outside_conjunction": total(all_of([spans, clear])) / duration,
                "longest_gap_h": statistics(spans, duration).longest_gap / HOUR,
            }
        )
    return {
        "sun_earth_mars_angle_deg": {"least": angles.min(), "largest": angles.max()},
        "conjunction_deg": float(np.degrees(threshold)),
        "conjunction_seasons": [{"start_s": a, "end_s": b} for a, b in lost],
        "stations": stations,
    }


def _graph(spans: Sequence[Windows]) -> Contacts | None:
    """Graph of links over time, or None where it may be too large to search."""
    nodes = len({name for w in spans for name in (w.first, w.second)})
    intervals = 1 + 2 * sum(w.count for w in spans)
    return contacts(spans) if nodes * intervals <= MAX_GRAPH else None


def latency_records(survey: Survey) -> list[dict[str, Any]] | None:
    """Store and forward between each two stations, both ways, through satellites and moons.

    None if there are more than `MAX_MAIL_STATIONS` stations, or too many links.
    """
    names = survey.names("station")
    if len(names) > MAX_MAIL_STATIONS:
        return None
    if len(names) < 2:
        return []
    graph = _graph(survey.without("earth"))
    if graph is None:
        return None
    records = []
    for one, two in combinations(names, 2):
        for source, target in ((one, two), (two, one)):
            values = asdict(latency(graph, source, target))
            values["mean_h"] = values.pop("mean") / HOUR
            values["longest_h"] = values.pop("longest") / HOUR
            records.append(values)
    return records


def eclipse_records(
    survey: Survey, epoch: float, figure: Figure = DEFAULT_FIGURE
) -> list[dict[str, Any]]:
    """Shadow of Mars on each satellite and moon: share, number and longest, umbra apart."""
    bodies = [node for node in survey.nodes if node.kind in ("satellite", "moon")]
    sun = sun_node(epoch, survey.duration)
    both = [
        eclipses(bodies, sun, survey.duration, figure=figure, total=umbra)
        for umbra in (False, True)
    ]
    return [
        {
            "node": node.name,
            "count": shade.count,
            "share": float(shade.length.sum()) / survey.duration,
            "longest_h": float(shade.length.max(initial=0.0)) / HOUR,
            "umbra_count": umbra.count,
            "umbra_longest_h": float(umbra.length.max(initial=0.0)) / HOUR,
        }
        for node, shade, umbra in zip(bodies, *both, strict=True)
    ]


def radio_records(survey: Survey, radios: Sequence[Radio]) -> list[dict[str, Any]]:
    """Range, range rate, light time and C/N0 along the windows that each radio serves."""
    records = []
    for radio in radios:
        for w in survey.windows:
            one, two = find_node(survey.nodes, w.first), find_node(survey.nodes, w.second)
            if not w.count or not radio.serves(one.kind, two.kind):
                continue
            path = pair_track(survey, w)
            ratio = carrier_to_noise(radio, path.distance)
            records.append(
                {
                    "first": w.first,
                    "second": w.second,
                    "least_range_km": path.distance.min() / 1e3,
                    "largest_range_km": path.distance.max() / 1e3,
                    "largest_range_rate_km_s": np.abs(path.range_rate).max() / 1e3,
                    "largest_light_time_s": path.light_time.max(),
                    "least_cn0_dbhz": ratio.min(),
                    "largest_cn0_dbhz": ratio.max(),
                    "required_cn0_dbhz": radio.required,
                    "usable_share": float((ratio >= radio.required).mean()),
                }
            )
    return records


def survey_record(
    survey: Survey,
    epoch: float,
    *,
    radios: Sequence[Radio] = (),
    threshold: float = 0.0,
    figure: Figure = DEFAULT_FIGURE,
    eclipse: bool = False,
) -> dict[str, Any]:
    """Return everything a survey has to say.

    Parameters
    ----------
    survey
        The windows.
    epoch
        TDB seconds past J2000.
    radios
        Radio links to judge.
    threshold
        Sun-Earth-Mars angle below which links to the Earth are lost, radians.
    figure
        Its equatorial radius casts the shadow.
    eclipse
        Whether to find eclipses.
    """
    nodes = [node_record(survey, node) for node in survey.nodes if node.kind != "satellite"]
    has_earth = bool(survey.names("earth"))
    return {
        "duration_sols": survey.sols,
        "nodes": [record for record in nodes if record],
        "latency": latency_records(survey),
        "earth": earth_record(survey, epoch, threshold) if has_earth else None,
        "eclipses": eclipse_records(survey, epoch, figure) if eclipse else [],
        "radio": radio_records(survey, radios),
        "pairs": [pair_record(survey, w) for w in survey.windows],
    }
