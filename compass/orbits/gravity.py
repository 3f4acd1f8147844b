"""Fields of gravity: the built-in one, and readers for those that others publish."""

import math
from dataclasses import dataclass, replace
from functools import cache
from importlib.resources import files
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from compass.errors import ArgumentError, DesignError

#: The highest degree that is read; recursion and time grow with its square.
MOST = 120

#: Where the prime meridians of the frames that fields refer to stand, radians east of the IAU 2000
#: one. The IAU 1991 meridian (older fields: GMM-2B, GGM2B, Mars50c) lies 0.238 degrees west:
#: W0 = 176.868 against 176.630 degrees.
MERIDIANS = {"iau-2000": 0.0, "iau-1991": math.radians(176.630 - 176.868)}

#: Tide systems whose C20 is the planet's own: the Sun is another force here. What sets them apart,
#: 1e-9 in C20, is 20 m after ten days.
TIDES = ("tide_free", "zero_tide")

#: Keys that the head of an ICGEM file must have.
_HEAD = {
    "earth_gravity_constant": "GM (m^3/s^2)",
    "radius": "the reference radius (m)",
    "tide_system": f"one of {', '.join(TIDES)}",
}


@dataclass(frozen=True, eq=False)
class GravityField:
    """Fully normalised (4 pi) spherical harmonics of Mars.

    Attributes
    ----------
    name
        What it is, with its source.
    gm
        m^3/s^2.
    radius
        Reference radius, m.
    c, s
        Coefficients, shape (degree + 1, degree + 1), [n, m]; below degree 2 only the leading 1.
    meridian
        Angle from the program's prime meridian east to the field's x axis, radians.
    file
        Path of the file that it was read from, some of its degrees left out or none; else empty.
    """

    name: str
    gm: float
    radius: float
    c: NDArray[np.float64]
    s: NDArray[np.float64]
    meridian: float = 0.0
    file: str = ""

    def __eq__(self, other: object) -> bool:
        return isinstance(other, GravityField) and self._values == other._values

    def __hash__(self) -> int:
        return hash(self._values)

    @property
    def _values(self) -> tuple[object, ...]:
        numbers = (self.gm, self.radius, self.meridian, self.degree)
        return (self.name, *numbers, self.c.tobytes(), self.s.tobytes())

    @property
    def degree(self) -> int:
        """Highest degree."""
        return len(self.c) - 1

    def truncated(self, degree: int, order: int | None = None) -> "GravityField":
        """Field up to a degree, and an order if given.

        Raises
        ------
        ArgumentError
            A degree below 0 or above the field's.
        """
        if not 0 <= degree <= self.degree:
            raise ArgumentError(
                f"gravity_degree = {degree}: allowed 0 to {self.degree}, the degree of {self.name}"
            )
        c, s = (a[: degree + 1, : degree + 1].copy() for a in (self.c, self.s))
        if order is not None:
            c[:, order + 1 :], s[:, order + 1 :] = 0.0, 0.0
        return replace(self, c=c, s=s, file=self.file if order is None else "")

    def terms(self) -> NDArray[np.float64]:
        """Recursion numbers and weights for `compass.core.gravity.field_acceleration`.

        A coefficient (n, m) of the potential weighs the harmonics (n + 1, m) and
        (n + 1, m +- 1) in the acceleration (Montenbruck and Gill 2000, eq. 3.33), here times the
        ratio of the normalisations.
        """
        from compass.core.gravity import COLUMNS

        top = self.degree + 1
        table = np.zeros((top + 1, top + 1, COLUMNS))
        for m in range(top + 1):
            for n in range(m, top + 1):
                if n == m:
                    table[m, n, 0] = math.sqrt(3.0) if m == 1 else math.sqrt(1 + 0.5 / max(m, 1))
                    continue
                square = (n - m) * (n + m)
                table[m, n, 0] = math.sqrt((2 * n - 1) * (2 * n + 1) / square)
                if n > m + 1:
                    below = (n + m - 1) * (n - m - 1) * (2 * n + 1) / ((2 * n - 3) * square)
                    table[m, n, 1] = math.sqrt(below)
        for n in range(2, self.degree + 1):
            share = (2 * n + 1) / (2 * n + 3)
            for m in range(n + 1):
                c, s = self.c[n, m], self.s[n, m]
                up = math.sqrt(share * (n + m + 2) * (n + m + 1))
                up *= math.sqrt(0.5) if m == 0 else 0.5
                table[m + 1, n + 1, 2:6] += up * np.array([-c, -s, s, -c])
                if m > 0:
                    down = 0.5 * math.sqrt(share * (n - m + 2) * (n - m + 1))
                    down *= math.sqrt(2.0) if m == 1 else 1.0
                    table[m - 1, n + 1, 2:6] += down * np.array([c, s, s, -c])
                level = math.sqrt(share * (n + 1 + m) * (n + 1 - m))
                table[m, n + 1, 6:] += level * np.array([-c, -s])
        return np.concatenate([table[m, m:] for m in range(top + 1)])


