"""A dozen and a half named places on Mars, for orientation on maps.

Planetocentric latitude and east longitude in degrees. Mountains, basins and plains: centres
from the Gazetteer of Planetary Nomenclature (International Astronomical Union Working Group for
Planetary System Nomenclature and U.S. Geological Survey, planetarynames.wr.usgs.gov). Landing
sites: positions as the missions report them (NASA Space Science Data Coordinated Archive, CNSA
for Zhurong), rounded to 0.1 degree: for reading a map, not for surveying.
"""

from dataclasses import dataclass


@dataclass(frozen=True)
class Place:
    """A named place: degrees, and whether something has landed there."""

    name: str
    latitude_deg: float
    longitude_deg: float
    landing: bool


PLACES = (
    Place("Olympus Mons", 18.65, -133.80, False),
    Place("Elysium Mons", 25.02, 147.21, False),
    Place("Hellas Planitia", -42.43, 70.50, False),
    Place("Argyre Planitia", -49.84, -43.31, False),
    Place("Utopia Planitia", 46.74, 117.52, False),
    Place("Syrtis Major", 9.20, 67.10, False),
    Place("Valles Marineris", -14.0, -58.6, False),
    Place("Viking 1", 22.3, -48.0, True),
    Place("Viking 2", 47.6, 134.3, True),
    Place("Pathfinder", 19.1, -33.2, True),
    Place("Spirit", -14.6, 175.5, True),
    Place("Opportunity", -1.9, -5.5, True),
    Place("Phoenix", 68.2, -125.7, True),
    Place("Curiosity", -4.6, 137.4, True),
    Place("InSight", 4.5, 135.6, True),
    Place("Perseverance", 18.4, 77.5, True),
    Place("Zhurong", 25.1, 109.9, True),
)
