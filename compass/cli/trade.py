"""``compass trade``: a study over many candidates, resumable, on a cluster if asked."""

from pathlib import Path

import click

from compass.cli.main import CLAIM_FAILS
from compass.cli.shared import announce_compilation, emit_json, json_option, print_table, say

_FILE = click.Path(path_type=Path)


@click.command()
@click.argument("study", type=_FILE)
@click.option(
    "-o",
    "--output",
    type=_FILE,
    help="Folder of the store; by default trades/NAME-OF-THE-FILE.",
)
@click.option("--workers", type=int, help="Processes on this machine; by default one a core.")
@click.option("--scheduler", help="Address of a Dask scheduler, such as tcp://host:8786.")
@click.option("--tls-ca", type=_FILE, help="Certificate of the cluster's authority (PEM).")
@click.option("--tls-cert", type=_FILE, help="Own certificate (PEM).")
@click.option("--tls-key", type=_FILE, help="Own key (PEM).")
@json_option
def command(
    study: Path,
    output: Path | None,
    workers: int | None,
    scheduler: str | None,
    tls_ca: Path | None,
    tls_cert: Path | None,
    tls_key: Path | None,
    as_json: bool,
) -> None:
    """Judge every candidate of a STUDY: an exact screen first, then maps, then entries.

    Every finished batch is stored at once; the same command resumes a run that was killed.
    Exit status 1 if no candidate meets every constraint and has a value for every objective, or
    workers died of some.
    """
    announce_compilation()
    import logging
    import os
    from contextlib import suppress

    from tqdm import tqdm

    from compass.errors import ArgumentError
    from compass.inputs.merit import MERITS
    from compass.inputs.study import read_study
    from compass.saving import check_writable
    from compass.study.candidates import check_space
    from compass.study.cluster import Cluster, Tls
    from compass.study.judge import check_lander
    from compass.study.results import first_front, read_results, write_results
    from compass.study.sampling import sampled_over, sampling_of
    from compass.study.store import Store
    from compass.study.trade import run_trade
    from compass.study.workers import Processes, Workers

    if scheduler is not None and workers is not None:
        raise ArgumentError("--workers: not beside --scheduler, whose cluster has its own")
    if workers is not None and not 1 <= workers <= 1024:
        raise ArgumentError(f"--workers = {workers}: allowed 1 to 1024")
    files = [tls_ca, tls_cert, tls_key]
    tls = None
    if any(files):
        if tls_ca is None or tls_cert is None or tls_key is None or scheduler is None:
            raise ArgumentError(
                "--tls-ca, --tls-cert, --tls-key: all three go together, beside --scheduler"
            )
        tls = Tls(tls_ca, tls_cert, tls_key)
    chosen = read_study(study)
    check_space(chosen)
    if chosen.entry is not None:
        check_lander(chosen.entry.scenario, chosen.entry.samples, chosen.seed)
    folder = output or Path("trades") / study.stem

    def hire() -> Workers:
        if scheduler is not None:
            with suppress(ImportError):  # as the cluster says
                import distributed  # noqa: F401  # which sets its loggers' levels itself
            for name in ("distributed", "distributed.client", "tornado.application"):
                logging.getLogger(name).setLevel(logging.CRITICAL)  # what matters is said here
            return Cluster(chosen, scheduler, tls)
        count = workers or os.cpu_count() or 1
        return Processes(chosen, count)  # one too: a candidate may kill whoever looks at it

    def bars(title: str, total: int, already: int) -> tqdm:
        return tqdm(desc=title, total=total, initial=already, disable=None, smoothing=0.05)

    with Store(folder, chosen) as store:
        if store.damaged:
            say(
                f"{store.path}: {len(store.damaged)} damaged line(s) ignored ({store.damaged[0]}); "
                "candidates that no other line has are computed again"
            )
        check_writable(folder / "trade.nc")
        team = hire()
        try:
            summary = run_trade(chosen, store, team, bars)
        finally:
            team.close()
        results = read_results(chosen, folder)
        write_results(results, folder / "trade.nc")
    feasible = int(results.feasible.sum())
    rows = first_front(chosen, results)
    if as_json:
        emit_json(
            {
                "study": chosen.name,
                "store": str(folder),
                "candidates": summary.candidates,
                "reached": summary.reached,
                "computed": summary.computed,
                "failed": summary.failed,
                "unfinished": summary.unfinished,
                "lethal": summary.lethal,
                "seconds": summary.seconds,
                "feasible": feasible,
                "front": rows,
                "sampled_over": {
                    name: how for name in MERITS if (how := sampling_of(chosen, name))
                },
            }
        )
    else:
        click.echo(
            f"{chosen.name}: {summary.candidates} candidates, {feasible} meet every constraint, "
            f"{len(rows)} on the Pareto front"
        )
        print_table(
            "Stages",
            [
                [
                    stage,
                    summary.reached[stage],
                    summary.computed[stage],
                    summary.failed[stage],
                    round(summary.seconds.get(stage, 0.0), 2),
                ]
                for stage in summary.reached
            ],
            ["stage", "candidates", "computed now", "raised", "work s"],
        )
        if rows:
            print_table(
                "Pareto front" + (", first 25" if len(rows) > 25 else ""),
                [list(row.values()) for row in rows[:25]],
                list(rows[0]),
            )
            if how := sampled_over(chosen, list(rows[0])):
                click.echo(f"\nsampled: {how}")
    if summary.unfinished:
        more = ["..."] if summary.unfinished > len(summary.lethal) else []
        say(
            f"{summary.unfinished} candidate(s) left out, whose workers died or had too little "
            "memory; the same command tries them again:\n  " + "\n  ".join(summary.lethal + more)
        )
    errors = [text for text in results.error.values if text]
    if errors:
        say(f"{len(errors)} candidate(s) raised an error and go no further; the first: {errors[0]}")
    if feasible and not rows:
        of_them = results.isel(candidate=results.feasible.values)
        lacking = [o.figure for o in chosen.objectives if of_them[o.figure].isnull().all()]
        say(
            "no candidate that meets every constraint has a value of "
            f"{' or of '.join(lacking) or 'every objective'}; choose another objective"
        )
    if not rows or summary.unfinished:
        raise click.exceptions.Exit(CLAIM_FAILS)
