"""The bodies: each constant with value, unit, one-sigma uncertainty and source."""

from dataclasses import dataclass
from math import pi

_IAU = "Archinal et al. 2018, Celest. Mech. Dyn. Astron. 130:22, doi 10.1007/s10569-017-9805-5"
_DE440 = "Park et al. 2021, Astron. J. 161:105 (DE440), doi 10.3847/1538-3881/abd414"


@dataclass(frozen=True)
class Constant:
    """A physical constant and where it comes from.

    Attributes
    ----------
    value
        In SI units (rad for angles).
    unit
        The unit of `value` and `uncertainty`, as text.
    uncertainty
        One sigma; zero for a value that is exact by definition.
    source
        The publication, with table or equation.
    """

    value: float
    unit: str
    uncertainty: float
    source: str

    def __float__(self) -> float:
        return self.value


MARS_GM = Constant(
    4.282837362069909e13, "m^3/s^2", 2.8e5, f"{_DE440}; Mars alone, gm_de440.tpc BODY499_GM"
)
MARS_J2 = Constant(
    1.9566e-3,
    "1",
    1e-7,
    "Genova et al. 2016, Icarus 272:228 (GMM-3), doi 10.1016/j.icarus.2016.02.050; "
    "-sqrt(5) times the normalised C20, rounded",
)
MARS_J2_RADIUS = Constant(
    3.396e6, "m", 0.0, "Genova et al. 2016, Icarus 272:228 (GMM-3): the field's reference radius"
)
MARS_EQUATORIAL_RADIUS = Constant(3.39619e6, "m", 100.0, f"{_IAU}, Table 4")
MARS_POLAR_RADIUS = Constant(3.37620e6, "m", 100.0, f"{_IAU}, Table 4 (mean of north and south)")
MARS_ROTATION_RATE = Constant(
    7.088218070006562e-05,
    "rad/s",
    1e-15,
    f"{_IAU}, Table 1: 350.891982443297 deg/day, the linear term of W",
)

KELLY2018_RADIUS = Constant(
    3.3962e6,
    "m",
    50.0,
    "Kelly and Bevilacqua 2018, Constellation Design for Mars Navigation using Small "
    "Satellites, Table 2",
)


def sidereal_day() -> float:
    """Return the rotation period of Mars against the stars, 2 pi / omega, in seconds."""
    return 2.0 * pi / MARS_ROTATION_RATE.value


SOLAR_DAY = Constant(
    88775.244147,
    "s",
    1e-6,
    "Allison and McEwen 2000, Planet. Space Sci. 48:215, doi 10.1016/S0032-0633(99)00092-6: "
    "mean solar day (sol) of Mars",
)

_SINCLAIR = "Sinclair 1989, Astron. Astrophys. 220:321 (orbital elements of Phobos and Deimos)"
_IAU_NOMINAL = "Prsa et al. 2016, Astron. J. 152:41 (IAU 2015 Resolution B3), nominal value"
_SI = "The International System of Units, 9th ed., 2019, BIPM: exact"

PHOBOS_SEMI_MAJOR_AXIS = Constant(
    9.37940e6, "m", 5.0, f"{_SINCLAIR}; half a unit of the last digit"
)
DEIMOS_SEMI_MAJOR_AXIS = Constant(
    2.346113e7, "m", 5.0, f"{_SINCLAIR}; half a unit of the last digit"
)
PHOBOS_GM = Constant(
    7.087e5, "m^3/s^2", 6e2, "Paetzold et al. 2014, Icarus 229:92, doi 10.1016/j.icarus.2013.10.021"
)
DEIMOS_GM = Constant(
    9.62e4,
    "m^3/s^2",
    2.8e3,
    "Jacobson 2010, Astron. J. 139:668, doi 10.1088/0004-6256/139/2/668, Table 2",
)
SUN_GM = Constant(1.32712440041e20, "m^3/s^2", 1e10, f"{_DE440}; in TDB, exact to its last digit")
SUN_IRRADIANCE = Constant(1361.0, "W/m^2", 0.5, f"{_IAU_NOMINAL} of total solar irradiance at 1 au")
SUN_RADIUS = Constant(6.957e8, "m", 0.0, _IAU_NOMINAL)
ASTRONOMICAL_UNIT = Constant(1.495978707e11, "m", 0.0, "IAU 2012 Resolution B2: exact")
SPEED_OF_LIGHT = Constant(299792458.0, "m/s", 0.0, _SI)
BOLTZMANN = Constant(1.380649e-23, "J/K", 0.0, _SI)
