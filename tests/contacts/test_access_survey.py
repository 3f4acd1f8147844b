"""Surveys of whole networks, their records and datasets."""

import numpy as np
import pytest

from compass.bodies import SOLAR_DAY, SUN_RADIUS
from compass.contacts.dataset import windows_dataset
from compass.contacts.record import (
    MAX_MAIL_STATIONS,
    earth_record,
    eclipse_records,
    latency_records,
    node_record,
    pair_record,
    pair_track,
    survey_record,
)
from compass.contacts.relay import contacts, reach
from compass.contacts.spans import all_of, any_of, total
from compass.contacts.survey import survey
from compass.errors import ArgumentError
from compass.frames import FIGURES
from compass.links import Radio, Wanted
from compass.orbits import areosynchronous_radius, walker_delta
from compass.sites import Site

DURATION = 2 * SOLAR_DAY.value
RELAY = walker_delta(3, 1, 0, inclination_deg=0.0, orbit="areosynchronous")
SITES = (Site("East", 0.1, 1.0), Site("West", -0.1, -2.0))


@pytest.fixture(scope="module")
def full():
    return survey(RELAY, SITES, DURATION, Wanted(("phobos",), True, True))


def test_every_pair_asked_for_is_linked_once(full):
    assert len(full.windows) == 2 * (3 + 1 + 1) + 1 * (3 + 1) + 3 + 3
    pairs = {frozenset((w.first, w.second)) for w in full.windows}
    assert len(pairs) == len(full.windows)
    assert full.names("satellite") == ["P1S1", "P1S2", "P1S3"]
    assert {w.second for w in full.of("East")} == set(full.names("satellite"))
    assert len(full.without("earth")) == len(full.windows) - 6
    assert full.sols == pytest.approx(2.0)


def test_a_ring_of_three_never_loses_the_equator(full):
    """The cap of an areosynchronous satellite, 80 degrees, is wider than half of 120."""
    for name in full.names("station"):
        np.testing.assert_array_equal(any_of([w.spans for w in full.of(name)]), [[0.0, DURATION]])
    crosslinks = [w for w in full.windows if w.first.startswith("P1") and w.second.startswith("P1")]
    assert all(w.length.sum() == pytest.approx(DURATION) for w in crosslinks)


def test_stations_reach_the_earth_through_the_ring(full):
    record = earth_record(full, RELAY.epoch, np.radians(2.0))
    for entry in record["stations"]:
        assert 0.3 < entry["direct_share"] < 0.6
        assert entry["share"] == pytest.approx(1.0)
        assert entry["by_hops"][1] == pytest.approx(entry["direct_share"])
        assert sum(entry["by_hops"].values()) == pytest.approx(1.0)
        assert entry["share_outside_conjunction"] == pytest.approx(1.0)
    angle = record["sun_earth_mars_angle_deg"]
    assert angle["least"] <= angle["largest"]


def test_reach_is_the_union_of_all_chains():
    """Station, satellite, Earth: any of the satellites whose two links are both up, or direct."""
    c = walker_delta(4, 2, 1, inclination_deg=57.3, radius_km=5000)
    found = survey(c, SITES[:1], DURATION, Wanted(earth=True))
    up, down = found.of("East"), found.of("Earth")
    chains = [all_of([a.spans, b.spans]) for a, b in zip(up, down, strict=True)]
    assert [w.second for w in up] == [w.second for w in down]
    direct = [w.spans for w in found.of("East", "earth")]
    through = reach(contacts(found.windows), "East", "Earth")
    np.testing.assert_allclose(through.spans, any_of([*chains, *direct]))
    assert 0.3 < through.share < 1
    assert through.by_hops[1] == pytest.approx(total(direct[0]) / DURATION)


def test_conjunction_takes_its_share_of_the_earth():
    from datetime import datetime

    from compass.frames import seconds_past_j2000

    epoch = seconds_past_j2000(datetime(2023, 11, 17))
    ring = walker_delta(3, 1, 0, inclination_deg=0.0, orbit="areosynchronous", epoch=epoch)
    found = survey(ring, SITES, DURATION, Wanted(earth=True))
    record = earth_record(found, epoch, np.radians(2.0))
    assert [entry["share_outside_conjunction"] for entry in record["stations"]] == [0.0, 0.0]
    assert record["conjunction_seasons"] == [{"start_s": 0.0, "end_s": DURATION}]


def test_records_of_pairs_and_nodes_agree(full):
    pairs = [pair_record(full, w) for w in full.of("Phobos")]
    node = node_record(full, next(n for n in full.nodes if n.name == "Phobos"))
    assert node["mean_share"] == pytest.approx(np.mean([p["share"] for p in pairs]))
    assert node["least_share"] == min(p["share"] for p in pairs)
    assert node["longest_gap_h"] == max(p["longest_gap_h"] for p in pairs)
    for pair in pairs:
        lengths = [w["duration_s"] for w in pair["windows"]]
        assert sum(lengths) / DURATION == pytest.approx(pair["share"])
        assert pair["passes_per_sol"] == pytest.approx(pair["count"] / 2)
        for w in pair["windows"]:
            assert w["end_s"] - w["start_s"] == pytest.approx(w["duration_s"])
    lone = survey(RELAY, SITES[:1], DURATION, Wanted())
    assert node_record(lone, lone.nodes[-1]) is None


def test_tracks_stay_inside_the_windows(full):
    for w in full.windows:
        if not w.count:
            continue
        path = pair_track(full, w)
        inside = (path.time[:, None] >= w.start) & (path.time[:, None] <= w.end)
        assert inside.any(axis=1).all()
        assert np.isin(w.spans.ravel(), path.time).all()
        assert np.all(np.diff(path.time) >= 0)


