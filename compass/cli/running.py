"""How a command runs: its function is called, and what an option names is written of its result."""

import inspect
from collections.abc import Callable
from functools import partial
from typing import Any

import compass
from compass.cli.shared import (
    command_line,
    put,
    put_pictures,
    say,
    silence_the_cluster,
    watched,
)

#: Methods of results, by the option that names the file or folder which they write.
WRITERS = {
    "elements": "write_elements",
    "oem": "write_orbits",
    "output": "write",
    "picture": "save_plot",
}


def called(command: str, **given: Any) -> Any:
    """Call the function of a command, write what is asked for of its result, and return that."""
    if given.get("scheduler") is not None:
        silence_the_cluster()
    given |= {"command": command_line(), "progress": watched(), "notice": say}

    def fitting(function: Callable[..., Any], *first: object) -> Any:
        """Call a function with those of the arguments given that it has names for."""
        taken = inspect.signature(function).parameters
        return function(*first, **{name: given[name] for name in given if name in taken})

    function = getattr(compass, command)
    taken = inspect.signature(function).parameters
    result = fitting(function, *(() if "designs" in taken else given.get("designs", ())))
    for option, writer in WRITERS.items():
        if option not in taken and given.get(option) is not None:
            put(partial(fitting, getattr(result, writer)), given[option])
    if given.get("figures") is not None:
        put_pictures(result.pictures, given["figures"])
    return result
