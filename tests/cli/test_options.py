"""Options against the functions that they give arguments to: the same names, defaults and words."""

import inspect
from typing import Literal, get_args, get_origin, get_type_hints

import click
import click.shell_completion
import pytest

import compass
from compass.cli import main as program
from compass.cli.options import OPTIONS
from compass.cli.running import WRITERS
from compass.cli.special import SPECIAL

COMMANDS = program.program.list_commands(click.Context(program.program))


def plain(default):
    """A default as both write it; none is None, nothing, no, or a mark of the library's own."""
    return default if default and isinstance(default, float | int | str | tuple) else None


def words_of(hint):
    """The words that a hint allows, of its own or among others."""
    kinds = [hint, *get_args(hint)]
    return {word for kind in kinds if get_origin(kind) is Literal for word in get_args(kind)}


def taken_by(function):
    """Names of what a function takes."""
    return set(inspect.signature(function).parameters) if function else set()


def written(name):
    """Options of what is written of a command's result, and names of what the writers take."""
    hint = get_type_hints(inspect.unwrap(getattr(compass, name)))["return"]
    options = {"figures"} if hasattr(hint, "pictures") else set()
    for option, method in WRITERS.items():
        for result in get_args(hint) or (hint,):
            if hasattr(result, method):
                options |= {option, *taken_by(getattr(result, method))}
    return options


@pytest.mark.parametrize("name", COMMANDS)
def test_an_option_is_by_default_what_the_functions_argument_is(name):
    command = program.program.get_command(None, name)
    context = click.Context(command)
    arguments = inspect.signature(getattr(compass, name)).parameters
    own = written(name) | taken_by(SPECIAL.get(name))
    for option in command.params:
        if not isinstance(option, click.Option) or not option.expose_value:
            continue
        if option.name not in arguments:
            assert option.name in own, f"{name}: nobody takes {option.opts}"
            continue
        argument = arguments[option.name]
        assert plain(option.get_default(context)) == plain(argument.default), option.name
        assert not option.required or plain(argument.default) is None, option.name
        if isinstance(option.type, click.Choice) and words_of(argument.annotation):
            assert set(option.type.choices) <= words_of(argument.annotation), option.name


def test_every_option_told_of_is_taken():
    taken = set()
    for name in COMMANDS:
        given = {parameter.name for parameter in program.program.get_command(None, name).params}
        own = {f"{name}.{each}" for each in given}
        taken |= own & OPTIONS.keys() | {each for each in given if f"{name}.{each}" not in OPTIONS}
    assert OPTIONS.keys() <= taken


def test_a_range_shown_is_the_commands_own(run):
    """What a command means by a name is another range than others have."""
    code, out, _ = run("series", "--help")
    assert code == 0 and "[2 to 1000000]" in " ".join(out.split())


@pytest.mark.parametrize(
    ("words", "completed"),
    [
        (["study", "--from", "st"], {"study-small", "study-fourfold"}),
        (["study", "--from", ""], {"study-small", "study-fourfold"}),
        (["--from", "study-s"], {"study-small"}),
        (["design", "--from", "compass"], {"compass-15-5-1"}),
        (["design", "--from", "./mine"], {"./mine"}),
    ],
)
def test_the_shell_completes_names_of_what_comes_along(words, completed):
    *before, begun = words
    shell = click.shell_completion.BashComplete(program.program, {}, "compass", "_COMPLETE")
    found = shell.get_completions(["new", *before], begun)
    assert {item.value for item in found} == completed
    assert {item.type for item in found} == ({"file"} if "./" in begun else {"plain"})
