"""``compass judge``: candidate constellations ranked by landing-navigation quality."""

from collections.abc import Callable, Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from compass.cli.shared import (
    announce_compilation,
    command_line,
    emit_json,
    json_option,
    print_table,
    say,
)

if TYPE_CHECKING:
    from compass.design import Design
    from compass.inputs.scenario import Scenario


@click.command()
@click.argument("designs", type=click.Path(path_type=Path), nargs=-1, required=True)
@click.option(
    "-s",
    "--scenario",
    "scenario_path",
    type=click.Path(path_type=Path),
    required=True,
    help="Scenario file of the lander.",
)
@click.option("--samples", type=int, default=1024, show_default=True, help="Entries to judge on.")
@click.option("--seed", type=int, default=0, show_default=True, help="Of sites, times and noise.")
@click.option("--goal-m", type=float, default=10.0, show_default=True, help="Position wanted, m.")
@click.option(
    "--density-sigma", type=float, default=0.0, help="Unknown density, relative; known if left out."
)
@click.option(
    "--lift-sigma", type=float, default=0.0, help="Unknown L/D, relative; known if left out."
)
@click.option("--finalists", type=int, default=3, show_default=True, help="Run the filter on them.")
@click.option("--runs", type=int, default=512, show_default=True, help="Filter runs of each.")
@click.option(
    "--rival",
    type=click.Path(path_type=Path),
    help="Find the best Walker delta of the first design's size, and write it there.",
)
@click.option(
    "--rival-radius-km", type=float, help="Its orbits' radius; the first design's if left out."
)
@click.option(
    "-o",
    "--report",
    "folder",
    type=click.Path(path_type=Path),
    help="Folder for an HTML page with maps and distributions; none is made if left out.",
)
@json_option
def command(
    designs: tuple[Path, ...],
    scenario_path: Path,
    samples: int,
    seed: int,
    goal_m: float,
    density_sigma: float,
    lift_sigma: float,
    finalists: int,
    runs: int,
    rival: Path | None,
    rival_radius_km: float | None,
    folder: Path | None,
    as_json: bool,
) -> None:
    """Judge constellations as beacons of a lander: anywhere, along any azimuth, at any time.

    The lander of the scenario is flown to parachute deployment (its trigger of that name, or the
    end of the scenario) at sites over the whole globe, at moments over the repeat period. Ranked
    by the 95th percentile of the Cramer-Rao bound of position there, blackout taken into account.
    """
    announce_compilation()
    import os

    from tqdm import tqdm

    from compass.errors import ArgumentError, DesignError
    from compass.inputs import read_design
    from compass.inputs.scenario import read_scenario
    from compass.pages.page import check_page_folder
    from compass.saving import check_writable, replacing
    from compass.study.judge import campaign_of
    from compass.study.ranking import check_ranking, rank_designs
    from compass.study.rival import best_rival, rival_toml

    threads = os.cpu_count() or 1

    def progress(work: Iterable[Any], total: int, desc: str) -> Iterable[Any]:
        return tqdm(work, total=total, desc=desc, disable=None)

    if folder is not None:
        check_page_folder(folder)
    faults: list[str] = []

    def read(reader: Callable[[Path], Any], path: Path) -> Any:
        try:
            return reader(path)
        except DesignError as error:  # said with those of the other files
            faults.extend(error.faults)

    scenario = read(read_scenario, scenario_path)
    candidates = [read(read_design, path) for path in designs]
    if faults:
        raise DesignError(list(dict.fromkeys(faults)))
    check_ranking(goal_m, finalists, runs)
    unknown: dict[str, Any] = {"density_sigma": density_sigma, "lift_sigma": lift_sigma}
    if rival_radius_km is not None and rival is None:
        raise ArgumentError("rival_radius_km: says where --rival is to look; give --rival too")
    surface = candidates[0].figure.equatorial_radius / 1e3
    if rival_radius_km is not None and not surface < rival_radius_km <= 1e7:
        raise ArgumentError(
            f"rival_radius_km = {rival_radius_km:g}: allowed above the surface ({surface:g} km) "
            "to 1e7 km"
        )
    if rival is not None:
        check_writable(rival, [scenario_path, *designs])
        found = best_rival(
            candidates[0],
            scenario,
            campaign_of(scenario, samples, seed, **unknown),
            radius=None if rival_radius_km is None else rival_radius_km * 1e3,
            threads=threads,
            progress=progress,
        )
        with replacing(rival) as temporary:
            temporary.write_text(rival_toml(found, candidates[0], command_line()), encoding="utf-8")
        say(f"wrote {rival}")
        candidates.append(read_design(rival))
    result = rank_designs(
        candidates,
        scenario,
        samples=samples,
        seed=seed,
        goal=goal_m,
        finalists=finalists,
        runs=runs,
        threads=threads,
        progress=progress,
        **unknown,
    )
    if folder is not None:
        _write_report(folder, result, candidates, scenario, threads)
    if as_json:
        emit_json(result)
    else:
        _print(result)


