"""Continuous coverage of a design, proven or refuted, as text, numbers and picture."""

from dataclasses import dataclass
from math import degrees, isfinite
from typing import TYPE_CHECKING, Any

from compass.api.fold_claim import FoldClaim
from compass.coverage.certificate import Outcome
from compass.coverage.clearance import Clearance
from compass.coverage.continuous import ContinuousCoverage
from compass.document import Bracket, Page, Proven, Sampled, Sentence, Table, Value, Verdict
from compass.document.blocks import Block, facts
from compass.document.plain import plain
from compass.frames import latitude_longitude, mcmf_from_mci, prime_meridian_angle
from compass.quantities import quantity
from compass.sites import Site
from compass.words import counted, place_words

if TYPE_CHECKING:
    from matplotlib.axes import Axes

#: Kinds of losses that the text lists.
LISTED = 20


@dataclass(frozen=True, repr=False)
class FoldResult(FoldClaim):
    """Whether a design has continuous k-fold coverage, and its margins.

    Attributes
    ----------
    design, fold, mask_deg
        As of `FoldClaim`.
    region
        Where.
    coverage
        What was found, in SI units and radians.
    sites
        The same of each station over its own horizon, for ever and at any longitude; asked only
        for the whole globe and all time, of orbits of one period.
    """

    region: str
    coverage: ContinuousCoverage
    sites: tuple[tuple[Site, Clearance], ...] = ()

    @property
    def outcome(self) -> Outcome:
        """Proven, refuted or undecided."""
        return self.coverage.outcome

    @property
    def mask_margin_deg(self) -> float | None:
        """Highest mask with the fold wanted, degrees, on the safe side; None if there is none."""
        margin = self.coverage.highest_mask
        return None if margin is None else degrees(margin)

    @property
    def cap_radius_min_deg(self) -> float | None:
        """Smallest common cap radius that will do, degrees; None where caps differ."""
        worst = self.coverage.worst
        if worst is None or not self.coverage.caps_alike or not isfinite(worst.radius):
            return None
        return degrees(worst.radius)

    @property
    def lowest_altitude_km(self) -> float | None:
        """Lowest altitude at which the pattern keeps the fold at this mask, km."""
        altitude = self.coverage.lowest_altitude
        return None if altitude is None else altitude / 1e3

    @property
    def scope(self) -> str:
        """For which motion and how long it was settled."""
        span = self.coverage.span
        when = "for all time" if span.for_all_time else f"over {span.stop / 3600:.6g} h"
        table = self.design.motion.table
        of = "two-body motion" if table is None else "of the ellipses that touch its paths"
        return f"{when}, {of}, {self.design.figure.words}"

    def to_dict(self) -> dict[str, Any]:
        """Plain values for JSON."""
        coverage, certificate, span = self.coverage, self.coverage.certificate, self.coverage.span
        witness = certificate.witness if self.outcome is Outcome.REFUTED else None
        shares = coverage.shares
        return plain(
            {
                "design": self.design.name,
                "outcome": self.outcome,
                "fold": self.fold,
                "mask_deg": self.mask_deg,
                "min_fold": _settled(coverage.least),
                "max_fold": _settled(coverage.greatest),
                "cap_radius_min_deg": self.cap_radius_min_deg,
                "mask_margin_deg": self.mask_margin_deg,
                "lowest_altitude_km": self.lowest_altitude_km,
                "witness": witness.as_dict() if witness else None,
                "worst": self._worst(),
                "intervals": certificate.intervals,
                "unsettled_s": certificate.unsettled if self.outcome is Outcome.UNDECIDED else (),
                "region": self.region,
                "start_s": span.start,
                "stop_s": span.stop,
                "for_all_time": span.for_all_time,
                "reason": span.reason,
                "tolerance_rad": certificate.tolerance,
                "motion": "two-body",
                "figure": self.design.figure.name,
                "fold_share": None if shares is None else shares.share,
                "fold_share_error": None if shares is None else shares.error,
                "evidence": {
                    "fold_share": "" if shares is None else str(_integrated(shares.error)),
                    "others": str(Proven(self.scope)),
                },
                "min_fold_bounds": coverage.least,
                "max_fold_bounds": coverage.greatest,
                "stations": [
                    {
                        "name": site.name,
                        "outcome": _OUTCOMES[clearance.holds],
                        "margin_deg": degrees(clearance.low),
                    }
                    for site, clearance in self.sites
                ],
                "after_losses": [self._after(k, sets) for k, sets in enumerate(coverage.losses, 1)],
            }
        )

    def _worst(self) -> dict[str, float] | None:
        """Where and when the fold-th nearest satellite is farthest, Mars-fixed."""
        worst = self.coverage.worst
        if worst is None or not isfinite(worst.radius):
            return None
        angle = prime_meridian_angle(self.design.constellation.epoch, worst.time)
        latitude, longitude = latitude_longitude(mcmf_from_mci(worst.place, angle))
        return {
            "time_s": worst.time,
            "latitude_deg": degrees(latitude),
            "longitude_deg": degrees(longitude),
        }

    @staticmethod
    def _after(number: int, sets: Any) -> dict[str, Any]:
        """What is left after so many losses."""
        least = sets[0].least
        return {
            "losses": number,
            "min_fold": _settled(least),
            "worst": [list(kind.satellites) for kind in sets if kind.least == least],
            "sets": [kind.as_dict() for kind in sets],
        }

    def document(self) -> Page:
        """The verdict, its witness, the margins, shares of area and time, losses."""
        certificate, span = self.coverage.certificate, self.coverage.span
        figure = self.design.figure.title
        when = (
            "for all time" if span.for_all_time else f"over {span.stop / 3600:.6g} h from the epoch"
        )
        claim = f"{self.fold} or more satellites above {self.mask_deg:g} deg, {self.region}, {when}"
        holds = {Outcome.PROVEN: True, Outcome.REFUTED: False}.get(self.outcome)
        how = (
            f"looked at {span.start / 3600:.6g} to {span.stop / 3600:.6g} h: {span.reason}; "
            f"{counted(certificate.intervals, 'interval')}, split until no cap strays more than "
            f"{certificate.tolerance:g} rad; rounding on the safe side"
        )
        blocks: list[Block] = [
            Verdict(self.outcome, f"{claim} (two-body motion, {figure})", holds),
            *([] if holds else [Sentence(self.outcome.sentence)]),
            *self._counterexample(),
            self.margins(),
            *self._stations(),
            *self._shares(),
            *self.losses_tables(),
            Sentence(how),
        ]
        return Page(self.design.name, tuple(blocks))

    def _counterexample(self) -> list[Block]:
        """What stands against the claim: a witness, or the time that is not settled."""
        certificate, mask = self.coverage.certificate, self.design.mask
        if self.outcome is Outcome.REFUTED and (w := certificate.witness):
            names = ", ".join(w.satellites) or "none"
            return [
                Sentence(
                    f"witness: {w.fold} in view ({names}) at t = {w.time:.6f} s, "
                    f"{place_words(degrees(w.latitude), degrees(w.longitude), '.6f')}; the next "
                    f"satellite is {degrees(w.shortfall):.3g} deg below the mask"
                )
            ]
        if self.outcome is Outcome.PROVEN:
            return []
        unsettled = "; ".join(f"{a:.9g} to {b:.9g} s" for a, b in certificate.unsettled[:5])
        if certificate.outcome is Outcome.REFUTED or not unsettled:
            return [
                Sentence(
                    f"the mask runs from {degrees(mask.lowest):g} to {degrees(mask.highest):g} deg "
                    "by azimuth: not proven with the highest all around, not refuted with the "
                    "lowest"
                )
            ]
        return [Sentence(f"unsettled: {unsettled}")]

    def margins(self) -> Table:
        """Least and greatest fold, and how far the claim is from failing."""
        coverage, proven = self.coverage, Proven(self.scope)

        def extreme(name: str, bounds: tuple[int, int]) -> Value:
            settled = bounds[0] == bounds[1]
            evidence = proven if settled else Bracket(*bounds, self.scope)
            return Value(quantity(name), bounds[0], evidence)

        def common(name: str, value: float | None) -> Value:
            """Of caps that are alike; where they differ there is nothing to prove."""
            return Value(quantity(name), value, None if value is None else proven)

        return facts(
            "Fold and margins",
            [
                extreme("min_fold", coverage.least),
                extreme("max_fold", coverage.greatest),
                common("cap_radius_min_deg", self.cap_radius_min_deg),
                Value(quantity("mask_margin_deg"), self.mask_margin_deg, proven),
                common("lowest_altitude_km", self.lowest_altitude_km),
            ],
        )

    def _stations(self) -> list[Block]:
        if not self.sites:
            return []
        room = quantity("requirement_margin_deg")
        rows = tuple(
            (
                site.name,
                _OUTCOMES[clearance.holds],
                Value(room, degrees(clearance.low), Proven(self.scope)),
            )
            for site, clearance in self.sites
        )
        return [
            Table(
                f"Stations: {self.fold} above their own horizons, at any longitude",
                ("", "claim", room.heading),
                rows,
            ),
            Sentence(
                "off the resonance with Mars a site meets every longitude of its latitude; where "
                "ground tracks close, the claim on the latitude is the stronger one"
            ),
        ]

    def shares_tables(self) -> tuple[Table, ...]:
        """Shares of area and time by fold, where they are known."""
        shares, share = self.coverage.shares, quantity("fold_share")
        if shares is None:
            return ()
        evidence = _integrated(shares.error)
        known = (
            Value(share, float(part), evidence, f"exactly {k} in view")
            for k, part in enumerate(shares.share)
            if part > 0
        )
        return (facts("Share of area and time by fold", known),)

    def _shares(self) -> list[Block]:
        shares = self.coverage.shares
        if shares is None:
            return []
        return [
            *self.shares_tables(),
            Sentence(
                f"shares good to {shares.error:.1g}; with 4 in view there are curves on which GDOP "
                "is infinite"
            ),
        ]

    def losses_tables(self) -> tuple[Table, ...]:
        """What is left after so many losses, a table each."""
        return tuple(self._losses(number, s) for number, s in enumerate(self.coverage.losses, 1))

    def _losses(self, number: int, sets: Any) -> Table:
        cap, least = quantity("cap_radius_min_deg"), quantity("min_fold")
        rows = tuple(
            (
                " ".join(kind.satellites),
                Value(quantity("alike"), kind.alike),
                Value(least, kind.least[0], Bracket(*kind.least)),
                Value(cap, None if kind.radius is None else degrees(kind.radius)),
            )
            for kind in sets
        )
        header = ("satellites lost", quantity("alike").title, least.title, cap.heading)
        return Table(f"After {counted(number, 'loss')}, worst first", header, rows, LISTED)

    def plot(self, *, axes: "Axes | None" = None) -> "Axes":
        """Draw the share of area and time by fold as bars.

        Parameters
        ----------
        axes
            Where to; new ones without.
        """
        from compass.pictures.style import CYCLE, MARS, axes_or_new, whole_numbers

        drawn = axes_or_new(axes)
        shares = self.coverage.shares
        for k, part in enumerate([] if shares is None else shares.share):
            if part > 0:
                drawn.bar(k, 100 * float(part), color=MARS if k < self.fold else CYCLE[0])
        drawn.set(
            xlabel="satellites in view",
            ylabel=quantity("fold_share").heading,
            title=f"{self.design.name}: {self.outcome}, {self.fold}-fold",
        )
        whole_numbers(drawn.xaxis)
        return drawn


#: What is said of a claim that holds, fails, or is open.
_OUTCOMES = {True: Outcome.PROVEN, False: Outcome.REFUTED, None: Outcome.UNDECIDED}


def _integrated(error: float) -> Sampled:
    """How well shares by fold are known."""
    return Sampled(error, "areas exact, integrated over time")


def _settled(bounds: tuple[int, int]) -> int | None:
    """The extreme that both bounds agree on, or None."""
    return bounds[0] if bounds[0] == bounds[1] else None
