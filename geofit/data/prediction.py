"""The prediction error of a surface away from its data: plain data of cross-validation and uncertainty."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from geofit.data.messages import Message, message

__all__ = ["LeftOut", "LeftOutBody", "Outlier", "PredictionResult", "SourceOffset", "Suggestion", "Uncertainty"]

Floats = NDArray[np.float64]
Scheme = Literal["hole", "section", "block"]


@dataclass(frozen=True)
class LeftOutBody:
    """Holes or sections of a body left out in turn: how well the others predict them.

    ``error`` is the root mean square distance from a contact to the predicted surface, metres: along a hole, at right
    angles to the surface on a section; nan if there is none. ``missed`` counts contacts of holes on which no contact is
    predicted. ``misclassified`` of the ``logged`` metres lie on the wrong side. ``inside`` is the share of contacts
    that the 90 % band contains: those at which the chance of lying inside is from 5 to 95 %; nan if there is none.
    ``beyond`` counts contacts beyond the reach of all other data, where no chance is known.
    """

    scheme: Scheme
    groups: int
    error: float
    missed: int
    misclassified: float
    logged: float
    inside: float
    beyond: int = 0


@dataclass(frozen=True, eq=False)
class LeftOut:
    """Cross-validation by one scheme: each group of points is predicted from all others.

    ``group`` (n,) names the group of each point, empty for points that are never left out; ``error`` (n,) is the
    point minus the surface fitted without its group, metres, nan where never left out; ``sd`` (n,) its standard
    deviation as predicted, after calibration, the point's own accuracy included. ``inside`` is the share of
    left-out points within the 90 % band, ``inside_raw`` the share before calibration. ``references`` holds the root
    mean square error of other methods on the same folds, by name ("thin plate", "kriging").
    """

    scheme: Scheme
    groups: int
    group: NDArray[np.str_]
    error: Floats
    sd: Floats
    rms: float
    mean_abs: float
    bias: float
    max_abs: float
    inside: float
    inside_raw: float
    references: Mapping[str, float]

    def __repr__(self) -> str:
        others = "".join(f", {name} {rms:.3g} m" for name, rms in self.references.items())
        return (
            f"<LeftOut by {self.scheme}: {self.groups} groups, rms {self.rms:.3g} m{others}, "
            f"{self.inside:.0%} in the 90 % band>"
        )


@dataclass(frozen=True, eq=False)
class Uncertainty:
    """Standard deviation of the surface on a grid, in map coordinates unless ``frame`` says otherwise, metres.

    ``x`` (nx,), ``y`` (ny,) ascending, ``sd`` (ny, nx), nan outside the study area. ``factor`` is by how much the
    posterior standard deviation was widened (above 1) so that 90 % of the left-out points lie in the 90 % band: the
    median of the local ``factors`` (ny, nx). With ``frame`` "best-plane" x and y run along the strike and up the dip
    of the surface's best plane, metres about its origin, and sd is measured across it. With "sections" they are the
    parameters of a folded surface, metres: x across its sections, y along them; sd is measured along its normal. The
    contact that a new hole finds scatters about the surface by ``noise`` more (1 sigma).
    """

    x: Floats
    y: Floats
    sd: Floats
    factor: float
    mean: float
    max: float
    factors: Floats
    frame: Literal["map", "best-plane", "sections"] = "map"
    noise: float = 0.0

    def __repr__(self) -> str:
        grid = f"{len(self.x)} x {len(self.y)} nodes"
        return f"<Uncertainty: mean {self.mean:.3g} m, largest {self.max:.3g} m, factor {self.factor:.3g}, {grid}>"


@dataclass(frozen=True)
class Suggestion:
    """A place for the next hole, in greedy order: where it stands, and what it would leave, metres.

    ``sd`` is the standard deviation there before any hole; ``mean_after`` and ``max_after`` that of the whole
    surface after this hole and those before it.
    """

    x: float
    y: float
    z: float
    sd: float
    mean_after: float
    max_after: float


@dataclass(frozen=True)
class Outlier:
    """A point that its neighbours contradict: left-out error, its standard deviation (m), and their ratio.

    ``name`` is what a person would look it up by.
    """

    index: int
    error: float
    sd: float
    ratio: float
    name: Message | str = ""


@dataclass(frozen=True)
class SourceOffset:
    """A systematic offset between the points of two kinds, metres, with its standard deviation ``sd`` (1 sigma).

    ``kind`` is that of the ``count`` points, ``reference`` that of the points measured nearest to the rock. ``offset``
    is positive above them; where not ``vertical``, it is measured across the best plane of a steep surface.
    """

    kind: str
    reference: str
    count: int
    offset: float
    sd: float
    vertical: bool = True

    @property
    def text(self) -> Message:
        """The offset in words."""
        figures = {"kind": self.kind, "reference": self.reference, "count": self.count, "sd": self.sd}
        if not self.vertical:
            return message(
                "data.source-aside",
                "the {count} points of kind '{kind}' lie {offset:.2g} m (± {sd:.1g} m) to one side of those of kind "
                "'{reference}'",
                offset=abs(self.offset),
                **figures,
            )
        if self.offset > 0:
            return message(
                "data.source-above",
                "the {count} points of kind '{kind}' lie {offset:.2g} m (± {sd:.1g} m) above those of kind "
                "'{reference}'",
                offset=self.offset,
                **figures,
            )
        return message(
            "data.source-below",
            "the {count} points of kind '{kind}' lie {offset:.2g} m (± {sd:.1g} m) below those of kind '{reference}'",
            offset=-self.offset,
            **figures,
        )


@dataclass(frozen=True, eq=False)
class PredictionResult:
    """Everything said about a surface away from its data; ``notes`` state what could not be done, and why.

    ``offsets`` are the systematic offsets between kinds of points, the most significant first.
    """

    left_out: tuple[LeftOut, ...]
    uncertainty: Uncertainty | None
    suggestions: tuple[Suggestion, ...]
    outliers: tuple[Outlier, ...]
    notes: tuple[Message, ...] = ()
    offsets: tuple[SourceOffset, ...] = ()

    def __repr__(self) -> str:
        parts = [f"rms {one.rms:.3g} m by {one.scheme}" for one in self.left_out]
        if self.uncertainty is not None:
            parts.append(f"mean standard deviation {self.uncertainty.mean:.3g} m")
        parts += [f"{len(self.suggestions)} suggested boreholes", f"{len(self.outliers)} outliers"]
        return f"<PredictionResult: {', '.join(parts)}>"
