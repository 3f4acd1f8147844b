"""The report of fused entry navigation: errors, claims, weights, faults, plasma."""

from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes

from compass.entry.consistency import error_ellipse
from compass.entry.faults import Fault
from compass.entry.radio import BROWNOUT_DENSITY, PER_CM3, attenuation, critical_density
from compass.report.section import Picture, Section, Table, picture
from compass.report.style import CYCLE, FAINT, INK, MARS, SKY, look, new_figure
from compass.study.fusion import FusionRuns

if TYPE_CHECKING:
    import xarray as xr

#: States shown in pictures: name, factor to the unit shown, unit.
SHOWN = (
    ("radius", 1.0, "m"),
    ("longitude", 180 / np.pi, "deg"),
    ("latitude", 180 / np.pi, "deg"),
    ("speed", 1.0, "m/s"),
    ("flight-path angle", 180 / np.pi, "deg"),
    ("azimuth", 180 / np.pi, "deg"),
)
#: Averages leave out the first sixth of the entry, while the filters settle.
SETTLING = 6
TITLES = {"clear": "without the fault", "faulty": "with the fault"}


def fusion_section(found: FusionRuns) -> Section:
    """Text, pictures and tables of one plan."""
    return Section(
        f"Fusion: {found.plan.case.name}",
        fusion_words(found),
        fusion_pictures(found),
        fusion_tables(found),
    )


def fusion_words(found: FusionRuns) -> tuple[str, ...]:
    """Say what is to be known before the numbers, and what went wrong on the way."""
    case = found.plan.case
    words = list(case.visibility_report())
    if words and found.plan.see_through:
        words.append("as in the source, ranges are let through the planet all the same")
    said = [". ".join(word[0].upper() + word[1:] for word in words) + "."] if words else []
    if case.arrival is not None:
        beta = case.arrival[:, 0]
        partial = (beta < 1) & (beta > 1.0001 * beta.min())
        dark = beta <= 1.0001 * beta.min()
        said.append(
            f"The plasma dims the ranges for {case.step * partial.sum():g} s (about "
            f"{beta[partial].sum():.1f} of them get through) and stops them for "
            f"{case.step * dark.sum():g} s."
        )
    if found.faulty:
        said.append("The fault: " + "; ".join(_fault_words(f) for f in found.plan.faults) + ".")
    for how, sets in (("", found.clear), (" with the fault", found.faulty)):
        for name, data in sets.items():
            if data.attrs["diverged"]:
                said.append(
                    f"{data.attrs['diverged']} of {data.attrs['runs']} runs of {name}{how} "
                    "diverged and are left out of its statistics; the first: "
                    f"{data.attrs['divergences'][0]}."
                )
    return tuple(said)


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


def fusion_tables(found: FusionRuns) -> tuple[Table, ...]:
    """Errors and consistency of every filter, without and with faults."""
    tables = []
    for key, runs in (("clear", found.clear), ("faulty", found.faulty)):
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
                    100 * float(data.capture[1:].mean("time").min()),
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
                    if found.faulty
                    else f"Filters, {count} runs",
                    (
                        "filter",
                        "position RMSE, m",
                        "at the end, m",
                        "worst state within 3 sigma, %",
                        "NEES",
                        "95 % bounds",
                        "verdict",
                        "diverged",
                    ),
                    tuple(rows),
                )
            )
    tables.append(_miss_table(found))
    return tuple(tables)


def _miss_table(found: FusionRuns) -> Table:
    rows = []
    for name, data in found.clear.items():
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


def fusion_facts(found: FusionRuns) -> dict[str, Any]:
    """Results as plain values for JSON."""
    case = found.plan.case

    def facts(data: "xr.Dataset") -> dict[str, Any]:
        return {
            "position_rmse_m": _settled(data, "position_rmse"),
            "final_position_rmse_m": float(data.position_rmse[-1]),
            "nees": _settled(data, "nees"),
            "nees_95": [data.attrs["nees_low"], data.attrs["nees_high"]],
            "within_3_sigma": dict(
                zip(data.state.values.tolist(), data.capture[1:].mean("time").values, strict=True)
            ),
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
        "filters": {name: facts(data) for name, data in found.clear.items()},
        "filters_with_faults": {name: facts(data) for name, data in found.faulty.items()},
    }


