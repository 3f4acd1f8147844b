"""Vehicle, atmosphere and model: what they compute and what they refuse."""

import numpy as np
import pytest

from compass.entry.atmosphere import Atmosphere, read_atmosphere_table
from compass.entry.model import EntryModel
from compass.entry.vehicle import Vehicle
from compass.errors import ArgumentError, DesignError

AIR = Atmosphere(2e-4, 3437.2e3, 7500.0)


def test_bank_holds_until_the_next_command():
    vehicle = Vehicle(0.016, 0.156, (10.0, 20.0), (0.1, 0.2))
    np.testing.assert_array_equal(
        vehicle.bank([0.0, 10.0, 19.9, 20.0, 99.0]), [0.1, 0.1, 0.1, 0.2, 0.2]
    )


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((-1.0, 0.1), "drag_area_per_mass"),
        ((0.1, np.nan), "lift_to_drag"),
        ((0.1, 0.1, (0.0,), (0.0, 1.0)), "1 times and 2 angles"),
        ((0.1, 0.1, (5.0, 5.0), (0.0, 1.0)), "must increase strictly"),
        ((0.1, 0.1, (0.0,), (0.0,), 0.0), "nose_radius"),
    ],
)
def test_impossible_vehicles_are_refused(arguments, message):
    with pytest.raises(ArgumentError, match=message):
        Vehicle(*arguments)


def test_exponential_density():
    np.testing.assert_allclose(AIR.density([3437.2e3, 3444.7e3]), [2e-4, 2e-4 / np.e], rtol=1e-14)
    # CO2 at 200 K: textbook value near 221 m/s
    assert AIR.speed_of_sound == pytest.approx(221.1, abs=0.1)


def test_a_table_is_taken_as_it_is():
    table = Atmosphere(3e-4, 3437.2e3, 7500.0, (3.40e6, 3.43e6, 3.50e6), (1e-2, 1e-3, 1e-7))
    np.testing.assert_allclose(table.density([3.40e6, 3.43e6, 3.50e6]), [1e-2, 1e-3, 1e-7])
    # exponential between rows; the reference density is what the table has there
    between = 1e-3 * (1e-7 / 1e-3) ** (7.2 / 70)
    np.testing.assert_allclose(table.density(3437.2e3), between, rtol=1e-12)
    assert table.reference_density == pytest.approx(between, rel=1e-12)
    half = table.of_density(between / 2)
    np.testing.assert_allclose(half.density([3.40e6, 3.45e6]), table.density([3.40e6, 3.45e6]) / 2)
    np.testing.assert_allclose(AIR.of_density(1e-4).density(3437.2e3), 1e-4)


def test_bias_and_scale_of_the_truth():
    table = Atmosphere(2e-4, 3437.2e3, 7500.0, (3.40e6, 3.50e6), (1e-2, 1e-7))
    for air in (AIR, table):
        heavier = air.changed(density_bias=0.1)
        np.testing.assert_allclose(heavier.density(3.45e6), 1.1 * air.density(3.45e6), rtol=1e-12)
        stretched = air.changed(scale_height_factor=1.25)
        np.testing.assert_allclose(stretched.density(3437.2e3), air.density(3437.2e3), rtol=1e-12)
        np.testing.assert_allclose(
            stretched.density(3437.2e3 + 12.5e3), air.density(3437.2e3 + 10e3), rtol=1e-12
        )
    with pytest.raises(ArgumentError, match="scale_height_factor = 0"):
        AIR.changed(scale_height_factor=0.0)
    with pytest.raises(ArgumentError, match="reference_density"):
        AIR.changed(density_bias=-1.0)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"scale_height": 0.0}, "scale_height = 0"),
        ({"table_radius": (1.0,), "table_density": (1.0,)}, "at least two"),
        ({"table_radius": (2.0, 1.0), "table_density": (1.0, 1.0)}, "increase strictly"),
        ({"table_radius": (1.0, 2.0), "table_density": (1.0, 0.0)}, "must be positive"),
    ],
)
def test_impossible_atmospheres_are_refused(change, message):
    with pytest.raises(ArgumentError, match=message):
        Atmosphere(
            **{"reference_density": 1e-4, "reference_radius": 3.4e6, "scale_height": 8e3} | change
        )


def test_reading_a_table(tmp_path):
    path = tmp_path / "air.txt"
    path.write_text("# altitude km, density kg/m3\n0, 1.5e-2\n\n50 1e-4 # middle\n")
    assert read_atmosphere_table(path) == ((0.0, 50e3), (1.5e-2, 1e-4))
    path.write_text("0 1 2\n")
    with pytest.raises(DesignError, match="line 1 = '0 1 2': must be two numbers"):
        read_atmosphere_table(path)
    path.write_text("")
    assert read_atmosphere_table(path) == ((), ())
    with pytest.raises(DesignError, match=r"cannot be read: No such file.*check the path"):
        read_atmosphere_table(tmp_path / "none.txt")
    path.write_bytes(b"\xff\xfe\x00")
    with pytest.raises(DesignError, match="not text in UTF-8"):
        read_atmosphere_table(path)


def test_model_parameters_and_refusals():
    model = EntryModel(Vehicle(0.016, 0.156), AIR, "none")
    assert model.omega == 0.0
    np.testing.assert_allclose(
        model.full_state(np.zeros((2, 6)))[:, 6:], [[np.log(2e-4), 0.156]] * 2
    )
    assert model.truth(0.1).atmosphere.reference_density == pytest.approx(2.2e-4)
    with pytest.raises(ArgumentError, match="rotation = 'some': allowed none, coriolis"):
        EntryModel(Vehicle(0.016, 0.156), AIR, "some")
    with pytest.raises(ArgumentError, match="gm = -1"):
        EntryModel(Vehicle(0.016, 0.156), AIR, "none", gm=-1.0)
    with pytest.raises(ArgumentError, match="rotation_rate"):
        EntryModel(Vehicle(0.016, 0.156), AIR, "full", rotation_rate=np.inf)
