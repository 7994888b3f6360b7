"""The picture of a surface in space: OpenGL without a window, or a message where there is none."""

from __future__ import annotations

import ctypes
import os
import sys
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from geofit.data.errors import MissingDependencyError
from geofit.data.messages import Message, message
from geofit.data.site import Hole
from geofit.fitting.horizon_fit import HorizonFit
from geofit.report.result import HorizonResult
from geofit.report.style import kind_style
from geofit.report.view import cut_edges, rims, trimmed

if TYPE_CHECKING:
    import pyvista

__all__ = [
    "NO_OPENGL",
    "Scene",
    "elevation_colours",
    "horizon_scene",
    "mesh_scene",
    "network_scene",
    "require_rendering",
    "site_scene",
]

Floats = NDArray[np.float64]

NO_OPENGL = message(
    "report.picture-without-opengl",
    "The 3D picture is missing: this machine has no OpenGL library. "
    "Install one (Debian and Ubuntu: apt-get install libgl1 libegl1 libxrender1) and run again.",
)

#: Steps of a patch's mesh on each side.
STEPS = 90
#: Opacity of horizons that stand behind each other.
SHEER = 0.55
#: Heights are raised by a whole number, at most MOST_RAISED, until it is this share of the width.
LEAST_HEIGHT, MOST_RAISED = 0.14, 5
#: Points and holes are not drawn if they lie farther outside the surfaces' extent than that is wide. Nor are those
#: whose height, exaggerated, differs from the median by more than that, and by this many times the usual difference.
FAR = 8.0
#: Pores of a network are drawn so much smaller, so that the throats are seen.
BALL = 0.6
#: Pixels around what is drawn, for points and lines that are wider than their places.
AROUND = 16
#: Direction of the viewpoint: from the south-west, above.
VIEWPOINT = (-0.5, -0.8, 0.62)


@dataclass(frozen=True, eq=False)
class Scene:
    """A picture in space: ``image`` (height, width, 3) pixels without a margin, heights times ``raised``.

    ``limits`` are the elevations at the ends of the colours, metres. ``low`` and ``high`` are the corners of the box
    around what is drawn, map coordinates; ``to_pixels`` (2, 4) turns map coordinates and 1 into columns and rows.
    ``omitted`` counts the points or holes that lie too far off to be drawn.
    """

    image: NDArray[np.uint8]
    raised: int
    limits: tuple[float, float]
    low: Floats
    high: Floats
    to_pixels: Floats
    omitted: int = 0

    def pixels(self, xyz: Floats) -> Floats:
        """Return columns and rows (n, 2) of (n, 3) map coordinates."""
        return np.asarray(np.column_stack([xyz, np.ones(len(xyz))]) @ self.to_pixels.T)

    @property
    def caption(self) -> Message:
        """Direction and scale in words."""
        seen = message("report.seen-true-scale", "Seen from the south-west, true scale.")
        if self.raised != 1:
            seen = message("report.seen-exaggerated", "Seen from the south-west, heights × {times}.", times=self.raised)
        if self.omitted:
            return message(
                "report.seen-without-far",
                "{seen} Not drawn, too far off: {count}.",
                seen=seen,
                count=self.omitted,
            )
        return seen


def horizon_scene(result: HorizonResult, size: tuple[int, int] = (1600, 1100)) -> Scene:
    """Draw one horizon with its points, coloured by elevation.

    Raises
    ------
    MissingDependencyError
        If there is no OpenGL library.
    """
    plotter = _plotter(size)
    surface = result.surface
    raised = _raised([surface])
    place = _Place(surface.origin, raised)
    mesh = _mesh(surface, place)
    # If one point lies far beyond the outline, the mesh may be too coarse to have a vertex within it.
    z = np.asarray(mesh["elevation"]) if mesh.n_points else surface.points.xyz[:, 2]
    limits = (float(z.min()), max(float(z.max()), float(z.min()) + 1e-3))
    _add_surface(plotter, mesh, cmap=elevation_colours(), clim=limits, scalars="elevation")
    _add_contours(plotter, mesh, limits)
    core = rims(surface, steps=400).get("core")
    if core is not None and len(surface.patches) > 1:
        _add_rim(plotter, surface, core, place, color="#0b2f4a", line_width=6)
        for line in cut_edges(surface, "core"):
            plotter.add_mesh(_line(place(line)), color="#0b2f4a", line_width=6)
    xyz = surface.points.xyz
    far = _far(xyz, raised, surface)
    _add_points(plotter, place(xyz[~far]))
    return replace(_image(plotter, place, raised, limits), omitted=int(far.sum()))


