"""The report of one design: geometry, coverage, stations, comparison with its source."""

from collections.abc import Callable
from importlib import import_module
from typing import Any

import numpy as np

from compass.api.access import access
from compass.api.fold import FoldResult, fold
from compass.api.map import MapResult
from compass.api.reproduce import comparison_table
from compass.api.show import ShowResult, show
from compass.core.ranking import nearest_rank
from compass.coverage.certified_geometry import CertifiedGeometry
from compass.coverage.site import site_coverage
from compass.design import Design
from compass.document.blocks import Section, Table, arranged
from compass.pages.access import access_section
from compass.pages.coverage import fold_pictures, map_pictures
from compass.pages.fold import fold_section
from compass.pages.orbits import cap_picture, gap_shapes, orbit_picture, track_picture
from compass.pages.page import render
from compass.pictures.maps import map_figure
from compass.pictures.style import picture
from compass.quantities import quantity
from compass.study.certified import certified_figures
from compass.study.mapping import DesignMap, MapOptions, make_map, provenance


def design_report(
    design: Design,
    command: str = "",
    options: MapOptions | None = None,
    *,
    progress: Callable[[str], None] = lambda step: None,
) -> tuple[str, list[Section]]:
    """Make the page (HTML text) and the sections of a design's report.

    Parameters
    ----------
    design
        The design.
    command
        The command line, for provenance.
    options
        How to map.
    progress
        Told the name of each part before it is made.
    """
    progress("coverage map")
    shown = show(design)
    mapped = make_map(design, options, command)
    certified = certified_figures(design, options or MapOptions())
    sections = []
    for name, part in (
        ("constellation", lambda: _constellation(shown)),
        ("geometry", lambda: _geometry(shown)),
        ("coverage pictures", lambda: _coverage(design, mapped, certified)),
        ("continuous fold", lambda: _fold(design)),
        ("stations", lambda: _stations(design, mapped)),
        ("access", lambda: _access(design)),
        ("comparison", lambda: _comparison(design)),
    ):
        progress(name)
        section = part()
        if section is not None:
            sections.append(section)
    page = render(
        design.name,
        " ".join(design.source.split()) or "No source given.",
        sections,
        provenance_rows(design, command, mapped),
        design.text,
    )
    return page, sections


def provenance_rows(design: Design, command: str, mapped: DesignMap) -> list[tuple[str, str]]:
    """What the report was made from, for its last section."""
    attrs = provenance(design, command)
    d = mapped.dataset.attrs
    return [
        ("command", attrs["command_line"] or "made from Python"),
        ("made", attrs["history"].split(" ")[0]),
        ("version", attrs["source"]),
        ("design file", attrs["design_file"]),
        ("SHA-256 of the design", attrs["design_sha256"]),
        ("grid", d["grid"]),
        ("epochs", f"{d['epochs']} in {d['period_s'] / 3600:.4f} h, {d['motion_model']} motion"),
        ("reference figure", design.figure.title),
    ]


def _constellation(shown: ShowResult) -> Section:
    explicit = shown.geometry is None
    tables = (shown.constellation_table(), *(shown.geometry_tables() if explicit else ()))
    pictures = (orbit_picture(shown.design), track_picture(shown.design))
    return arranged("Constellation", (), pictures, tables)


def _geometry(shown: ShowResult) -> Section:
    pictures = (cap_picture(shown.design),)
    if shown.geometry is None:
        return arranged("Caps and gaps", shown.notes(), pictures)
    text = (
        "Published means the source paper's printed formula, kept for comparison; exact means "
        "the geometry of the sphere."
    )
    return arranged("Caps and gaps", (text, *shown.notes()), pictures, shown.geometry_tables())


