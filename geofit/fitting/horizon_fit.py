"""The result of a fit: a surface with the points and settings it was fitted to, its check, and how it was made."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from os import PathLike
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from geofit.checks.check import check, judged_by
from geofit.data.accuracy import Accuracy, Conflict, Partition, ReadBack
from geofit.data.given import arguments_checked
from geofit.data.picture import LEVELS, card, deviation_colours, plan_svg
from geofit.data.points import PointSet
from geofit.data.settings import FitSettings
from geofit.fitting import edit
from geofit.fitting.model import Model
from geofit.geometry.mesh import Mesh, Tolerance
from geofit.geometry.projection import Projection
from geofit.geometry.trim_loops import Loops
from geofit.splines.patch import Patch
from geofit.surfaces.mesh_surface import MeshSurface
from geofit.surfaces.patch_surface import PatchSurface

if TYPE_CHECKING:
    from geofit.cad.step_origin import Origin

__all__ = ["HorizonFit", "fit_of"]

Floats = NDArray[np.float64]


@arguments_checked
@dataclass(frozen=True, eq=False)
class HorizonFit:
    """A surface with the points it was fitted to (or is judged by), and its check.

    Parameters
    ----------
    surface : PatchSurface or MeshSurface
        The surface; its geometry (``patches``, ``origin``, ``outline``, ``elevation``, ``distance``, ...) can be
        reached from the fit directly.
    points : PointSet
        All original points.
    settings : FitSettings
        Settings of the fit.
    name : str
        Name of the horizon.
    partition : Partition or None
        The split into core and periphery.
    core : (n,) array of bool
        Which points the surface interpolates exactly.
    accuracy : Accuracy or None
        The check; None only while the fit is under way.
    diagnostics : mapping
        Figures of the fit for the report: control points, energy, smoothing, iterations, seconds a stage.
    model : Model or None
        The control net behind the patches of a fit; None for an imported surface.
    """

    surface: PatchSurface | MeshSurface
    points: PointSet = field(default_factory=lambda: PointSet(np.empty((0, 3))))
    settings: FitSettings = field(default_factory=FitSettings)
    name: str = "horizon"
    partition: Partition | None = None
    core: NDArray[np.bool_] = field(default_factory=lambda: np.zeros(0, bool))
    accuracy: Accuracy | None = None
    diagnostics: Mapping[str, Any] = field(default_factory=dict)
    model: Model | None = None

    def __repr__(self) -> str:
        patches = f"{n} patch{'' if n == 1 else 'es'}" if (n := len(self.patches)) else "triangles"
        parts = [patches, f"{len(self.points)} points"]
        if (a := self.accuracy) is not None:
            parts.append(f"sigma {a.sigma:.3g} m {'<' if a.sigma < a.epsilon else '>='} {a.epsilon:g} m {a.verdict}")
        return f"<HorizonFit {self.name}: {', '.join(parts)}>"

    def _repr_html_(self) -> str:
        """Return the verdict, and a plan of the points by their deviation and of the surface's end, for notebooks."""
        rows: dict[str, object] = {"patches": len(self.patches), "points": len(self.points)}
        colours = np.full(len(self.points), LEVELS[0])
        if (a := self.accuracy) is not None:
            failed = ", ".join(check.name for check in a.checks if check.passed is False)
            rows |= {
                a.verdict: f"sigma {a.sigma:.3g} m {'<' if a.sigma < a.epsilon else '>='} {a.epsilon:g} m",
                "largest deviation": f"{a.max_abs:.3g} m",
                "failed checks": failed or "none",
            }
            colours = deviation_colours(a.residuals, self.settings.boundary_tolerance, self.settings.interior_tolerance)
        outlines = [] if self.outline is None else [self.outline]
        return card(self.name, rows, plan_svg([(self.points.xyz[:, :2], colours)], outlines))

    def with_(self, **changes: Any) -> HorizonFit:
        """Return a copy with some fields of the fit, or of its surface, replaced."""
        own = {f.name for f in fields(self)}
        of_surface = {key: value for key, value in changes.items() if key not in own}
        kept = {key: value for key, value in changes.items() if key in own}
        if of_surface:
            kept["surface"] = replace(kept.get("surface", self.surface), **of_surface)
        return replace(self, **kept)

    @property
    def patches(self) -> tuple[Patch, ...]:
        """NURBS patches about ``origin``; the core first, if there is one."""
        return self.surface.patches

    @property
    def origin(self) -> Floats:
        """Offset that turns the patches' coordinates into map coordinates, metres."""
        return self.surface.origin

    @property
    def outline(self) -> Floats | None:
        """Plan polygon (k, 2) that ends the surface, map coordinates; None: not trimmed."""
        return self.surface.outline

    @property
    def loops(self) -> Loops:
        """Trim loops of each patch in its parameters."""
        return self.surface.loops

    @property
    def frame(self) -> str:
        """In which frame the surface is a height field: "map", "best-plane", "sections" (in none) or ""."""
        return self.surface.frame

    @property
    def bounds(self) -> tuple[Floats, Floats]:
        """Lowest and highest coordinates, (3,) each, of a box that contains the surface."""
        return self.surface.bounds

    @property
    def control_points(self) -> int:
        """Number of control points; rows that two patches share count once for each."""
        return sum(patch.control.shape[0] * patch.control.shape[1] for patch in self.patches)

    def elevation(self, x: ArrayLike, y: ArrayLike) -> Floats:
        """Return the height at map coordinates in metres, nan outside; arrays broadcast.

        Where the surface lies over a place more than once (an overturned fold), the highest.
        """
        return self.surface.elevation(x, y)

    def project(self, xyz: ArrayLike) -> Projection:
        """Return the foot points of (n, 3) map coordinates, with signed orthogonal distances in metres."""
        return self.surface.project(xyz)

    def distance(self, xyz: ArrayLike) -> Floats:
        """Return the signed orthogonal distance of (n, 3) map coordinates, metres, positive above."""
        return self.surface.distance(xyz)

    def triangulate(self, tolerance: Tolerance = 0.05) -> Mesh:
        """Return triangles within a tolerance (m), trimmed to where the surface ends."""
        return self.surface.triangulate(tolerance)

    def adjust(self, patch: str, i: int, j: int, dz: float, aside: Sequence[float] = (0.0, 0.0, 0.0)) -> HorizonFit:
        """Return the fit with one control point moved; see :func:`geofit.fitting.edit.adjust`."""
        return edit.adjust(self, patch, i, j, dz, aside)

    def move_to(self, point: int | ArrayLike, share: float = 1.0) -> HorizonFit:
        """Return the fit moved to one of its points, or to a place; see :func:`geofit.fitting.edit.move_to`."""
        return edit.move_to(self, point, share)

    def weigh(self, patch: str, i: int, j: int, weight: float) -> HorizonFit:
        """Return the fit with another weight of one control point; see :func:`geofit.fitting.edit.weigh`."""
        return edit.weigh(self, patch, i, j, weight)

    def to_cadquery(self) -> Any:
        """Return a cadquery shell of the sewn patches in map coordinates, to go on modelling with."""
        from geofit.cad.sewing import to_shape

        return to_shape(self)

    def write_step(
        self, path: str | PathLike[str], *, author: str = "", organisation: str = "", origin: Origin = "map"
    ) -> ReadBack:
        """Write the shell as STEP AP242, read it back, and return what the reader found.

        Parameters
        ----------
        path : path
            The file, usually ``*.step``.
        author, organisation : str
            Who answers for the file, for its header.
        origin : {"map", "local"} or (3,) array_like
            Zero of the file: that of the map; a round place below the data; or the project datum in map coordinates,
            metres. The file states the offset, and :func:`geofit.read_surface` adds it.
        """
        from geofit.cad.step import write_step

        found = write_step({self.name: self}, path, author=author, organisation=organisation, origin=origin)
        return found[self.name]

    def checked(self, conflicts: tuple[Conflict, ...], notes: tuple[Any, ...]) -> HorizonFit:
        """Return the fit with its surface measured and checked anew."""
        return replace(self, accuracy=check(self, conflicts, notes))

    def judged_by(self, epsilon: float) -> HorizonFit:
        """Return the fit judged by another control error, metres: the same surface, and perhaps another verdict."""
        judged = replace(self, settings=replace(self.settings, epsilon=epsilon))
        if self.accuracy is None or not len(self.points):
            return judged
        return replace(judged, accuracy=judged_by(judged, self.accuracy, epsilon))

    def refitted(self, model: Model) -> HorizonFit:
        """Return the fit with the surface of another control net, checked anew."""
        given, net = model.problem, model.net
        remade = replace(self, surface=model.patch_surface(), model=model)
        figures = {**self.diagnostics, **model.figures(), "control_points": remade.control_points}
        remade = replace(remade, diagnostics=figures)
        return remade.checked(given.conflicts, (*given.parametrization.notes, *net.notes))

    def ended_at(self, outline: Floats) -> HorizonFit:
        """Return a fit that ends at an outline, checked anew within it.

        What is made from it later, by manual edits or by a separation, ends there too.

        Parameters
        ----------
        outline : (k, 2) array
            Corners in map coordinates.
        """
        assert self.model is not None
        assert self.accuracy is not None
        model = replace(self.model, problem=replace(self.model.problem, outline=outline))
        return self.with_(outline=outline, model=model).checked(self.accuracy.conflicts, self.accuracy.notes)


def fit_of(model: Model) -> HorizonFit:
    """Return the fit of a control net, with its check."""
    given = model.problem
    blank = HorizonFit(
        surface=model.patch_surface(),
        points=given.points,
        settings=given.settings,
        name=given.name,
        partition=given.partition(),
        core=given.split.inside & given.kept,
    )
    return blank.refitted(model)