def site_scene(
    surfaces: Sequence[HorizonFit],
    colours: Sequence[str],
    holes: Sequence[Hole] = (),
    size: tuple[int, int] = (1800, 1300),
) -> Scene:
    """Draw all horizons of a site, each in its colour, with the site's holes.

    Raises
    ------
    MissingDependencyError
        If there is no OpenGL library.
    """
    plotter = _plotter(size)
    plotter.enable_depth_peeling(8)
    raised = _raised(surfaces)
    place = _Place(surfaces[0].origin, raised)
    sheer = _opacities(surfaces)
    for i, surface in enumerate(surfaces):
        _add_surface(plotter, _mesh(surface, place), color=colours[i], opacity=sheer[i])
        for rim in rims(surface, steps=400).values():
            _add_rim(plotter, surface, rim, place, color="#1c2733", line_width=2, opacity=0.35)
    far = _far(np.array([hole.xyz.mean(axis=0) for hole in holes]).reshape(-1, 3), raised, *surfaces)
    for hole in (hole for hole, gone in zip(holes, far, strict=True) if not gone):
        plotter.add_mesh(_line(place(hole.xyz)), color=kind_style(hole.kind)[1], line_width=4)
    return replace(_image(plotter, place, raised, (0.0, 0.0), boxed=True), omitted=int(far.sum()))


def mesh_scene(
    vertices: Floats, triangles: NDArray[np.integer], points: Floats, colour: str, size: tuple[int, int] = (1600, 1200)
) -> Scene:
    """Draw a closed triangle mesh with points on it, in its box.

    Parameters
    ----------
    vertices : (n, 3) array
        Map coordinates, metres.
    triangles : (m, 3) array of int
        Corners of the triangles.
    points : (k, 3) array
        Map coordinates, metres.
    colour : str
        #rrggbb.
    size : tuple of int
        Pixels.

    Raises
    ------
    MissingDependencyError
        If there is no OpenGL library.
    """
    plotter = _plotter(size)
    import pyvista

    place = _Place((vertices.min(axis=0) + vertices.max(axis=0)) / 2, 1)
    faces = np.column_stack([np.full(len(triangles), 3), triangles])
    _add_surface(plotter, pyvista.PolyData(place(vertices), faces.ravel()), color=colour)
    _add_points(plotter, place(points))
    return _image(plotter, place, 1, (0.0, 0.0), boxed=True)


def network_scene(
    centre: Floats, radius: Floats, links: NDArray[np.integer], size: Floats, pixels: tuple[int, int] = (1600, 1200)
) -> Scene:
    """Draw a pore network: a ball for each pore, coloured by its radius, a line for each throat, the sample's box.

    Parameters
    ----------
    centre, radius : (n, 3) and (n,) arrays
        Of the pores, in one unit.
    links : (m, 2) array of int
        Pores that throats join.
    size : (3,) array
        Edges of the sample.
    pixels : tuple of int
        Size of the picture.

    Raises
    ------
    MissingDependencyError
        If there is no OpenGL library.
    """
    plotter = _plotter(pixels)
    import pyvista

    place = _Place(size / 2, 1)
    cloud = pyvista.PolyData(place(centre))
    cloud["radius"] = radius.astype(np.float32)
    ball = pyvista.Sphere(radius=1.0, theta_resolution=14, phi_resolution=14)
    balls = cloud.glyph(geom=ball, scale="radius", factor=BALL, orient=False)
    plotter.add_mesh(balls, scalars="radius", cmap=elevation_colours(), show_scalar_bar=False, smooth_shading=True)
    if len(links):
        lines = np.column_stack([np.full(len(links), 2), links])
        plotter.add_mesh(pyvista.PolyData(place(centre), lines=lines.ravel()), color="#3a4652", line_width=5)
    plotter.add_mesh(pyvista.Box(np.column_stack([-size / 2, size / 2]).ravel()), style="wireframe", color="#9aa7b4")
    return _image(plotter, place, 1, (float(radius.min()), float(radius.max())), boxed=True)


