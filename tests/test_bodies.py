import math

from compass import bodies


def constants():
    return {k: v for k, v in vars(bodies).items() if isinstance(v, bodies.Constant)}


def test_every_constant_has_a_value_a_unit_and_a_source():
    assert constants()
    for name, constant in constants().items():
        assert math.isfinite(float(constant)), name
        assert constant.unit, name
        assert constant.uncertainty >= 0, name
        assert len(constant.source) > 10, name


def test_rotation_rate_is_the_linear_term_of_the_prime_meridian():
    rate = math.radians(350.891982443297) / 86400
    assert abs(bodies.MARS_ROTATION_RATE.value - rate) < 1e-19
    # the sidereal day that ephemerides print: 24 h 37 min 22.66 s
    assert abs(bodies.sidereal_day() - (24 * 3600 + 37 * 60 + 22.663)) < 0.005


def test_solar_day_follows_from_the_sidereal_one_and_the_tropical_year():
    # 1/solar = 1/sidereal - 1/year; 686.9725 days (Allison and McEwen 2000) to 1e-4 days
    year = 686.9725 * 86400
    solar = 1 / (1 / bodies.sidereal_day() - 1 / year)
    assert abs(solar - bodies.SOLAR_DAY.value) < 0.01
