"""The figures of a check, as plain data: what the report prints and the JSON holds."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, fields, is_dataclass
from pathlib import PurePath
from typing import Any

import numpy as np
from numpy.typing import NDArray

from geofit.data.messages import Message

__all__ = ["Accuracy", "Check", "Conflict", "Exceedance", "Group", "Partition", "ReadBack", "Seam", "plain"]

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Group:
    """Residuals of a part of the points: count, sigma of eq. 3 over the part, largest |d|, mean d (metres)."""

    n: int
    sigma: float
    max_abs: float
    mean: float


@dataclass(frozen=True)
class Exceedance:
    """Points further from the surface than a tolerance: the tolerance in metres and their count."""

    limit: float
    count: int


@dataclass(frozen=True)
class Seam:
    """Where two patches meet: largest gap (m) and largest angle between their normals (degrees)."""

    first: str
    second: str
    gap: float
    angle: float


@dataclass(frozen=True)
class Check:
    """One question put to the surface: ``passed`` is None where it does not apply; ``text`` says it in words.

    ``places`` are where it is worst (map coordinates, worst first), for a fault that has places.
    """

    name: str
    passed: bool | None
    value: float
    limit: float
    unit: str
    text: Message
    places: tuple[tuple[float, float, float], ...] = ()

    def __repr__(self) -> str:
        verdict = {True: "PASS", False: "FAIL", None: "no limit"}[self.passed]
        limit = "" if self.passed is None else f", limit {self.limit:.3g}"
        return f"<Check {self.name}: {verdict}, {self.value:.3g}{limit} {self.unit}".rstrip() + ">"


@dataclass(frozen=True)
class Conflict:
    """Two points at one location with different elevations: indices into the points, and how it was resolved."""

    kept: int
    dropped: int
    difference: float
    text: Message


@dataclass(frozen=True)
class Partition:
    """How the points were split into core and periphery, and why (paper, sec. 3.2; fig. 3a).

    ``corners`` are the core's four corners in map coordinates (None without a core), ``core`` and
    ``periphery`` count points, ``reason`` states what was chosen. ``lost``: there
    is a dense core, and its points are approximated all the same.
    """

    corners: tuple[tuple[float, float], ...] | None
    core: int
    periphery: int
    reason: Message
    lost: bool = False


@dataclass(frozen=True, eq=False)
class Accuracy:
    """The check of one horizon (paper, sec. 3.3, and METHOD).

    ``sigma = sqrt(sum d_i^2 / (n - 1))`` over all n original points (eq. 3); passed when sigma < epsilon and the
    surface does not run far beyond the elevations of its data.
    ``residuals`` (n,) are signed orthogonal distances in metres, positive above the surface; ``patch`` (n,)
    names the patch of each point. ``over`` counts the points beyond tolerances, by the name of the setting:
    "interior_tolerance", "epsilon".
    ``worst`` holds the indices of the largest residuals, largest first.
    """

    n: int
    sigma: float
    epsilon: float
    passed: bool
    max_abs: float
    mean: float
    residuals: Floats
    patch: NDArray[np.str_]
    by_patch: Mapping[str, Group]
    by_kind: Mapping[str, Group]
    by_hole: Mapping[str, Group]
    by_section: Mapping[str, Group]
    over: Mapping[str, Exceedance]
    worst: tuple[int, ...]
    seams: tuple[Seam, ...] = ()
    checks: tuple[Check, ...] = ()
    conflicts: tuple[Conflict, ...] = ()
    notes: tuple[Message, ...] = ()

    def __repr__(self) -> str:
        sign = "<" if self.sigma < self.epsilon else ">="
        failed = [check.name for check in self.checks if check.passed is False]
        return (
            f"<Accuracy {self.verdict}: sigma {self.sigma:.3g} m {sign} {self.epsilon:g} m, {self.n} points, "
            f"largest {self.max_abs:.3g} m, {len(self.checks)} checks"
            f"{', failed: ' + ', '.join(failed) if failed else ''}>"
        )

    @property
    def verdict(self) -> str:
        """PASS or FAIL: sigma against epsilon, as the paper has it, of a surface that does not run away."""
        return "PASS" if self.passed else "FAIL"


@dataclass(frozen=True)
class ReadBack:
    """What an independent reader (OpenCASCADE) finds in the file that was written.

    ``core_max_abs`` is nan where there is no core; seams are sampled at 200 places each.
    """

    file: str
    sha256: str
    faces: int
    sigma: float
    core_max_abs: float
    max_abs: float
    seams: tuple[Seam, ...]
    brep_valid: bool
    free_edges: int
    outline_edges: int
    edge_tolerance: float
    self_intersects: bool
    checks: tuple[Check, ...] = field(default=())

    @property
    def passed(self) -> bool:
        """Whether every check of the file holds."""
        return all(check.passed is not False for check in self.checks)


def plain(value: Any) -> Any:
    """Turn dataclasses, arrays and numbers into what JSON holds.

    nan and infinities become null; a message becomes its code, severity, text and parameters.
    """
    if isinstance(value, Message):
        return plain(value.as_data())
    if is_dataclass(value) and not isinstance(value, type):
        return {f.name: plain(getattr(value, f.name)) for f in fields(value)}
    if isinstance(value, Mapping):
        return {str(k): plain(v) for k, v in value.items()}
    if isinstance(value, np.ndarray):
        return plain(value.tolist())
    if isinstance(value, (list, tuple)):
        return [plain(v) for v in value]
    if isinstance(value, np.generic):
        return plain(value.item())
    if isinstance(value, PurePath):
        return str(value)
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    return value
