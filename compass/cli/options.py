"""Arguments and options as commands declare them; what several share is written once."""

from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import Any

import click

from compass.errors import SHORT, near

Decorator = Callable[..., Any]


class Word(click.Choice[str]):
    """One of some words; the one that a mistyped word is near is offered."""

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> str:
        """Return the word; refuse one that is none of them."""
        try:
            return super().convert(value, param, ctx)
        except click.BadParameter as error:
            self.fail(error.message + meant(str(value), self.choices), param, ctx)


def meant(word: str, known: Iterable[str]) -> str:
    """The question whether a near word was meant, if there is one."""
    return "".join(f" Did you mean '{w}'?" for w in near(word, known, likeness=SHORT))


def _option(names: Sequence[str], kind: Any, help: str, default: Any, more: dict[str, Any]) -> Any:
    """Make an option whose help says what it is by default, where that is anything."""
    shown = {} if default is None else {"default": default, "show_default": True}
    return click.option(*names, type=kind, help=help, **shown, **more)


def real(*names: str, help: str, default: Any = None, **more: Any) -> Decorator:
    """Take a real number; several with `nargs`."""
    return _option(names, float, help, default, more)


def whole(*names: str, help: str, default: int | None = None, **more: Any) -> Decorator:
    """Take a whole number; several with `nargs`."""
    return _option(names, int, help, default, more)


def path(*names: str, help: str, **more: Any) -> Decorator:
    """Take the path of a file or folder."""
    return _option(names, click.Path(path_type=Path), help, None, more)


def choice(
    *names: str, among: Sequence[str], help: str, default: str | None = None, **more: Any
) -> Decorator:
    """Take one of some words."""
    return _option(names, Word(among), help, default, more)


_FILE = click.Path(path_type=Path)
design_argument = click.argument("design", type=_FILE)
designs_argument = click.argument("designs", nargs=-1, required=True, type=_FILE)
scenario_argument = click.argument("scenario", type=_FILE)
kind_argument = click.argument("kind", type=Word(["design", "scenario", "study"]))

figures_option = path("--figures", help="Folder to write the pictures (SVG, maps PNG) into.")
fold_option = whole("--fold", help="Satellites in view at once; else the design's.")
mask_option = real("--mask-deg", help="Elevation mask, degrees; else the design's.")
motion_option = choice(
    "--motion",
    among=("two-body", "j2", "numerical"),
    help="How the satellites move; else as the design says.",
)
region_option = click.option(
    "--region", help="lat:MIN:MAX or polygon:LAT,LON;LAT,LON;..., degrees; else everywhere."
)
start_day_option = real("--start-day", default=0.0, help="Day after the epoch to begin at.")
stations_option = click.option(
    "--station",
    "stations",
    multiple=True,
    metavar="NAME=LAT,LON[,MASK]",
    help="A station beside the designs': planetocentric latitude, east longitude, mask; degrees.",
)


def _radii(_context: click.Context, _option: click.Parameter, text: str | None) -> Sequence[float]:
    from compass.api.radii import read_radii

    return () if text is None else read_radii(text)


radii_option = click.option(
    "--radius-km",
    callback=_radii,
    help="Also how long it lasts at other radii: FIRST..LAST:STEP, or A,B,C, km.",
)


def area_options(command: Decorator) -> Decorator:
    """Add the options that say at which sites and in which regions figures are wanted."""
    for option in (
        click.option(
            "--region",
            "regions",
            multiple=True,
            metavar="REGION",
            help="A region: globe, lat:MIN:MAX or polygon:LAT,LON;LAT,LON;..., degrees; also many.",
        ),
        click.option(
            "--site",
            "sites",
            multiple=True,
            metavar="SITE",
            help="A site: the name of a [[station]], or NAME=LAT,LON[,MASK], degrees; also many.",
        ),
    ):
        command = option(command)
    return command


def certified_options(command: Decorator) -> Decorator:
    """Add the options of whatever is found between proven bounds."""
    for option in (
        path(
            "--leaves",
            help="File of open boxes: what it holds of the same question is gone on from, and what "
            "is left open is kept there.",
        ),
        real("--budget-s", help="Seconds for each figure between bounds."),
        real("--width", help="How near bounds of a share are to come, such as 1e-5 for 0.001 %."),
    ):
        command = option(command)
    return command


def cluster_options(command: Decorator) -> Decorator:
    """Add the options of whatever a Dask cluster can do."""
    for option in (
        path("--tls-key", help="Own key (PEM)."),
        path("--tls-cert", help="Own certificate (PEM)."),
        path("--tls-ca", help="Certificate of the cluster's authority (PEM)."),
        click.option("--scheduler", help="Address of a Dask scheduler, such as tcp://host:8786."),
    ):
        command = option(command)
    return command
