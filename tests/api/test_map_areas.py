"""Figures at sites and in regions, beside those of the whole surface."""

from dataclasses import replace

import numpy as np
import pytest

import compass
from compass import Mask, Site
from compass.api.map_areas import area_blocks
from compass.coverage import areas as module
from compass.coverage.certified_percentile import CertifiedPercentile
from compass.coverage.certified_share import CertifiedShare
from compass.design import Design
from compass.errors import ArgumentError
from compass.orbits.motion import Motion
from compass.ranging import Receiver, Signal

SIGNAL = Signal(ephemeris=(2, 8, 5), clock_sigma=3, receiver=Receiver(0.5, 0.5), ionosphere=1.0)
HERE = Site("here", 0.3, 1.0, mask=Mask.of(10))
FEW = {"step_deg": 90, "epochs": 1}


def design(**options):
    c = compass.walker_delta(12, 3, 1, inclination_deg=50, radius_km=20427)
    return Design(c, name="d", mask=Mask.of(5), stations=(HERE,), **options)


@pytest.fixture
def told(monkeypatch):
    """What certified figures are asked, answered at once."""
    asked = []

    def share(self, c, limit, **options):
        asked.append(("share", options["dop"], limit, options))
        return CertifiedShare(0.5, 0.6, 1, "")

    def percentiles(self, c, percents, **options):
        asked.extend(("percentile", options["dop"], q, options) for q in percents)
        return {q: CertifiedPercentile(2.0, 3.0, q, "") for q in percents}

    monkeypatch.setattr(module.Effort, "share", share)
    monkeypatch.setattr(module.Effort, "percentiles", percentiles)
    return asked


def figures(d, **options):
    areas = module.areas_of(d, **({"fold": 1, "span": (0.0, 9e4)} | options))
    return module.area_figures(areas, 6.0, 30.0)


def test_sites_and_regions_are_asked_where_they_are(told):
    d = design(signal=SIGNAL)
    site, belt, bent = figures(
        d,
        sites=(HERE,),
        regions=("lat:-20:30", "polygon:0,0;0,30;10,10;30,0"),
    )
    assert (site.name, belt.name) == ("here", "lat:-20:30")
    assert site.availability == (0.5, 0.6) and site.gdop == {50: (2.0, 3.0), 95: (2.0, 3.0)}
    assert set(site.errors) == {"error_horizontal_m", "error_vertical_m", "error_position_m"}
    assert "for ever" in site.scope and "at every longitude" in belt.scope
    assert "for ever" in bent.scope  # its latitudes weigh by how wide it is there
    places = [type(one[3]["place"]).__name__ for one in told]
    assert places[0] == "Circle" and "Region" in places
    # a bent polygon is two convex ones, and the Sun is asked for overhead and set
    shares = [one for one in told if one[1] == "error_vertical_m"]
    assert len(shares) == 2 * (1 + 1 + 2)
    assert told[0][3]["mask"] == Mask.of(10)
    known = site.as_dict()
    assert known["fold"]["met"] is True and known["error_limit_m"] == 30.0
    assert known["error_position_m"] == {"share_bracket": [0.5, 0.6]}
    # limited to a span, or along paths, the place itself is asked
    figures(d, sites=(HERE,), limited=True)
    assert type(told[-1][3]["place"]).__name__ == "Spot"


def test_maps_show_areas_as_text_numbers_and_variables(told):
    where = {"sites": "here", "regions": ["lat:0:30"]}  # the globe's own figures do not matter
    found = compass.map(design(signal=SIGNAL), fold=1, budget_s=0.1, **where, **FEW)
    text = str(found)
    assert "At sites and in regions" in text and "lat:0:30" in text
    assert "horizontal error at most 30 m" in text
    one, other = found.to_dict()["areas"]
    assert (one["name"], other["availability_bracket"]) == ("here", [0.5, 0.6])
    one, other = found.areas
    open_ = replace(other, availability=(0.0, 1.0), gdop=dict.fromkeys(other.gdop, (0.0, np.inf)))
    table, *_ = area_blocks((one, open_))
    assert [str(cell) for cell in table.rows[0][3:6]] == ["50 to 60", "2 to 3", "2 to 3"]
    assert [str(cell) for cell in table.rows[1][3:6]] == ["not known"] * 3
    made = found.dataset
    assert made.area_availability.sel(area="here", bound="low") == 0.5
    assert made.area_gdop.sel(area="lat:0:30", area_percent=95, bound="high") == 3.0
    assert made.area_fold_met.sel(area="here") == 1
    assert made.area_error_position_m_share.dims == ("area", "bound")


def test_what_is_no_place_is_refused():
    d = design()
    refused = (
        ({"sites": "nowhere"}, r"no \[\[station\]\] of that name; there are here"),
        ({"sites": ["here", "here=1,2"]}, "site 'here': given twice"),
        ({"sites": "x=1"}, "site 'x=1': not NAME=LAT,LON"),
        ({"regions": "lat:9:1"}, "the southern one first"),
    )
    for options, words in refused:
        with pytest.raises(ArgumentError, match=words):
            compass.map(d, **options, **FEW)
    with pytest.raises(ArgumentError, match=r"regions: .* is not a design; leave it out"):
        compass.report("designs/entry-compass.toml", regions="globe", output="page")


def test_errors_along_paths_are_asked_of_ranges_without_a_direction(told):
    d = design(signal=replace(SIGNAL, ephemeris=(2, 8, 5)), motion=Motion("numerical"))
    (site,) = figures(replace(d, requirements=()), sites=(HERE,), span=(0.0, 3600.0))
    assert site.errors["error_vertical_m"] == (0.5, 0.6) and "numerical" in site.fold.scope
    worst, best = (one[3]["ranges"] for one in told if one[1] == "error_vertical_m")
    assert worst.is_isotropic and best.is_isotropic
    assert worst.covariance[0, 3, 3] > best.covariance[0, 3, 3] >= 4.0


def test_several_designs_are_mapped_as_one_network():
    high = compass.Design(
        compass.walker_delta(3, 1, 0, inclination_deg=0, radius_km=20000), name="high"
    )
    low = compass.Design(
        compass.walker_delta(2, 2, 1, inclination_deg=80, radius_km=9000), name="low"
    )
    grid = {"step_deg": 45, "epochs": 5, "duration_h": 6, "width": 0.9}
    one, other, both = (compass.map(*d, **grid) for d in ((high,), (low,), (high, low)))
    assert both.design.name == "high + low"
    for name in ("count_mean", "cells_count_mean"):
        added = one.dataset[name].values + other.dataset[name].values
        assert both.dataset[name].values == pytest.approx(added, rel=1e-6)