def fusion_pictures(found: FusionRuns) -> tuple[Picture, ...]:
    """All pictures of a plan."""
    shown = next((n for n in ("dcifaif", "intermittent") if _holds(found, n)), None)
    shown = shown or next(iter(found.single))
    pictures = [
        _rmse_picture(found),
        _error_picture(found.single[shown], shown, ""),
        _nees_picture(found),
    ]
    if found.faulty:
        pictures.append(_error_picture(found.single_faulty[shown], shown, " with the fault"))
    weighted = {
        name: data for name, data in found.single.items() if data.weight.std("beacon").max() > 1e-6
    }
    if weighted:
        pictures.append(_weight_picture(weighted))
    if found.plan.electrons is not None:
        pictures.append(_plasma_picture(found))
    return tuple(pictures)


def _holds(found: FusionRuns, name: str) -> bool:
    """Whether a filter was flown and its first run did not diverge."""
    return name in found.single and not found.single[name].attrs["divergence"]


def _finish(axes: Axes, ylabel: str, xlabel: str = "time after entry, s") -> None:
    axes.set_xlabel(xlabel)
    axes.set_ylabel(ylabel)
    axes.grid(True)


def _colours(names: "list[str]") -> dict[str, str]:
    return {name: CYCLE[k % len(CYCLE)] for k, name in enumerate(names)}


def _rmse_picture(found: FusionRuns) -> Picture:
    sets = [(TITLES["clear"] if found.faulty else "", found.clear)]
    if found.faulty:
        sets.append((TITLES["faulty"], found.faulty))
    figure = new_figure(9.0, 4.0)
    with look():
        panels = figure.subplots(1, len(sets), sharey=True, squeeze=False)[0]
        for axes, (title, runs) in zip(panels, sets, strict=True):
            for name, colour in _colours(list(runs)).items():
                if np.isfinite(runs[name].position_rmse).any():
                    dashed = "--" if name == "federated" else "-"
                    axes.semilogy(
                        runs[name].time, runs[name].position_rmse, dashed, color=colour, label=name
                    )
            axes.set_title(title)
            _finish(axes, "position RMSE, m" if axes is panels[0] else "")
        figure.legend(*panels[0].get_legend_handles_labels(), loc="outside right upper", fontsize=8)
    return picture(
        figure,
        "fusion-rmse",
        "Position error of the filters",
        "Root mean square of the position error over the runs, logarithmic. Filters whose runs "
        "all diverged are missing; federated is dashed, for it lies on the EKF's line.",
    )