def elevation_colours() -> Any:
    """Return the colour map of elevations: from deep water blue to dry ochre, lightness rising throughout."""
    from matplotlib.colors import LinearSegmentedColormap

    return LinearSegmentedColormap.from_list("ground", ["#23506b", "#55877f", "#9dba8c", "#e2d9a4", "#f3e6c8"])


def _opacities(surfaces: Sequence[HorizonFit]) -> list[float]:
    """Return how opaque each horizon is: what stands steep and the lowest whole, what hides others sheer."""
    heights = [float(np.mean([rim[:, 2].mean() for rim in rims(surface).values()])) for surface in surfaces]
    steep = [surface.frame in ("best-plane", "sections") for surface in surfaces]
    return [1.0 if stands or z <= min(heights) else SHEER for z, stands in zip(heights, steep, strict=True)]


class _Place:
    """Map coordinates to the picture's: about a centre, because float32 carries 7 digits; heights raised."""

    def __init__(self, centre: Floats, raised: int) -> None:
        self.centre, self.scale = centre, np.array([1.0, 1.0, raised])

    def __call__(self, xyz: Floats) -> NDArray[np.float32]:
        return np.asarray((xyz - self.centre) * self.scale, np.float32)


def _raised(surfaces: Sequence[HorizonFit]) -> int:
    xyz = np.concatenate([rim for s in surfaces for rim in rims(s).values()])
    width, height = np.ptp(xyz[:, :2], axis=0).max(), np.ptp(xyz[:, 2])
    return int(np.clip(np.ceil(LEAST_HEIGHT * width / max(height, 1e-9)), 1, MOST_RAISED))


def _far(xyz: Floats, raised: int, *surfaces: HorizonFit) -> NDArray[np.bool_]:
    """Mark places (n, 3) so far off that the surfaces would shrink to a speck: a wrong sign, unit or digit."""
    if not len(xyz):
        return np.zeros(0, bool)
    plan = np.concatenate(
        [
            surface.outline if surface.outline is not None else np.concatenate([*rims(surface).values()])[:, :2]
            for surface in surfaces
        ]
    )
    low, high = plan.min(axis=0), plan.max(axis=0)
    width = float((high - low).max())
    outside = np.maximum(low - xyz[:, :2], xyz[:, :2] - high).max(axis=1)
    away = np.abs(xyz[:, 2] - np.median(xyz[:, 2]))
    return np.asarray((outside > width) | (raised * away > max(width, FAR * raised * float(np.median(away)))))


def _plotter(size: tuple[int, int]) -> pyvista.Plotter:
    require_rendering()
    import pyvista

    plotter = pyvista.Plotter(off_screen=True, window_size=list(size), lighting="none")
    plotter.set_background("white")
    # The sun of a hill-shaded map is in the north-west; a weak light beside the eye lifts the shadows.
    plotter.add_light(pyvista.Light(position=(-1, 0.9, 1.1), intensity=0.7, light_type="scene light"))
    plotter.add_light(pyvista.Light(position=VIEWPOINT, intensity=0.5, light_type="scene light"))
    return plotter


def require_rendering() -> None:
    """Raise a :class:`MissingDependencyError` if there is no OpenGL library; choose EGL where there is no screen."""
    if not opengl_found():
        raise MissingDependencyError(NO_OPENGL)
    # Otherwise pyvista opens a window of its own to find out the same.
    os.environ.setdefault("ALLOW_PLOTTING", "true")
    if sys.platform.startswith("linux") and not os.environ.get("DISPLAY"):
        # VTK would try the X server first, and complain.
        os.environ.setdefault("VTK_DEFAULT_OPENGL_WINDOW", "vtkEGLRenderWindow")


