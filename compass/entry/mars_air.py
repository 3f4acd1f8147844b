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

#: Altitude (km) and one sigma of the density, relative: of 200 perturbed profiles of Mars-GRAM, as
#: tabulated with AMAT; alike at the equator, 40 and 80 north. They tend to be rather large (Justh
#: and Justus 2007, NASA NTRS 20090028811).
SPREAD = (
    (5.0, 0.02), (10.0, 0.023), (20.0, 0.031), (30.0, 0.041), (40.0, 0.054), (50.0, 0.072),
    (60.0, 0.095), (70.0, 0.127), (80.0, 0.17), (90.0, 0.226), (100.0, 0.3), (120.0, 0.4),
)  # fmt: skip
