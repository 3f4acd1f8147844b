"""Flying the fusion part of a scenario: every filter, without and with its faults."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

from compass.entry.fused_runs import monte_carlo
from compass.inputs.fusion import FusionPlan

if TYPE_CHECKING:
    from collections.abc import Iterator

    import xarray as xr

#: Averages leave out the first sixth of the entry, while the filters settle.
SETTLING = 6

#: How runs without and with a plan's faults are spoken of.
TITLES = {"clear": "without the fault", "faulty": "with the fault"}


@dataclass(frozen=True)
class FusionRuns:
    """What became of a plan.

    Attributes
    ----------
    plan
        What was flown.
    clear, faulty
        Statistics by filter, without and with the plan's faults; `faulty` is empty if it has none.
    single, single_faulty
        The first run of each in full.
    """

    plan: FusionPlan
    clear: "dict[str, xr.Dataset]"
    faulty: "dict[str, xr.Dataset]"
    single: "dict[str, xr.Dataset]"
    single_faulty: "dict[str, xr.Dataset]"

    def groups(self) -> "Iterator[tuple[str, xr.Dataset]]":
        """Name and dataset of every result, for the groups of a netCDF file."""
        for kind, sets in (
            ("clear", self.clear),
            ("faulty", self.faulty),
            ("single", self.single),
            ("single_faulty", self.single_faulty),
        ):
            for name, data in sets.items():
                said = {key: "\n".join(v) for key, v in data.attrs.items() if isinstance(v, list)}
                yield f"fusion/{kind}/{name}", data.assign_attrs(said)


def run_fusion(plan: FusionPlan, runs: int | None = None, progress: bool = True) -> FusionRuns:
    """Fly a plan's Monte Carlo; `runs` instead of the plan's own number."""
    count = plan.runs if runs is None else runs
    fused = FusionRuns(plan, {}, {}, {}, {})
    for settings in plan.filters:
        name = settings.algorithm
        for faults, many, one in (
            ((), fused.clear, fused.single),
            (plan.faults, fused.faulty, fused.single_faulty),
        ):
            if faults or many is fused.clear:
                many[name], one[name] = monte_carlo(
                    plan.case,
                    settings,
                    count,
                    plan.seed,
                    faults=faults,
                    see_through=plan.see_through,
                    progress=progress,
                )
    return fused
