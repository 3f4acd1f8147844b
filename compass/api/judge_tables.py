"""The tables of a ranking of designs for a lander."""

from collections.abc import Mapping, Sequence
from typing import Any

from compass.coverage.certified_percentile import bounded
from compass.document import Proven, Table, Value
from compass.document.numbers import significant
from compass.quantities import Quantity, quantity


def unknown_air(record: dict[str, Any]) -> list[str]:
    """What of the air is not known beforehand, and by how much."""
    known = (("density", record["density_sigma"]), ("L/D", record["lift_sigma"]))
    return [f"{name} unknown by {100 * sigma:g} %" for name, sigma in known if sigma]


def surface_table(rows: Sequence[dict[str, Any]]) -> Table:
    """Coverage and geometry of every design for users on the surface."""
    margin = quantity("mask_margin_deg")
    good = quantity("availability")
    header = ("design", "continuous coverage", margin.heading, "GDOP p50", "p95", good.heading)
    return Table("Users on the surface", header, tuple(_surface(row, margin) for row in rows))


def _surface(row: dict[str, Any], margin: Quantity) -> tuple[object, ...]:
    known = row["surface"]
    highest = known["mask_margin_deg"]
    return (
        row["design"],
        f"{known['fold']['wanted']}-fold {known['fold']['outcome']}",
        Value(margin, "no mask has it" if highest is None else highest, Proven()),
        *(bounded("gdop", known["gdop"], key) for key in ("p50", "p95")),
        bounded("availability", known, "availability"),
    )


def ranking_table(rows: Sequence[dict[str, Any]]) -> Table:
    """Bounds of every design, the best first."""
    return Table(
        "Designs ranked by the 95th percentile of the position bound",
        (
            "rank", "design", "satellites", "in view, fewest", "position p50, m", "p95, m",
            "worst found, m", "velocity p95, m/s", "p95 after worst loss, m", "worst found, m",
            "blind, %",
        ),
        tuple(
            (
                row["rank"],
                row["design"],
                row["satellites"],
                row["in_view"]["min"],
                with_bounds(row["crlb_position_m"], "p50"),
                with_bounds(row["crlb_position_m"], "p95"),
                _digits(row["worst_found"]["value"]),
                with_bounds(row["crlb_velocity_m_s"], "p95"),
                *_loss_columns(row),
                _blind(row),
            )
            for row in rows
        ),
    )  # fmt: skip


def _blind(row: dict[str, Any]) -> str | float:
    """Share of blind entries, per cent, with its bounds."""
    name = "unobservable_share"
    ends = row.get(f"{name}_interval")
    percent: dict[str, Any] = {name: 100.0 * row[name]}
    if ends is not None:
        percent[f"{name}_interval"] = [100.0 * end for end in ends]
    return with_bounds(percent, name)


def _loss_columns(row: dict[str, Any]) -> tuple[object, object]:
    """95th percentile and worst found after the worst loss; nothing where there is nobody."""
    if "after_loss" not in row:
        return "", ""
    lost = row["after_loss"]
    return with_bounds(lost["crlb_position_m"], "p95"), _digits(lost["worst_found"]["value"])


def budget_table(rows: Sequence[dict[str, Any]]) -> Table:
    """What the position error of every design comes from, m."""
    names = max((list(row["budget_m"]) for row in rows), key=len)

    def part(row: dict[str, Any], name: str) -> float:
        return _digits(row["budget_m"].get(name, 0.0))

    return Table(
        "Where the position error comes from, root mean square, m",
        ("design", *names),
        tuple((row["design"], *(part(row, name) for name in names)) for row in rows),
    )


def filter_table(rows: Sequence[dict[str, Any]]) -> Table:
    """Errors of the filter, and whether they are as large as it says."""
    return Table(
        "The filter itself: its errors at deployment, and whether they are as large as it says",
        (
            "design", "runs", "diverged", "error p50, m", "p95, m", "rms over the bound's", "NEES",
            "95 % of consistent filters between", "consistent",
        ),
        tuple(
            (
                row["design"],
                row["runs"],
                row["diverged"],
                with_bounds(row["ekf_position_m"], "p50"),
                with_bounds(row["ekf_position_m"], "p95"),
                _digits(row["rms_over_bound"]),
                _digits(row["nees"]),
                "{low:.2f} and {high:.2f}".format(**row["nees_interval"]),
                _consistent(row),
            )
            for row in rows
        ),
    )  # fmt: skip


def delivery_words(rows: Sequence[dict[str, Any]]) -> list[str]:
    """Where guided landers come by what the filters of designs know; nothing unguided."""
    return [
        f"{row['design']}, guided by what its filter knows: half of {row['delivery_m']['entries']} "
        f"entries deploy within {with_bounds(row['delivery_m'], 'p50')} m of their targets, 95 % "
        f"within {with_bounds(row['delivery_m'], 'p95')} m; NEES at last "
        f"{significant(row['delivery_m']['nees'], 3)} where 6 is right."
        for row in rows
        if "delivery_m" in row
    ]


def _consistent(row: dict[str, Any]) -> str:
    if not row["believed"]:
        return f"no: errors {row['errors_over_claim']:.3g} times its claim"
    return "yes" if row["consistent"] else "no"


def not_told_apart(rows: Sequence[dict[str, Any]]) -> list[str]:
    """Say which designs so few entries cannot put behind the best; nothing if there is none."""
    best, *others = rows
    bounds = best["crlb_position_m"].get("p95_interval")
    if bounds is None:
        return []
    names = [
        f"“{row['design']}”"
        for row in others
        if row["crlb_position_m"]["p95_interval"][0] <= bounds[1]
    ]
    if not names:
        return []
    return [
        f"so few entries do not put {' or '.join(names)} behind “{best['design']}”: the "
        "bounds of their 95th percentiles overlap"
    ]


def with_bounds(known: Mapping[str, Any], key: str) -> str | float:
    """A percentile of what was drawn, and between what bounds that of endless draws lies."""
    bounds = known.get(f"{key}_interval")
    if bounds is None:
        return _digits(known[key])
    return f"{known[key]:.4g} ({significant(bounds[0], 3)} to {significant(bounds[1], 3)})"


def _digits(value: float) -> float:
    """Four digits: more would be noise of the entries drawn."""
    return float(f"{value:.4g}")
