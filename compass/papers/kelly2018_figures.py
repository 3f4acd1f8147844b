"""The numbers behind Figures 1 and 4 to 9 of Kelly and Bevilacqua 2018, one dataset a figure."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from compass.bodies import KELLY2018_RADIUS, SOLAR_DAY
from compass.contacts.dataset import windows_dataset
from compass.contacts.nodes import Node, moon_node, satellite_nodes, station_node
from compass.contacts.windows import windows
from compass.orbits import orbital_period, positions_mci, walker_delta
from compass.papers.kelly2018_access import FIGURE, constellation
from compass.papers.line_of_sight import misses
from compass.sites import Site

if TYPE_CHECKING:
    import xarray as xr

#: Of the access profiles, which say neither mask nor span: three sols without a mask.
SPAN = 3 * SOLAR_DAY.value
#: Longitude of the first equatorial station, degrees; the other one is opposite. One of those at
#: which every satellite rises over one of the two.
STATION_LONGITUDE = 6.0
#: Latitude and longitude of the user that Figure 1 draws, degrees in the inertial frame.
USER = (20.0, -60.0)


@dataclass(frozen=True)
class PaperFigure:
    """A figure of the paper: its number, what it shows, and a function that makes its data."""

    number: int
    title: str
    make: Callable[[], "xr.Dataset"]


def navigation_structure() -> "xr.Dataset":
    """Figure 1: satellites, a user with those in view of it, a control station at the pole."""
    import xarray as xr

    r = positions_mci(constellation(), np.zeros(1))[:, 0]
    latitude, longitude = np.radians(USER)
    level = np.cos(latitude)
    places = KELLY2018_RADIUS.value * np.array(
        [
            [level * np.cos(longitude), level * np.sin(longitude), np.sin(latitude)],
            [0.0, 0.0, 1.0],
        ]
    )
    # from a hair above the ground, which itself is in the way of nothing
    linked = misses(1.000001 * places[:, None], r[None, :], KELLY2018_RADIUS.value)
    return xr.Dataset(
        {
            "satellite_place": (("satellite", "axis"), r, {"units": "m"}),
            "ground_place": (("site", "axis"), places, {"units": "m"}),
            "in_view": (("site", "satellite"), linked, {"long_name": "satellite in view"}),
        },
        coords={"site": ["user", "control station"], "axis": ["x", "y", "z"]},
    )


def orbits() -> "xr.Dataset":
    """Figure 4: the five orbits and the satellites at the epoch."""
    import xarray as xr

    c = constellation()
    times = np.linspace(0.0, float(orbital_period(c.semi_major_axis[0])), 181)
    r = positions_mci(c, times)
    return xr.Dataset(
        {
            "track": (("plane", "time", "axis"), r[::3], {"units": "m"}),
            "satellite_place": (("satellite", "axis"), r[:, 0], {"units": "m"}),
        },
        coords={"axis": ["x", "y", "z"], "time": ("time", times, {"units": "s"})},
    )


def planar_coverage(step_deg: float = 2.0) -> "xr.Dataset":
    """Figure 5: how many of two and of three satellites of a plane are in view, by place."""
    import xarray as xr

    lat = np.arange(-90 + step_deg / 2, 90, step_deg)
    lon = np.arange(-180 + step_deg / 2, 180, step_deg)
    level = np.cos(np.radians(lat))[:, None]
    up = np.stack(
        [
            level * np.cos(np.radians(lon)),
            level * np.sin(np.radians(lon)),
            np.broadcast_to(np.sin(np.radians(lat))[:, None], (lat.size, lon.size)),
        ],
        axis=2,
    )
    counts = []
    for satellites in (2, 3):
        c = walker_delta(satellites, 1, 0, inclination_deg=45.0, radius_km=20427)
        r = positions_mci(c, np.zeros(1))[:, 0]
        n = r / np.linalg.norm(r, axis=1, keepdims=True)
        half = KELLY2018_RADIUS.value / float(c.semi_major_axis[0])
        counts.append((up @ n.T >= half).sum(axis=2))
    return xr.Dataset(
        {"count": (("satellites", "lat", "lon"), np.array(counts), {"units": "1"})},
        coords={
            "satellites": [2, 3],
            "lat": ("lat", lat, {"units": "degrees_north"}),
            "lon": ("lon", lon, {"units": "degrees_east"}),
        },
    )


def _profile(nodes: list[Node]) -> "xr.Dataset":
    """Windows of command stations with all satellites."""
    satellites = satellite_nodes(constellation())
    pairs = [(node, satellite) for node in nodes for satellite in satellites]
    return windows_dataset(windows(pairs, SPAN, figure=FIGURE))


def equatorial_profile() -> "xr.Dataset":
    """Figure 6: two stations on the equator, 180 degrees apart."""
    epoch = constellation().epoch
    return _profile(
        [
            station_node(Site(name, 0.0, float(np.radians(longitude)), figure=FIGURE), epoch, SPAN)
            for name, longitude in (
                (f"{STATION_LONGITUDE:g} E", STATION_LONGITUDE),
                (f"{180 - STATION_LONGITUDE:g} W", STATION_LONGITUDE - 180),
            )
        ]
    )


def polar_profile() -> "xr.Dataset":
    """Figure 7: a station at the north pole."""
    site = Site("north pole", np.pi / 2, 0.0, figure=FIGURE)
    return _profile([station_node(site, constellation().epoch, SPAN)])


def deimos_profile() -> "xr.Dataset":
    """Figure 8: a station on Deimos."""
    return _profile([moon_node("deimos", constellation().epoch, SPAN)])


def phobos_profile() -> "xr.Dataset":
    """Figure 9: a station on Phobos."""
    return _profile([moon_node("phobos", constellation().epoch, SPAN)])


FIGURES_OF_THE_PAPER = (
    PaperFigure(1, "Navigation structure", navigation_structure),
    PaperFigure(4, "The constellation", orbits),
    PaperFigure(5, "Coverage by two and by three satellites of a plane", planar_coverage),
    PaperFigure(6, "Access of two equatorial command stations", equatorial_profile),
    PaperFigure(7, "Access of a polar command station", polar_profile),
    PaperFigure(8, "Access of a command station on Deimos", deimos_profile),
    PaperFigure(9, "Access of a command station on Phobos", phobos_profile),
)
