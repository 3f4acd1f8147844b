"""What is said of fused filters: errors, claims, faults, plasma; sentences, tables, numbers."""

from math import isnan
from typing import TYPE_CHECKING, Any

import numpy as np

from compass.document import Interval
from compass.document.blocks import Picture, Section, Table, arranged
from compass.entry.accuracy import error_ellipse
from compass.entry.faults import Fault
from compass.entry.fused_kinds import Kind
from compass.quantities.draws import CONFIDENCE, share_bounds
from compass.study.fusion import SETTLING, TITLES, FusionRuns
from compass.words import capital

if TYPE_CHECKING:
    import xarray as xr


def fusion_section(fused: FusionRuns, *, pictures: bool = True) -> Section:
    """Text, pictures and tables of one plan."""
    drawn: tuple[Picture, ...] = ()
    if pictures:
        from compass.pictures.fusion import fusion_pictures

        drawn = fusion_pictures(fused)
    title = f"Fusion: {fused.plan.case.name}"
    return arranged(title, fusion_words(fused), drawn, fusion_tables(fused))


def fusion_words(fused: FusionRuns) -> tuple[str, ...]:
    """Say what is to be known before the numbers, and what went wrong on the way."""
    case = fused.plan.case
    words = list(case.visibility_report())
    if words and fused.plan.see_through:
        words.append("as in the source, ranges are let through the planet all the same")
    said = [". ".join(capital(word) for word in words) + "."] if words else []
    vain = too_sure(fused)
    if vain:
        told = "; ".join(f"{name}, {how}" for name, how in vain.items())
        said.insert(0, f"Not to be believed: {told}.")
    if case.arrival is not None:
        beta, step = case.arrival[:, 0], case.times[1] - case.times[0]
        partial = (beta < 1) & (beta > 1.0001 * beta.min())
        dark = beta <= 1.0001 * beta.min()
        said.append(
            f"The plasma dims the ranges for {step * partial.sum():g} s (about "
            f"{beta[partial].sum():.1f} of them get through) and stops them for "
            f"{step * dark.sum():g} s."
        )
    if fused.faulty:
        said.append("The fault: " + "; ".join(_fault_words(f) for f in fused.plan.faults) + ".")
    for how, sets in (("", fused.clear), (" with the fault", fused.faulty)):
        for name, data in sets.items():
            if data.attrs["diverged"]:
                said.append(
                    f"{data.attrs['diverged']} of {data.attrs['runs']} runs of {name}{how} "
                    "diverged and are left out of its statistics; the first: "
                    f"{data.attrs['divergences'][0]}."
                )
    return tuple(said)


def too_sure(fused: FusionRuns) -> dict[str, str]:
    """Filters that claim too much where nothing is at fault, and how; a cautious one does not."""
    alone = [kind.algorithm for kind in fused.plan.filters if _each_alone(kind.kind)]
    return {
        name: f"{how}{_ALONE if name in alone else ''}"
        for name, data in fused.clear.items()
        if (how := _vain(data))
    }


#: Why a filter without feedback strays.
_ALONE = (
    ", for its subsystems hear one beacon each and never the fused estimate: each is sure of "
    "where its own linearisation led it"
)


def _each_alone(kind: Kind) -> bool:
    """Whether subsystems go their own way throughout."""
    return kind.apart and not kind.feedback


def _vain(data: "xr.Dataset") -> str:
    """How far a filter claims too much; empty if it does not."""
    nees, high = _settled(data, "nees"), data.attrs["nees_high"]
    if nees <= high:
        return ""
    if not np.isfinite(nees):
        return "whose runs are all lost"
    times = np.sqrt(nees / data.sizes["state"])
    return (
        f"whose errors are {times:.3g} times what it claims (NEES {nees:.4g}, at most {high:.2f})"
    )


def _fault_words(fault: Fault) -> str:
    """Say a fault."""
    what = fault.kind.replace("-", " ") + (f" of {fault.beacon}" if fault.beacon else "")
    size = f" by {fault.size:g} m" if fault.size else ""
    if fault.kind == "spike":
        return f"{what}{size} at {fault.start:g} s"
    end = f"to {fault.end:g} s" if np.isfinite(fault.end) else "on"
    return f"{what}{size} from {fault.start:g} s {end}"


