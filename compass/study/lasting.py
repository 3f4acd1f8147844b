"""What real orbits make of candidates: how long their fold lasts, what keeping them costs.

Two ways, a quick law for all of them and a proof for those that are left. The law: the mean push
of Mars's field along the track, undone for a year (`compass.orbits.resonance`). The proof: orbits
under all forces, trimmed where they can be, and no symmetry (`compass.coverage.lasting`).
"""

from collections.abc import Iterator
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from compass.core.resonance import push_on_patterns
from compass.coverage.certificate import Outcome
from compass.coverage.lasting import prove_span
from compass.frames import SECONDS_PER_DAY, Figure, prime_meridian_angle
from compass.inputs.study import Study
from compass.orbits import Constellation
from compass.orbits.forces import ForceModel
from compass.orbits.gravity import GravityField
from compass.orbits.motion import Motion
from compass.orbits.resonance import SlowPushes, slow_pushes
from compass.orbits.trajectory import COARSE, Trajectory
from compass.orbits.trimming import beat_of, can_trim, trimmed_path
from compass.quantities.merits import worked_out
from compass.study.candidates import make_constellation, patterns_of

#: A year here, s.
YEAR = 365.25 * SECONDS_PER_DAY

#: Half width of a slot's box, as a share of what the margin allows; as of `compass.keep`.
BOX = 0.5

#: Parts of the days for which orbits that no trim helps are followed, if longer than so many days.
PARTS, SHORT = (0.0625, 0.25, 1), 20.0

_forces = lru_cache(maxsize=1)(ForceModel)


@lru_cache(maxsize=4)  # batches of one study have the same orbits
def _slow(
    field: GravityField, radius_km: tuple[float, ...], inclination_deg: tuple[float, ...]
) -> SlowPushes:
    """Pushes on circles."""
    return slow_pushes(field, np.array(radius_km) * 1e3, np.radians(inclination_deg))


def keeping_law(
    rows: NDArray, spare: NDArray[np.float64], motion: Motion | None = None
) -> NDArray[np.float64]:
    """Delta-v a year of the satellite that needs most, by the law of a mean push, m/s, shape (n,).

    Nothing where what Mars's field does swings no satellite out of its box. With the nodes and
    phases of the candidates as they stand at their epoch.

    Parameters
    ----------
    rows
        Candidates, of dtype `compass.study.candidates.ROW`.
    spare
        Cap radius less the least one with the fold, radians, shape (n,); nan where unknown.
    motion
        Whose gravity field pushes; the built-in one if it has none.
    """
    field = ((motion and motion.forces) or _forces()).field
    orbits, group = np.unique(rows[["radius_km", "inclination_deg"]], return_inverse=True)
    slow = _slow(
        field, tuple(orbits["radius_km"].tolist()), tuple(orbits["inclination_deg"].tolist())
    )
    largest = np.empty(rows.size)
    meridian = float(prime_meridian_angle(0.0, 0.0)) + field.meridian
    push_on_patterns(
        patterns_of(rows),
        group.ravel().astype(np.int64),
        meridian,
        BOX * np.asarray(spare),
        slow.swings,
        slow.waves,
        slow.pushes,
        largest,
    )
    return largest * YEAR


def orbits_figures(study: Study, rows: NDArray) -> dict[str, NDArray[np.float64]]:
    """Days that each candidate's fold is proven on real orbits, trimmed once where that helps."""
    days = [
        proven_days(
            make_constellation(row),
            study.fold,
            study.orbits.days,
            study.figure,
            float(np.radians(row["mask_deg"])),
            study.motion,
        )
        for row in rows
    ]
    return worked_out("orbits", {"days_proven": days})


def real_motion() -> Motion:
    """Motion under all forces."""
    return Motion("numerical", _forces())


def paths_left_alone(
    c: Constellation, days: float, motion: Motion | None = None
) -> Iterator[tuple[float, Trajectory]]:
    """Paths for more and more days up to all: trimmed once where forces allow it, to `COARSE`.

    Orbits that no trim helps are soon lost: they are followed for a part of the days first. Of
    trimmed ones all days are known at once.

    Yields
    ------
    days, path
        The last of all `days`.
    """
    moved = motion or real_motion()
    stop, forces = days * SECONDS_PER_DAY, moved.forces
    if forces is not None and can_trim(beat_of(c, forces.field)):
        yield days, trimmed_path(c, forces, stop)
        return
    for part in PARTS:
        if part == 1 or part * days > SHORT:
            yield part * days, moved.trajectory(c, 0.0, part * stop, tolerance=COARSE)


def proven_days(
    c: Constellation,
    fold: int,
    days: float,
    figure: Figure,
    mask: float,
    motion: Motion | None = None,
) -> float:
    """Days for which a fold is proven from the epoch on, trimmed once where forces allow it."""
    ground: Any = {"sphere_radius": figure.equatorial_radius, "stretch": figure.stretch}
    proven = 0.0
    for until, path in paths_left_alone(c, days, motion):
        stop = until * SECONDS_PER_DAY
        lasting = prove_span(path, fold, **ground, mask=mask, stop=stop)
        proven = lasting.days_proven
        if lasting.outcome is not Outcome.PROVEN:
            break
    return proven
