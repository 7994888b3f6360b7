"""Holes that are in several collar tables of one site."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from geofit.data.messages import EMPTY, Untranslated, message, plural_message
from geofit.io.boreholes import Boreholes
from geofit.io.journal import Journal
from geofit.io.rows import name_key

__all__ = ["warn_of_shared_holes"]

#: Collars are written in centimetres: smaller distances are none, metres.
SAME_COLLAR = 0.005


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
