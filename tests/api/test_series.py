"""Series at stations against dense samples; several designs as one network; bad input."""

from dataclasses import replace

import numpy as np
import pytest

import compass
from compass.api.given import joined_designs
from compass.errors import ArgumentError, OutputError
from compass.orbits import positions_mcmf
from compass.ranging import Signal
from compass.tracking import Tracker, Tracking

RING = compass.walker_delta(3, 3, 0, inclination_deg=30, radius_km=9000)
OTHER = compass.walker_delta(2, 1, 0, inclination_deg=0, radius_km=12000)
SITE = compass.Site.of("S", latitude_deg=12, longitude_deg=40, mask_deg=5)


def test_gaps_and_counts_are_those_of_dense_samples():
    found = compass.series(
        compass.Design(RING, "ring"), stations=[SITE], fold=1, days=0.5, epochs=50
    )
    t = np.linspace(0, 43200, 8641)
    count = SITE.sees(np.moveaxis(positions_mcmf(RING, t), 1, 0)).sum(axis=1)
    row = found.rows()[0]
    assert row["share"] == pytest.approx((count >= 1).mean(), abs=1e-3)
    edges = np.flatnonzero(np.diff(np.concatenate([[1], count >= 1, [1]])))
    lengths = 5.0 * (edges[1::2] - edges[::2])
    assert row["gaps"] == len(lengths) > 1
    assert 3600 * row["longest_gap_h"] == pytest.approx(lengths.max(), abs=10)
    assert not found.holds and "fewer than 1 in view" in str(found)
    at = found.dataset["count"].values[0]
    again = SITE.sees(np.moveaxis(positions_mcmf(RING, found.dataset.time.values), 1, 0))
    assert at.tolist() == again.sum(axis=1).tolist()
    age = found.dataset["age_h"].values[0]
    assert (age[at >= 1] == 0).all() and np.nanmax(age) <= row["longest_gap_h"]
    assert row["age_h"] == row["response_h"]
    assert found.to_dict()["stations"][0]["gdop_p95"] is None
    assert row["gdop_p95"] == np.inf
    assert "∞" in str(found)


def test_two_designs_are_one_network(tmp_path):
    """As their constellations joined by hand; names alike are told apart by their designs."""
    one, two = compass.Design(RING, "one"), compass.Design(OTHER, "two")
    both = compass.Design(
        compass.from_elements(
            semi_major_axis_km=[9000] * 3 + [12000] * 2,
            inclination_deg=[30] * 3 + [0] * 2,
            raan_deg=[0, 120, 240, 0, 0],
            mean_anomaly_deg=[0, 0, 0, 0, 180],
        ),
        "both",
    )
    asked = {"stations": [SITE], "fold": 2, "days": 0.2, "epochs": 20}
    joined, single = compass.series(one, two, **asked), compass.series(both, **asked)
    assert joined.rows() == single.rows()
    again = joined_designs((one, compass.Design(RING, "again")))
    assert again.constellation.satellite_names[0].startswith("one ")
    named = (replace(one, label="one.toml"), replace(two, label="two more.toml"))
    assert joined_designs(named).typed == "one.toml 'two more.toml'"
    assert joined_designs((joined_designs(named[:1]), named[1])).typed == "one.toml 'two more.toml'"
    wanted = (compass.Requirement.of("w", sites=[SITE], fold=1),)
    check = compass.check(compass.Design(RING, "one", requirements=wanted), two, days=0.2)
    assert check.design.constellation.size == 5
    for suffix in (".nc", ".csv"):
        joined.write(tmp_path / f"f{suffix}")
    lines = (tmp_path / "f.csv").read_text().splitlines()
    assert lines[0].startswith("station,time_s,count,gdop") and len(lines) == 21
    joined.save_plot(tmp_path / "f.png", "age_h")
    assert (tmp_path / "f.png").read_bytes()[:4] == b"\x89PNG"


def test_beacons_on_the_ground_count_with_satellites():
    """A mast on high ground is over the horizon of a station beside it, and not of one far away."""
    mast = compass.Site.of("mast", latitude_deg=0.1, longitude_deg=0, height_km=5)
    near = compass.Site.of("near", latitude_deg=0, longitude_deg=0)
    far = compass.Site.of("far", latitude_deg=0, longitude_deg=90)
    asked = {"stations": [near, far, mast], "fold": 2, "days": 0.3, "epochs": 30}
    bare = compass.series(compass.Design(RING, "ring"), **asked)
    lit = compass.series(compass.Design(RING, "ring"), beacons=["mast"], **asked)
    more = lit.dataset["count"].values.astype(int) - bare.dataset["count"].values
    assert more.tolist() == [[1] * 30, [0] * 30, [0] * 30]
    assert bare.gaps["near"].count > 0 == lit.gaps["near"].count
    assert lit.gaps["far"] == bare.gaps["far"] and lit.gaps["mast"] == bare.gaps["mast"]
    with pytest.raises(ArgumentError, match="site 'none': no"):
        compass.series(compass.Design(RING, "ring"), beacons=["none"], **asked)


