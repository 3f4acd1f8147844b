"""Whatever a public function is given, it answers with a sentence that names the argument."""

import inspect
import re
from collections.abc import Sequence
from pathlib import Path
from types import UnionType
from typing import Literal, Union, get_args, get_origin

import numpy as np
import pytest
from numpy.typing import ArrayLike

import compass
from compass.allowed import RANGES, check_allowed
from compass.arguments import checked
from compass.errors import ArgumentError, CompassError

DESIGN = "designs/compass-15-5-1.toml"
LANDING = "designs/entry-ground-beacons.toml"
PATTERN = {"satellites": 6, "planes": 3, "inclination_deg": 50, "radius_km": 20000}
MATRICES = [np.eye(3)] * 2
#: What each function runs with, but for the one wrong argument; others are given a design.
GIVEN = {
    "Mask.of": {"mask_deg": 5},
    "Requirement.of": {"name": "here", "fold": 1},
    "Site.of": {"name": "here", "latitude_deg": 1, "longitude_deg": 2},
    "areosynchronous_radius_km": {},
    "covariance_intersection": {
        "states": np.eye(3)[:2],
        "covariances": MATRICES,
        "weights": [0.5, 0.5],
    },
    "determine": {"design": "designs/tracked-15-5-1.toml"},
    "ephemeris": {"constellation": compass.walker_delta(phasing=1, **PATTERN), "times": 0.0},
    "export": {"design": DESIGN, "format": "czml"},
    "fold": {"design": DESIGN, "days": 1},
    "from_elements": {"semi_major_axis_km": 9000, "inclination_deg": 30},
    "horizon": {"design": DESIGN, "terrain": "none.nc"},
    "intersection_weights": {"covariances": MATRICES},
    "judge": {"designs": DESIGN, "scenario": "designs/landing.toml"},
    "land": {"scenario": LANDING},
    "locate": {"design": "designs/tracked-15-5-1.toml", "site": "Gale=-4.6,137.4"},
    "new": {"kind": "design"},
    "optimize": {"scenario": LANDING},
    "read_design": {},
    "read_scenario": {"path": LANDING},
    "read_study": {},
    "report": {"thing": LANDING},
    "reproduce": {},
    "rosette": {"multiplier": "1/2", **PATTERN},
    "schema": {},
    "search": {"max_satellites": 5, "fold": 1, "radius_km": 20428},
    "trade": {"study": "designs/study-fourfold.toml"},
    "version": {},
    "walker_delta": {"phasing": 1, **PATTERN},
    "walker_star": {"phasing": 1, **PATTERN},
    "warm": {},
}
#: Refuse some ranges only after a first computation.
LATE = ("judge", "locate", "report")
ORBIT = ("radius_km", "altitude_km", "orbit", "repeat")


class Quantity:
    """As a number with a unit of its own."""

    magnitude, units = 3.0, "degree"

    def __float__(self):
        return self.magnitude

    def __repr__(self):
        return "<Quantity(3, degree)>"


#: Wrong for every argument, whatever its kind.
WRONG = (Quantity(), object(), {"a": 1})
#: Wrong where no hint of its kind is among those named; not a number is wrong for every number.
WRONG_BUT_FOR = (
    ("forty", (str, Path)),
    (None, (type(None),)),
    (True, (bool,)),
    (7.5, (float, ArrayLike)),
    ([7.5, "x"], ()),
    (float("nan"), ()),
)


def public():
    """Public functions and, of classes, what makes one of degrees and kilometres."""
    for name in compass.__all__:
        thing = getattr(compass, name)
        if not inspect.isclass(thing):
            if callable(thing):
                yield name, thing
        elif hasattr(thing, "of"):
            yield f"{name}.of", thing.of


def kinds_of(hint):
    """The kinds that a hint allows; an array is one."""
    kinds = set(get_args(hint)) if get_origin(hint) in (Union, UnionType) else {hint}
    ways = set(get_args(ArrayLike))
    return (kinds - ways) | {ArrayLike} if ways <= kinds else kinds


def wrong_for(hint):
    """Values that an argument of a hint can not be."""
    kinds = kinds_of(hint)
    yield from WRONG
    for value, allowed in WRONG_BUT_FOR:
        if not any(kind in kinds for kind in allowed):
            yield value