def _coverage(design: Design, mapped: DesignMap, certified: CertifiedGeometry | None) -> Section:
    data, grid, name = mapped.dataset, mapped.grid, design.figure.name
    shapes = gap_shapes(design)
    first = mapped.view.r[0]
    latitude = np.degrees(np.arctan2(first[:, 2], np.hypot(first[:, 0], first[:, 1])))
    longitude = np.degrees(np.arctan2(first[:, 1], first[:, 0]))
    snapshot = picture(
        map_figure(
            _counts_at_epoch(mapped),
            grid,
            "Satellites in view at the epoch" + (", with the gap polygons" if shapes else ""),
            "satellites",
            figure_name=name,
            scale="counts",
            shapes=shapes,
            satellites=(longitude, latitude),
        ),
        "count-epoch",
        "Satellites in view at the epoch",
        "Stars: satellites at the zenith. White: where no satellite of one plane is in view."
        if shapes
        else "Stars: satellites at the zenith.",
    )
    d = data.attrs
    text = (
        f"{d['epochs']} epochs over {d['period_s'] / 3600:.4f} h on {d['grid']}; numbers are "
        "weighted by area and time. With fewer than four satellites or singular geometry a "
        "dilution of precision is infinite, and counts as such in every percentile."
    )
    made = MapResult(design, mapped, certified)
    return arranged(
        "Coverage",
        (text, *(f"{said[0].upper()}{said[1:]}." for said in made.certain())),
        (snapshot, *map_pictures(data, grid, name), *fold_pictures(data)),
        made.tables(),
    )


def _fold(design: Design) -> Section:
    found = fold(design, motion="two-body")
    assert isinstance(found, FoldResult)
    return fold_section(found)


def _access(design: Design) -> Section | None:
    """Everything that the design asks to be linked; None if it is nothing."""
    wanted = design.access
    if not (design.stations or wanted.moons or wanted.earth or wanted.crosslinks):
        return None
    return access_section(access(design, eclipse=True))


def _counts_at_epoch(mapped: DesignMap) -> Any:
    """Counts of the first epoch: a map of that epoch alone has its count as the smallest."""
    from dataclasses import replace

    from compass.coverage.maps import coverage_map

    view = mapped.view
    first = replace(view, times=view.times[:1], r=view.r[:1], cos_cap=view.cos_cap[:1])
    return coverage_map(first, mapped.grid).count_min.values


def _stations(design: Design, mapped: DesignMap) -> Section | None:
    if not design.stations:
        return None
    rows: list[tuple[object, ...]] = []
    for site in design.stations:
        seen = site_coverage(design.constellation, site, mapped.view.times)
        count = seen["count"]
        rows.append(
            (
                site.name,
                float(np.degrees(site.latitude)),
                float(np.degrees(site.longitude)),
                site.height / 1e3,
                float(np.degrees(site.mask.lowest)),
                int(count.min()),
                float(count.mean()),
                int(count.max()),
                *(_nearest_rank(seen[name].values, 95) for name in ("gdop", "pdop", "hdop")),
                float((seen.pdop <= mapped.dataset.attrs["pdop_threshold"]).mean()),
            )
        )
    header = (
        "station",
        "latitude deg",
        "longitude deg",
        "height km",
        "mask deg",
        "fewest",
        "mean",
        "most",
        *(f"{quantity(name).title} p95" for name in ("gdop", "pdop", "hdop")),
        "availability",
    )
    text = "Each station on its reference figure, at its height and over its own horizon."
    table = Table("Satellites and geometry at the stations", header, tuple(rows))
    return arranged("Stations", (text,), (), (table,))


def _nearest_rank(values: Any, q: int) -> float:
    """Return the smallest value that at least q percent of the values do not exceed."""
    return float(np.sort(values)[nearest_rank(values.size, q)])


def _comparison(design: Design) -> Section | None:
    if design.paper is None:
        return None
    module = import_module(f"compass.papers.{design.paper}")
    text = (
        "The paper's numbers on geometry and coverage beside the computed ones. Reproduced: equal "
        "within what is printed beside it. Erratum: the paper is shown to be wrong, and how. "
        "Differs: neither. Computed: the paper says nothing. Population and "
        f"stations' access: compass reproduce {design.paper}."
    )
    table = comparison_table(module.TITLE, module.coverage_rows())
    return arranged("Published against computed", (text,), (), (table,))
