"""Bodies in the project file: their records, triangles and figures, written and read."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from geofit import __version__
from geofit.data.errors import GeofitError, InputError, SettingsError
from geofit.data.messages import message
from geofit.implicit.mesh import TriangleMesh
from geofit.io.parser_errors import parser_message
from geofit.io.project import Project, ProjectBody
from geofit.project.body_building import BodyResult
from geofit.project.body_record import BodyProvenance, BodyRecord
from geofit.project.mesh_body import read_mesh_body
from geofit.project.state import State

__all__ = ["SavedBody", "bodies_of", "largest_difference", "read_bodies", "records_of", "saved_body"]


@dataclass(frozen=True, eq=False)
class SavedBody:
    """What a project keeps of a body: triangles in map coordinates, and figures of the check."""

    mesh: TriangleMesh
    n: int = 0
    sigma: float | None = None
    passed: bool | None = None
    volumes: Mapping[str, float] | None = None


def saved_body(result: BodyResult) -> SavedBody:
    """Return what a project keeps of a body."""
    mesh = TriangleMesh(result.mesh.vertices + result.body.origin, result.mesh.triangles)
    a, v = result.accuracy, result.volumes
    volumes = None if v is None else {"p10": v.p10, "p50": v.p50, "p90": v.p90, "best": v.best}
    if a is None:
        return SavedBody(mesh, volumes=volumes)
    return SavedBody(mesh, a.n, a.sigma, a.passed, volumes)


def bodies_of(
    state: State, bodies: Mapping[str, SavedBody], former: Project | None, folder: Path
) -> tuple[ProjectBody, ...]:
    """Return the entries of a state's bodies; one that is not available keeps the triangles of ``former``."""
    kept = {} if former is None else {body.name: body for body in former.bodies}
    entries = []
    for name, record in state.bodies.items():
        one, old = bodies.get(name), kept.get(name)
        figures: dict[str, Any] = {}
        if one is not None:
            figures = {"n": one.n, "sigma": one.sigma, "passed": one.passed, "volumes": one.volumes or {}}
        elif old is not None and _holds(old, record) and (folder / old.mesh).is_file():
            figures = {key: getattr(old, key) for key in ("mesh", "sha256", "n", "sigma", "passed", "volumes")}
        entries.append(ProjectBody(name=name, record=record.to_data(), geofit=__version__, **figures))
    return tuple(entries)


def _holds(old: ProjectBody, record: BodyRecord) -> bool:
    """Whether a project's entry has the triangles of a record's body."""
    return bool(old.mesh) and BodyProvenance.from_data(old.record) == record.provenance


def records_of(project: Project) -> dict[str, BodyRecord]:
    """Return the bodies of a project.

    Raises
    ------
    InputError
        If a body does not say what it is made from.
    """
    found = {}
    for body in project.bodies:
        try:
            found[body.name] = BodyRecord.from_data(body.record)
        except (KeyError, TypeError, ValueError, AttributeError, SettingsError) as error:
            raise InputError(
                message(
                    "project.body-unreadable",
                    "The project does not say what body '{name}' is made from: {error}",
                    name=body.name,
                    error=parser_message(error)[0] if isinstance(error, KeyError) else str(error),
                ),
                message("data.undo-last-edit", "Undo the last manual edit, or open a copy."),
                file=project.name,
            ) from None
    return found


def read_bodies(project: Project, folder: Path, changed: Mapping[str, str]) -> dict[BodyProvenance, BodyResult]:
    """Return bodies as the project holds them, by what they were made from; without those whose files have changed.

    They show what was saved until they are made again.
    """
    found = {}
    for body in project.bodies:
        if not body.mesh or body.mesh in changed:
            continue
        try:
            mesh = read_mesh_body(folder / body.mesh, body.name)
        except GeofitError:
            continue  # it is made again from its data
        found[BodyRecord.from_data(body.record).provenance] = BodyResult(mesh, origin="read back")
    return found


def largest_difference(old: BodyResult, new: BodyResult) -> float:
    """Return the largest distance in metres between the vertices of two bodies; 0 if they are the same."""
    one, two = (saved_body(result).mesh for result in (old, new))
    if np.array_equal(one.triangles, two.triangles) and np.allclose(one.vertices, two.vertices, rtol=0, atol=1e-6):
        return 0.0
    from scipy.spatial import cKDTree

    origin = one.vertices[0]
    trees = [cKDTree(mesh.vertices - origin) for mesh in (one, two)]
    pairs = ((trees[0], two), (trees[1], one))
    return float(max(np.max(tree.query(mesh.vertices - origin)[0]) for tree, mesh in pairs))
