"""The page of one design: the answer first, then a board's questions in their order.

A further section joins `SECTIONS` in its place: its title and a function from `DesignResults` to
it, which may be None where there is nothing to say.
"""

from collections.abc import Callable, Sequence
from importlib import import_module

from compass.api.access import access
from compass.api.check import check
from compass.api.fold import fold
from compass.api.fold_result import FoldResult
from compass.api.map import result_of
from compass.api.map_areas import area_blocks
from compass.api.map_result import MapResult
from compass.api.outlook import outlook
from compass.api.reproduce import comparison_table
from compass.api.series import series
from compass.api.series_result import SeriesResult
from compass.api.show import show
from compass.bodies import SOLAR_DAY
from compass.design import Design
from compass.document.blocks import (
    Block,
    Details,
    Section,
    Sentence,
    arranged,
)
from compass.frames import SECONDS_PER_DAY
from compass.orbits.symmetry import one_circle
from compass.pages.access import access_section
from compass.pages.advice import answer_section
from compass.pages.aloft import aloft_section, maps_aloft
from compass.pages.answers import subtitle
from compass.pages.coverage import (
    count_picture,
    dilution_pictures,
    fold_pictures,
    one_colour,
    one_count,
)
from compass.pages.deployment import deployment_section
from compass.pages.design_results import DesignResults
from compass.pages.fold import fold_section
from compass.pages.globe.piece import globe
from compass.pages.globe.still import still_picture
from compass.pages.lasting import lasting_section
from compass.pages.metres import metres_section, tracking_section
from compass.pages.neighbours import Neighbour, neighbours
from compass.pages.orbits import cap_picture, orbit_picture, track_picture
from compass.pages.page import render
from compass.quantities import quantity
from compass.sites import Site
from compass.study.certified import certified_areas
from compass.study.mapping import MapOptions, make_map, provenance


