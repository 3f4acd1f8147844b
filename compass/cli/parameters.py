"""How an option or argument is told of, and how a command takes those of `compass.cli.options`."""

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

import click
import click.shell_completion

from compass.errors import SHORT, near

#: What is told of an option that click does not know: whether it is a file to read, or a file or
#: folder to write, and with which endings; what else must be given for it to say anything.
OURS = ("reads", "writes", "endings", "needs")

#: Names that are not made of the library's.
_FLAGS = {"output": "-o --output", "picture": "--figure"}

#: What click is told of an option or argument, and ``flags``: its names where they are not made of
#: the library's, None of an argument.
Told = dict[str, Any]


class Word(click.Choice[str]):
    """One of some words; the one that a mistyped word is near is offered."""

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> str:
        """Return the word; refuse one that is none of them."""
        try:
            return super().convert(value, param, ctx)
        except click.BadParameter as error:
            self.fail(error.message + meant(str(value), self.choices), param, ctx)


class WholeNumber(click.types.IntParamType):
    """Whole numbers that a kernel can take: of 64 bits, which no help needs to recite."""

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """Return the number; refuse one that is too large."""
        number = super().convert(value, param, ctx)
        if not -(2**63) <= number < 2**63:
            self.fail(f"{number} is not in the range -2**63 to 2**63 - 1.", param, ctx)
        return number


def meant(word: str, known: Iterable[str]) -> str:
    """The question whether a near word was meant, if there is one."""
    return "".join(f" Did you mean '{w}'?" for w in near(word, known, likeness=SHORT))


def argument(**more: Any) -> Told:
    """Tell of what is given without a name: the path of a file, or what is said."""
    return {"type": click.Path(path_type=Path), "flags": None, "reads": True, **more}


def text(help: str, default: Any = None, **more: Any) -> Told:
    """Tell of an option with one text; what it is by default is shown where that is anything."""
    shown = {} if default is None else {"default": default, "show_default": True}
    return {"help": help, **shown, **more}


def several(name: str, help: str) -> Told:
    """Tell of one that may be given many times, with the form of what it takes in its `name`."""
    flags, metavar = name.split()
    return text(help, flags=flags, metavar=metavar, multiple=True)


def real(help: str, default: Any = None, **more: Any) -> Told:
    """Tell of a real number; of several with `nargs`."""
    return text(help, default, type=float, **more)


def whole(help: str, default: int | None = None, **more: Any) -> Told:
    """Tell of a whole number; of several with `nargs`."""
    return text(help, default, type=WholeNumber(), **more)


def path(help: str, **more: Any) -> Told:
    """Tell of the path of a file or folder."""
    return text(help, type=click.Path(path_type=Path), **more)


def source(help: str, **more: Any) -> Told:
    """Tell of a file to read: nothing that is written may be it."""
    return path(help, reads=True, **more)


def output(help: str, endings: Sequence[str] = (), **more: Any) -> Told:
    """Tell of a file to write, with one of some endings if any are told.

    That it can be written is looked at before any work is done.
    """
    if endings:
        help, more = f"{help}: {', '.join(endings)}.", {"endings": endings, **more}
    return path(help, writes="file", **more)


def new_folder(help: str, **more: Any) -> Told:
    """Tell of a folder to make, likewise."""
    return path(help, writes="new folder", **more)


def folder(help: str, **more: Any) -> Told:
    """Tell of a folder to write pictures into, likewise."""
    return path(help, writes="folder", **more)


def choice(among: Sequence[str], help: str, default: str | None = None, **more: Any) -> Told:
    """Tell of one of some words."""
    return text(help, default, type=Word(among), **more)


def flag(help: str, **more: Any) -> Told:
    """Tell of a yes that is no where it is left out."""
    return text(help, is_flag=True, **more)


def radii(_context: click.Context, _option: click.Parameter, given: str | None) -> Sequence[float]:
    """Radii in a row or one by one."""
    from compass.api.radii import read_radii

    return () if given is None else read_radii(given)


def radius(_context: click.Context, _option: click.Parameter, given: str | None) -> object:
    """One radius, or the least and the greatest."""
    if given is None:
        return None
    try:
        numbers = tuple(float(part) for part in given.split(":"))
    except ValueError:
        numbers = ()
    if len(numbers) in (1, 2):
        return numbers if len(numbers) == 2 else numbers[0]
    raise click.BadParameter(f"{given!r} is not a number or LEAST:MOST, such as 9000:26000.")


def listed(_context: click.Context, _option: click.Parameter, given: str | None) -> Sequence[str]:
    """Names between commas."""
    return [name.strip() for name in (given or "").split(",") if name.strip()]


def shipped(
    context: click.Context, _option: click.Parameter, begun: str
) -> list[click.shell_completion.CompletionItem]:
    """What completes a name of a file that comes with compass: names of the kind, or a path."""
    from compass.inputs.shipped import MODELS, names

    item = click.shell_completion.CompletionItem
    # what precedes an option without its value yet is left over
    said = [context.params.get("kind"), *context.args]
    kinds = [kind for kind in MODELS if kind in said] or list(MODELS)
    known = [name for each in kinds for name in names(each) if name.startswith(begun)]
    return [item(name) for name in known] or [item(begun, type="file")]


def parameter(name: str, told: Told) -> click.Parameter:
    """Return what click makes of an argument or option that gives a function's argument."""
    told = {key: told[key] for key in told if key not in OURS}
    flags = told.pop("flags", _FLAGS.get(name, "--" + name.replace("_", "-")))
    if flags is None:
        return click.Argument([name], **told)
    return click.Option([*flags.split(), name], **told)