def test_designs_that_join_keep_of_each_what_is_its_own():
    """Masks and names of requirements, covariances of satellites; tracking if all say the same."""
    wanted = compass.Requirement("same", fold=1)
    one = compass.Design(RING, "one", mask=compass.Mask.of(5), requirements=(wanted,))
    two = compass.Design(OTHER, "two", mask=compass.Mask.of(12), requirements=(wanted,))
    joined = joined_designs((one, two))
    assert [each.name for each in joined.requirements] == ["one: same", "two: same"]
    masks = [np.degrees(each.mask) for each in joined.requirements]
    assert masks == pytest.approx([5, 12])
    high = replace(two, mask=compass.Mask.of([(0, 5), (90, 9)]))
    with pytest.raises(ArgumentError, match="two: same is over its horizon_deg, and other"):
        joined_designs((one, high))
    near, far = (tuple(tuple(k * row) for row in np.eye(4)) for k in (1.0, 9.0))
    heard = replace(one, signal=Signal(covariance=(near,)))
    faint = replace(two, signal=Signal(covariance=(far,) * OTHER.size))
    signal = joined_designs((heard, faint)).signal
    assert signal.covariance == (near,) * RING.size + (far,) * OTHER.size
    assert joined_designs((heard, replace(two, signal=heard.signal))).signal == heard.signal
    assert joined_designs((heard, two)).signal is None
    assert joined_designs((heard, replace(two, signal=Signal(update=60.0)))).signal is None
    tracking = Tracking(crosslinks=Tracker(range=2.0))
    tracked = replace(one, tracking=tracking)
    assert joined_designs((tracked, two)).tracking is None
    assert joined_designs((tracked, replace(two, tracking=tracking))).tracking == tracking


def test_what_cannot_be_joined_or_asked_is_told():
    one = compass.Design(RING, "one", stations=(SITE,))
    moved = compass.Site.of("S", latitude_deg=13, longitude_deg=40)
    with pytest.raises(ArgumentError, match="station S: two of that name differ; rename one"):
        joined_designs((one, compass.Design(OTHER, "two", stations=(moved,))))
    with pytest.raises(ArgumentError, match="one \\+ two: different figure; give both the same"):
        joined_designs((one, compass.Design(OTHER, "two", figure=compass.Site.of(
            "E", latitude_deg=0, longitude_deg=0, figure="iau-ellipsoid").figure)))  # fmt: skip
    with pytest.raises(ArgumentError, match="design: missing"):
        joined_designs(())
    with pytest.raises(ArgumentError, match="station: none; add a"):
        compass.series(compass.Design(RING, "r"))
    for key, value in {"fold": 0, "days": 0, "start_day": -1, "epochs": 1, "mask_deg": 90}.items():
        with pytest.raises(ArgumentError, match=f"{key} = {value}: (allowed|must be a whole)"):
            compass.series(one, **{key: value})
    made = compass.series(one, fold=1, days=0.01, epochs=2, start_day=1, motion="j2")
    told = made.to_dict()
    assert (told["start_day"], told["motion"]) == (1, made.motion)
    assert "J2" in made.motion
    with pytest.raises(OutputError, match=r"must end in \.nc, \.csv"):
        made.write("x.txt")
    with pytest.raises(ArgumentError, match="name = 'fold': allowed count"):
        made.plot(name="fold")


def test_the_command_prints_it_and_writes(run, tmp_path, designs):
    out, picture = tmp_path / "s.csv", tmp_path / "s.png"
    code, said, _ = run(
        "series", designs / "five-landing-sites.toml", "--days", 0.05, "--epochs", 3,
        "--mask-deg", 10, "-o", out, "--figure", picture,
    )  # fmt: skip
    assert code == 0
    assert "4 satellites in view at all times" in said
    assert "two-body motion; gaps and fewest in view by rise and set, to 1 ms" in " ".join(
        said.split()
    )
    assert out.exists() and picture.exists()
