"""A user who stands still: the gathered covariance against batch estimates of simulated data."""

import json
from dataclasses import replace

import numpy as np
import pytest
from click.testing import CliRunner

import compass
from compass.cli.main import program
from compass.clocks import Clock
from compass.core.gather import OFFSET, RATE
from compass.design import Design
from compass.document import text
from compass.errors import ArgumentError
from compass.frames import mcmf_from_mci, prime_meridian_angle
from compass.orbits import keplerian
from compass.ranging import Receiver, Signal
from compass.signal.budget import mean_age_covariance
from compass.signal.ranges import radial_along_cross
from compass.signal.standing import HALF, SIDEWAYS, UPWARDS, sights_from, standing_covariance
from compass.sites import Site

SITE = Site.of("rover", latitude_deg=18.4, longitude_deg=77.5)
SIGNAL = Signal(ephemeris=(1.0, 3.0, 2.0), clock_sigma=1.0, receiver=Receiver(0.5, 0.3))
DOPPLER = 0.002


def pair(n=2):
    """Satellites over the site at the epoch, in planes that cross."""
    here = float(np.radians(77.5) + prime_meridian_angle(0.0, 0.0))
    node = here + np.array([-0.5, 0.3, 0.0])[:n]
    c = keplerian(12e6, 0.0, np.radians([40.0, 75.0, 110.0][:n]), node, 0.0, [0.5, 0.2, 0.3][:n])
    return Design(c, signal=SIGNAL)


def ranges(design, place, errors, times):
    """True ranges from a place, the satellites off by radial, along, cross; (t, n)."""
    r, v = design.motion.states(design.constellation, times)
    r = r + np.einsum("nk,ntki->nti", errors, radial_along_cross(r, v))
    fixed = mcmf_from_mci(r, prime_meridian_angle(design.constellation.epoch, times))
    return np.linalg.norm(fixed - place, axis=-1).T


@pytest.mark.parametrize("held", [True, False])
def test_batch_estimates_of_simulated_data_scatter_as_the_covariance_says(held):
    """Gauss-Newton on all measurements at once, unknowns and what is known of them beside."""
    rng = np.random.default_rng(5)
    design = pair(2 if held else 3)
    n, times = design.constellation.size, 300.0 * np.arange(24)
    sights = sights_from(design, SITE, times, DOPPLER)
    assert sights.seen.min() == n
    perfect = Clock("still", white=1e-30, source="a test")
    claimed = standing_covariance(design, sights, perfect if held else None, None)[-1]
    east = np.array(SITE.enu_mcmf)
    clocks, known = (1 if held else times.size), mean_age_covariance(SIGNAL, n)
    size = 3 + 2 * clocks + 4 * n
    scale = np.concatenate(
        [[SIDEWAYS, SIDEWAYS, UPWARDS], np.tile([OFFSET**0.5, RATE**0.5], clocks),
         np.sqrt(np.diagonal(known, axis1=1, axis2=2)).ravel()]
    )  # fmt: skip
    sigma = np.sqrt(sights.variances)

    def model(x):
        errors = x[-4 * n :].reshape(n, 4)
        clock = x[3 : -4 * n].reshape(clocks, 2)
        place = SITE.r_mcmf + x[:3] @ east
        at = [ranges(design, place, errors[:, :3], times + d) for d in (0.0, -HALF, HALF)]
        offset = clock[0, 0] + clock[0, 1] * times if held else clock[:, 0]
        first = at[0] + offset[:, None] + errors[:, 3]
        second = (at[2] - at[1]) / (2 * HALF) + (clock[:, 1] if not held else clock[0, 1])[
            ..., None
        ]
        return np.stack([first, second], axis=-1) / sigma

    # slopes hardly change over what anything is off by: once is enough for steps that converge
    steps = np.diag(np.minimum(scale, 1.0))
    slopes = np.stack(
        [
            (model(s) - model(0.0 * s)).ravel() / step
            for s, step in zip(steps, steps.diagonal(), strict=True)
        ],
        1,
    )
    inverse = np.linalg.pinv(np.vstack([slopes * scale, np.eye(size)]))

    def fit(measured):
        x = np.zeros(size)
        for _ in range(4):
            right = np.concatenate([(measured - model(x)).ravel(), -x / scale])
            x = x + scale * (inverse @ right)
        return x

    runs, total = 40, 0.0
    for _ in range(runs):
        truth = scale * rng.standard_normal(size)
        # where the user is and his clock's offset are found however far off: begin near
        truth[: 3 + 2 * clocks] *= 1e-3
        measured = model(truth) + rng.standard_normal(sigma.shape)
        miss = (fit(measured) - truth)[:3]
        total += miss @ np.linalg.solve(claimed, miss)
    # a sum of 3 squares a run: 3 a run, with a variance of 6 a run
    assert abs(total - 3 * runs) < 3.0 * np.sqrt(6 * runs)


