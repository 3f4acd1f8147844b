"""Horizons that terrain draws around a design's stations, to be written into its file."""

from dataclasses import dataclass, field, replace
from functools import cached_property
from math import degrees
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from compass.api.given import given_design
from compass.api.progress import bar
from compass.api.results import Result
from compass.arguments import checked
from compass.design import Design
from compass.document import Page, Sentence, Table, Value
from compass.document.blocks import Block
from compass.document.plain import plain
from compass.errors import ArgumentError
from compass.handover.toml import design_toml
from compass.inputs.terrain import read_terrain
from compass.quantities import quantity
from compass.saving import replacing
from compass.sites import Site
from compass.terrain import horizon as horizon_of
from compass.terrain import on_ground

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes


@dataclass(frozen=True, repr=False)
class HorizonResult(Result):
    """A design whose stations stand on terrain, over the horizon that it draws.

    Attributes
    ----------
    design
        With the new stations.
    terrain
        The grid's file.
    """

    design: Design = field(repr=False)
    terrain: str

    def to_dict(self) -> dict[str, Any]:
        """Plain values for JSON."""
        return plain(
            {
                "design": self.design.name,
                "terrain": self.terrain,
                "stations": [
                    {
                        "name": site.name,
                        "height_km": site.height / 1e3,
                        "horizon_deg": [
                            [degrees(a), degrees(e)]
                            for a, e in zip(site.mask.azimuth, site.mask.elevation, strict=True)
                        ],
                    }
                    for site in self.design.stations
                ],
            }
        )

    def document(self) -> Page:
        """Height and highest part of the horizon of every station."""
        mask = quantity("mask_deg")
        rows = tuple(
            (
                site.name,
                Value(quantity("station.height_km"), site.height / 1e3),
                Value(mask, degrees(site.mask.highest)),
                _towards(site),
            )
            for site in self.design.stations
        )
        header = (
            "",
            quantity("station.height_km").heading,
            f"highest horizon, {mask.shown_unit}",
            "towards",
        )
        how = (
            f"terrain of {self.terrain}; straight lines of sight over the curved figure, every "
            "edge of the grid counts; the profile nowhere passes below the terrain"
        )
        blocks: tuple[Block, ...] = (Table("Horizons", header, rows), Sentence(how))
        return Page(self.design.name, blocks)

    @cached_property
    def dataset(self) -> "xr.Dataset":
        """Elevation of every station's horizon by azimuth, as CF lays it out."""
        import xarray as xr

        azimuths = np.unique([a for site in self.design.stations for a in site.mask.azimuth])
        elevation = [np.degrees(site.mask.at(azimuths)) for site in self.design.stations]
        return xr.Dataset(
            {
                "horizon": (
                    ("station", "azimuth"),
                    np.reshape(elevation, (len(elevation), azimuths.size)),
                    {"units": "deg", "long_name": "elevation of the horizon"},
                )
            },
            {
                "station": [site.name for site in self.design.stations],
                "azimuth": (
                    "azimuth",
                    np.degrees(azimuths),
                    {"units": "deg", "long_name": "azimuth, clockwise from north"},
                ),
            },
            {"title": self.design.name, "source": self.terrain},
        )

    def plot(self, *, axes: "Axes | None" = None) -> "Axes":
        """Draw the horizon of every station by azimuth.

        Parameters
        ----------
        axes
            Where to; new ones without.
        """
        from compass.pictures.style import CYCLE, axes_or_new, look

        drawn, known = axes_or_new(axes), self.dataset
        with look():
            for k, site in enumerate(self.design.stations):
                line = known.horizon[k]
                drawn.plot(known.azimuth, line, color=CYCLE[k % len(CYCLE)], label=site.name)
            drawn.set(
                xlabel="azimuth from north, deg",
                ylabel="elevation of the horizon, deg",
                title=f"{self.design.name}: horizons of the terrain",
                xlim=(0.0, 360.0),
            )
            drawn.grid(alpha=0.3)
            if self.design.stations:
                drawn.legend(fontsize="small")
        return drawn

    def write(self, path: str | Path) -> None:
        """Write the design with these horizons; comments of its file are lost.

        Raises
        ------
        OutputError
            It cannot be written.
        """
        with replacing(Path(path)) as temporary:
            temporary.write_text(design_toml(self.design), encoding="utf-8")


@checked
def horizon(
    design: Design | str | Path,
    terrain: str | Path,
    *,
    variable: str | None = None,
    latitude_kind: str = "planetocentric",
    above_m: float = 0.0,
    azimuths: int = 360,
    progress: bool = False,
) -> HorizonResult:
    """Draw the horizon of every station of a design from a grid of heights.

    Parameters
    ----------
    design
        A design with stations, or the path of its file.
    terrain
        GeoTIFF or netCDF grid of heights in areographic coordinates.
    variable, latitude_kind
        Of netCDF: which variable, and ``planetocentric`` or ``planetographic`` latitudes.
    above_m
        Height of the stations over the ground, metres.
    azimuths
        Steps of the profile around.
    progress
        Show bars on stderr.

    Raises
    ------
    ArgumentError, DesignError
        No station, a grid that cannot be read or does not hold one, a height below the ground.

    Examples
    --------
    >>> import tempfile, numpy as np, xarray as xr
    >>> import compass
    >>> height = ("lat", "lon"), np.zeros((181, 361)), {"units": "m"}
    >>> flat = xr.Dataset({"height": height}, {"lat": np.r_[-90:91.0], "lon": np.r_[-180:181.0]})
    >>> with tempfile.NamedTemporaryFile(suffix=".nc") as file:
    ...     flat.to_netcdf(file.name, engine="h5netcdf")
    ...     found = compass.horizon("designs/five-landing-sites.toml", file.name, azimuths=8)
    >>> len(found.design.stations)
    5
    """
    read = given_design(design)
    if not read.stations:
        raise ArgumentError("stations: there are none; add a [[station]] for every horizon wanted")
    grid = read_terrain(terrain, read.figure, variable=variable, latitude_kind=latitude_kind)
    moved: dict[str, Site] = {}
    for site in bar(progress, "stations", read.stations):
        standing = on_ground(site, grid, above_m)
        mask = horizon_of(standing, grid, azimuths).mask(safe=True)
        moved[site.name] = replace(standing, mask=mask)
    wanted = tuple(
        replace(each, sites=tuple(moved[site.name] for site in each.sites))
        for each in read.requirements
    )
    changed = replace(read, stations=tuple(moved.values()), requirements=wanted)
    return HorizonResult(changed, str(terrain))


def _towards(site: Site) -> str:
    highest = int(np.argmax(site.mask.elevation))
    return f"{degrees(site.mask.azimuth[highest]):.0f} deg"
