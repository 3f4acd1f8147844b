"""Pictures as files of their own, for commands that make no page."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from compass.document.blocks import Picture
from compass.errors import OutputError
from compass.saving import check_writable, replacing

if TYPE_CHECKING:
    from matplotlib.axes import Axes

#: Of pictures that stand alone, finer than those of a page.
FILE_DPI = 150


def save_axes(axes: "Axes", path: str | Path, **options: Any) -> None:
    """Write the figure of some axes as a PNG file; a killed run leaves no partial one.

    Options are those of its ``savefig``.

    Raises
    ------
    OutputError
        The file cannot be written.
    """
    from matplotlib.figure import Figure

    figure = axes.figure
    assert isinstance(figure, Figure)
    with replacing(Path(path)) as temporary:
        figure.savefig(temporary, format="png", dpi=FILE_DPI, **options)


def check_folder(folder: Path) -> None:
    """Refuse a folder for pictures before any work is spent on it.

    Raises
    ------
    OutputError
        The path is a file, or cannot be written into or made.
    """
    if folder.exists() and not folder.is_dir():
        raise OutputError(f"{folder}: is a file; give a folder for the pictures")
    check_writable(folder / "picture.png" if folder.is_dir() else folder)


def write_pictures(pictures: Sequence[Picture], folder: Path) -> None:
    """Write each picture as ``STEM.svg`` or ``STEM.png`` into `folder`.

    The folder is made if its parent exists.

    Raises
    ------
    OutputError
        The folder cannot be made or written into.
    """
    try:
        folder.mkdir(exist_ok=True)
    except OSError as error:
        raise OutputError(f"{folder}: cannot be made: {error.strerror or error}") from error
    for image in pictures:
        with replacing(folder / image.file_name) as temporary:
            temporary.write_bytes(image.drawn)
