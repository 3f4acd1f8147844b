"""The air of Mars by figures of others: a mean profile, how far it strays, and a wind."""

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

#: Altitude (km) and wind to the east and north, m/s: sample output of Mars-GRAM 2021a (GRAM Suite
#: 1.5), late northern summer (Ls 172), along a path from 22 N 48 E below to 40 N 78 E above. Of one
#: place and hour; their standard deviation is about 2 + h/10 m/s at h km.
WINDS = (
    (10.0, 22.5, -5.4), (20.0, 14.2, -14.7), (30.0, -10.1, -13.5), (50.0, 3.9, 1.9),
    (60.0, -77.6, -32.3), (70.0, -64.2, 43.9), (90.0, -15.4, 4.1), (100.0, -37.0, 37.1),
    (120.0, 23.4, 107.3),
)  # fmt: skip
