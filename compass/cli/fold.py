"""``compass fold``: continuous k-fold coverage, proven or refuted with a witness."""

from pathlib import Path
from typing import Any

import click

from compass.cli.main import CLAIM_FAILS
from compass.cli.shared import design_argument, emit_json, json_option, print_table, say


@click.command()
@design_argument
@click.option("--fold", "wanted", type=int, help="Satellites in view at once; else the design's.")
@click.option("--mask-deg", type=float, help="Elevation mask, degrees; else the design's.")
@click.option("--losses", type=int, default=0, help="Also what is left after so many failures.")
@click.option(
    "--region",
    "where",
    help="lat:MIN:MAX or polygon:LAT,LON;LAT,LON;..., degrees; else everywhere.",
)
@click.option("--duration-h", type=float, help="Hours from the epoch to look at, not all time.")
@json_option
def command(
    design: Path,
    wanted: int | None,
    mask_deg: float | None,
    losses: int,
    where: str | None,
    duration_h: float | None,
    as_json: bool,
) -> None:
    """Prove continuous k-fold coverage, or refute it with a witness; no grid, no time steps.

    Exit status 0 proven, 1 refuted or undecided, 2 bad input.
    """
    from math import degrees, isfinite, radians

    from tqdm import tqdm

    from compass.coverage.certificate import Certificate, fold_range, prove_fold
    from compass.coverage.margin import (
        after_losses,
        covering_radius,
        highest_mask,
        lowest_altitude,
    )
    from compass.coverage.region import GLOBE, read_region
    from compass.coverage.share import mean_fold_shares
    from compass.coverage.symmetry import one_circle, shortest_span, unlike_subsets
    from compass.errors import ArgumentError
    from compass.inputs import read_design

    read = read_design(design)
    c, sphere = read.constellation, read.figure.equatorial_radius
    fold = read.fold if wanted is None else wanted
    if mask_deg is not None and not 0 <= mask_deg < 90:
        raise ArgumentError(f"mask_deg = {mask_deg:g}: allowed 0 up to below 90 degrees")
    if losses < 0:
        raise ArgumentError(f"losses = {losses}: allowed 0 to {c.size}, the number of satellites")
    high = read.mask.highest if mask_deg is None else radians(mask_deg)
    low = read.mask.lowest if mask_deg is None else high
    region = GLOBE if where is None else read_region(where)
    duration = None if duration_h is None else duration_h * 3600.0
    span = shortest_span(c, region, duration)
    if losses:
        unlike_subsets(c, losses, region)  # refuse too many before any work

    def settle(mask: float) -> Certificate:
        return prove_fold(c, fold, sphere_radius=sphere, mask=mask, region=region, span=span)

    certificate, outcome = settle(high), "undecided"
    if high == low or certificate.outcome == "proven":
        outcome = certificate.outcome
    else:
        say(
            f"mask from {degrees(low):g} to {degrees(high):g} deg by azimuth: not proven with the "
            "highest all around; trying to refute with the lowest"
        )
        lowest = settle(low)
        if lowest.outcome == "refuted":
            certificate, outcome = lowest, "refuted"
    least, greatest = fold_range(c, sphere_radius=sphere, mask=high, region=region, span=span)
    cap = covering_radius(c, fold, span=span).radius if region.is_globe and one_circle(c) else None
    margin = highest_mask(c, fold, sphere_radius=sphere, region=region, span=span)
    altitude = None if cap is None or not isfinite(cap) else lowest_altitude(cap, sphere, high)
    shares = None
    if region.is_globe and one_circle(c):
        shares = mean_fold_shares(c, sphere_radius=sphere, mask=high, span=span)
    witness = certificate.witness if outcome == "refuted" else None
    found: list[list[Any]] = [
        [
            loss.as_dict()
            for loss in after_losses(
                c,
                lost,
                fold,
                sphere_radius=sphere,
                mask=high,
                region=region,
                duration=duration,
                progress=lambda sets: tqdm(sets, disable=None, desc="losses"),
            )
        ]
        for lost in range(1, losses + 1)
    ]
    result = {
        "design": read.name,
        "outcome": outcome,
        "fold": fold,
        "mask_deg": degrees(high),
        "min_fold": least[0] if least[0] == least[1] else None,
        "max_fold": greatest[0] if greatest[0] == greatest[1] else None,
        "cap_radius_min_deg": None if cap is None or not isfinite(cap) else degrees(cap),
        "mask_margin_deg": None if margin is None else degrees(margin),
        "lowest_altitude_km": None if altitude is None else altitude / 1e3,
        "witness": witness.as_dict() if witness else None,
        "intervals": certificate.intervals,
        "unsettled_s": certificate.unsettled if outcome == "undecided" else (),
        "region": region.name,
        "start_s": span.start,
        "stop_s": span.stop,
        "for_all_time": span.for_all_time,
        "reason": span.reason,
        "tolerance_rad": certificate.tolerance,
        "motion": "two-body",
        "fold_share": None if shares is None else shares.share,
        "fold_share_error": None if shares is None else shares.error,
        "min_fold_bounds": least,
        "max_fold_bounds": greatest,
        "after_losses": [
            {"losses": k + 1, "min_fold": sets[0]["min_fold"], "worst": _worst(sets), "sets": sets}
            for k, sets in enumerate(found)
        ],
    }
    if as_json:
        emit_json(result)
    else:
        _print(result)
    if outcome != "proven":
        raise click.exceptions.Exit(CLAIM_FAILS)


