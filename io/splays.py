"""Splays of cave surveys: their walls are added to a survey, and listed."""

from __future__ import annotations

from geofit.caves.shots import ShotList
from geofit.data.messages import message, plural_message
from geofit.io.journal import Journal

__all__ = ["use_splays"]


def use_splays(shots: ShotList, file: str, journal: Journal) -> None:
    """Add the walls that splays show to the shots of a file, and list how many splays are used and how many are not."""
    stations, used = shots.add_walls_of_splays()
    if used:
        journal.add(
            "note",
            file,
            message(
                "io.walls-of-splays",
                "Walls are computed from splays: splays {count}, stations {stations}",
                count=used,
                stations=stations,
            ),
            message("io.walls-of-splays-last", "Walls that were measured as left, right, up and down count first."),
        )
    if unused := len(shots.splays) - used:
        journal.add(
            "note",
            file,
            plural_message(
                "io.splays-unused",
                "{count} splay gives no wall: it leads along the passage, or from a station without one",
                "{count} splays give no wall: they lead along the passage, or from a station without one",
                count=unused,
            ),
            message("io.check-splays", "Check their stations where walls are missing."),
        )
