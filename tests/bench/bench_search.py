"""Searches for requirements: every pattern to sixteen, with geometry, within two minutes."""

from time import perf_counter

import pytest

import compass

SITES = {
    "Jezero": (18.4, 77.5),
    "Gale": (-4.6, 137.4),
    "Arcadia": (38.0, 190.0),
    "Hellas": (-41.0, 70.0),
    "Meridiani": (-2.0, 354.5),
}

#: Seconds on two cores.
LONGEST = 120.0


def test_five_sites_with_geometry_always_on_the_resonance():
    sites = [
        compass.Site.of(name, latitude_deg=latitude, longitude_deg=longitude, mask_deg=10)
        for name, (latitude, longitude) in SITES.items()
    ]
    asked = compass.Requirement.of("sites", sites=sites, pdop_at_most=6)
    started = perf_counter()
    found = compass.search(require=[asked], orbit="areosynchronous", max_satellites=16)
    assert perf_counter() - started < LONGEST
    assert found.best.constellation.size == 14
    assert found.best.verdicts[0].evidence == "proven"


@pytest.mark.parametrize(
    ("band", "mask", "size"), [(30, 0, 12), (45, 0, 13)], ids=["30 at mask 0", "45 at mask 0"]
)
def test_bands_with_geometry_always(band, mask, size):
    """Sizes of others' searches: 12/4/0 at 9 to 16 deg, and 13/13/3 at 12 to 28 deg."""
    found = compass.search(
        region=f"lat:-{band}:{band}",
        mask_deg=mask,
        pdop_at_most=6,
        radius_km=20427.7,
        max_satellites=16,
    )
    assert found.best.constellation.size == size
