"""Maps whose rows a cluster does: the same bytes, whoever finishes first; what it tells."""

import pickle

import pytest

import compass
from compass import Mask
from compass.design import Design
from compass.errors import CompassError
from compass.integrity import Integrity
from compass.ranging import Receiver, Signal
from compass.study.map_cluster import by_cluster
from compass.study.mapping import MapOptions, MapRows, make_map

SIGNAL = Signal(ephemeris=(2, 8, 5), clock_sigma=3, receiver=Receiver(0.5, 0.5), ionosphere=1.0)
OPTIONS = MapOptions(step_deg=45, epochs=3, duration_h=1)


@pytest.fixture(scope="module")
def design():
    c = compass.walker_delta(9, 3, 1, inclination_deg=50, radius_km=20427)
    return Design(c, name="d", mask=Mask.of(5), signal=SIGNAL, integrity=Integrity())


class Backwards:
    """Workers far away: what they know comes as bytes, and the last block is finished first."""

    def __init__(self, rows, lethal=None):
        self.sent, self.lethal, self.kinds = pickle.dumps(rows), lethal, []

    def run(self, kind, blocks):
        self.kinds.append(kind)
        there = pickle.loads(self.sent)
        for rows in reversed(list(blocks)):
            died = self.lethal in rows.tolist()
            yield rows, None if died else there(kind, rows)


def test_rows_done_elsewhere_make_the_same_map(design):
    teams, done = [], []

    def by(rows):
        teams.append(Backwards(rows))
        return by_cluster(teams[0], done.append)

    here, there = make_map(design, OPTIONS), make_map(design, OPTIONS, by=by)
    for made in (here, there):
        made.dataset.attrs.pop("history")  # the moment
    assert here.dataset.identical(there.dataset)
    assert teams[0].kinds == ["gaps", "counts", "errors", "protection"]
    assert sum(done) == 3 * 4


def test_rows_that_kill_whoever_does_them_are_told(design):
    def by(rows):
        return by_cluster(Backwards(rows, lethal=2), lambda rows: None)

    with pytest.raises(CompassError, match=r"workers died of row 2 of the map: .* larger cells"):
        make_map(design, OPTIONS, by=by)


def test_what_is_sent_is_the_design_and_the_options_alone(design):
    rows = MapRows(design, OPTIONS)
    before = len(pickle.dumps(rows))
    assert rows.view.r.size  # made, and not sent
    assert len(pickle.dumps(rows)) == before
