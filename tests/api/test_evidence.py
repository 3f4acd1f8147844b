"""No share and no percentile stands in the JSON of a command without how well it is known."""

import re

import pytest

import compass

#: Names of shares and percentiles: of values, not of what was asked or of what knows them.
NAMED = re.compile(r"(^|_)(share|availability|fraction|p\d\d?|within_3_sigma)(_|$)")
BESIDE = ("_bracket", "_interval", "_sampling", "_error")


def unknown(found, covered=frozenset(), path=""):
    """Paths of shares and percentiles that nothing says how well they are known.

    What knows them stands beside them as `BESIDE`, is called ``sampling``, or is the ``evidence``
    of an object that they are in: a sentence on all of it, or by names, ``others`` the rest.
    """
    if isinstance(found, list):
        return [bad for k, one in enumerate(found) for bad in unknown(one, covered, f"{path}[{k}]")]
    if not isinstance(found, dict):
        return []
    told = found.get("evidence")
    known = covered | ({"others"} if isinstance(told, str) and told else set(told or ()))
    bad = []
    for key, value in found.items():
        here = f"{path}.{key}".lstrip(".")
        if key in ("evidence", "sampling", "provenance") or key.endswith(BESIDE):
            continue
        beside = any(f"{key}{ending}" in found for ending in BESIDE) or key in found.get(
            "sampling", ()
        )
        within = "others" in known or any(here.endswith(name) for name in known)
        if beside or within or key in known:
            continue
        if NAMED.search(key) and value is not None:
            bad.append(here)
        else:
            bad += unknown(value, known, here)
    return bad


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


SAID = {
    "show": lambda d: compass.show(d / "compass-15-5-1.toml"),
    "fold": lambda d: compass.fold(d / "rosette-12-3-quarter.toml"),
    "check": lambda d: compass.check(d / "relay-orbiters.toml"),
    "series": lambda d: compass.series(d / "compass-15-5-1.toml", days=0.2),
    "drift": lambda d: compass.drift(d / "compass-15-5-1.toml", days=1),
    "determine": lambda d: compass.determine(d / "tracked-15-5-1.toml"),
    "land": lambda d: compass.land(d / "entry-compass.toml", runs=2),
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