def _write_report(
    folder: Path,
    ranking: dict[str, Any],
    designs: "list[Design]",
    scenario: "Scenario",
    threads: int,
) -> None:
    """Make the page of a ranking."""
    from compass.pages.judge import judge_report
    from compass.pages.page import write_page

    page, sections = judge_report(ranking, designs, scenario, command_line(), threads=threads)
    say(f"report: {write_page(folder, page, sections)}")


def _print(r: dict[str, Any]) -> None:
    """Print the tables and one sentence a design."""
    from compass.pages.judge import estimate

    rows = r["designs"]
    unknown = [
        f"{name} unknown by {100 * sigma:g} %"
        for name, sigma in (("density", r["density_sigma"]), ("L/D", r["lift_sigma"]))
        if sigma
    ]
    print_table(
        f"{r['scenario']}: position and velocity at {r['deployment']}, {r['samples']} entries"
        + "".join(f", {text}" for text in unknown),
        [
            [
                d["rank"],
                d["design"],
                d["satellites"],
                f"{d['in_view']['min']} / {d['in_view']['median']:g}",
                *(f"{d['crlb_position_m'][key]:.2f}" for key in ("p50", "p95")),
                f"{d['worst_found']['value']:.2f}",
                f"{d['crlb_velocity_m_s']['p95']:.4f}",
                f"{d['after_loss']['crlb_position_m']['p95']:.2f}" if "after_loss" in d else "",
                f"{d['after_loss']['worst_found']['value']:.2f}" if "after_loss" in d else "",
                f"{100 * d['unobservable_share']:.3g}",
                "" if d["nees"] is None else f"{d['ekf_position_m']['p95']:.2f}",
                "" if d["nees"] is None else f"{d['rms_over_bound']:.3f}",
                ""
                if d["nees"] is None
                else f"inconsistent, errors {d['errors_over_claim']:.3g} times its claim"
                if not d["believed"]
                else f"{d['nees']:.2f} in {{low:.2f}} to {{high:.2f}}".format(**d["nees_interval"]),
            ]
            for d in rows
        ],
        [
            "rank", "design", "sats", "in view", "p50 m", "p95 m", "worst m", "p95 m/s",
            "p95 lost", "worst lost", "blind %", "EKF p95 m", "rms/bound", "NEES",
        ],
    )  # fmt: skip
    click.echo(
        "\np50, p95: Cramer-Rao sigma of the position in space over the entries; worst: that a "
        "search\nfinds. in view: fewest and median. lost: after the loss of the one satellite that "
        "matters most.\nblind: entries whose measurements alone do not determine the state. EKF "
        "p95: of the filter's\nerrors, which scatter about their sigma; rms/bound: their root mean "
        "square over that of the bound.\nNEES: 6 if the filter is consistent (which in 95 of 100 "
        "cases puts it in the interval)."
        + (" The filter takes density and L/D as known." if unknown else "")
    )
    print_table(
        "Users on the surface",
        [
            [
                d["design"],
                f"{d['surface']['fold']['wanted']}-fold {d['surface']['fold']['outcome']}",
                "none"
                if d["surface"]["mask_margin_deg"] is None
                else f"{d['surface']['mask_margin_deg']:.3f}",
                *(
                    estimate(d["surface"]["gdop"][key], d["surface"]["gdop_error"][key])
                    for key in ("p50", "p95")
                ),
                estimate(100 * d["surface"]["gdop_share"], 100 * d["surface"]["gdop_share_error"]),
            ]
            for d in rows
        ],
        ["design", "coverage", "highest mask deg", "GDOP p50", "GDOP p95", "GDOP <= 6, %"],
    )
    click.echo(f"\nWithin {r['goal_m']:g} m at deployment, anywhere and at any time?")
    for d in rows:
        click.echo(f"  {d['design']}: {d['answer']}")
