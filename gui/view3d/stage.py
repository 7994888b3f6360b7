"""Keeps the actors in step with the list of layers."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from geofit.gui.view3d.actors import ActorPart
from geofit.gui.view3d.item import Item, Look
from geofit.gui.view3d.layers import Layer, Layers
from geofit.gui.view3d.projector import Projector

__all__ = ["Stage"]

Floats = NDArray[np.float64]
Builder = Callable[[Layer, Look], Item]

#: Points of clouds that are drawn for each pixel of the still picture, and of the moving one.
STILL, MOVING = 1.5, 0.25


class Stage:
    """Builds the item of each layer, and builds it anew where its colours change.

    ``render`` is asked for after every change; a layer is built when it is first seen.
    """

    def __init__(self, layers: Layers, renderer: Any, window: Any, render: Callable[[], None]) -> None:
        self.layers, self.look = layers, Look(np.zeros(3), False)
        self.clip: Any = None
        self._renderer, self._window, self._render = renderer, window, render
        self._builders: dict[str, Builder] = {}
        self._items: dict[str, Item] = {}
        self._built: dict[str, tuple[object, ...]] = {}
        self._extras: dict[str, list[ActorPart]] = {}
        self._full, self._stretch, self._pixels, self._metres = True, 1.0, 1.0, 1.0
        self._end = layers.subscribe(self._changed)

    def show(self, layer: Layer, builder: Builder) -> None:
        """Add a layer, or renew it."""
        self._builders[layer.key] = builder
        self._built.pop(layer.key, None)
        self.layers.add(layer)

    def rebuild(self, key: str) -> None:
        """Build a layer anew, because what it was built from has changed."""
        self._built.pop(key, None)
        self._update(self.layers[key])

    def items(self) -> Iterator[tuple[Layer, Item]]:
        """Layers that are seen, with what they put into the scene."""
        for layer in self.layers:
            if layer.visible and layer.key in self._items:
                yield layer, self._items[layer.key]

    def box(self, key: str | None = None) -> Floats | None:
        """Return the extent (2, 3) in map coordinates of one layer, or of all that are seen."""
        boxes = [item.box for layer, item in self.items() if key is None or layer.key == key]
        if not boxes:
            return None
        return np.stack([np.min([b[0] for b in boxes], axis=0), np.max([b[1] for b in boxes], axis=0)])

    def set_look(self, look: Look) -> None:
        """Build everything anew for another origin or background."""
        self.look = look
        self._built.clear()
        for layer in self.layers:
            self._update(layer)

    def set_detail(self, full: bool) -> None:
        """Choose between the still and the moving picture."""
        self._full = full
        self._apply_all()

    def renew(self, view: Projector, pixels: int) -> None:
        """Choose the points of the clouds in sight anew for a picture of so many pixels; together they share it."""
        crowds = [item.crowd for _, item in self.items() if item.crowd is not None]
        whole = sum(len(crowd.cloud) for crowd in crowds)
        for crowd in crowds:
            budget = round(pixels * (STILL if self._full else MOVING) * len(crowd.cloud) / whole)
            crowd.renew(view, "full" if self._full else "coarse", budget)

    def set_stretch(self, stretch: float) -> None:
        """Set the vertical exaggeration."""
        self._stretch = stretch
        self._apply_all()

    def set_pixels(self, pixels: float) -> None:
        """Set how many pixels of the picture a logical pixel has."""
        self._pixels = pixels
        self._apply_all()

    def set_metres(self, metres: float) -> None:
        """Set how many metres a logical pixel has where the viewpoint looks; it changes at every step of a flight."""
        self._metres = metres
        for layer in self.layers:
            for part in self._items[layer.key].parts if layer.key in self._items else ():
                if part.spacing:
                    self._style(part, layer.opacity)

    def set_clip(self, planes: Any) -> None:
        """Cut every surface and point by planes (vtkPlaneCollection), or by none."""
        self.clip = planes
        self._apply_all()

    def redraw(self) -> None:
        """Draw once more: what an actor is made of has changed."""
        self._render()

    def set_extra(self, name: str, parts: list[ActorPart]) -> None:
        """Draw something that is not a layer (axes, a tool) in place of what it was; it is never clipped."""
        self._take(self._extras.pop(name, []))
        if parts:
            self._extras[name] = parts
        for part in parts:
            self._renderer.AddActor(part.actor)
            self._style(part, 1.0)
        self._render()

    def close(self) -> None:
        """Take everything out and stop listening."""
        self._end()
        for name in tuple(self._extras):
            self._take(self._extras.pop(name))
        for key in tuple(self._items):
            self._drop(key)
        self._builders.clear()

    def _changed(self, what: str, key: str) -> None:
        if what == "cleared":
            for known in tuple(self._items):
                self._drop(known)
            self._builders.clear()
        elif what == "removed":
            self._drop(key)
            self._builders.pop(key, None)
        elif key in self._builders:
            self._update(self.layers[key])
        self._render()

    def _update(self, layer: Layer) -> None:
        wanted = (layer.colour_by, layer.isolines, layer.labels, layer.colour)
        if layer.visible and self._built.get(layer.key) != wanted:
            self._drop(layer.key)
            item = self._builders[layer.key](layer, self.look)
            self._items[layer.key], self._built[layer.key] = item, wanted
            for part in item.parts:
                self._renderer.AddActor(part.actor)
            if item.legend != layer.legend:
                self.layers.change(layer.key, legend=item.legend)
        if layer.key in self._items:
            self._apply(self.layers[layer.key], self._items[layer.key])

    def _drop(self, key: str) -> None:
        item = self._items.pop(key, None)
        self._built.pop(key, None)
        self._take(item.parts if item is not None else [])

    def _take(self, parts: list[ActorPart]) -> None:
        for part in parts:
            self._renderer.RemoveActor(part.actor)
            part.actor.ReleaseGraphicsResources(self._window)

    def _apply_all(self) -> None:
        for layer in self.layers:
            if layer.key in self._items:
                self._apply(layer, self._items[layer.key])
        for parts in self._extras.values():
            for part in parts:
                self._style(part, 1.0)
        self._render()

    def _apply(self, layer: Layer, item: Item) -> None:
        for part in item.parts:
            fits = part.detail in ("both", "full" if self._full else "coarse")
            part.actor.SetVisibility(layer.visible and fits)
            self._style(part, layer.opacity)
            mapper = part.actor.GetMapper()
            if self.clip is None:
                mapper.RemoveAllClippingPlanes()
            else:
                mapper.SetClippingPlanes(self.clip)

    def _style(self, part: ActorPart, opacity: float) -> None:
        part.actor.GetProperty().SetOpacity(opacity * part.strength(self._metres))
        part.actor.SetScale(1.0, 1.0, self._stretch)
        part.scale(self._pixels)