def test_two_stations_on_one_satellite_wait_for_each_other():
    """A single low polar satellite carries mail between the poles in half a revolution."""
    c = walker_delta(1, 1, 0, inclination_deg=90.0, radius_km=3900)
    poles = (Site("North", np.pi / 2, 0.0), Site("South", -np.pi / 2, 0.0))
    found = survey(c, poles, DURATION)
    half = np.pi / c.mean_motion[0]
    north = found.of("North")[0]
    (there, back) = latency_records(found)
    assert (there["source"], there["target"]) == ("North", "South")
    assert there["at_once"] == 0.0
    # the longest wait: from a set in the north to the next rise there, then half a revolution
    gap = np.diff(any_of([north.spans]).ravel())[1::2].max()
    assert there["longest_h"] * 3600 == pytest.approx(gap + half, rel=1e-6)
    assert there["mean_h"] == pytest.approx(back["mean_h"], rel=0.02)
    assert latency_records(survey(c, poles[:1], DURATION)) == []
    crowd = [Site(str(k), 0.0, 0.1 * k) for k in range(MAX_MAIL_STATIONS + 1)]
    assert latency_records(survey(c, crowd, 1000.0)) is None


def test_a_radio_is_judged_along_its_windows(full):
    radios = (
        Radio(("satellite", "station"), 4e8, 7.0, -15.0, 45.0),
        Radio(("moon", "moon"), 4e8, 7.0, -15.0, 45.0),
    )
    record = survey_record(full, RELAY.epoch, radios=radios, eclipse=True)
    links = record["radio"]
    assert {(r["first"], r["second"]) for r in links} == {
        (w.first, w.second) for name in ("East", "West") for w in full.of(name) if w.count
    }
    for link in links:
        # from 10 degrees off the zenith at most to the rim
        assert 17_000 < link["least_range_km"] <= link["largest_range_km"] < 20_200
        assert link["least_cn0_dbhz"] <= link["largest_cn0_dbhz"]
        assert link["usable_share"] == 1.0
        assert link["largest_light_time_s"] == pytest.approx(link["largest_range_km"] / 299792.458)
    assert len(record["eclipses"]) == 4
    assert survey_record(full, RELAY.epoch)["eclipses"] == []


def test_an_equatorial_ring_is_eclipsed_near_the_equinox():
    """About 2 asin(R/r)/n; penumbra and umbra differ by the Sun's diameter at either edge."""
    from datetime import datetime

    from compass.frames import seconds_past_j2000
    from compass.planets import sun_earth_mci

    # the equinox nearest to 2029: where the Sun crosses Mars's equator
    days = np.arange(0, 700) * 86400.0
    start = seconds_past_j2000(datetime(2029, 1, 1))
    sun = sun_earth_mci(start, days)[0]
    epoch = start + days[np.abs(sun[:, 2] / np.linalg.norm(sun[:, :3], axis=1)).argmin()]
    ring = walker_delta(3, 1, 0, inclination_deg=0.0, orbit="areosynchronous", epoch=epoch)
    found = survey(ring, SITES, DURATION)
    records = eclipse_records(found, epoch, FIGURES["iau-sphere"])
    plain = 2 * np.arcsin(FIGURES["iau-sphere"].equatorial_radius / areosynchronous_radius())
    disc = 2 * np.arcsin(SUN_RADIUS.value / np.linalg.norm(sun_earth_mci(epoch, 0.0)[0][0, :3]))
    hours = plain / ring.mean_motion[0] / 3600
    for record in records:
        assert record["count"] in (1, 2, 3)
        assert record["umbra_longest_h"] < hours < record["longest_h"]
        assert record["longest_h"] - record["umbra_longest_h"] == pytest.approx(
            2 * disc / ring.mean_motion[0] / 3600, rel=0.02
        )


def test_nothing_to_link_and_too_much_are_refused(monkeypatch):
    with pytest.raises(ArgumentError, match="nothing to link"):
        survey(RELAY, (), DURATION)
    with pytest.raises(ArgumentError, match="two nodes named P1S2, a station and a satellite; st"):
        survey(RELAY, (Site("P1S2", 0.0, 0.0),), DURATION)
    monkeypatch.setattr("compass.contacts.survey.MAX_PAIRS", 5)
    with pytest.raises(ArgumentError, match="6 pairs; at most 5"):
        survey(RELAY, SITES, DURATION)


def test_a_graph_too_large_is_not_searched(full, monkeypatch):
    monkeypatch.setattr("compass.contacts.record.MAX_GRAPH", 10)
    assert latency_records(full) is None
    for entry in earth_record(full, RELAY.epoch, 0.0)["stations"]:
        assert entry["share"] is None
        assert entry["by_hops"] is None
        assert entry["share_outside_conjunction"] == pytest.approx(entry["direct_share"])


def test_the_dataset_holds_every_window(full):
    dataset = windows_dataset(full.windows, title="t")
    assert dataset.attrs["title"] == "t"
    assert int(dataset["count"].sum()) == dataset.sizes["window"]
    assert dataset.sizes["pair"] == len(full.windows)
    np.testing.assert_array_equal(dataset["start"], np.concatenate([w.start for w in full.windows]))
    assert dataset["max_elevation"].attrs["units"] == "degree"
    assert float(dataset["max_elevation"].max()) <= 90
    assert all("long_name" in dataset[name].attrs for name in dataset.variables)
