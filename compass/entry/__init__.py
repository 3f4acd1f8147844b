"""Entry: how a lander flies through the atmosphere and how well it knows where it is."""
