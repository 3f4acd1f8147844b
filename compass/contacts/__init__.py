"""Who is in sight of whom, and when: stations, satellites, moons, the Earth and the Sun."""
