"""What a cluster's machine is asked to do, sent with its code: the machine may lack this package.

A function that is sent by its name takes down a worker that cannot import it. These are sent by
value, so they import inside, and use nothing of this file but themselves.
"""

import pickle
from collections.abc import Callable
from typing import Any


def able() -> str:
    """Return what keeps this machine from the work; nothing if it can do it."""
    try:
        import compass
        import compass.study.cluster
        import compass.study.stages
    except ImportError as error:
        return f"no package {error.name}" if error.name else str(error)
    return compass.__version__


def work(version: str, stage: str, job: bytes, rows: bytes) -> Any:
    """Do a part of a job, with the client's version or not at all."""
    try:
        import compass
        from compass.study.cluster import evaluated
    except ImportError as error:
        from distributed import get_worker

        raise RuntimeError(f"{get_worker().address}: no package {error.name}") from None
    if version != compass.__version__:
        from distributed import get_worker

        raise RuntimeError(
            f"{get_worker().address}: compass {compass.__version__}, this is {version}"
        )
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
