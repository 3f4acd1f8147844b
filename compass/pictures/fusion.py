"""Pictures of fused entry navigation: errors and claims over time, weights, plasma."""

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes

from compass.document.blocks import Picture
from compass.entry.radio import BROWNOUT_DENSITY, PER_CM3, attenuation, critical_density
from compass.pictures.style import CYCLE, FAINT, INK, MARS, SKY, look, new_figure, picture
from compass.study.fusion import SETTLING, TITLES, FusionRuns

if TYPE_CHECKING:
    import xarray as xr


def fusion_pictures(fused: FusionRuns) -> tuple[Picture, ...]:
    """All pictures of a plan."""
    shown = next((n for n in ("dcifaif", "intermittent") if _holds(fused, n)), None)
    shown = shown or next(iter(fused.single))
    pictures = [
        _rmse_picture(fused),
        _error_picture(fused.single[shown], shown, ""),
        _nees_picture(fused),
    ]
    if fused.faulty:
        pictures.append(_error_picture(fused.single_faulty[shown], shown, " with the fault"))
    weighted = {
        name: data for name, data in fused.single.items() if data.weight.std("beacon").max() > 1e-6
    }
    if weighted:
        pictures.append(_weight_picture(weighted))
    if fused.plan.electrons is not None:
        pictures.append(_plasma_picture(fused))
    return tuple(pictures)


def _holds(fused: FusionRuns, name: str) -> bool:
    """Whether a filter was flown and its first run did not diverge."""
    return name in fused.single and not fused.single[name].attrs["divergence"]


def _finish(axes: Axes, ylabel: str, xlabel: str = "time after entry, s") -> None:
    axes.set_xlabel(xlabel)
    axes.set_ylabel(ylabel)
    axes.grid(True)


def _colours(names: "list[str]") -> dict[str, str]:
    return {name: CYCLE[k % len(CYCLE)] for k, name in enumerate(names)}


def _rmse_picture(fused: FusionRuns) -> Picture:
    sets = [(TITLES["clear"] if fused.faulty else "", fused.clear)]
    if fused.faulty:
        sets.append((TITLES["faulty"], fused.faulty))
    figure = new_figure(6.4, 4.0)
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
    figure = new_figure(6.4, 5.6)
    with look():
        panels = figure.subplots(2, 3).ravel()
        for j, axes in enumerate(panels):
            bound = 3 * data.sigma[:, j].values
            axes.fill_between(data.time, -bound, bound, color=SKY, alpha=0.18, lw=0)
            axes.plot(data.time, bound, color=SKY, lw=0.7)
            axes.plot(data.time, -bound, color=SKY, lw=0.7)
            axes.plot(data.time, data.error[:, j], color=MARS, lw=1.0)
            settled = np.nanmax(bound[bound.size // SETTLING :], initial=0.0)
            inside = np.abs(data.error[:, j].values[bound.size // SETTLING :])
            limit = 1.6 * max(settled, float(np.nanmax(inside, initial=0.0)))
            if limit > 0:
                axes.set_ylim(-limit, limit)
            axes.set_title(str(data.state.values[j]))
            _finish(axes, f"error, {data.unit.values[j]}")
    return picture(
        figure,
        f"fusion-errors{'-fault' if how else ''}",
        f"Errors of one run of {name}{how}",
        "Error (red) and what the filter claims (blue, 3 sigma). The scale is that of the settled "
        "filter; the first seconds run out of it.",
    )


def _nees_picture(fused: FusionRuns) -> Picture:
    figure = new_figure(5.8, 3.8)
    with look():
        axes = figure.subplots()
        for name, colour in _colours(list(fused.clear)).items():
            data = fused.clear[name]
            if np.isfinite(data.nees).any():
                dashed = "--" if name == "federated" else "-"
                axes.semilogy(data.time, data.nees, dashed, color=colour, label=name)
        first = next(iter(fused.clear.values()))
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
    figure = new_figure(6.4, 2.4 * len(weighted) + 0.6)
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


def _plasma_picture(fused: FusionRuns) -> Picture:
    plan, case = fused.plan, fused.plan.case
    assert plan.electrons is not None
    n = case.electrons(plan.electrons)
    beta = case.arrival
    assert beta is not None
    figure = new_figure(6.4, 5.4)
    with look():
        above, below = figure.subplots(2, 1, sharex=True)
        above.semilogy(case.times, n / PER_CM3, color=INK)
        for level, colour, name in (
            (BROWNOUT_DENSITY.value, SKY, "brownout"),
            (critical_density(), MARS, "blackout"),
        ):
            above.axhline(level / PER_CM3, color=colour, lw=1.0, ls="--", label=name)
        above.legend(loc="upper right", fontsize=8)
        _finish(above, "electrons per cm³", "")
        twin = above.twinx()
        twin.plot(case.times, attenuation(n), color=MARS, lw=0.8, alpha=0.6)
        twin.set_ylabel("attenuation, dB/m", color=MARS)
        below.plot(case.times, beta[:, 0], color=INK)
        came = next(iter(fused.single.values())).arrived[1:, 3:].values
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