def design_report(
    design: Design,
    command: str = "",
    options: MapOptions | None = None,
    places: tuple[Sequence[Site], Sequence[str]] = ((), ()),
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
    places
        Sites and regions of which figures are wanted besides.
    progress
        Told the name of each part before it is made.
    """
    results = look_at(design, command, options or MapOptions(), progress, places)
    progress("patterns beside it")
    beside = _beside(results)
    progress("globe")
    carrying = globe(design, still_picture(design))
    sections = [answer_section(results, [carrying], beside)]
    for name, part in SECTIONS:
        progress(name)
        section = part(results, beside)
        if section is not None:
            sections.append(section)
    page = render(
        design.name,
        subtitle(design),
        sections,
        provenance_rows(results, command),
        design.text,
    )
    return page, sections


def look_at(
    design: Design,
    command: str,
    options: MapOptions,
    progress: Callable[[str], None],
    places: tuple[Sequence[Site], Sequence[str]] = ((), ()),
) -> DesignResults:
    """Ask the commands, each once."""
    progress("coverage map")
    made = make_map(design, options, command)
    promised = design.signal is not None and design.integrity is not None
    mapped = result_of(design, made, options, places, losses=promised)
    stations = certified_areas(design, options, design.stations, ())
    progress("continuous fold")
    lost = 1 if design.constellation.size > 1 else 0
    proven = fold(design, motion="two-body", losses=lost)
    assert isinstance(proven, FoldResult)
    progress("access")
    wanted = design.access
    linked = design.stations or wanted.moons or wanted.earth or wanted.crosslinks
    links = access(design, eclipse=True, duration_sols=_known_sols(design)) if linked else None
    progress("how long it lasts")
    lasts = outlook(design)
    progress("requirements")
    checked = check(design) if design.requirements else None
    progress("errors over time")
    followed = _followed(design, mapped)
    progress("users in orbit and in beams")
    aloft = maps_aloft(design, options, command)
    return DesignResults(
        design, show(design), mapped, proven, links, lasts, checked, followed, stations, aloft
    )


#: Days over which errors at sites are followed at most, and moments of them.
FOLLOWED_DAYS, MOMENTS = 3.0, 433


def _followed(design: Design, mapped: MapResult) -> SeriesResult | None:
    """What stations know of their place over the time that is mapped, where ranges have errors."""
    if design.signal is None or not design.stations:
        return None
    period = float(mapped.dataset.attrs["period_s"]) / SECONDS_PER_DAY
    start = float(mapped.dataset.attrs["start_day"])
    return series(design, days=min(period, FOLLOWED_DAYS), start_day=start, epochs=MOMENTS)


def _known_sols(design: Design) -> float | None:
    """Sols for which an ephemeris is known, if that is less than what the design asks for."""
    table = design.motion.table
    if table is None or table.stop >= design.access_duration:
        return None
    return table.stop / SOLAR_DAY.value


def provenance_rows(results: DesignResults, command: str) -> list[tuple[str, str]]:
    """What the report was made from, for its last section."""
    design, d = results.design, results.mapped.dataset.attrs
    attrs = provenance(design, command)
    return [
        ("command", attrs["command_line"] or "made from Python"),
        ("version", attrs["source"]),
        ("design file", attrs["design_file"]),
        ("SHA-256 of the design", attrs["design_sha256"]),
        ("grid", d["grid"]),
        ("epochs", f"{d['epochs']} in {d['period_s'] / 3600:.4f} h, {d['motion_model']} motion"),
        ("reference figure", design.figure.title),
    ]


def _beside(results: DesignResults) -> list[Neighbour]:
    """Patterns beside the design's own, where it is one."""
    c = results.design.constellation
    if c.pattern is None or not one_circle(c):
        return []
    return neighbours(c, results.fold.fold, results.design.figure.equatorial_radius)


def _requirements(results: DesignResults, _: list[Neighbour]) -> Section | None:
    """What was asked for, one by one: verdict, margin, the tightest place and moment."""
    if results.checked is None:
        return None
    return Section("Requirements", results.checked.blocks())


def _areas(results: DesignResults, _: list[Neighbour]) -> Section | None:
    """What users at the sites and in the regions asked for have."""
    blocks = area_blocks(results.mapped.areas)
    return Section("At sites and in regions", blocks) if blocks else None


def _coverage(results: DesignResults, beside: list[Neighbour]) -> Section:
    """Whether everybody is served, always: proof, margin, and how many are in view where."""
    exact = fold_section(results.fold, beside)
    in_view = results.mapped.tables()[0]
    alike = one_count(results.mapped)
    mapped = () if alike else (count_picture(results.mapped),)
    pictures = (*mapped, *fold_pictures(results.mapped.dataset))
    return arranged(
        "Coverage",
        (*exact.paragraphs, *alike),
        (*exact.pictures, *pictures),
        (*exact.tables, in_view),
    )


def _accuracy(results: DesignResults, _: list[Neighbour]) -> Section:
    """How good the geometry of a fix is."""
    d = results.mapped.dataset.attrs
    text = (
        f"Maps {results.mapped.looked.how}, over {d['period_s'] / 3600:.4f} h; numbers are "
        "weighted by area and time. With fewer than four satellites or singular geometry a "
        "dilution of precision is infinite, and counts as such in every percentile."
    )
    metres = (
        "A fix errs by its dilution times the error of a range. How many metres that is this page "
        "says of designs with a table [signal]: clocks, orbits, receiver. "
        "designs/tracked-15-5-1.toml is one.",
    )
    return arranged(
        "Geometry and accuracy",
        (
            text,
            *(() if results.design.signal else metres),
            *results.mapped.certain(),
            *one_colour(results.mapped),
        ),
        dilution_pictures(results.mapped),
        (results.mapped.tables()[1],),
    )


def _links(results: DesignResults, _: list[Neighbour]) -> Section | None:
    """Who on the ground, around Mars and at the Earth sees them."""
    parts = [_stations(results), *([access_section(results.access)] if results.access else [])]
    blocks: list[Block] = [block for part in parts if part for block in part.blocks]
    return Section("Stations and links", tuple(blocks)) if blocks else None


def _orbits(results: DesignResults, _: list[Neighbour]) -> Section:
    """What flies."""
    shown = results.shown
    explicit = shown.geometry is None
    tables = (shown.constellation_table(), *(shown.geometry_tables() if explicit else ()))
    pictures = (orbit_picture(shown.design), track_picture(shown.design))
    return arranged("Orbits", (), pictures, tables)


def _losses(results: DesignResults, _: list[Neighbour]) -> Section | None:
    """What is left when satellites fail."""
    tables = results.fold.losses_tables()
    if not tables:
        return None
    wanted = quantity("min_fold").title
    text = (
        f"The {wanted} that is left, proven {results.fold.scope}; sets that the pattern's symmetry "
        "makes equal are one row."
    )
    return arranged("Losses", (text,), (), tables)


def _caps(results: DesignResults, _: list[Neighbour]) -> Section | None:
    """Caps and gaps by formulas; nothing of the kind for explicit elements."""
    shown = results.shown
    if shown.geometry is None:
        return None
    text = (
        "Published means the source paper's printed formula, kept for comparison; exact means "
        "the geometry of the sphere."
    )
    tables = Details("Caps, gaps and totals in numbers", shown.geometry_tables())
    pictures = (cap_picture(shown.design),) if shown.geometry.gap else ()
    words = (Sentence(note) for note in (text, *shown.notes()))
    return Section("Caps and gaps", (*words, *pictures, tables))


def _stations(results: DesignResults) -> Section | None:
    blocks = area_blocks(results.stations, "Satellites and geometry at the stations")
    text = "Each station on its reference figure, at its height and over its own horizon."
    return Section("Stations", (Sentence(text), *blocks)) if blocks else None


def _comparison(results: DesignResults, _: list[Neighbour]) -> Section | None:
    design = results.design
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


#: The sections after the answer, in the order of a board's questions.
SECTIONS: tuple[tuple[str, Callable[[DesignResults, list[Neighbour]], Section | None]], ...] = (
    ("requirements", _requirements),
    ("sites and regions", _areas),
    ("coverage", _coverage),
    ("geometry and accuracy", _accuracy),
    ("errors in metres", lambda found, _: metres_section(found.mapped, found.followed)),
    ("users in orbit", lambda found, _: aloft_section(found.aloft)),
    ("who tracks them", lambda found, _: tracking_section(found.design)),
    ("stations and links", _links),
    ("orbits", _orbits),
    ("how long it lasts", lambda found, _: lasting_section(found.design, found.outlook)),
    ("deployment", lambda found, _: deployment_section(found.design)),
    ("losses", _losses),
    ("caps and gaps", _caps),
    ("comparison", _comparison),
)

#: How many parts `design_report` tells of: what it looks at and draws first, then the sections.
PARTS = 9 + len(SECTIONS)
