"""Bodies in the scene: their triangles, and the contacts and logged intervals that they were fitted to."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from geofit.bodies.data import BodyData
from geofit.gui.view3d.actors import ActorPart, dots, lines, poly
from geofit.gui.view3d.colouring import legible_on
from geofit.gui.view3d.horizon_items import shape_item
from geofit.gui.view3d.item import Item, Look, corners_of
from geofit.gui.view3d.layers import Layer
from geofit.gui.view3d.shape import Shape, thinned
from geofit.gui.view3d.site_items import DRILLED
from geofit.gui.view3d.stage import Stage
from geofit.implicit.mesh import TriangleMesh

__all__ = ["BodyScene", "MorphScene", "body_shape"]

Floats = NDArray[np.float64]

#: Sizes of contacts and widths of logged stretches, logical pixels.
CONTACT, INSIDE, OUTSIDE = 6.0, 4.0, 2.0
#: Opacity of the ends of a metamorphosis.
SKIN = 0.18


def body_shape(mesh: TriangleMesh, *, coarse: bool = True) -> Shape:
    """Return the triangles of a body (map coordinates) with smooth normals; ``coarse`` with few while moving."""
    total = np.zeros(mesh.vertices.shape)
    for k in range(3):
        np.add.at(total, mesh.triangles[:, k], mesh.area_vectors)
    length = np.linalg.norm(total, axis=1, keepdims=True)
    normals = np.where(length > 0, total / np.maximum(length, 1e-300), (0.0, 0.0, 1.0))
    fine = Shape(mesh.vertices, mesh.triangles, normals)
    return Shape(fine.xyz, fine.triangles, fine.normals, thinned(fine)) if coarse else fine


class BodyScene:
    """Shows bodies as layers "body:NAME", and what they were fitted to as "body data:NAME"."""

    def __init__(self, stage: Stage) -> None:
        self._stage = stage
        self._shown: dict[str, object] = {}
        self._seen: dict[str, bool] = {}

    def show(self, name: str, mesh: TriangleMesh, colour: str, opacity: float, visible: bool) -> None:
        """Show a body, or its new fit or style; an empty mesh shows nothing."""
        key = f"body:{name}"
        if not len(mesh.triangles):
            self.remove(name)
            return
        if self._shown.get(key) is not mesh or key not in self._stage.layers:
            shape = body_shape(mesh)
            self._stage.show(
                Layer(key, "body", name, colour, visible, opacity),
                lambda layer, look: shape_item(shape, None, layer, look),
            )
            self._shown[key] = mesh
        self._stage.layers.change(key, colour=colour, opacity=opacity, visible=visible)

    def show_data(self, name: str, data: BodyData | None, colour: str, visible: bool) -> None:
        """Show contacts and logged stretches of a body; None takes them away."""
        key = f"body data:{name}"
        if data is None:
            self._stage.layers.remove(key)
            self._shown.pop(key, None)
            return
        if self._shown.get(key) is not data or key not in self._stage.layers:
            self._stage.show(Layer(key, "body data", name, colour, visible), lambda a, b: _data_item(data, a, b))
            self._shown[key] = data
        self._stage.layers.change(key, colour=colour)
        if self._seen.get(key) != visible:
            # Hidden and shown with its body; otherwise as the list of layers has it.
            self._seen[key] = visible
            self._stage.layers.change(key, visible=visible)

    def remove(self, name: str) -> None:
        """Take a body away with its data."""
        for key in (f"body:{name}", f"body data:{name}"):
            self._stage.layers.remove(key)
            self._shown.pop(key, None)
            self._seen.pop(key, None)

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the bodies in the scene."""
        return tuple(layer.horizon for layer in self._stage.layers if layer.kind == "body")


def _drawn(shape: Shape) -> Callable[[Layer, Look], Item]:
    return lambda layer, look: shape_item(shape, None, layer, look)


class MorphScene:
    """Shows a frame of a metamorphosis, and its ends as skins that can be seen through."""

    def __init__(self, stage: Stage) -> None:
        self._stage = stage

    def show_frame(self, name: str, mesh: TriangleMesh, colour: str) -> None:
        """Show a frame in place of the one before."""
        shape = body_shape(mesh, coarse=False)
        self._stage.show(
            Layer("morph", "morph", name, colour), lambda layer, look: shape_item(shape, None, layer, look)
        )

    def show_ends(self, ends: Sequence[tuple[str, TriangleMesh, str]]) -> None:
        """Show ends by name, triangles in map coordinates and colour."""
        wanted = {f"morph end:{k}" for k in range(len(ends))}
        for layer in self._stage.layers:
            if layer.kind == "morph end" and layer.key not in wanted:
                self._stage.layers.remove(layer.key)
        for k, (name, mesh, colour) in enumerate(ends):
            shape = body_shape(mesh)
            layer = Layer(f"morph end:{k}", "morph end", name, colour, opacity=SKIN)
            self._stage.show(layer, _drawn(shape))

    def clear(self) -> None:
        """Take everything away."""
        self.show_ends(())
        self._stage.layers.remove("morph")


def _data_item(data: BodyData, layer: Layer, look: Look) -> Item:
    colour = legible_on(layer.colour, look.dark)
    every = [data.contacts]
    parts = [ActorPart(dots(poly(data.contacts - look.origin), colour, balls=True), size=CONTACT)]
    ways: list[tuple[str, Floats]] = []
    for xyz, hole, shade, width in (
        (data.outside, data.outside_hole, DRILLED[look.dark], OUTSIDE),
        (data.inside, data.inside_hole, colour, INSIDE),
    ):
        runs = [run for run in _holes(hole) if len(run[1]) > 1]
        if runs:
            parts.append(ActorPart(lines(poly(xyz - look.origin, runs=_joined(xyz, runs)), shade, 1.0), width=width))
        ways += [(name, xyz[index]) for name, index in runs]
        every.append(xyz)
    return Item(parts, corners_of(np.concatenate(every)), ways=tuple(ways))


def _holes(names: NDArray[np.str_]) -> Sequence[tuple[str, NDArray[np.int64]]]:
    return [(name, np.flatnonzero(names == name)) for name in np.unique(names[names != ""]).tolist()]


def _joined(xyz: Floats, runs: Sequence[tuple[str, NDArray[np.int64]]]) -> list[NDArray[np.int64]]:
    """Return runs of samples that follow each other in a hole: a longer step leads over the other side."""
    joined = []
    for _, index in runs:
        step = np.linalg.norm(np.diff(xyz[index], axis=0), axis=1)
        breaks = np.flatnonzero(step > 1.5 * np.median(step)) + 1
        joined += [part for part in np.split(index, breaks) if len(part) > 1]
    return joined
