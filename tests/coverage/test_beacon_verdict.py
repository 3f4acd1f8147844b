"""Beacons on the ground beside satellites: what sites over whose horizon they stand have."""

from dataclasses import replace

import numpy as np
import pytest

import compass
from compass import Mask, Requirement, Site, walker_delta
from compass.coverage.beacon_verdict import heard
from compass.coverage.site import site_coverage
from compass.design import Design
from compass.errors import ArgumentError

BASE = Site.of("base", latitude_deg=4, longitude_deg=137, mask_deg=2)
NORTH = Site.of("north", latitude_deg=4.3, longitude_deg=137, height_km=5)
WEST = Site.of("west", latitude_deg=4, longitude_deg=136.8, height_km=5)
FAR = Site.of("far", latitude_deg=-4, longitude_deg=37)
DAY = 88642.66


def design(*wanted, phase=0.0, **options):
    c = walker_delta(
        9, 9, 3, inclination_deg=25, orbit="areosynchronous", raan_deg=10, phase_deg=phase
    )
    stations = (BASE, NORTH, WEST, FAR)
    return Design(c, name="near", stations=stations, requirements=wanted, **options)


def verdict(wanted, beacons=("north", "west"), of=None, **options):
    (found,) = compass.check(of or design(wanted), beacons=beacons, **options).verdicts
    return found


def test_a_site_hears_beacons_over_its_horizon_and_not_itself():
    named = [one.name for one in heard(BASE, Mask(), (BASE, NORTH, WEST, FAR))]
    assert named == ["north", "west"]
    assert not heard(FAR, Mask(), (NORTH, WEST)) and not heard(BASE, Mask.of(60), (NORTH, WEST))
    with pytest.raises(ArgumentError, match="of that name; did you mean north"):
        verdict(Requirement("any", fold=1), beacons="norht")


def test_so_many_satellites_fewer_are_wanted_where_beacons_stand():
    """Against every moment, beacons counted as satellites are; at the far site none helps."""
    times = np.linspace(0, DAY, 3000)
    counts = {}
    for site in (BASE, FAR):
        lit = heard(site, Mask(), (NORTH, WEST))
        seen = site_coverage(design().constellation, site, times, beacons=lit)
        counts[site.name] = int(seen["count"].min())
    for site in (BASE, FAR):
        for fold in range(1, counts[site.name] + 2):
            found = verdict(Requirement("some", sites=(site,), fold=fold))
            assert (found.met, found.evidence) == (fold <= counts[site.name], "proven")
    both = Requirement("both", sites=(BASE, FAR), fold=min(counts.values()))
    assert verdict(both).met is True
    assert verdict(replace(both, fold=both.fold + 1)).met is False
    assert "2 beacons at most over a horizon (north and west)" in verdict(both).scope


def test_beacons_alone_may_suffice_and_are_never_lost():
    one = Requirement("one", sites=(BASE,), fold=2, losses=9)
    found = verdict(one)
    assert (found.met, found.evidence, found.share) == (True, "proven", (1.0, 1.0))
    assert verdict(one, beacons=()).met is False
    lit = design(one, beacons=(NORTH, WEST))  # as pages ask, with the beacons in the design
    assert compass.check(lit).verdicts == (found,)


def test_what_satellites_keep_alone_is_proven_and_what_they_do_not_is_sampled():
    wide = Requirement("fix", sites=(BASE,), limits=(("pdop", 1e4),), share=0.5)
    alone = verdict(wide, beacons=())
    beside = verdict(wide)
    assert alone.met is beside.met is True and beside.evidence == alone.evidence == "bracket"
    often = replace(wide, limits=(("gdop", 5.0),), share=0.999)
    assert verdict(often, beacons=()).met is False
    found = verdict(often)
    times = np.random.default_rng(3).uniform(0, DAY, 3000)
    seen = site_coverage(design().constellation, BASE, times, beacons=(NORTH, WEST))
    share = float((seen.gdop <= 5.0).mean())
    assert found.evidence == "sampled"
    assert found.share[0] - 0.04 <= share <= found.share[1] + 0.04
    # an always is refuted by samples, and never proven by them
    always = replace(often, share=1.0)
    assert verdict(always).met is (None if share == 1.0 else False)


def test_regions_and_metres_count_satellites_alone():
    belt = Requirement("belt", regions=("lat:0:9",), fold=3)
    alone, beside = verdict(belt, beacons=()), verdict(belt)
    assert replace(beside, scope=alone.scope) == alone
    assert "no beacon is over the horizon of a site" in beside.scope


def test_maps_count_beacons_at_sites():
    options = {"sites": ["base", "far"], "step_deg": 30, "epochs": 3, "fold": 5}
    alone = compass.map(design(), **options)
    beside = compass.map(design(), beacons=["north", "west"], **options)
    (base, far), (base_alone, far_alone) = beside.areas, alone.areas
    assert replace(far, fold=replace(far.fold, scope=far_alone.fold.scope)) == far_alone
    assert base.scope == base_alone.scope + "; with north and west over its horizon"
    assert (base.fold.met, base_alone.fold.met) == (True, False)
    assert base.availability == (base_alone.availability[0], 1.0)
    assert beside.dataset.count_mean.equals(alone.dataset.count_mean)
    with pytest.raises(ArgumentError, match="beacons: count at sites, and satellites alone elsew"):
        compass.map(design(), beacons=["north"], regions="lat:0:9")