def opengl_found() -> bool:
    """Whether VTK will find a way to draw: it aborts the process where it does not."""
    if not sys.platform.startswith("linux"):
        return True
    for name in ("libGL.so.1", "libEGL.so.1") if os.environ.get("DISPLAY") else ("libEGL.so.1",):
        try:
            ctypes.CDLL(name)
        except OSError:
            return False
    return True


def _mesh(surface: HorizonFit, place: _Place) -> pyvista.PolyData:
    """Return the patches as triangles, cut along the outline of the study area."""
    import pyvista

    share = np.linspace(0, 1, STEPS)
    number = np.arange(STEPS**2).reshape(STEPS, STEPS)
    a, b, c, d = (part.ravel() for part in (number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]))
    triangles = np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)])
    points = []
    for patch in surface.patches:
        u0, u1, v0, v1 = patch.domain
        points.append(patch.evaluate(u0 + share[:, None] * (u1 - u0), v0 + share[None] * (v1 - v0)).reshape(-1, 3))
    true = np.concatenate(points) + surface.origin
    faces = (np.arange(len(points))[:, None, None] * STEPS**2 + triangles).reshape(-1, 3)
    mesh = pyvista.PolyData.from_regular_faces(place(true), faces)
    mesh["elevation"] = true[:, 2]
    if surface.outline is not None:
        mesh["inside"] = np.clip(trimmed(surface, true[:, 0], true[:, 1]), -1e6, 1e6)
        mesh = mesh.clip_scalar(scalars="inside", value=0.0, invert=False)
    return mesh


def _add_surface(plotter: pyvista.Plotter, mesh: pyvista.PolyData, **style: Any) -> None:
    if mesh.n_points:
        plotter.add_mesh(mesh, smooth_shading=True, specular=0.05, ambient=0.15, show_scalar_bar=False, **style)


def _add_rim(plotter: pyvista.Plotter, surface: HorizonFit, rim: Floats, place: _Place, **style: Any) -> None:
    """Draw a patch's edge as far as it lies in the study area."""
    inside = trimmed(surface, rim[:, 0], rim[:, 1]) > -1e-6
    for run in np.split(np.arange(len(rim)), np.flatnonzero(np.diff(inside)) + 1):
        if inside[run[0]] and len(run) > 1:
            plotter.add_mesh(_line(place(rim[run])), **style)


def _add_contours(plotter: pyvista.Plotter, mesh: pyvista.PolyData, limits: tuple[float, float]) -> None:
    from matplotlib.ticker import MaxNLocator

    levels = MaxNLocator(14, steps=[1, 2, 5, 10]).tick_values(*limits)
    lines = mesh.contour(isosurfaces=list(levels), scalars="elevation") if mesh.n_points else mesh
    if lines.n_points:
        plotter.add_mesh(lines, color="#22303c", line_width=2, opacity=0.5, show_scalar_bar=False)


def _add_points(plotter: pyvista.Plotter, local: NDArray[np.float32]) -> None:
    import pyvista

    if len(local):
        plotter.add_mesh(
            pyvista.PolyData(local), color="#14202b", point_size=9 if len(local) < 3000 else 3,
            render_points_as_spheres=True,
        )  # fmt: skip


def _line(local: NDArray[np.float32]) -> pyvista.PolyData:
    import pyvista

    return pyvista.lines_from_points(local)


