"""No share and no percentile stands in the JSON of a command without how well it is known."""

import pytest

import compass
from tests.evidence import unknown


@pytest.mark.parametrize(
    ("found", "bad"),
    [
        ({"availability": 0.5}, ["availability"]),
        ({"availability": 0.5, "availability_bracket": [0.4, 0.6]}, []),
        ({"rows": [{"gdop_p95": 3.0}]}, ["rows[0].gdop_p95"]),
        ({"gdop": {"p95": 3.0, "p99": 4.0}, "evidence": {"gdop.p95": "proven"}}, ["gdop.p99"]),
        ({"gdop": {"p95": 3.0}, "evidence": {"others": "sampled"}}, []),
        ({"evidence": "proven", "rows": [{"share": 1.0}]}, []),
        ({"evidence": "", "rows": [{"share": 1.0}]}, ["rows[0].share"]),
        ({"error": {"p95": 3.0, "share": 0.5, "sampling": {"p95": 0.1}}}, ["error.share"]),
    ],
)
def test_what_stands_alone_is_found(found, bad):
    assert unknown(found) == bad


#: What finds other shares than the results that `test_results` walks, one of every command.
SAID = {
    "fold": lambda d: compass.fold(d / "rosette-12-3-quarter.toml"),
    "check": lambda d: compass.check(d / "relay-orbiters.toml"),
    "land guided": lambda d: compass.land(d / "landing-guided.toml", runs=2),
    "judge": lambda d: compass.judge(
        d / "compass-15-5-1.toml", scenario=d / "entry-compass.toml", samples=8
    ),
    "search": lambda d: compass.search(max_satellites=6, fold=1, radius_km=20427),
}


@pytest.mark.slow
@pytest.mark.parametrize("command", SAID)
def test_every_share_and_percentile_says_how_well_it_is_known(command, designs):
    assert unknown(SAID[command](designs).to_dict()) == []
