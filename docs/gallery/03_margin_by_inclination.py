"""Highest mask with continuous coverage, by inclination."""

import numpy as np
from matplotlib.figure import Figure

import compass

inclinations = np.linspace(35, 70, 15)
axes = Figure(figsize=(7, 4)).subplots()
for phasing in (1, 4):
    margins = []
    for inclination in inclinations:
        pattern = compass.walker_delta(
            15, 5, phasing, inclination_deg=inclination, orbit="areosynchronous"
        )
        margins.append(compass.fold(compass.Design(pattern), fold=4).mask_margin_deg)
    axes.plot(inclinations, margins, label=f"15/5/{phasing}")
axes.set(xlabel="inclination, deg", ylabel="highest mask with four in view, deg")
axes.legend()
