"""Yu et al. 2018: Tables 1 to 6 and Figures 1, 3 to 7 and 9 to 12 of the observability chapter."""

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from compass.entry.schedule import in_view
from compass.entry.trajectory import fly
from compass.entry.views import cartesian_of
from compass.entry.visible_area import VisibleArea
from compass.papers import yu2018_case as paper
from compass.papers.verdict import Erratum, Row, claim, computed
from compass.papers.yu2018_ground import filter_rows, ground_rows
from compass.papers.yu2018_information import information_rows
from compass.papers.yu2018_orbiters import comparison_rows, orbiter_rows

TITLE = (
    "Z. Yu, P. Cui, R. Xu and S. Zhu, Mars Networks-Based Navigation: Observability and "
    "Optimization, InTechOpen 2018, doi 10.5772/intechopen.73605"
)


def rows() -> list[Row]:
    """Every table, figure and checkable statement."""
    return [
        *dynamics_rows(),
        *information_rows(),
        *ground_rows(),
        *filter_rows(),
        *orbiter_rows(),
        *comparison_rows(),
    ]


def newton_end() -> NDArray[np.float64]:
    """Place at the last of the times by Newton's law in the rotating frame, metres, shape (3,).

    ``a = -GM r/|r|^3 - D v/|v| + L u - 2 omega x v`` with the lift's direction u at right angles to
    v in the plane of r and v (bank zero), in Cartesian coordinates: nothing of eq. 1 is used.
    """
    m, start = paper.model(), np.asarray(cartesian_of(paper.table_2()))
    air, vehicle = m.atmosphere, m.vehicle
    spin = np.array([0.0, 0.0, m.omega])

    def rate(_: float, y: NDArray[np.float64]) -> NDArray[np.float64]:
        r, v = y[:3], y[3:]
        height, speed = np.linalg.norm(r), np.linalg.norm(v)
        density = 2e-4 * np.exp((air.reference_radius - height) / air.scale_height)
        drag = 0.5 * density * vehicle.drag_area_per_mass * speed**2
        up = r / height - (r @ v) / (height * speed**2) * v
        lift = 0.156 * drag * up / np.linalg.norm(up)
        a = -m.gm * r / height**3 - drag * v / speed + lift - 2 * np.cross(spin, v)
        return np.concatenate([v, a])

    span = (0.0, float(paper.TIMES[-1]))
    flown = solve_ivp(rate, span, start, rtol=1e-11, atol=1e-6, method="DOP853")
    if not flown.success:  # the last state would be of an earlier moment
        raise RuntimeError(f"Newton's law at {flown.t[-1]:g} s of {span[1]:g}: {flown.message}")
    return flown.y[:3, -1]


def dynamics_rows() -> list[Row]:
    """Equation 1, the flight of Table 2 and Figure 3."""
    newton = newton_end()
    flight, beacons = paper.ground_flight(), paper.ground_beacons()
    printed = fly(paper.model("published-coriolis"), paper.table_2(), [0.0, 240.0]).states[-1]
    apart = [
        float(np.linalg.norm(cartesian_of(state)[:3] - newton)) / 1e3
        for state in (printed, flight.states[-1])
    ]
    seen = in_view(beacons, flight.states, paper.RADIUS)
    return [
        claim(
            "Place at 240 s against Newton's law in the rotating frame: eq. 1 as printed; its "
            "Coriolis terms of gamma' and psi' exchanged",
            "eq. 1",
            "the equations of motion",
            apart,
            "km off",
            "the first within 1 m",
            lambda as_printed, _: as_printed < 1e-3,
            shown="{:.3f}; {:.2g}",
            erratum=Erratum(
                "the two terms are exchanged",
                shown=lambda as_printed, exchanged: exchanged < 1e-3 < as_printed,
            ),
        ),
        claim(
            "Altitude and time at the end of the flight",
            "Table 2, Figure 3",
            "the entry phase lasts approximately 240 s",
            (flight.altitude[-1] / 1e3, flight.times[-1]),
            "km, s",
            "above the ground and below 50 km at 240 s",
            lambda altitude, time: 0 < altitude < 50 and time == 240,
            shown="{:.2f}, {:.0f}",
        ),
        claim(
            "Epochs at which the three beacons of Figure 4 see the lander; all epochs",
            "eq. 52, Figure 3",
            "in view during the whole entry",
            (seen.all(axis=1).sum(), seen.shape[0]),
            "1",
            "equal",
            lambda found, wanted: found == wanted,
            shown="{:.0f}; {:.0f}",
        ),
        *_figure_3_rows(),
    ]


def figure_3() -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Trajectory over ground and edge of the visible area: unit vectors, (t, 3) and (k, 3)."""
    flight = paper.ground_flight()
    place = cartesian_of(flight.states)[:, :3]
    up = place / np.linalg.norm(place, axis=1, keepdims=True)
    return up, VisibleArea(flight).outline()


def _figure_3_rows() -> list[Row]:
    """The edge sees the lander at elevation zero at worst: area and edge, by two ways."""
    flight = paper.ground_flight()
    _, edge = figure_3()
    place = cartesian_of(flight.states)[:, None, :3] - paper.RADIUS * edge
    sine = (place * edge).sum(axis=2) / np.linalg.norm(place, axis=2)
    worst = np.degrees(np.arcsin(sine.min(axis=0)))
    centre = VisibleArea(flight).centre
    reach = np.arccos(np.clip(edge @ centre, -1, 1))
    step = 2 * np.pi / (len(edge) - 1)
    area = float(((1 - np.cos(reach[:-1])) * step).sum()) * (paper.RADIUS / 1e3) ** 2
    words = np.radians(paper.WORDS_OF_FIGURE_4)
    n = np.stack(
        [
            np.cos(words[:, 0]) * np.cos(words[:, 1]),
            np.cos(words[:, 0]) * np.sin(words[:, 1]),
            np.sin(words[:, 0]),
        ],
        axis=1,
    )
    off = np.degrees(np.arccos(np.clip(n @ edge.T, -1, 1)).min(axis=1))
    return [
        computed(
            "Area from which the lander is in view all the way; lowest elevation over its edge, "
            "least and greatest",
            "Figure 3",
            (area, worst.min(), worst.max()),
            "km^2; deg",
            shown="{:.4g}; {:.1e}, {:.1e}",
            note="zero all along the edge, as it must be",
        ),
        claim(
            "Distance of the beacons placed by the chapter's words from the edge of that area",
            "Figure 4",
            "close to the edge of both sides",
            off,
            "deg",
            "1 or less each",
            lambda *degrees: max(degrees) <= 1,
            shown="{:.2f}, {:.2f}, {:.2f}",
            fitted="they were placed by these words; the chapter prints no coordinates",
        ),
    ]
