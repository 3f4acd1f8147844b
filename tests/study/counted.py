"""The program, noting down every candidate that it evaluates: who computes what, and how often.

Run as ``python counted.py trade ...`` or as ``dask worker --preload counted.py``; worker processes
of the program load it again. Each evaluation is a line, written at once, of the file that the
environment names: stage and candidates. Of the candidate that it calls lethal the process dies.
A batch takes PAUSE seconds more, so that a study is not over before it can be disturbed, however
busy the machine is.
"""

import os
import time

from compass.study import order, stages
from compass.study.candidates import identities

PAUSE = 0.2

# Dask loads this twice
_evaluate = getattr(stages.evaluate, "uncounted", stages.evaluate)


def evaluate(stage, study, rows):
    keys = identities(rows)
    line = " ".join([stage, *keys]) + "\n"
    handle = os.open(os.environ["EVALUATIONS"], os.O_WRONLY | os.O_APPEND | os.O_CREAT)
    os.write(handle, line.encode())
    os.close(handle)
    if os.environ.get("LETHAL") in keys:
        os._exit(9)
    time.sleep(PAUSE if len(keys) > 1 else 0)  # not for those tried one by one
    return _evaluate(stage, study, rows)


evaluate.uncounted = _evaluate
stages.evaluate = evaluate  # before anyone imports it from there
order.LEVELS = order.DRAWS = {}  # proven bounds take longer than all that is disturbed here

if "SILENCE" in os.environ:  # so that a test need not wait for half a minute
    from compass.study import cluster

    cluster.SILENCE, cluster.WATCH = float(os.environ["SILENCE"]), 1.0

if __name__ == "__main__":
    from contextlib import nullcontext

    from compass.cli.main import main
    from compass.study import workers

    workers._callers_script_hidden = nullcontext  # processes of this one count as well

    main()