@cache
def built_in_sigmas(degree: int) -> tuple[tuple[str, int, int, float], ...]:
    """Formal sigmas of the built-in field from degree 2 on: C or S, degree, order, one sigma."""
    text = files("compass.data").joinpath("mars-gravity-gmm3.csv").read_text(encoding="utf-8")
    sigmas = []
    for line in text.splitlines():
        if line[:1].isdigit():
            n, m, *_, of_c, of_s = line.split(",")
            if int(n) <= degree:
                sigmas.append(("C", int(n), int(m), float(of_c)))
                if int(m):
                    sigmas.append(("S", int(n), int(m), float(of_s)))
    return tuple(sigmas)


def unit_terms(kind: str, n: int, m: int, degree: int) -> NDArray[np.float64]:
    """Return `GravityField.terms` of a field of one coefficient C or S (n, m) at 1."""
    c, s = np.zeros((degree + 1, degree + 1)), np.zeros((degree + 1, degree + 1))
    (c if kind == "C" else s)[n, m] = 1.0
    return GravityField("one coefficient", 1.0, 1.0, c, s).terms()


@cache
def built_in_field() -> GravityField:
    """GMM-3 of NASA's Goddard Space Flight Center to degree and order 20.

    References
    ----------
    Genova et al. 2016, Seasonal and static gravity field of Mars from MGS, Mars Odyssey and MRO
    radio science, Icarus 272:228; product ``gmm3_120_sha.tab`` of the Planetary Data System.
    """
    text = files("compass.data").joinpath("mars-gravity-gmm3.csv").read_text(encoding="utf-8")
    return field_from_csv(text, "GMM-3 (Genova et al. 2016)", 42828.37285418775e9, 3396.0e3)


def field_from_csv(text: str, name: str, gm: float, radius: float) -> GravityField:
    """Field of a table ``n,m,C,S,...`` of normalised coefficients, IAU 2000 meridian."""
    rows = [
        (k, line.split(","))
        for k, line in enumerate(text.splitlines(), start=1)
        if line and line[0].isdigit()
    ]
    return _field(name, gm, radius, rows, 0.0)


def read_field(path: Path, frame: str | None) -> GravityField:
    """Field of a SHADR table (``.tab``) or an ICGEM file (``.gfc``).

    Parameters
    ----------
    path
        The file.
    frame
        To which prime meridian its longitudes refer: a key of `MERIDIANS`.

    Raises
    ------
    DesignError
        An unreadable file, another format, another normalisation, no frame.
    """
    if frame not in MERIDIANS:
        given = "missing" if frame is None else f"{frame!r}"
        raise DesignError(
            f"motion.gravity_frame: {given}; allowed {' or '.join(MERIDIANS)}. {path.name} gives "
            "longitudes from a prime meridian that its columns do not name; older fields (GMM-2B, "
            "GGM2B, Mars50c) use the IAU 1991 one, 0.238 deg from the IAU 2000 one, and used as "
            "they stand would put every equilibrium wrong by that much"
        )
    try:
        text = path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        why = getattr(error, "strerror", None) or error
        raise DesignError(f"{path}: cannot be read: {why}") from error
    reader = _icgem if "product_type" in text or "end_of_head" in text else _shadr
    try:
        return replace(reader(text, path.name, MERIDIANS[frame]), file=str(path.resolve()))
    except ValueError as error:
        raise DesignError(f"{path}: {error}") from error


