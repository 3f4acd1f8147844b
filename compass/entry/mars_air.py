"""The air of Mars where a scenario says nothing of it: a mean profile."""

#: Altitude (km) and density (kg/m^3): mean of Mars-GRAM (Justh et al., NASA Marshall) over the
#: planet and the year, as tabulated with AMAT (Girija et al. 2021, J. Open Source Software
#: 6:3710); exponential between its rows and beyond the last.
PROFILE = (
    (0.0, 1.319e-2), (5.0, 8.976e-3), (10.0, 5.762e-3), (15.0, 3.596e-3), (20.0, 2.190e-3),
    (25.0, 1.302e-3), (30.0, 7.659e-4), (35.0, 4.203e-4), (40.0, 2.357e-4), (50.0, 6.420e-5),
    (60.0, 1.754e-5), (70.0, 7.254e-6), (80.0, 2.022e-6), (90.0, 4.192e-7), (100.0, 7.749e-8),
    (110.0, 1.488e-8), (120.0, 3.205e-9), (125.0, 1.632e-9),
)  # fmt: skip