def _settled(data: "xr.Dataset", name: str) -> float:
    return float(data[name][data.sizes["time"] // SETTLING :].mean())


def fusion_tables(fused: FusionRuns) -> tuple[Table, ...]:
    """Errors and consistency of every filter, without and with faults."""
    tables = []
    for key, runs in (("clear", fused.clear), ("faulty", fused.faulty)):
        rows = []
        for name, data in runs.items():
            low, high = data.attrs["nees_low"], data.attrs["nees_high"]
            nees = _settled(data, "nees")
            verdict = "consistent" if low <= nees <= high else "cautious"
            if not nees <= high:
                verdict = "overconfident" if np.isfinite(nees) else "lost"
            rows.append(
                (
                    name,
                    _settled(data, "position_rmse"),
                    float(data.position_rmse[-1]),
                    _bounded(
                        float(data.capture[1:].mean("time").min()),
                        data.attrs["runs"],
                        data.sizes["state"],
                    ),
                    nees,
                    f"{low:.2f} to {high:.2f}",
                    verdict,
                    int(data.attrs["diverged"]),
                )
            )
        if rows:
            count = next(iter(runs.values())).attrs["runs"]
            tables.append(
                Table(
                    f"Filters {TITLES[key]}, {count} runs"
                    if fused.faulty
                    else f"Filters, {count} runs",
                    (
                        "filter",
                        "position RMSE, m",
                        "at the end, m",
                        f"worst state within 3 sigma, % ({Interval.WORDS})",
                        "NEES",
                        "95 % bounds",
                        "verdict",
                        "diverged",
                    ),
                    tuple(rows),
                )
            )
    tables.append(_miss_table(fused))
    if any(np.isfinite(settings.gate_sigma) for settings in fused.plan.filters):
        tables.append(_refused_table(fused))
    return tuple(tables)


def _miss_table(fused: FusionRuns) -> Table:
    rows = []
    for name, data in fused.clear.items():
        if not np.isfinite(data.miss).all():
            continue
        ellipse = error_ellipse(data.miss.values[:2], data.miss_covariance.values[:2, :2])
        claim = error_ellipse(np.zeros(2), data.claimed_covariance.values[:2, :2])
        rows.append(
            (
                name,
                ellipse.semi_major,
                ellipse.semi_minor,
                float(np.degrees(ellipse.azimuth)),
                claim.semi_major,
                claim.semi_minor,
            )
        )
    return Table(
        "95 % error ellipse where the entry ends",
        (
            "filter",
            "semi-major, m",
            "semi-minor, m",
            "azimuth, deg",
            "claimed semi-major, m",
            "claimed semi-minor, m",
        ),
        tuple(rows),
    )


def _refused_table(fused: FusionRuns) -> Table:
    """Say what the gate refused, as a share of all epochs: the filters' own fault report."""
    runs = fused.faulty or fused.clear
    first = next(iter(runs.values()))
    return Table(
        f"Measurements refused by the gate, % of epochs ({Interval.WORDS})",
        ("filter", *first.sensor.values.tolist()),
        tuple(
            (
                name,
                *(
                    _bounded(float(share), data.attrs["runs"])
                    for share in data.refused[1:].mean("time")
                ),
            )
            for name, data in runs.items()
        ),
    )


def _bounded(share: float, runs: int, several: int = 1) -> str | float:
    """A share of so many runs, per cent, with its bounds, as `_shares`; of `several` all hold."""
    if isnan(share):
        return share
    low, high = share_bounds(share, runs, 0.5 * (1.0 - CONFIDENCE) / several)
    return f"{100 * share:.4g} ({100 * low:.3g} to {100 * high:.3g})"


def _shares(
    name: str, of: "xr.DataArray", held: "xr.DataArray", runs: int
) -> dict[str, dict[str, Any]]:
    """Shares of the epochs of all runs, with bounds as if a run were all one or all the other.

    Whatever ties the epochs of a run, their share is of no greater variance.
    """
    shares = dict(zip(of.values.tolist(), held[1:].mean("time").values.tolist(), strict=True))
    return {
        name: shares,
        f"{name}_interval": {
            key: None if isnan(share) else share_bounds(share, runs)
            for key, share in shares.items()
        },
    }


def fusion_facts(fused: FusionRuns) -> dict[str, Any]:
    """Results as plain values for JSON."""
    case = fused.plan.case

    def facts(data: "xr.Dataset") -> dict[str, Any]:
        return {
            "position_rmse_m": _settled(data, "position_rmse"),
            "final_position_rmse_m": float(data.position_rmse[-1]),
            "nees": _settled(data, "nees"),
            "nees_95": [data.attrs["nees_low"], data.attrs["nees_high"]],
            **_shares("within_3_sigma", data.state, data.capture, data.attrs["runs"]),
            **_shares("refused_share", data.sensor, data.refused, data.attrs["runs"]),
            "runs": data.attrs["runs"],
            "diverged": data.attrs["diverged"],
            "divergences": list(data.attrs["divergences"]),
        }

    return {
        "visible_epochs": dict(
            zip(case.beacons.names, case.visible.sum(axis=0).tolist(), strict=True)
        ),
        "epochs": case.times.size,
        "warnings": list(case.visibility_report()),
        "filters": {name: facts(data) for name, data in fused.clear.items()},
        "filters_with_faults": {name: facts(data) for name, data in fused.faulty.items()},
    }
