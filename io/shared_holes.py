"""Holes that are in several collar tables of one site."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.spatial import cKDTree

from geofit.data.messages import EMPTY, Untranslated, message, plural_message, some_of
from geofit.io.boreholes import Boreholes
from geofit.io.journal import Journal
from geofit.io.rows import name_key

__all__ = ["warn_of_shared_holes", "warn_of_twins"]

#: Collars are written in centimetres: smaller distances are none, metres.
SAME_COLLAR = 0.005
#: No two holes begin so near to each other, which is their own diameter, and keep together down to the end of the
#: shorter one: metres, and a share of the depth there.
TWIN, TOGETHER, TOGETHER_SHARE = 0.15, 0.5, 0.01
#: Pairs of them that a warning names.
NAMED = 5


def warn_of_shared_holes(campaigns: Sequence[Boreholes], journal: Journal) -> None:
    """Warn of each two collar tables that have holes of the same names, with the largest distance of their collars."""
    for k, later in enumerate(campaigns):
        for earlier in campaigns[:k]:
            before = {name_key(name): path.xyz[0] for name, path in earlier.paths.items()}
            pairs = [
                (before[name_key(name)], path.xyz[0]) for name, path in later.paths.items() if name_key(name) in before
            ]
            if not pairs:
                continue
            apart = float(max(np.linalg.norm(one - other) for one, other in pairs))
            used = [campaign.collar for campaign in (earlier, later) if campaign.logs]
            reason = plural_message(
                "io.holes-in-two-collar-tables",
                "{count} hole is in {file} too, {where}{logs}",
                "{count} holes are in {file} too, {where}{logs}",
                count=len(pairs),
                file=Untranslated(earlier.collar),
                where=message("io.collars-apart", "up to {distance:.2f} m away", distance=apart)
                if apart > SAME_COLLAR
                else message("io.at-same-location", "at the same place"),
                logs=message("io.logs-of-collars", "; logs are read with {names}", names=", ".join(used))
                if used
                else EMPTY,
            )
            remedy = message(
                "io.keep-one-collar-table",
                "If they are the same holes, keep them in one of the tables; otherwise, rename those of one.",
            )
            journal.add("warning", later.collar, reason, remedy)


def warn_of_twins(campaigns: Sequence[Boreholes], journal: Journal) -> None:
    """Warn of holes of different names that run along the same path: one hole that was entered twice.

    Collars of one table that are equal are left out: their rows are warned of as they are read.
    """
    holes = [(campaign, name) for campaign in campaigns for name in campaign.paths]
    if len(holes) < 2:
        return
    mouths = np.array([campaign.paths[name].xyz[0] for campaign, name in holes])
    twins: dict[str, list[tuple[str, str]]] = {}
    for i, k in sorted(cKDTree(mouths).query_pairs(TWIN)):
        (first, one), (second, other) = holes[i], holes[k]
        known = first is second and np.array_equal(mouths[i], mouths[k])
        if known or name_key(one) == name_key(other):
            continue
        depth = min(first.ends[one], second.ends[other])
        apart = np.linalg.norm(first.paths[one].at(depth) - second.paths[other].at(depth))
        if apart <= max(TOGETHER, TOGETHER_SHARE * depth):
            twins.setdefault(second.collar, []).append((one, other))
    for file, pairs in twins.items():
        reason = plural_message(
            "io.holes-of-two-names",
            "{count} hole runs along the path of another: {names}. It may be one hole under two names, and counts "
            "twice",
            "{count} holes run along the paths of others: {names}. They may be one hole under two names each, and "
            "count twice",
            count=len(pairs),
            names=some_of([f"{other} = {one}" for one, other in pairs], NAMED),
        )
        remedy = message("io.remove-or-rename-hole", "If they are one hole, remove one.")
        journal.add("warning", file, reason, remedy, value=pairs[0][1])