@pytest.mark.parametrize(
    ("name", "function"),
    [
        pytest.param(name, made, marks=pytest.mark.slow, id=name)
        if name in LATE
        else pytest.param(name, made, id=name)
        for name, made in public()
    ],
)
def test_a_wrong_kind_is_refused_by_name(name, function, designs, monkeypatch):
    monkeypatch.chdir(designs.parent)
    given = GIVEN.get(name, {"design": DESIGN})
    for parameter in inspect.signature(function).parameters.values():
        if parameter.name in ("notice", "command"):
            continue  # called while at work; a text that is only kept
        key = "pdop_at_most" if parameter.kind is parameter.VAR_KEYWORD else parameter.name
        if parameter.kind is parameter.VAR_POSITIONAL:
            continue
        kept = {k: v for k, v in given.items() if key not in ORBIT or k not in ORBIT}
        for value in wrong_for(parameter.annotation):
            with pytest.raises(CompassError) as refused:
                function(**{**kept, key: value})
            assert key.partition("_")[0].rstrip("s") in str(refused.value), (key, value)


#: Numbers that no argument can be, whatever it is.
ABSURD = (float("inf"), -float("inf"), 1e300, -1e300)
ABSURD_WHOLE = (10**30, -(10**30))


def numbers_of(hint):
    """Absurd numbers in the form that an argument takes; none where it takes no number."""
    kinds = kinds_of(hint)
    if kinds & {float, ArrayLike}:
        yield from ABSURD
    elif int in kinds:
        yield from ABSURD_WHOLE
    for kind in kinds:
        if get_origin(kind) in (Sequence, tuple) and float in get_args(kind):
            size = 1 if get_origin(kind) is Sequence else len(get_args(kind))
            yield from ((number,) * size for number in ABSURD)


#: Not numbers of one meaning each: states of any kind, matrices, weights, instants.
MATRICES_OF = ("covariance_intersection", "intersection_weights")


@pytest.mark.parametrize(
    ("name", "function"),
    [pytest.param(n, made, id=n) for n, made in public() if n not in MATRICES_OF],
)
def test_an_absurd_number_is_refused_by_name(name, function, designs, monkeypatch):
    """Infinite, or beyond what Mars has room and history time for: before any work is done."""
    monkeypatch.chdir(designs.parent)
    given = GIVEN.get(name, {"design": DESIGN})
    for parameter in inspect.signature(function).parameters.values():
        keys = (parameter.name,)
        if parameter.kind is parameter.VAR_KEYWORD:
            keys = ("pdop_at_most", "error_vertical_m_at_most")
        for key in keys:
            kept = {k: v for k, v in given.items() if key not in ORBIT or k not in ORBIT}
            for value in numbers_of(parameter.annotation):
                with pytest.raises(CompassError) as refused:
                    function(**{**kept, key: value})
                assert str(refused.value).startswith(key.partition("_")[0].rstrip("s")), value


def test_every_number_has_a_range_of_its_own_or_says_so_itself():
    """A new argument without a range is noticed here, and so is a range that nobody asks for."""
    by_themselves = {"inclination_deg", "latitude_deg", "height_km", "repeat", "multiplier",
                     "satellites", "planes", "phasing", "times", "lost", "eccentricity",
                     "semi_major_axis_km", "altitude_km", "radius_km", "rival_radius_km",
                     "states", "covariances", "weights", "scale", "azimuth"}  # fmt: skip
    asked = set()
    for where, function in (*public(), ("Constellation.without", compass.Constellation.without)):
        for key, parameter in inspect.signature(function).parameters.items():
            if parameter.kind is parameter.VAR_KEYWORD or not list(
                numbers_of(parameter.annotation)
            ):
                continue
            asked |= {key, f"{where}.{key}"}
            known = {key, f"{where}.{key}"} & RANGES.keys()
            assert known or key in by_themselves, f"{where}: {key} has no range"
    assert {key for key in RANGES if not key.endswith("_at_most")} <= asked


@pytest.mark.parametrize("name", sorted(RANGES))
def test_the_ends_of_a_range_are_as_it_says(name):
    allowed = RANGES[name]
    assert allowed.has(allowed.least) is not allowed.above
    assert allowed.has(allowed.most) is not allowed.below
    assert allowed.has((allowed.least + allowed.most) / 2)
    assert not any(allowed.has(value) for value in (*ABSURD, float("nan")))
    where, _, key = name.rpartition(".")
    beyond = 2 * allowed.most + 1
    with pytest.raises(ArgumentError, match=re.escape(f": allowed {allowed}")) as refused:
        check_allowed(key, beyond, where)
    assert str(refused.value).startswith(f"{key} = ")


