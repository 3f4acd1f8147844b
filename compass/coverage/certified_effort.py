"""How far certified figures are taken, and the file from which finer ones go on from coarser."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, TypedDict, Unpack
from zipfile import BadZipFile

import numpy as np
from numpy.typing import NDArray

from compass.allowed import check_all_allowed
from compass.coverage.certified_distribution import Boxes
from compass.coverage.certified_percentile import (
    CertifiedPercentile,
    CertifiedPercentiles,
    certified_percentiles,
)
from compass.coverage.certified_question import Asked
from compass.coverage.certified_share import CertifiedShare, certified_folds, certified_share
from compass.coverage.certified_worst import (
    CertifiedAlways,
    CertifiedWorst,
    certified_always,
    certified_worst,
)
from compass.digest import digest_of
from compass.errors import ArgumentError
from compass.kept import version
from compass.orbits import Constellation
from compass.saving import check_writable, replacing

#: How near bounds of a percentile come, relative to it, for a width of those of a share; at most.
PERCENTILE_PER_SHARE, COARSEST = 100.0, 0.1

#: And how near those of shares by fold come: rims of caps are nearly everywhere.
FOLD_PER_SHARE = 10.0


class Budget(TypedDict):
    """What ends a figure early."""

    budget_s: float
    budget_boxes: float


@dataclass
class Effort:
    """How near bounds are to come and how long that may take; all figures of a command share it.

    Without `width` and `budget_s` callers' own widths and numbers of boxes count, which are the
    same on any machine. Once interrupted, what is asked next answers at once what is known of it.

    Attributes
    ----------
    width
        How near bounds of shares are to come; those by fold `FOLD_PER_SHARE` times that; those of
        percentiles `PERCENTILE_PER_SHARE` times, relative to the value, at most `COARSEST` apart.
    budget_s
        Seconds that each figure may take.
    file
        Where open boxes are kept: what it holds of the same question is gone on from. What
        another version of the program left is not.
    workers
        Threads; the numbers do not depend on them.
    progress
        Called with what is looked for and which part of the way to the width is gone, 0 to 1, on
        a logarithmic scale of what is open.
    """

    width: float | None = None
    budget_s: float | None = None
    file: Path | None = None
    workers: int = 1
    progress: Callable[[str, float], None] = lambda title, part: None
    interrupted: bool = False
    _arrays: dict[str, NDArray[Any]] = field(default_factory=dict, repr=False)

    def __post_init__(self) -> None:
        """Check what is asked and read the file.

        Raises
        ------
        ArgumentError
            A width or budget out of range, or a file that is none of open boxes.
        OutputError
            A file that cannot be written.
        """
        check_all_allowed(width=self.width, budget_s=self.budget_s)
        if self.file is not None:
            check_writable(self.file)
            if self.file.exists():
                self._arrays = _read(self.file)

    def share(
        self,
        constellation: Constellation,
        limit: float,
        *,
        width: float,
        budget_boxes: float,
        **asked: Unpack[Asked],
    ) -> CertifiedShare:
        """As `certified_share`; `width` and `budget_boxes` where nothing else was asked."""
        wide, key = self.width or width, _key("share", constellation, limit, asked)

        def told(still: float) -> None:
            self.progress("share", _part(still, wide))

        share = certified_share(
            constellation,
            limit,
            width=wide,
            start=self._share(key),
            workers=self.workers,
            progress=told,
            **self.budget(budget_boxes),
            **asked,
        )
        self._put_share(key, share)
        self._close(share.stopped)
        return share

    def folds(
        self,
        constellation: Constellation,
        folds: Sequence[int],
        *,
        width: float,
        budget_boxes: float,
        **asked: Unpack[Asked],
    ) -> list[CertifiedShare]:
        """As `certified_folds`; `width` and `budget_boxes` where nothing else was asked."""
        wide = width if self.width is None else FOLD_PER_SHARE * self.width
        key = _key("folds", constellation, 0.0, asked) + "-".join(map(str, folds))
        shares = certified_folds(
            constellation,
            folds,
            width=wide,
            start=self._share(key),
            workers=self.workers,
            progress=lambda still: self.progress("folds", _part(still, wide)),
            **self.budget(budget_boxes),
            **asked,
        )
        self._put_share(key, shares[0])
        self._close(shares[0].stopped)
        return shares

    def percentiles(
        self,
        constellation: Constellation,
        percents: Sequence[float],
        *,
        precision: float,
        budget_boxes: float,
        **asked: Unpack[Asked],
    ) -> Mapping[float, CertifiedPercentile]:
        """As `certified_percentiles`; `precision` and `budget_boxes` where nothing else was."""
        key = _key("percentiles", constellation, 0.0, asked) + "-".join(f"{q:g}" for q in percents)
        if self.width is not None:
            precision = min(PERCENTILE_PER_SHARE * self.width, COARSEST)
        percentiles = certified_percentiles(
            constellation,
            percents,
            precision=precision,
            start=self._percentiles(key, percents),
            workers=self.workers,
            **self.budget(budget_boxes),
            **asked,
        )
        self._put_percentiles(key, percentiles)
        self.progress("percentiles", 1.0)
        self._close(next((one.stopped for one in percentiles.of.values() if one.stopped), ""))
        return percentiles.of

    def worst(
        self,
        constellation: Constellation,
        *,
        precision: float = 1e-3,
        budget_boxes: float,
        **asked: Unpack[Asked],
    ) -> CertifiedWorst:
        """As `certified_worst`; only seconds, no width, move the number of boxes."""
        key, start = _key("worst", constellation, 0.0, asked), None
        if (best := self._arrays.get(f"{key}/best")) is not None:
            leaves, boxes = self._arrays[f"{key}/leaves"], int(self._arrays[f"{key}/boxes"])
            start = CertifiedWorst(
                0.0, np.inf, None, boxes, "", leaves=leaves, best=tuple(best.tolist())
            )
        worst = certified_worst(
            constellation,
            precision=precision,
            start=start,
            workers=self.workers,
            **self.budget(budget_boxes, by_width=False),
            **asked,
        )
        if worst.leaves is not None:
            self._arrays |= {
                f"{key}/best": np.array(worst.best),
                f"{key}/leaves": worst.leaves,
                f"{key}/boxes": np.array(worst.boxes),
            }
        self.progress("largest", 1.0)
        self._close(worst.stopped)
        return worst

    def always(
        self,
        constellation: Constellation,
        limit: float,
        *,
        budget_boxes: float,
        **asked: Unpack[Asked],
    ) -> CertifiedAlways:
        """As `certified_always`, begun anew each time."""
        budget = self.budget(budget_boxes)
        always = certified_always(constellation, limit, workers=self.workers, **budget, **asked)
        self.interrupted = self.interrupted or always.stopped == "interrupted"
        return always

    def budget(self, boxes: float, *, by_width: bool = True) -> Budget:
        """Seconds and boxes that a figure may take, any number if a width ends it (`by_width`)."""
        seconds = math.inf if self.budget_s is None else self.budget_s
        free = self.budget_s is not None or (by_width and self.width is not None)
        return {
            "budget_s": 0.0 if self.interrupted else seconds,
            "budget_boxes": math.inf if free else boxes,
        }

    def _share(self, key: str) -> CertifiedShare | None:
        """Where a share stopped; None where it has not begun."""
        if (leaves := self._arrays.get(f"{key}/leaves")) is None:
            return None
        settled = tuple(self._arrays[f"{key}/settled"].tolist())
        boxes = int(self._arrays[f"{key}/boxes"])
        return CertifiedShare(0.0, 1.0, boxes, "", leaves=leaves, settled=settled)

    def _put_share(self, key: str, share: CertifiedShare | None) -> None:
        """Keep where a share stopped, or that none is open."""
        for name in ("leaves", "settled", "boxes"):
            self._arrays.pop(f"{key}/{name}", None)
        if share is not None and share.leaves is not None:
            self._arrays |= {
                f"{key}/leaves": share.leaves,
                f"{key}/settled": np.array(share.settled),
                f"{key}/boxes": np.array(share.boxes),
            }

    def _percentiles(self, key: str, percents: Sequence[float]) -> CertifiedPercentiles | None:
        """Where percentiles stopped; None where they have not begun."""
        if (ends := self._arrays.get(f"{key}/ends")) is None:
            return None
        of = {
            q: CertifiedPercentile(low, high, q, "", "time" if late else "")
            for q, (low, high, late) in zip(percents, ends.tolist(), strict=True)
        }
        held = [self._arrays[f"{key}/{name}"] for name in ("leaves", "settled", "sums", "eps")]
        leaves, settled, (inside, looked), eps = held
        boxes = Boxes(leaves, settled, float(inside), eps, int(looked))
        return CertifiedPercentiles(of, boxes, self._arrays[f"{key}/points"])

    def _put_percentiles(self, key: str, percentiles: CertifiedPercentiles) -> None:
        """Keep where percentiles stopped."""
        if (boxes := percentiles.boxes) is None:
            return
        ends = [(one.low, one.high, float(bool(one.stopped))) for one in percentiles.of.values()]
        self._arrays |= {
            f"{key}/ends": np.array(ends),
            f"{key}/leaves": boxes.leaves,
            f"{key}/settled": boxes.settled,
            f"{key}/sums": np.array([boxes.inside, boxes.looked]),
            f"{key}/eps": boxes.eps,
            f"{key}/points": percentiles.points,
        }

    def _close(self, stopped: str) -> None:
        """Note why a figure stopped, and write the file."""
        self.interrupted = self.interrupted or stopped == "interrupted"
        if self.file is not None:
            with replacing(self.file) as temporary, temporary.open("wb") as stream:
                np.savez(stream, version=np.array(version()), **self._arrays)  # type: ignore[arg-type]


def _key(kind: str, constellation: Constellation, at: float, asked: Asked) -> str:
    """Name of all that a figure depends on."""
    return digest_of((kind, constellation, float(at), dict(asked)))


def _part(still: float, wide: float) -> float:
    """Part of the way from all open to a width."""
    if still <= wide or wide >= 1.0:
        return 1.0
    return max(math.log(still) / math.log(wide), 0.0)


def _read(path: Path) -> dict[str, NDArray[Any]]:
    """Arrays of a file of open boxes; none of another version.

    Raises
    ------
    ArgumentError
        It is something else.
    """
    try:
        with path.open("rb") as stream, np.load(stream, allow_pickle=False) as held:
            arrays = {name: held[name] for name in held.files}
        known = str(arrays.pop("version"))
    except (OSError, ValueError, KeyError, EOFError, BadZipFile) as error:
        raise ArgumentError(
            f"leaves = {path}: not a file of open boxes; name one that a run has written, or a "
            "new one"
        ) from error
    return arrays if known == version() else {}
