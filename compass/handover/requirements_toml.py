"""Tables ``[[requirement]]`` of a design file."""

from collections.abc import Iterable

import numpy as np

from compass.design import Requirement
from compass.handover.decimals import decimal, number
from compass.inputs.toml_values import toml_text, toml_value


def requirement_lines(requirements: Iterable[Requirement]) -> list[str]:
    """Lines that read back as the same requirements."""
    lines = []
    for wanted in requirements:
        lines += ["", "[[requirement]]", f"name = {toml_text(wanted.name)}"]
        if wanted.sites:
            lines.append(f"sites = {toml_value([site.name for site in wanted.sites])}")
        if wanted.regions:
            lines.append(f"region = {toml_value(list(wanted.regions))}")
        if wanted.fold is not None:
            lines.append(f"fold = {wanted.fold}")
        if wanted.mask is not None:
            mask = decimal(float(np.degrees(wanted.mask)), np.radians, wanted.mask)
            lines.append(f"mask_deg = {mask}")
        lines += [f"{name}_at_most = {number(limit)}" for name, limit in wanted.limits]
        if wanted.share < 1.0:
            lines.append(f"share = {number(wanted.share)}")
        if wanted.share_of != "time":
            lines.append(f"share_of = {toml_text(wanted.share_of)}")
        if wanted.altitude:
            height = decimal(wanted.altitude / 1e3, lambda km: km * 1e3, wanted.altitude)
            lines.append(f"altitude_km = {height}")
        if wanted.losses:
            lines.append(f"losses = {wanted.losses}")
    return lines
