"""``compass version``: which version this is, and on what it runs."""

import click

import compass


@click.command()
def command() -> object:
    """Print the versions of compass and of what it runs on."""
    return compass.version()