def test_more_knowledge_never_harms_and_one_satellite_needs_a_held_clock():
    design = pair(1)
    sights = sights_from(design, SITE, 60.0 * np.arange(90), DOPPLER)
    good = compass.clocks.clock_named("uso")
    error = {
        (clock is not None, height): np.sqrt(np.trace(standing_covariance(design, sights, clock, height)[-1]))
        for clock in (good, None)
        for height in (10.0, None)
    }  # fmt: skip
    assert error[True, 10.0] <= error[True, None]
    assert error[True, 10.0] < 1e3 < 1e5 < error[False, 10.0]


def test_no_standing_takes_away_what_all_satellites_have_wrong_alike():
    """A turn of their frame moves east and north; their time is part of the user's own clock."""
    turned = replace(SIGNAL, common_orientation=1e-6, common_time=50.0)
    alone, shared = (
        compass.locate(replace(pair(), signal=each), site=SITE, hours=1.5, step_s=300.0).best.sigma
        for each in (SIGNAL, turned)
    )
    moved = (pair().figure.equatorial_radius * 1e-6) ** 2
    np.testing.assert_allclose(shared**2, alone**2 + [moved, moved, 0.0], rtol=1e-12)


def test_the_command_tells_after_how_long_and_what_it_stands_on(tmp_path):
    found = compass.locate(pair(), site=SITE, hours=1.5, step_s=120.0, goal_m=8.0)
    out = found.to_dict()
    assert [way["clock_held"] for way in out["ways"]] == [True, True, False, False]
    held = out["ways"][0]
    k = out["hours"].index(held["until_goal_h"])
    assert held["standing_error_m"][k] <= 8.0 < held["standing_error_m"][k - 1]
    said = text(found.document())
    assert "KNOWN: rover, standing still, 2 satellites, 2 in view at once" in said
    assert found.plot().get_xlabel() == "hours of standing still"
    poor = compass.locate(pair(1), site=SITE, hours=0.1, goal_m=1e-3)
    assert not poor.holds
    said = text(poor.document())
    assert "place not known to 0.001 m within 0.1 h" in said and "nothing is ever" not in said
    behind = Site.of("behind", latitude_deg=-18.4, longitude_deg=257.5)
    said = text(compass.locate(pair(1), site=behind, hours=0.1).document())
    assert "0 in view at once: place not known" in said and "nothing is ever measured" in said


def test_those_that_are_there_already_keep_their_own_covariances():
    each = tuple(tuple(tuple(row) for row in np.diag([k, k, k, k])) for k in (1.0, 4.0))
    design = replace(pair(), signal=Signal(covariance=each))
    name = design.constellation.satellite_names[1]
    used = compass.locate(design, site=SITE, satellites=[name], hours=0.1).design
    assert used.constellation.satellite_names == (name,)
    assert used.signal.covariance == each[1:]


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"site": "nowhere"}, "is no station of the design, which has none"),
        ({"site": "far=95,0"}, "^site 'far=95,0': latitude_deg = 95: allowed -90 to 90"),
        ({"satellites": ["x"]}, "satellites = 'x': is none of the design"),
        ({"goal_m": 0.0}, "goal_m = 0: allowed above 0"),
        ({"hours": 0.0}, "hours = 0: allowed above 0"),
        ({"hours": 1e4}, "must make 1 to 20000 steps"),
        ({"step_s": 0.0}, "step_s = 0: allowed above 0"),
        ({"start_day": -1.0}, "start_day = -1"),
        ({"clock": "sundial"}, "clock = 'sundial': not known"),
    ],
)
def test_what_cannot_be_is_refused(options, said):
    with pytest.raises(ArgumentError, match=said):
        compass.locate(pair(), **({"site": SITE} | options))


def test_without_a_signal_there_is_nothing_to_stand_on(designs):
    run = CliRunner().invoke(
        program, ["locate", str(designs / "areostationary-trio.toml"), "--site", "a=0,0"]
    )
    assert "has no table [signal]" in str(run.exception)


def test_a_place_is_named_on_the_command_line(tmp_path):
    from compass.handover.toml import design_toml

    file = tmp_path / "d.toml"
    file.write_text(design_toml(replace(pair(), stations=(SITE,))))
    for site in ("rover", "other=18.4,77.5"):
        run = CliRunner().invoke(
            program, ["locate", str(file), "--site", site, "--hours", "0.2", "--json"]
        )
        assert json.loads(run.stdout)["site"] == site.partition("=")[0]
