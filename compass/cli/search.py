"""``compass search``: the smallest pattern with continuous k-fold coverage."""

from pathlib import Path

import click

from compass.cli.main import CLAIM_FAILS
from compass.cli.shared import command_line, emit_json, json_option, print_table, say


@click.command()
@click.option("--fold", type=int, required=True, help="Satellites to be in view at once.")
@click.option("--mask-deg", type=float, default=0.0, show_default=True, help="Elevation mask.")
@click.option("--radius-km", type=float, help="Orbit radius from Mars's centre.")
@click.option("--altitude-km", type=float, help="Orbit altitude over the equator.")
@click.option("--orbit", type=click.Choice(["areosynchronous"]), help="An orbit by name.")
@click.option("--max-satellites", type=int, required=True, help="Largest size to try.")
@click.option(
    "--pattern",
    type=click.Choice(["walker-delta", "walker-star", "rosette"]),
    default="walker-delta",
    show_default=True,
    help="Kind of pattern.",
)
@click.option(
    "--figure",
    type=click.Choice(["iau-sphere", "kelly2018-sphere"]),
    default="iau-sphere",
    show_default=True,
    help="Sphere that is to be covered.",
)
@click.option("--finalists", type=int, default=10, show_default=True, help="How many to certify.")
@click.option("-o", "--output", type=click.Path(path_type=Path), help="Write the best as a design.")
@json_option
def command(
    fold: int,
    mask_deg: float,
    radius_km: float | None,
    altitude_km: float | None,
    orbit: str | None,
    max_satellites: int,
    pattern: str,
    figure: str,
    finalists: int,
    output: Path | None,
    as_json: bool,
) -> None:
    """Find the smallest pattern with continuous k-fold coverage of the whole sphere.

    Every pattern of every size, each at its best inclination to 0.01 degree; smallest first,
    then largest mask margin. Exit status 1 if there is none.
    """
    import os
    from math import degrees, radians

    from tqdm import tqdm

    from compass.errors import ArgumentError
    from compass.frames import FIGURES
    from compass.handover.toml import constellation_toml
    from compass.orbits import areosynchronous_radius
    from compass.saving import check_writable, replacing
    from compass.sites import Mask
    from compass.study.search import search

    given = [
        name
        for name, value in (
            ("--radius-km", radius_km),
            ("--altitude-km", altitude_km),
            ("--orbit", orbit),
        )
        if value is not None
    ]
    if len(given) != 1:
        raise ArgumentError(
            f"orbit: needs exactly one of --radius-km, --altitude-km and --orbit; found "
            f"{' and '.join(given) or 'none'}"
        )
    sphere = FIGURES[figure].equatorial_radius
    if radius_km is not None:
        radius = radius_km * 1e3
    elif altitude_km is not None:
        radius = altitude_km * 1e3 + sphere
    else:
        radius = areosynchronous_radius()
    if not radius < 1e10:
        raise ArgumentError(f"orbit radius {radius / 1e3:g} km: allowed below 1e7 km")
    if output is not None:
        check_writable(output)
    found = search(
        fold,
        radians(mask_deg),
        radius=radius,
        sphere_radius=sphere,
        largest=max_satellites,
        kind=pattern,
        finalists=finalists,
        workers=os.cpu_count() or 1,
        progress=lambda work, total: tqdm(work, total=total, disable=None, desc="patterns"),
    )
    rows = [candidate.as_dict() for candidate in found]
    result = {
        "fold": fold,
        "mask_deg": mask_deg,
        "radius_km": radius / 1e3,
        "figure": figure,
        "pattern": pattern,
        "max_satellites": max_satellites,
        "smallest": found[0].constellation.size if found else None,
        "candidates": rows,
    }
    if as_json:
        emit_json(result)
    elif found:
        print_table(
            f"Continuous {fold}-fold coverage above {mask_deg:g} deg at {radius / 1e3:.6g} km: "
            f"{len(found)} patterns of up to {max_satellites} satellites",
            [
                [
                    candidate.constellation.pattern.notation,  # type: ignore[union-attr]
                    row["satellites"],
                    f"{row['inclination_deg']:.2f}",
                    f"{row['cap_radius_min_deg']:.4f}",
                    f"{row['mask_margin_deg']:.4f}",
                    f"{row['closest_approach_deg']:.2f}",
                    "" if row["gdop_p95"] is None else f"{row['gdop_p95']:.2f}",
                    "proven" if row["proven"] else "",
                ]
                for candidate, row in zip(found[:25], rows, strict=False)
            ],
            [
                "pattern",
                "satellites",
                "incl. deg",
                "cap radius deg",
                "highest mask deg",
                "closest deg",
                "GDOP p95",
                "certificate",
            ],
        )
    else:
        say(
            f"no {pattern} of up to {max_satellites} satellites at {radius / 1e3:.6g} km has "
            f"continuous {fold}-fold coverage above {mask_deg:g} deg"
        )
    if not found:
        raise click.exceptions.Exit(CLAIM_FAILS)
    if output is not None:
        best = found[0]
        text = constellation_toml(
            best.constellation,
            FIGURES[figure],
            mask=Mask.constant(radians(mask_deg)),
            fold=fold,
            source=f"Smallest of its kind with continuous {fold}-fold coverage, found by: "
            f"{command_line()}. Highest mask {degrees(best.mask_margin):.4f} deg.",
        )
        with replacing(output) as temporary:
            temporary.write_text(text, encoding="utf-8")
        say(f"wrote {output}")
