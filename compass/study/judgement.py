"""What a judgement says: figures of merit of a constellation over many entries."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from compass.entry.campaign import Campaign
from compass.entry.unknowns import Unknowns
from compass.orbits import Constellation
from compass.quantities.draws import median_of, percentiles, quantile_bounds, share_bounds
from compass.quantities.percentile import percentile

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Judgement:
    """How well landers navigate on a constellation, entry by entry.

    Attributes
    ----------
    constellation, campaign, unknowns
        Who was judged, on what, and what the lander does not know.
    epochs
        Seconds after the constellation's epoch at which each entry begins, (m,).
    seen
        Which satellites are in view, (m, t, n).
    counts
        How often 0 to n are in view, with all satellites and without each of them, (1 + n, 1 + n).
    information
        Without prior, in prior-whitened coordinates, (m, d, d).
    shares
        The same by satellite, packed, (m, n, d (d + 1)/2).
    own
        Of what needs no satellite, packed, (m, d (d + 1)/2).
    sigma
        Posterior Cramer-Rao sigma of position (m) and velocity (m/s) at deployment, (m, 1 + n,
        2): with all satellites, then without each of them.
    ends, sums
        Gains at deployment, (m, 6, d), and sums as `core.entry.information` has them.
    """

    constellation: Constellation
    campaign: Campaign
    unknowns: Unknowns
    epochs: Array
    seen: NDArray[np.bool_]
    counts: NDArray[np.int64]
    information: Array
    shares: Array
    own: Array
    sigma: Array
    ends: Array
    sums: Array

    @property
    def position_sigma(self) -> Array:
        """Of each entry with all satellites, m, shape (m,)."""
        return self.sigma[:, 0, 0]

    @property
    def worst_loss(self) -> int | None:
        """Satellite without which the 95th percentile of the position bound is largest."""
        if not self.constellation.size:
            return None
        return int(np.argmax(percentile(self.sigma[:, 1:, 0], 95, axis=0)))

    def figures(self, goal: float = 10.0) -> dict[str, Any]:
        """Figures of merit as plain values, with those after the worst loss of one satellite.

        Parameters
        ----------
        goal
            Position sigma wanted at deployment, metres.
        """
        result = self._figures(None, goal)
        lost = self.worst_loss
        if lost is not None:
            name = self.constellation.satellite_names[lost]
            result["after_loss"] = {"satellite": name, **self._figures(lost, goal)}
        return result

    def budget(self) -> dict[str, float]:
        """Root mean square position error over the entries by its source, m; squares add up.

        With K the posterior covariance of u: what the first state (and density, L/D, clock and the
        satellites' frame) leave is ``K K`` in their components, noise leaves ``K N K``, satellites'
        errors ``K B B^T K``, B their weight in the best gain. ``ignored`` is the whole for a gain
        that is blind to the satellites' errors: the classical consider covariance.
        """
        place, count = self.ends[:, :3], self.ends.shape[2]
        plain, spoilt, orbits, biases = np.moveaxis(unpacked(self.sums), 1, 0)
        own = unpacked(self.own)

        def rms(matrix: Array, known: Array = self.information) -> float:
            gain = np.linalg.solve(np.eye(count) + known, np.swapaxes(place, 1, 2))
            return float(np.sqrt(np.einsum("mai,mab,mbi->m", gain, matrix, gain).mean()))

        clock = self.unknowns.clock_sigmas().size
        names = ["first state"] * 6 + self.campaign.unknown_names
        names += ["satellites' frame"] * int(self.turns.sum()) + ["receiver's clock"] * clock
        parts = {
            name: rms(np.broadcast_to(np.diag([float(n == name) for n in names]), plain.shape))
            for name in dict.fromkeys(names)
        }
        parts["noise of the ranges"] = rms(self.information - own - orbits - biases)
        if own.any():
            parts["noise of the instruments"] = rms(own)
        parts["satellites' orbits and clocks"] = rms(orbits)
        parts["biases of the ranges"] = rms(biases)
        parts["all"] = float(np.sqrt(np.mean(self.position_sigma**2)))
        by_turns = plain * self.turns
        spoilt = spoilt + by_turns @ np.swapaxes(by_turns, 1, 2)
        blind = (plain + own) * ~self.turns * ~self.turns[:, None]
        parts["ignored"] = rms(np.eye(count) + plain + own + spoilt, blind)
        return parts

    @property
    def turns(self) -> NDArray[np.bool_]:
        """Which components of u are turns of the satellites' frame, (d,)."""
        last = self.ends.shape[2] - self.unknowns.clock_sigmas().size
        places = np.arange(self.ends.shape[2])
        return (places >= last - (3 if self.unknowns.turn else 0)) & (places < last)

    @property
    def known(self) -> dict[str, Any]:
        """What figures of merit are worked out of: arrays of one candidate, (1, ...), numbers."""
        return {
            "position_m": self.sigma[None, :, 0, 0],
            "velocity_m_s": self.sigma[None, :, 0, 1],
            "counts": self.counts[:1],
            "longest": self.campaign.longest,
            "blind": self._spectrum(self.information)[1][None],
        }

    def _spectrum(self, information: Array) -> tuple[Array, NDArray[np.bool_]]:
        """Eigenvalues, ascending, (m, d), and which entries leave a state open, (m,).

        As told to who knows the satellites' frame: no satellite tells of that.
        """
        information = information[:, ~self.turns][:, :, ~self.turns]
        spectrum, floor = spectrum_and_floor(information, self.campaign.longest)
        return spectrum, spectrum[:, 0] <= floor

    def _figures(self, lost: int | None, goal: float) -> dict[str, Any]:
        column = 0 if lost is None else 1 + lost
        position, velocity = self.sigma[:, column].T
        counts, f = self.counts[column], self.information
        if lost is not None:
            counts = counts[:-1]  # one fewer is possible
            kept = np.delete(self.shares, lost, axis=1).sum(axis=1)
            f = unpacked(kept + self.own)
        spectrum, blind = self._spectrum(f)
        with np.errstate(divide="ignore"):
            log_det = np.log(np.where(blind[:, None], 0.0, spectrum)).sum(axis=1)
        worst, trace = int(position.argmax()), spectrum.sum(axis=1)
        latitude, longitude = self.campaign.deployment_place
        return {
            "in_view": {
                "min": int(np.argmax(counts > 0)),
                **median_of("median", counts, self.epochs.size, self.campaign.longest),
            },
            "crlb_position_m": {
                **percentiles(position),
                "worst": float(position[worst]),
                "worst_latitude_deg": float(np.degrees(latitude[worst])),
                "worst_longitude_deg": float(np.degrees(longitude[worst])),
                "worst_azimuth_deg": float(np.degrees(self.campaign.arrivals.azimuth[worst])),
                "worst_epoch_s": float(self.epochs[worst]),
            },
            "crlb_velocity_m_s": {**percentiles(velocity), "worst": float(velocity.max())},
            **_share("share_within_goal", position <= goal),
            **_share("unobservable_share", blind),
            "fisher_log_det": {
                "p50": float(percentile(log_det, 50)),
                "p50_interval": list(quantile_bounds(log_det, 50)),
                "p5": float(percentile(log_det, 5)),
                "p5_interval": list(quantile_bounds(log_det, 5)),
            },
            "fisher_trace": {
                "p50": float(percentile(trace, 50)),
                "p50_interval": list(quantile_bounds(trace, 50)),
            },
        }


def _share(name: str, drawn: NDArray[np.bool_]) -> dict[str, Any]:
    """Share of the entries drawn of which something holds, with the bounds that so few leave."""
    share = float(drawn.mean())
    return {name: share, f"{name}_interval": list(share_bounds(share, drawn.size))}


def unpacked(packed: Array) -> Array:
    """Symmetric matrices (..., d, d) from their packed lower triangles."""
    d = int(np.sqrt(2 * packed.shape[-1]))
    full = np.empty((*packed.shape[:-1], d, d))
    a, b = np.tril_indices(d)
    full[..., a, b] = full[..., b, a] = packed
    return full


def spectrum_and_floor(f: Array, terms: int) -> tuple[Array, Array]:
    """Eigenvalues, ascending, (m, d), and what rounding leaves of a zero one, (m,).

    A sum of m positive semi-definite terms is off by at most ``m eps`` times its trace, and the
    eigenvalues of a symmetric matrix by about ``d eps`` times the largest more: below
    ``(m + d) eps trace`` an eigenvalue cannot be told from zero.
    """
    values = np.asarray(np.linalg.eigvalsh(f), dtype=np.float64)
    floor = (terms + values.shape[1]) * np.finfo(float).eps * values.sum(axis=1)
    return values, np.asarray(floor, dtype=np.float64)
