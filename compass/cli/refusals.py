"""What a command refuses before any work is spent, and every refusal in words of the user."""

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import click
from click.core import ParameterSource

from compass.cli.parameters import Told
from compass.errors import ArgumentError
from compass.saving import check_ending, check_new_folder, check_writable


def check_given(given: Mapping[str, Any], told: Mapping[str, Told]) -> None:
    """Refuse outputs that cannot be written, and what says nothing without something else."""
    for name in told:
        if given[name] is not None and "endings" in told[name]:
            check_ending(given[name], told[name]["endings"])
    files = [given[name] for name in told if given[name] and "reads" in told[name]]
    inputs = [Path(f) for file in files for f in (file if isinstance(file, tuple) else [file])]

    def those(kind: str) -> list[Path]:
        return [given[name] for name in told if given[name] and told[name].get("writes") == kind]

    check_outputs(*those("file"), folders=those("folder"), inputs=inputs)
    for new in those("new folder"):
        check_new_folder(new)
    for name in told:
        if "needs" in told[name]:
            _check_needed(name, given, *told[name]["needs"])


def _check_needed(name: str, given: Mapping[str, Any], other: str, words: str) -> None:
    """Refuse an option that says nothing without another that is not given."""
    context = click.get_current_context()
    asked = context.get_parameter_source(name) is ParameterSource.COMMANDLINE
    if asked and given[other] in (None, False):
        [option] = [max(p.opts, key=len) for p in context.command.params if p.name == name]
        shown = "" if given[name] is True else f" {given[name]}"
        raise ArgumentError(f"{option}{shown}: needs {words}")


def check_outputs(
    *outputs: Path, folders: Iterable[Path] = (), inputs: Sequence[Path] = ()
) -> None:
    """Refuse files to write before any work is spent on them.

    Neither the inputs may be written over, nor files that they name: a scenario's constellation.

    Raises
    ------
    ArgumentError
        Two are the same.
    OutputError
        As `compass.saving.check_writable` and, of folders, `compass.pictures.files.check_folder`.
    """
    read = list(inputs)
    if any(output.is_file() for output in outputs):
        from compass.inputs.reading import named_files

        files = (source for source in inputs if source.suffix == ".toml" and source.is_file())
        read += [other for source in files for other in named_files(source)]
    for output in outputs:
        if outputs.count(output) > 1:
            raise ArgumentError(f"{output}: is two outputs at once; give another name")
        check_writable(output, read)
    for folder in folders:
        from compass.pictures.files import check_folder

        check_folder(folder)


def in_words_of_the_user(message: str, context: click.Context) -> str:
    """Name the option that a message is about; else the file, if there is one and it does not."""
    heads = re.match(r"\w+(?:(?:, | and )\w+)*(?=[ :])", message)
    names = re.split(", | and ", heads[0]) if heads else []
    parameters = context.command.params
    for parameter in parameters:
        if context.get_parameter_source(parameter.name or "") is not ParameterSource.COMMANDLINE:
            continue
        option = max(parameter.opts, key=len)
        words = option.removeprefix("--").replace("-", "_") + "_"
        if len(names) > 1 and parameter.name in names:  # arguments, which no file has
            return _with_options(message, parameters)
        if len(names) == 1 and (parameter.name == names[0] or words.startswith(f"{names[0]}_")):
            message = option + message[len(names[0]) :]  # its unit may be left out
            break
    files = list(_files(context))
    if not files:
        return _with_options(message, parameters)
    if message.startswith("--") or any(file in message for file in files):
        return message
    return f"{', '.join(files)}: {message}"


def _files(context: click.Context) -> Iterator[str]:
    """Names of the files that a command was given, the outputs of options apart."""
    for parameter in context.command.params:
        if isinstance(parameter, click.Argument):
            given = context.params.get(parameter.name or "")
            for value in given if isinstance(given, tuple) else (given,):
                if isinstance(value, Path):
                    yield str(value)


def _with_options(message: str, parameters: list[click.Parameter]) -> str:
    """Name the options wherever their names stand: there is no file that they could be keys of."""
    names = {p.name: max(p.opts, key=len) for p in parameters if isinstance(p, click.Option)}
    name = "|".join(sorted(map(str, names), key=len, reverse=True))
    # names that are words of the language as well are taken for names in a list of such alone
    told = rf"(?<![-\w])(?:(?:{name})(?:(?:, | and )(?:{name}))+|\w+_\w+)\b"
    message = re.sub(
        told, lambda part: re.sub(r"\w+", lambda w: names.get(w[0], w[0]), part[0]), message
    )
    first = re.match(r"\w+(?=[ :])", message)
    return names.get(first[0], first[0]) + message[first.end() :] if first else message
