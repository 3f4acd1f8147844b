import pytest

from compass.inputs.study import read_study_text

TEXT = """
name = "tiny"
[study]
patterns = ["walker-delta"]
satellites = [5, 6, 7]
inclination_deg = [40, 55]
orbits = ["areosynchronous"]
mask_deg = 5
fold = {fold}
{more}
[map]
step_deg = 45
epochs = 2
[[constraint]]
figure = "fold_proven"
at_least = 1
[[objective]]
figure = "satellites"
[[objective]]
figure = "mask_margin_deg"
"""

ENTRY = """
[entry]
scenario = "entry-compass.toml"
samples = 4
finalists = 3
[compare]
design = "compass-15-5-1.toml"
"""


@pytest.fixture
def tiny(designs):
    """Give a study of 52 candidates."""

    def make(more="", fold=1, entry=False):
        text = TEXT.format(more=more, fold=fold) + (ENTRY if entry else "")
        return read_study_text(text, "tiny.toml", designs)

    return make
