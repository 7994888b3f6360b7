"""Taking a fit that was made before, in the place of the present one."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

from geofit.data.messages import Message, message
from geofit.project.command import Command, known
from geofit.project.provenance import Provenance
from geofit.project.state import State

__all__ = ["TakeFit"]


@dataclass
class TakeFit(Command):
    """Another fit becomes the surface of its horizon, with its settings and the rows that it left out."""

    kind = "take-fit"
    provenance: Provenance

    @property
    def text(self) -> Message:  # noqa: D102
        return message("project.step-take-fit", "Take another fit of {name}", name=self.provenance.horizon)

    def on(self, state: State) -> State:  # noqa: D102
        one = self.provenance
        known(state, one.horizon)
        return replace(
            state,
            settings={**state.settings, one.horizon: one.settings},
            excluded={**state.excluded, one.horizon: frozenset(one.excluded)},
            provenances={**state.provenances, one.horizon: one},
        )

    @classmethod
    def from_data(cls, data: Mapping[str, Any]) -> Command:  # noqa: D102
        return cls(Provenance.from_data(data["provenance"]))