def _shadr(text: str, name: str, meridian: float) -> GravityField:
    """Field of a SHADR table: a line of constants, then ``n, m, C, S, ...``."""
    lines = [
        (k, line.replace(",", " ").split())
        for k, line in enumerate(text.splitlines(), start=1)
        if line.strip()
    ]
    try:
        head = [_float(text) for text in lines[0][1][:6]]
    except (ValueError, IndexError):
        head = []
    # a table without its first line begins with a degree, where the radius is expected
    if len(head) < 6 or head[0] < MOST:
        raise ValueError(
            "is neither a SHADR table (first line: radius, GM, its uncertainty, degree, order, "
            "normalisation) nor an ICGEM file (product_type ... end_of_head); convert it to one"
        )
    if head[5] != 1:
        raise ValueError(
            f"normalisation state {head[5]:g}: allowed 1, full (4 pi); convert the coefficients"
        )
    # the format's unit is the kilometre
    return _field(name, head[1] * 1e9, head[0] * 1e3, lines[1:], meridian)


def _icgem(text: str, name: str, meridian: float) -> GravityField:
    """Field of an ICGEM file: keys up to ``end_of_head``, then lines ``gfc n m C S ...``."""
    head, _, body = text.partition("end_of_head")
    keys = {}
    for line in head.splitlines():
        words = line.split()
        if len(words) >= 2:
            keys[words[0]] = words[1]
    norm = keys.get("norm", "fully_normalized")
    if norm != "fully_normalized":
        raise ValueError(f"norm = {norm}: allowed fully_normalized; convert the coefficients")
    for key, remedy in _HEAD.items():
        if key not in keys:
            raise ValueError(f"{key}: missing from the head; give {remedy}")
    if keys["tide_system"] not in TIDES:
        raise ValueError(
            f"tide_system = {keys['tide_system']}: allowed {', '.join(TIDES)}; take the Sun's "
            "permanent tide out of C20, some 1e-9, and say so"
        )
    above = head.count("\n") + 1
    rows = [
        (above + k, line.split()[1:])
        for k, line in enumerate(body.splitlines())
        if line.startswith("gfc")
    ]
    gm, radius = _float(keys["earth_gravity_constant"]), _float(keys["radius"])
    return _field(name, gm, radius, rows, meridian)


def _field(
    name: str, gm: float, radius: float, rows: list[tuple[int, list[str]]], meridian: float
) -> GravityField:
    """Field of numbered lines n, m, C, S, with checks that tell another planet or another unit."""
    if not 4.2e13 < gm < 4.4e13:
        raise ValueError(f"GM = {gm:g} m^3/s^2: is not that of Mars, 4.2828e13; check the units")
    if not 3.3e6 < radius < 3.5e6:
        raise ValueError(f"radius = {radius:g} m: is not that of Mars, 3.396e6; check the units")
    known = _coefficients(rows)
    degree = max((n for n, _ in known), default=0)
    c, s = np.full((2, degree + 1, degree + 1), np.nan)
    c[:2], s[:2] = 0.0, 0.0
    for (n, m), (cosine, sine) in known.items():
        c[n, m], s[n, m] = cosine, sine
    if not -8.9e-4 < c[2, 0] < -8.6e-4:
        raise ValueError(
            f"C20 = {c[2, 0]:g}: Mars's fully normalised one is -8.75e-4; "
            "unnormalised or foreign coefficients must be converted"
        )
    c, s = np.tril(c), np.tril(s)
    for n, m in np.argwhere(np.isnan(c))[:1]:
        raise ValueError(
            f"degree {n}, order {m}: missing, though degree {degree} is there; the file is cut off "
            "or has a hole: give the coefficients, zeros if they are none"
        )
    return GravityField(name, gm, radius, c, s, meridian)


def _coefficients(rows: list[tuple[int, list[str]]]) -> dict[tuple[int, int], tuple[float, float]]:
    """Cosine and sine coefficients by degree and order, of degree 2 to `MOST`."""
    known: dict[tuple[int, int], tuple[float, float]] = {}
    for line, words in rows:
        try:
            n, m = int(words[0]), int(words[1])
            pair = _float(words[2]), _float(words[3])
            if not (0 <= m <= n and math.isfinite(pair[0]) and math.isfinite(pair[1])):
                raise ValueError
        except (ValueError, IndexError):
            raise ValueError(
                f"line {line}: {' '.join(words)[:60]!r}: must be degree, order, C and S, finite"
            ) from None
        if (n, m) in known:
            raise ValueError(f"line {line}: degree {n}, order {m}: given twice; leave one out")
        if 2 <= n <= MOST:
            known[n, m] = pair
    if not known:
        raise ValueError("no coefficients of degree 2 or more; a field needs at least degree 2")
    return known


def _float(text: str) -> float:
    """Number of a text that may have Fortran's D for an exponent."""
    return float(text.replace("D", "e").replace("d", "e"))
