"""Users above the ground and in beams of antennas, of whom a design's requirements speak."""

from dataclasses import dataclass, replace

import numpy as np

from compass.api.map import result_of
from compass.api.map_errors import error_table, error_words
from compass.api.map_result import MapResult
from compass.design import Design
from compass.document.blocks import Block, Picture, Section, Sentence, Table
from compass.pages.coverage import percentile_map
from compass.pages.metres import error_picture
from compass.study.mapping import MapOptions, make_map
from compass.words import capital


@dataclass(frozen=True)
class Standing:
    """How high users stand, above which mask and in which beams, as `compass.map` takes them."""

    altitude_km: float
    mask_deg: float | None
    beam_deg: float | None


def standings(design: Design) -> list[Standing]:
    """Of users in regions above the ground or in beams, each once, as requirements name them."""
    found = []
    for each in design.requirements:
        if each.areas and (each.altitude or each.beam is not None):
            mask, beam = (
                None if angle is None else float(np.degrees(angle))
                for angle in (each.mask, each.beam)
            )
            found.append(Standing(each.altitude / 1e3, mask, beam))
    return list(dict.fromkeys(found))


def maps_aloft(design: Design, options: MapOptions, command: str) -> tuple[MapResult, ...]:
    """Map what users of each standing have, of the whole shell."""
    found = []
    for one in standings(design):
        asked = replace(options, **vars(one))
        found.append(result_of(design, make_map(design, asked, command), asked))
    return tuple(found)


def aloft_section(mapped: tuple[MapResult, ...]) -> Section | None:
    """Satellites in view, geometry and errors of users above the ground; None without any."""
    told: list[Block] = []
    for k, one in enumerate(mapped):
        attrs, in_metres = one.dataset.attrs, one.design.signal is not None
        mask = ", ".join(f"{angle:.4g}" for angle in attrs["elevation_mask_deg"])
        who = f"users anywhere{one.users}"
        told.append(Sentence(f"{capital(who)}, above {mask} deg:"))
        told += [Sentence(words) for words in one.certain()]
        told += error_words(one) if in_metres else ()
        tables = (*one.tables(), error_table(one)) if in_metres else one.tables()
        told += [_named(table, who) for table in tables]
        name = "error_position_m" if in_metres else "gdop"
        if not one.nowhere(name):
            shown = (
                error_picture(one, name)
                if in_metres
                else percentile_map(one, name, "At most this for 95 % of the time.")
            )
            told.append(_of(shown, who, k))
    return Section("Users in orbit and in beams", tuple(told)) if told else None


def _named(table: Table, who: str) -> Table:
    """A table whose title says whose it is."""
    return replace(table, title=f"{table.title}: {who}")


def _of(shown: Picture, who: str, k: int) -> Picture:
    """A picture that says whose it is, under a name of its own."""
    title = f"{shown.title}: {who}"
    alt = f"{shown.alt} Of {who}."
    return replace(shown, stem=f"aloft-{k + 1}-{shown.stem}", title=title, alt=alt)