def test_what_fits_comes_as_pythons_own():
    @checked
    def told(number: float, count: int, several: tuple[float, float], *more: bool, **named: str):
        return number, count, several, more, named

    given = told(np.float32(0.5), np.int64(3), [1, 2.5], np.True_, unit="m")
    assert given == (0.5, 3, (1, 2.5), (True,), {"unit": "m"})
    assert [type(part) for part in given[:2]] == [float, int]
    with pytest.raises(ArgumentError, match=r"several\[1\] = 'x': must be a finite number"):
        told(1, 2, [1, "x"])
    with pytest.raises(ArgumentError, match=r"several = \[1\]: must be 2 of them"):
        told(1, 2, [1])
    with pytest.raises(ArgumentError, match="unit = 5: must be a text"):
        told(1, 2, (1, 2), unit=5)
    with pytest.raises(TypeError, match="missing a required argument: 'count'"):
        told(1)


@pytest.mark.parametrize(
    ("call", "said"),
    [
        (
            lambda: compass.walker_delta(15, 5, 1, inclination=45, radius_km=20427),
            "^inclination: unknown argument; did you mean inclination_deg",
        ),
        (lambda: compass.fold(DESIGN, mask=5), "^mask: unknown argument; did you mean mask_deg"),
        (
            lambda: compass.map(DESIGN, radius_km=5),
            "^radius_km: unknown; allowed design, others, sites,",
        ),
        (
            lambda: compass.walker_delta(15, 5, 1, 45, 20427),
            "^5 arguments by position: allowed satellites, planes, phasing; give the others by "
            "name: inclination_deg, radius_km",
        ),
        (lambda: compass.Site.of("x", 1, 2), "^3 arguments by position: allowed name; give"),
    ],
)
def test_an_unknown_name_is_answered_with_the_one_that_was_meant(call, said):
    with pytest.raises(TypeError, match=said):
        call()


def test_a_choice_says_what_is_allowed():
    @checked
    def chosen(motion: Literal["two-body", "j2"] | float = 1.0):
        return motion

    assert chosen("j2") == "j2" and chosen(2) == 2
    with pytest.raises(ArgumentError, match="must be one of two-body, j2 or a finite number"):
        chosen("j3")


def test_arrays_carry_no_unit_of_their_own():
    with pytest.raises(ArgumentError, match=r"inclination_deg = .* without units"):
        compass.from_elements(semi_major_axis_km=9000, inclination_deg=Quantity())
    with pytest.raises(ArgumentError, match="array of them"):
        compass.from_elements(semi_major_axis_km=[[1, 2], [3]], inclination_deg=0)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda c: c.without("x"), "lost = 'x': must be a list"),
        (lambda c: c.without([1.5]), r"lost\[0\] = 1.5: must be a whole number"),
        (lambda c: compass.Design(c, motion="j2"), "motion = 'j2': must be a Motion"),
        (lambda c: compass.Design(c, radios=5), "radios = 5: must be a list"),
        (lambda c: compass.Design(c, stations="Gale"), "stations = 'Gale': must be a list"),
        (lambda c: compass.Site("a", "b", 0), "latitude = 'b': must be a finite number"),
        (lambda c: compass.Site("a", 0, np.inf), "longitude = inf: must be a finite number"),
        (lambda c: compass.Site("a", 0, 0, mask=5), r"make it of degrees, Mask.of\(5\)"),
        (lambda c: compass.search(max_satellites=5, fold=1, share=2), "share = 2: allowed above 0"),
        (lambda c: compass.search(max_satellites=5, pdop_at_most=0.5), "pdop_at_most = 0.5: allow"),
        (lambda c: compass.fold(DESIGN, days=1, duration_h=2), "both days and duration_h"),
        (lambda c: compass.fold(DESIGN, start_day=1), "days: missing; from a start_day on"),
    ],
)  # fmt: skip
def test_made_by_hand_it_is_refused_too(make, message, designs, monkeypatch):
    monkeypatch.chdir(designs.parent)
    with pytest.raises(ArgumentError, match=message):
        make(GIVEN["ephemeris"]["constellation"])
