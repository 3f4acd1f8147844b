"""The world of an entry in the numbers of the papers' own filters, which carry spherical states."""

import numpy as np
from numpy.typing import NDArray

from compass.entry.model import EntryModel


def spherical_parameters(model: EntryModel, bank: float = 0.0) -> NDArray[np.float64]:
    """Parameters of `compass.core.papers.spherical`, for one bank angle (radians).

    A point mass and air that turns with the planet: the papers know neither J2 nor winds.
    """
    air = model.atmosphere
    head = [
        model.gm,
        air.reference_radius,
        air.scale_height,
        model.vehicle.drag_area_per_mass,
        bank,
        model.omega,
        model.terms,
    ]
    ratio = np.log(air.table_density) - air.log_reference_density
    return np.concatenate([head, air.table_radius, ratio])
