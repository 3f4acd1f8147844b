from compass.papers.montenbruck2018 import rows
from compass.papers.verdict import Verdict


def test_the_printed_weights_are_reproduced_and_mars_stands_beside_them():
    verdicts = [row.verdict for row in rows()]
    assert verdicts.count(Verdict.REPRODUCED) == 6
    assert verdicts.count(Verdict.COMPUTED) == 4 and len(verdicts) == 10