def _image(
    plotter: pyvista.Plotter, place: _Place, raised: int, limits: tuple[float, float], *, boxed: bool = False
) -> Scene:
    """Take the picture, and cut its margin off; ``boxed``: keep room for the box around what is drawn."""
    low, high = np.reshape(plotter.bounds, (3, 2)).T / place.scale + place.centre
    plotter.camera_position = [VIEWPOINT, (0.0, 0.0, 0.0), (0.0, 0.0, 1.0)]
    plotter.enable_parallel_projection()
    plotter.enable_anti_aliasing("ssaa")
    plotter.reset_camera()
    plotter.camera.zoom(1.0 if boxed else _closest(plotter))
    _narrow(plotter, boxed=boxed)
    image = np.asarray(plotter.screenshot(return_img=True))[..., :3]
    to_pixels = _projection(plotter, image.shape[:2], place)
    plotter.close()
    # Channel by channel: numpy's minimum over an axis of length three is far slower.
    red, green, blue = np.moveaxis(image, 2, 0)
    drawn = np.minimum(np.minimum(red, green), blue) < 250
    rows, columns = np.flatnonzero(drawn.any(axis=1)), np.flatnonzero(drawn.any(axis=0))
    if not rows.size:
        return Scene(image.copy(), raised, limits, low, high, to_pixels)
    first, last = np.array([columns[0], rows[0]]), np.array([columns[-1], rows[-1]]) + 1
    if boxed:
        corners = np.stack(np.meshgrid(*np.stack([low, high], axis=1)), axis=-1).reshape(-1, 3)
        flat = np.column_stack([corners, np.ones(8)]) @ to_pixels.T
        first = np.minimum(first, np.floor(flat.min(axis=0)).astype(int)).clip(0)
        last = np.maximum(last, np.ceil(flat.max(axis=0)).astype(int)).clip(None, [image.shape[1], image.shape[0]])
    to_pixels[:, 3] -= first
    return Scene(image[first[1] : last[1], first[0] : last[0]].copy(), raised, limits, low, high, to_pixels)


def _closest(plotter: pyvista.Plotter) -> float:
    """Return how much larger the picture may be drawn: most are flat, and leave room above and below."""
    camera, (wide, tall) = plotter.camera, plotter.window_size
    places = np.concatenate([np.asarray(mesh.points, float) for mesh in plotter.meshes if mesh.n_points])
    flat = np.abs((places - np.asarray(camera.focal_point)) @ np.stack(_across(plotter), axis=1))
    most = (flat.max(axis=0) / (camera.parallel_scale * np.array([wide / tall, 1.0]))).max()
    return float(min(1.15, 0.98 / most))


def _narrow(plotter: pyvista.Plotter, *, boxed: bool) -> None:
    """Make the window as small as what is drawn in it, at the same scale: all else would be drawn as well, and cut off.

    Without room for the box nothing beyond the window as it was is kept.
    """
    camera = plotter.camera
    wide, tall = plotter.window_size
    right, up = _across(plotter)
    corners = np.stack(np.meshgrid(*np.reshape(plotter.bounds, (3, 2))), axis=-1).reshape(-1, 3)
    scale = tall / (2 * camera.parallel_scale)
    flat = (corners - np.asarray(camera.focal_point)) @ np.stack([right, up], axis=1) * scale
    low, high = flat.min(axis=0) - AROUND, flat.max(axis=0) + AROUND
    if not boxed:
        half = np.array([wide, tall]) / 2
        low, high = np.maximum(low, -half), np.minimum(high, half)
    size = np.ceil(high - low).astype(int)
    move = ((low + high) / 2 / scale) @ np.stack([right, up])
    camera.position, camera.focal_point = np.asarray(camera.position) + move, np.asarray(camera.focal_point) + move
    camera.parallel_scale = size[1] / (2 * scale)
    plotter.window_size = size.tolist()


def _across(plotter: pyvista.Plotter) -> tuple[Floats, Floats]:
    """Return the directions that are right and up in the picture."""
    camera = plotter.camera
    back = np.subtract(camera.position, camera.focal_point)
    back = back / np.linalg.norm(back)
    right = np.cross(camera.up, back)
    right /= np.linalg.norm(right)
    return right, np.cross(back, right)


def _projection(plotter: pyvista.Plotter, shape: tuple[int, ...], place: _Place) -> Floats:
    """Return the (2, 4) matrix from map coordinates to columns and rows of a parallel projection."""
    camera = plotter.camera
    right, up = _across(plotter)
    tall, wide = shape
    scale = tall / (2 * camera.parallel_scale)
    linear = np.stack([right, -up]) * scale
    start = np.array([wide / 2, tall / 2]) - linear @ np.asarray(camera.focal_point)
    of_map = linear * place.scale
    return np.column_stack([of_map, start - of_map @ place.centre])
