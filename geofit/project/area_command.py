"""The study area, as drawn in plan: surfaces end there."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

from geofit.data.messages import Message, message
from geofit.data.numbers import is_finite
from geofit.project.command import Command
from geofit.project.provenance import Corners, DocumentError
from geofit.project.state import State

__all__ = ["SetArea"]


@dataclass
class SetArea(Command):
    """Another study area: corners in map coordinates, metres, not closed; None: that of the site's files."""

    kind = "area"
    area: Corners | None

    @property
    def text(self) -> Message:  # noqa: D102
        if self.area is None:
            return message("project.step-area-of-files", "Study area as in the files")
        return message("project.step-area", "Study area with {count} corners", count=len(self.area))

    def on(self, state: State) -> State:  # noqa: D102
        if self.area is not None:
            _check(self.area)
        return replace(state, area=self.area)

    @classmethod
    def from_data(cls, data: Mapping[str, Any]) -> Command:  # noqa: D102
        area = data["area"]
        return cls(None if area is None else tuple((x, y) for x, y in area))


def _check(area: Corners) -> None:
    import shapely

    finite = all(is_finite(value) for corner in area for value in corner)
    if len(area) < 3 or not finite or not (shape := shapely.Polygon(area)).is_valid or not shape.area > 0:
        raise DocumentError(
            message(
                "project.area-invalid",
                "The study area needs at least three corners, and no side may cross another; {count} were given.",
                count=len(area),
            )
        )
