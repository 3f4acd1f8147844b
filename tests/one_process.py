"""A study in the process of its test, which can see what happens and stand in for parts of it."""

import math

from compass.core.compiling import worked
from compass.study.stages import evaluate


class OneProcess:
    """Workers as of `compass.study.workers.Workers` that are no processes of their own."""

    count = 1

    def __init__(self, study):
        self._study = study

    def run(self, stage, batches, until=math.inf):
        for rows in batches:
            yield rows, evaluate(stage, self._study, rows)

    def now(self):
        return worked()

    def close(self):
        pass
