"""Horizons from logged codes of an open site: what a rule would pick, shown before it is taken."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from geofit.data.errors import InputError
from geofit.data.messages import message
from geofit.data.points import PointSet
from geofit.data.site import Site
from geofit.io.added_tables import tables_text, with_tables
from geofit.io.contact_rules import ContactRule
from geofit.io.contacts import load_rule
from geofit.io.journal import Journal
from geofit.io.source import Source

__all__ = ["Code", "RulePicks", "codes_of", "horizon_table", "picks_of"]


@dataclass(frozen=True)
class Code:
    """A code of the interval logs: in how many holes and intervals it is, its metres, its mean elevation (m)."""

    code: str
    holes: int
    intervals: int
    metres: float
    elevation: float


@dataclass(frozen=True, eq=False)
class RulePicks:
    """What a rule picks: points, holes that carry the codes, and holes without a certain contact."""

    points: PointSet
    carrying: int
    unseen: int


def codes_of(site: Site) -> tuple[Code, ...]:
    """Return the codes of all interval logs, the highest first."""
    holes: dict[str, set[str]] = {}
    thickness: dict[str, list[float]] = {}
    height: dict[str, list[float]] = {}
    for campaign in site.boreholes:
        for log in campaign.logs:
            for hole in np.unique(log.hole):
                of = log.hole == hole
                middle = campaign.paths[str(hole)].at((log.top[of] + log.base[of]) / 2)[:, 2]
                for code, metres, z in zip(log.code[of].tolist(), log.base[of] - log.top[of], middle, strict=True):
                    holes.setdefault(code, set()).add(str(hole))
                    thickness.setdefault(code, []).append(float(metres))
                    height.setdefault(code, []).append(float(z))
    found = [
        Code(code, len(holes[code]), len(metres), sum(metres), float(np.mean(height[code])))
        for code, metres in thickness.items()
    ]
    return tuple(sorted(found, key=lambda one: (-one.elevation, one.code)))


def picks_of(site: Site, rule: ContactRule) -> RulePicks:
    """Return what a rule picks of the interval logs of a site.

    Raises
    ------
    InputError
        If no interval has a code of the rule.
    """
    sets, carrying = [], set[str]()
    for campaign in site.boreholes:
        if any(np.isin(log.code, rule.codes).any() for log in campaign.logs):
            sets.append(load_rule(campaign, rule, Journal()))
            for log in campaign.logs:
                carrying |= set(log.hole[np.isin(log.code, rule.codes)].tolist())
    if not sets:
        raise InputError(
            message("project.no-code-of-rule", "No interval has the code {code}", code=rule.label),
            message("data.name-one", "Name one of them."),
        )
    points = PointSet.concatenate(sets)
    return RulePicks(points, len(carrying), len(carrying - set(points.hole.tolist())))


def horizon_table(name: str, rule: ContactRule, site_file: Path, site: Site, added: Sequence[str]) -> str:
    """Return the [[horizon]] table of a rule as TOML, to be added to those of the site file.

    Where the site file has no [[horizon]] table, every name of its files makes a horizon; they are named along with
    the new table, or they would be lost.
    """
    stated = with_tables(Source(path=site_file).read(), added, site_file.name)
    table: dict[str, Any] = {"name": name, rule.limit: list(rule.codes) if len(rule.codes) > 1 else rule.codes[0]}
    if rule.occurrence is not None:
        table["occurrence"] = rule.occurrence
    if rule.thinner > 0:
        table["thinner"] = rule.thinner
    others = [] if "horizon" in stated else [("[[horizon]]", {"name": other}) for other in site.horizons]
    return tables_text([*others, ("[[horizon]]", table)])
