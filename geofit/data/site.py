"""A site: the horizons of one place with what surrounds them. Plain data, no algorithms."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from geofit.data.given import arguments_checked, keywords_known
from geofit.data.logs import LoggedHoles
from geofit.data.messages import EMPTY, Message
from geofit.data.picture import card, plan_svg
from geofit.data.points import PointSet
from geofit.data.settings import FitSettings
from geofit.data.title_block import TitleBlock

__all__ = ["Ground", "Hole", "ImportIssue", "Orientations", "Section", "Site", "TableCount"]

Floats = NDArray[np.float64]

#: Colours of the horizons of a site in its plan, in turn.
COLOURS = ("#5a91cf", "#b08a20", "#27784f", "#cf8275", "#9a4aa0", "#a4532a", "#3f9a9a", "#76716a")


@dataclass(frozen=True)
class ImportIssue:
    """One thing that a reader wants a person to know about one row of a file.

    ``severity`` is "error" (the row is not used), "warning" (used, but look) or "note" (a guess that was made).
    """

    file: str
    row: int
    column: str
    value: str
    severity: Literal["error", "warning", "note"]
    reason: Message
    remedy: Message = EMPTY


@dataclass(frozen=True)
class TableCount:
    """Rows of one file: ``read == used + listed`` always holds."""

    file: str
    read: int
    used: int
    listed: int


@dataclass(frozen=True, eq=False)
class Hole:
    """A borehole or adit as a line in space.

    ``depth`` (k,) metres along the hole, ``xyz`` (k, 3) metres, both from the collar on.
    """

    name: str
    kind: Literal["borehole", "adit"]
    depth: Floats
    xyz: Floats


@dataclass(frozen=True, eq=False)
class Section:
    """A section drawing's line in plan: ``line`` (k, 2) metres."""

    name: str
    line: Floats


@dataclass(frozen=True, eq=False)
class Ground:
    """The ground as a regular grid: ``x`` (nx,), ``y`` (ny,) ascending, ``z`` (ny, nx), metres."""

    x: Floats
    y: Floats
    z: Floats

    @arguments_checked
    def elevation(self, x: Floats, y: Floats) -> Floats:
        """Height at map coordinates by bilinear interpolation, nan outside; arrays broadcast."""
        x, y = np.broadcast_arrays(np.asarray(x, float), np.asarray(y, float))
        i = np.clip(np.searchsorted(self.x, x, side="right") - 1, 0, len(self.x) - 2)
        j = np.clip(np.searchsorted(self.y, y, side="right") - 1, 0, len(self.y) - 2)
        s = (x - self.x[i]) / (self.x[i + 1] - self.x[i])
        t = (y - self.y[j]) / (self.y[j + 1] - self.y[j])
        z = (1 - t) * ((1 - s) * self.z[j, i] + s * self.z[j, i + 1]) + t * (
            (1 - s) * self.z[j + 1, i] + s * self.z[j + 1, i + 1]
        )
        outside = (s < 0) | (s > 1) | (t < 0) | (t > 1)
        return np.where(outside, np.nan, z)


@dataclass(frozen=True, eq=False)
class Orientations:
    """Dips of bedding, joints or faults that were measured in the field: arrays of equal length n.

    ``xyz`` (n, 3) metres; ``azimuth`` of the line of steepest descent, clockwise from grid north, and ``dip``
    below the horizontal, degrees; ``horizon`` that each belongs to, empty where none is named; ``file``, ``row``.
    """

    xyz: Floats
    azimuth: Floats
    dip: Floats
    horizon: NDArray[np.str_]
    file: NDArray[np.str_]
    row: NDArray[np.int64]

    def __len__(self) -> int:
        return len(self.xyz)


@keywords_known
@dataclass(frozen=True, eq=False)
class Site:
    """Everything that was read of one site.

    Parameters
    ----------
    name : str
        Title of the site.
    horizons : mapping of str to PointSet
        Points of each horizon, in the order of the site file.
    settings : mapping of str to FitSettings
        Settings of each horizon; those that the site file does not name have the defaults.
    boundary : (k, 2) array or None
        Corners of the study area in map coordinates, not closed.
    ground : Ground or None
        The ground surface.
    holes, sections : tuple
        What the points come from, for pictures and windows.
    issues, counts : tuple
        What the readers found, and how many rows of each file were used.
    crs : str
        Label of the coordinate system, as the file states it; empty if it does not.
    inputs : mapping of str to str
        SHA-256 of each file that was read, by its name.
    orientations : Orientations or None
        Structural dip measurements.
    order : tuple of str
        Horizons that must not cross, from the top to the bottom; empty if the file states none.
    faults : mapping of str to tuple of str
        Horizons that are faults, and which horizons each of them cuts.
    boreholes : tuple of LoggedHoles
        Paths and interval tables of the boreholes, one entry a campaign.
    title : TitleBlock
        What the report's cover says: project, client, document, status, revisions.
    datum : (3,) tuple of float or None
        Project datum: easting, northing and elevation in map coordinates, metres; an origin for STEP files.
    blocks : mapping of str to str
        Of those of ``horizons`` that are fault blocks: the horizon that each is a block of.
    """

    name: str
    horizons: Mapping[str, PointSet]
    settings: Mapping[str, FitSettings] = field(default_factory=dict)
    boundary: Floats | None = None
    ground: Ground | None = None
    holes: tuple[Hole, ...] = ()
    sections: tuple[Section, ...] = ()
    issues: tuple[ImportIssue, ...] = ()
    counts: tuple[TableCount, ...] = ()
    crs: str = ""
    inputs: Mapping[str, str] = field(default_factory=dict)
    orientations: Orientations | None = None
    order: tuple[str, ...] = ()
    faults: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    boreholes: tuple[LoggedHoles, ...] = ()
    title: TitleBlock = field(default_factory=TitleBlock)
    datum: tuple[float, float, float] | None = None
    blocks: Mapping[str, str] = field(default_factory=dict)

    def __repr__(self) -> str:
        return f"<Site {self.name}: {', '.join(f'{key} {value}' for key, value in self._counted().items())}>"

    def _repr_html_(self) -> str:
        """Return the counts, and a plan of the points by horizon and of the study area, for notebooks."""
        groups = [(points.xyz[:, :2], COLOURS[k % len(COLOURS)]) for k, points in enumerate(self.horizons.values())]
        outlines = [] if self.boundary is None else [self.boundary]
        return card(self.name, self._counted() | {"crs": self.crs or "not stated"}, plan_svg(groups, outlines))

    def _counted(self) -> dict[str, object]:
        """Return what the site consists of, by name."""
        errors = sum(issue.severity == "error" for issue in self.issues)
        return {
            "horizons": len(self.horizons),
            "points": sum(map(len, self.horizons.values())),
            "holes": len(self.holes),
            "sections": len(self.sections),
            "rows not used": errors,
        }
