"""Who stands alone: shares and percentiles of which nothing says how well they are known."""

import re

#: Names of shares and percentiles: of values, not of what was asked or of what knows them.
NAMED = re.compile(r"(^|_)(share|availability|fraction|p\d\d?|median|within_3_sigma)(_|$)")
BESIDE = ("_bracket", "_interval", "_sampling", "_error")


def unknown(found, covered=frozenset(), path=""):
    """Paths of shares and percentiles that nothing says how well they are known.

    What knows them stands beside them as `BESIDE`, is called ``sampling``, or is the ``evidence``
    of an object that they are in: a sentence on all of it, or by names, ``others`` the rest.
    """
    if isinstance(found, list):
        return [bad for k, one in enumerate(found) for bad in unknown(one, covered, f"{path}[{k}]")]
    if not isinstance(found, dict):
        return []
    told = found.get("evidence")
    known = covered | ({"others"} if isinstance(told, str) and told else set(told or ()))
    bad = []
    for key, value in found.items():
        here = f"{path}.{key}".lstrip(".")
        if key in ("evidence", "sampling", "provenance") or key.endswith(BESIDE):
            continue
        beside = any(f"{key}{ending}" in found for ending in BESIDE) or key in found.get(
            "sampling", ()
        )
        within = "others" in known or any(here.endswith(name) for name in known)
        if beside or within or key in known:
            continue
        if NAMED.search(key) and value is not None:
            bad.append(here)
        else:
            bad += unknown(value, known, here)
    return bad


def unknown_variables(dataset):
    """Variables of a dataset that are shares or percentiles and stand alone.

    What knows them are attributes, of their own or of the dataset for all that say no other, or a
    variable beside them.
    """
    if {"evidence", "sampled"} & set(dataset.attrs):
        return []
    own = {"evidence", "sampled_over", "ancillary_variables"}
    return [
        name
        for name, variable in dataset.data_vars.items()
        if NAMED.search(name)
        and not name.endswith(BESIDE)
        and not own & set(variable.attrs)
        and bool(variable.notnull().any())
        and f"{name}_low" not in dataset
        and f"{name}_sampling" not in dataset
    ]
