"""How much memory there is: the least of what machine, container and user allow."""

import os
import resource

import pytest

from compass import memory
from compass.errors import ArgumentError


@pytest.mark.parametrize(
    ("container", "user", "least"),
    [("max", None, None), ("5000000", None, 5e6), ("5000000", 4e6, 4e6), ("none", 6e6, 6e6)],
)
def test_the_least_limit_counts(monkeypatch, tmp_path, container, user, least):
    own = resource.RLIM_INFINITY if user is None else int(user)
    monkeypatch.setattr(resource, "getrlimit", lambda kind: (own, resource.RLIM_INFINITY))
    file = tmp_path / "memory.max"
    file.write_text(container + "\n")
    monkeypatch.setattr(memory, "CONTAINER", (tmp_path / "missing", file))
    machine = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    there = machine if least is None else least
    memory.check_fits(0.89 * there, "it", "take less")
    with pytest.raises(ArgumentError, match=r"it would take .* GB of memory, there are .*; take"):
        memory.check_fits(0.91 * there, "it", "take less")