def _worst(sets: list[dict[str, Any]]) -> list[list[str]]:
    """Names in one set of each kind that leaves the least fold."""
    least = sets[0]["min_fold_bounds"]
    return [kind["satellites"] for kind in sets if kind["min_fold_bounds"] == least]


def _print(r: dict[str, Any]) -> None:
    """Print the result as a few sentences and tables."""
    when = (
        "for all time" if r["for_all_time"] else f"over {r['stop_s'] / 3600:.6g} h from the epoch"
    )
    claim = f"{r['fold']} or more satellites above {r['mask_deg']:g} deg, {r['region']}, {when}"
    click.echo(f"{r['design']}: {r['outcome'].upper()}: {claim} (two-body motion)")
    click.echo(
        f"  looked at {r['start_s'] / 3600:.6g} to {r['stop_s'] / 3600:.6g} h: {r['reason']};\n"
        f"  {r['intervals']} interval(s), split until no cap strays more than "
        f"{r['tolerance_rad']:g} rad; rounding on the safe side"
    )
    if r["outcome"] == "undecided":
        for start, stop in r["unsettled_s"][:5]:
            click.echo(f"  unsettled: {start:.9g} to {stop:.9g} s")
    if w := r["witness"]:
        names = ", ".join(w["satellites"]) or "none"
        click.echo(
            f"  witness: {w['fold']} in view ({names}) at t = {w['time_s']:.6f} s, latitude "
            f"{w['latitude_deg']:.6f}, longitude {w['longitude_deg']:.6f} deg; the next satellite "
            f"is {w['shortfall_deg']:.3g} deg below the mask"
        )

    def bounds(pair: tuple[int, int]) -> object:
        return pair[0] if pair[0] == pair[1] else f"{pair[0]} to {pair[1]}, not settled"

    def number(value: float | None) -> object:
        return "none" if value is None else round(value, 6)

    print_table(
        "Fold and margins",
        [
            ["least fold", bounds(r["min_fold_bounds"]), ""],
            ["greatest fold", bounds(r["max_fold_bounds"]), ""],
            ["smallest cap radius", number(r["cap_radius_min_deg"]), "deg"],
            ["highest mask", number(r["mask_margin_deg"]), "deg"],
            ["lowest altitude at this mask", number(r["lowest_altitude_km"]), "km"],
        ],
    )
    if r["fold_share"] is not None:
        print_table(
            "Share of area and time by fold",
            [[k, f"{100 * part:.4f} %"] for k, part in enumerate(r["fold_share"]) if part > 0],
        )
        click.echo(
            f"areas exact, integrated over time to {r['fold_share_error']:.1g}; with 4 in view "
            "there are curves on which GDOP is infinite"
        )
    for after in r["after_losses"]:
        rows = [
            [
                " ".join(kind["satellites"]),
                kind["alike"],
                bounds(kind["min_fold_bounds"]),
                number(kind["cap_radius_min_deg"]),
            ]
            for kind in after["sets"]
        ]
        print_table(
            f"After {after['losses']} loss(es), worst first",
            rows[:20],
            ["satellites lost", "sets alike", "least fold", f"cap for {r['fold']}-fold, deg"],
        )
        if len(rows) > 20:
            click.echo(f"... and {len(rows) - 20} more kinds; --json has them all")
