"""Surfaces with known properties for the tests of distance, stitching and STEP."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np

from geofit.data.points import PointSet
from geofit.data.settings import FitSettings
from geofit.fitting.horizon_fit import HorizonFit
from geofit.splines import bspline
from geofit.splines.patch import Patch
from geofit.surfaces.patch_surface import PatchSurface

ORIGIN = np.array([5e5, 3.1e6, 400.0])


def height_field(nu=24, nv=18, degree=3, size=(1000.0, 700.0), multiplicity=1, z=None, turn=0.0):
    """A height field over a (turned) rectangle, its control heights from z(x, y)."""
    breaks_u = np.linspace(0, size[0], (nu - degree - 1) // multiplicity + 2)
    breaks_v = np.linspace(0, size[1], (nv - degree - 1) // multiplicity + 2)
    ku, kv = (bspline.clamped_knots(b, degree, multiplicity) for b in (breaks_u, breaks_v))
    x, y = np.meshgrid(bspline.greville(ku, degree), bspline.greville(kv, degree), indexing="ij")
    heights = wave(x, y) if z is None else z(x, y)
    c, s = np.cos(turn), np.sin(turn)
    return Patch("core", (degree, degree), ku, kv, np.stack([c * x - s * y, s * x + c * y, heights], axis=-1))


def wave(x, y):
    return 40 * np.sin(x / 130) * np.cos(y / 170) + 0.2 * x


def fold(nu=40, nv=12):
    """An overturned fold: over some places the surface stands three times (z grows with u: no crossing)."""
    ku = bspline.clamped_knots(np.linspace(0, 1, nu - 2), 3)
    kv = bspline.clamped_knots(np.linspace(0, 300, nv - 2), 3)
    u, y = np.meshgrid(bspline.greville(ku, 3), bspline.greville(kv, 3), indexing="ij")
    x = 100 * u + 120 * np.sin(2 * np.pi * u) + 0.05 * y
    z = 200 * u + 5 * np.sin(y / 60)
    return Patch("limb", (3, 3), ku, kv, np.stack([x, y, z], axis=-1))


def lifted(patch, z, name=None):
    """The patch with other heights of its control points."""
    control = np.concatenate([patch.control[..., :2], np.asarray(z)[..., None]], axis=-1)
    return replace(patch, control=control, name=patch.name if name is None else name)


def split(patch, cuts_u, cuts_v):
    """Cut a patch at breaks into patches p00, p01, ...; each is an exact restriction."""
    ku, kv = (
        np.sort(np.concatenate([k, *(np.full(d - np.sum(k == c), c) for c in cuts)]))
        for k, d, cuts in ((patch.knots_u, patch.degree[0], cuts_u), (patch.knots_v, patch.degree[1], cuts_v))
    )
    to_u = bspline.insertion_matrix(patch.knots_u, ku, patch.degree[0])
    to_v = bspline.insertion_matrix(patch.knots_v, kv, patch.degree[1])
    control = np.einsum("ai,bj,ijk->abk", to_u, to_v, patch.control)
    return tuple(
        Patch(f"p{i}{j}", patch.degree, one, two, control[a : a + na, b : b + nb].copy())
        for i, (a, na, one) in enumerate(_parts(ku, patch.degree[0], cuts_u))
        for j, (b, nb, two) in enumerate(_parts(kv, patch.degree[1], cuts_v))
    )


def _parts(knots, degree, cuts):
    ends = [knots[0], *cuts, knots[-1]]
    for low, high in pairwise(ends):
        inner = knots[(knots > low) & (knots < high)]
        first = 0 if low == knots[0] else int(np.searchsorted(knots, low)) - 1
        yield (
            first,
            len(inner) + degree + 1,
            np.concatenate([[low] * (degree + 1), inner, [high] * (degree + 1)]),
        )


def horizon(patches, points=None, core=None, name="T1", outline=None, seam="tangent"):
    points = PointSet(np.empty((0, 3)) if points is None else points)
    core = np.zeros(len(points), bool) if core is None else core
    outline = None if outline is None else np.asarray(outline, float) + ORIGIN[:2]
    settings = FitSettings(seam=seam)
    return HorizonFit(PatchSurface(tuple(patches), ORIGIN, name, outline), points, settings, name, core=core)


def nine():
    """Nine patches of one wavy surface, cut at knots."""
    whole = height_field()
    u, v = np.unique(whole.knots_u), np.unique(whole.knots_v)
    return whole, split(whole, [u[6], u[15]], [v[4], v[11]])


def bored(path, patches):
    """Write patches of 1,000 by 700 m as BREP, bored from above in three places, one of them on the rim.

    Return the area (OpenCASCADE's own) and the length of the rim in plan.
    """
    import cadquery as cq
    from OCP.BRepAlgoAPI import BRepAlgoAPI_Cut
    from OCP.BRepGProp import BRepGProp
    from OCP.BRepTools import BRepTools
    from OCP.GProp import GProp_GProps
    from OCP.TopLoc import TopLoc_Location

    from geofit.cad.sewing import shell

    shape = shell(horizon(patches)).Located(TopLoc_Location())
    for x, y, radius in ((500, 350, 120), (250, 180, 60), (700, 700, 90)):
        drill = cq.Solid.makeCylinder(radius, 1000, cq.Vector(x, y, -500)).wrapped
        shape = BRepAlgoAPI_Cut(shape, drill).Shape()
    BRepTools.Write_s(shape, str(path))
    figures = GProp_GProps()
    BRepGProp.SurfaceProperties_s(shape, figures, 1e-9)
    return figures.Mass(), 3400 + 2 * np.pi * (120 + 60) + (np.pi - 2) * 90


def area(corners):
    """Area of triangles (m, 3, 3)."""
    return np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1).sum() / 2