def _error_picture(data: "xr.Dataset", name: str, how: str) -> Picture:
    figure = new_figure(9.0, 5.6)
    with look():
        panels = figure.subplots(2, 3).ravel()
        for j, (axes, (state, factor, unit)) in enumerate(zip(panels, SHOWN, strict=True)):
            bound = 3 * factor * data.sigma[:, j].values
            axes.fill_between(data.time, -bound, bound, color=SKY, alpha=0.18, lw=0)
            axes.plot(data.time, bound, color=SKY, lw=0.7)
            axes.plot(data.time, -bound, color=SKY, lw=0.7)
            axes.plot(data.time, factor * data.error[:, j], color=MARS, lw=1.0)
            settled = np.nanmax(bound[bound.size // SETTLING :], initial=0.0)
            inside = np.abs(factor * data.error[:, j].values[bound.size // SETTLING :])
            limit = 1.6 * max(settled, float(np.nanmax(inside, initial=0.0)))
            if limit > 0:
                axes.set_ylim(-limit, limit)
            axes.set_title(state)
            _finish(axes, f"error, {unit}")
    return picture(
        figure,
        f"fusion-errors{'-fault' if how else ''}",
        f"Errors of one run of {name}{how}",
        "Error (red) and what the filter claims (blue, 3 sigma). The scale is that of the settled "
        "filter; the first seconds run out of it.",
    )


def _nees_picture(found: FusionRuns) -> Picture:
    figure = new_figure(8.0, 4.0)
    with look():
        axes = figure.subplots()
        for name, colour in _colours(list(found.clear)).items():
            data = found.clear[name]
            if np.isfinite(data.nees).any():
                dashed = "--" if name == "federated" else "-"
                axes.semilogy(data.time, data.nees, dashed, color=colour, label=name)
        first = next(iter(found.clear.values()))
        axes.axhspan(
            first.attrs["nees_low"], first.attrs["nees_high"], color=FAINT, alpha=0.5, lw=0
        )
        _finish(axes, "mean NEES")
        figure.legend(*axes.get_legend_handles_labels(), loc="outside right upper", fontsize=8)
    return picture(
        figure,
        "fusion-nees",
        "Consistency of the filters",
        "Mean normalised estimation error squared; a consistent filter stays in the grey band "
        "(95 %). Above it a filter is overconfident, below it cautious.",
    )


def _weight_picture(weighted: "dict[str, xr.Dataset]") -> Picture:
    figure = new_figure(9.0, 2.4 * len(weighted) + 0.6)
    with look():
        panels = figure.subplots(len(weighted), 1, sharex=True, squeeze=False)[:, 0]
        for axes, (name, data) in zip(panels, weighted.items(), strict=True):
            colours = [CYCLE[k % len(CYCLE)] for k in range(data.sizes["beacon"])]
            axes.stackplot(
                data.time[1:],
                data.weight[1:].values.T,
                colors=colours,
                labels=data.beacon.values,
                alpha=0.85,
            )
            axes.set_ylim(0, 1)
            axes.set_xlim(float(data.time[1]), float(data.time[-1]))
            axes.set_title(name)
            _finish(axes, "weight", "time after entry, s" if axes is panels[-1] else "")
        figure.legend(*panels[0].get_legend_handles_labels(), loc="outside right upper", fontsize=8)
    return picture(
        figure,
        "fusion-weights",
        "Fusion weights over time",
        "Share of each subsystem (IMU and one beacon) in the fused estimate of one run.",
    )


def _plasma_picture(found: FusionRuns) -> Picture:
    plan, case = found.plan, found.plan.case
    assert plan.electrons is not None
    n = case.electrons(plan.electrons)
    beta = case.arrival
    assert beta is not None
    figure = new_figure(9.0, 5.4)
    with look():
        above, below = figure.subplots(2, 1, sharex=True)
        above.semilogy(case.times, n / PER_CM3, color=INK)
        for level, colour, name in (
            (BROWNOUT_DENSITY.value, SKY, "brownout"),
            (critical_density(), MARS, "blackout"),
        ):
            above.axhline(level / PER_CM3, color=colour, lw=1.0, ls="--", label=name)
        above.legend(loc="upper right", fontsize=8)
        _finish(above, "electrons per cm$^3$", "")
        twin = above.twinx()
        twin.plot(case.times, attenuation(n), color=MARS, lw=0.8, alpha=0.6)
        twin.set_ylabel("attenuation, dB/m", color=MARS)
        below.plot(case.times, beta[:, 0], color=INK)
        came = next(iter(found.single.values())).arrived[1:, 3:].values
        for k, name in enumerate(case.beacons.names):
            hits = case.times[1:][came[:, k]]
            level, colour = -0.08 - 0.07 * k, CYCLE[k % len(CYCLE)]
            below.plot(hits, np.full(hits.size, level), "|", color=colour, ms=4)
            below.annotate(
                name,
                (case.times[-1], level),
                (4, 0),
                textcoords="offset points",
                fontsize=7,
                color=colour,
                va="center",
                annotation_clip=False,
            )
        below.set_yticks(np.linspace(0, 1, 6))
        below.set_ylim(-0.12 - 0.07 * case.beacons.size, 1.05)
        _finish(below, "arrival probability")
    return picture(
        figure,
        "fusion-plasma",
        "Plasma and arrivals",
        "Electron density with the densities of brownout and blackout at 401 MHz, attenuation, and "
        "the probability that a range arrives; ticks: the ranges that arrived in one run.",
    )
