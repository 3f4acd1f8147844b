"""An access record as tables, for reports and the command line alike."""

import math
from typing import Any

from compass.document.blocks import Table

# a column: key of the record, heading, and how to show its value
_PERCENT = "percent"
_Columns = tuple[tuple[str, str, int | str | None], ...]

_NODES: _Columns = (
    ("node", "node", None),
    ("satellites", "satellites", None),
    ("seen", "seen", None),
    ("mean_share", "mean share of time [%]", _PERCENT),
    ("least_share", "least share [%]", _PERCENT),
    ("passes_per_sol", "passes a sol, each", 3),
    ("mean_pass_h", "mean pass [h]", 3),
    ("longest_gap_h", "longest gap [h]", 3),
    ("any_share", "any satellite [%]", _PERCENT),
    ("any_longest_gap_h", "longest gap of any [h]", 3),
)
_EARTH: _Columns = (
    ("station", "station", None),
    ("direct_share", "direct [%]", _PERCENT),
    ("share", "through the network [%]", _PERCENT),
    ("by_hops", "by links in the chain", None),
    ("share_outside_conjunction", "out of conjunction [%]", _PERCENT),
    ("longest_gap_h", "longest outage [h]", 3),
)
_MAIL: _Columns = (
    ("source", "from", None),
    ("target", "to", None),
    ("at_once", "at once [%]", _PERCENT),
    ("mean_h", "mean wait [h]", 3),
    ("longest_h", "longest wait [h]", 3),
    ("undelivered", "not within the span [%]", _PERCENT),
)
_ECLIPSES: _Columns = (
    ("node", "node", None),
    ("count", "eclipses", None),
    ("share", "share of time [%]", _PERCENT),
    ("longest_h", "longest [h]", 3),
    ("umbra_count", "umbrae", None),
    ("umbra_longest_h", "longest umbra [h]", 3),
)
_RADIO: _Columns = (
    ("first", "from", None),
    ("second", "to", None),
    ("largest_range_km", "largest range [km]", 0),
    ("largest_range_rate_km_s", "largest range rate [km/s]", 3),
    ("largest_light_time_s", "largest light time [s]", 3),
    ("least_cn0_dbhz", "least C/N0 [dB Hz]", 1),
    ("required_cn0_dbhz", "needed [dB Hz]", 1),
    ("usable_share", "usable [%]", _PERCENT),
)
_PAIRS: _Columns = (
    ("first", "from", None),
    ("second", "to", None),
    ("count", "windows", None),
    ("passes_per_sol", "a sol", 3),
    ("mean_duration_h", "mean length [h]", 3),
    ("share", "share of time [%]", _PERCENT),
    ("longest_gap_h", "longest gap [h]", 3),
    ("least_range_km", "least range [km]", 0),
    ("largest_range_km", "largest range [km]", 0),
)


def access_tables(record: dict[str, Any], *, pairs: bool = False) -> list[Table]:
    """Make the tables for which a record has something to say, with a line a pair if wanted."""
    earth = record["earth"]["stations"] if record["earth"] else []
    parts = [
        ("Satellites in sight", _NODES, record["nodes"]),
        ("Reaching the Earth", _EARTH, earth),
        ("Store and forward between stations", _MAIL, record["latency"] or []),
        ("In Mars's shadow", _ECLIPSES, record["eclipses"]),
        ("Radio links along their windows", _RADIO, record["radio"]),
        ("Pairs", _PAIRS, record["pairs"] if pairs else []),
    ]
    return [
        Table(
            title,
            tuple(heading for _, heading, _ in columns),
            tuple(tuple(_shown(r[key], how) for key, _, how in columns) for r in rows),
        )
        for title, columns, rows in parts
        if rows
    ]


def _shown(value: Any, how: int | str | None) -> object:
    if isinstance(value, dict):
        return ", ".join(f"{n}: {100 * share:.1f} %" for n, share in value.items()) or "-"
    if value is None:
        return "-"
    if how is None:
        return value
    if not math.isfinite(value):
        return "-"
    return f"{100 * value:.2f}" if how == _PERCENT else f"{value:.{how}f}"
