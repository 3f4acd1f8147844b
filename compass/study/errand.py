"""What a cluster's machine is asked to do, sent with its code: the machine may lack this package.

A function that is sent by its name takes down a worker that cannot import it. These are sent by
value, so they import inside.
"""

import pickle
from collections.abc import Callable
from typing import Any


def able() -> str:
    """Return the version of this package on this machine; or what keeps it from the work."""
    import sys

    try:
        import compass
        import compass.study.cluster
        import compass.study.stages
    except Exception as error:  # of whatever a machine may lack, or have instead
        name = getattr(error, "name", None)
        if not name:
            return " ".join(f"cannot import compass: {error}".split())
        there = sys.modules.get("compass")
        place = getattr(there, "__file__", None) or next(iter(getattr(there, "__path__", ())), None)
        other = f", and {place} is another compass" if name.startswith("compass.") else ""
        return f"no package {name}{other}"
    return compass.__version__


def work(version: str, stage: str, job: bytes, rows: bytes) -> Any:
    """Do a part of a job, with the client's version or not at all."""
    if (found := able()) != version:
        from distributed import get_worker

        said = found if " " in found else f"compass {found}, this is {version}"
        raise RuntimeError(f"{get_worker().address}: {said}")
    from compass.study.cluster import evaluated

    return evaluated(stage, job, rows)


class ByValue:
    """A function of this file that takes its code along when it is pickled."""

    def __init__(self, function: Callable[..., Any]) -> None:
        import cloudpickle

        from compass.study import errand

        self.__name__ = function.__name__
        cloudpickle.register_pickle_by_value(errand)
        try:
            self._code = cloudpickle.dumps(function)
        finally:
            cloudpickle.unregister_pickle_by_value(errand)

    def __reduce__(self) -> tuple[Any, ...]:
        return pickle.loads, (self._code,)

    def __call__(self, *arguments: Any) -> Any:
        """As the function."""
        return pickle.loads(self._code)(*arguments)
