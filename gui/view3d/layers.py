"""What is shown in the scene, and how: a list of layers that tells its listeners of changes. No Qt, no VTK."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import Any

__all__ = ["Layer", "Layers", "Legend", "Swatch"]

#: What happened ("added", "removed", "changed", "cleared") and to which layer.
Listener = Callable[[str, str], None]


@dataclass(frozen=True)
class Swatch:
    """One line of a legend: a colour, and a text that is shown as it is (``plain``) or translated by the window."""

    colour: str
    text: str
    plain: bool = True


@dataclass(frozen=True)
class Legend:
    """What the colours of a layer mean: single colours, or a ramp from ``low`` to ``high`` in ``unit``.

    ``title`` is a way of colouring (see Layer.colour_by). ``count`` is how many points each swatch represents.
    ``beyond``: something drawn is larger than ``high``.
    """

    title: str
    unit: str = ""
    swatches: tuple[Swatch, ...] = ()
    ramp: tuple[str, ...] = ()
    low: float = 0.0
    high: float = 0.0
    beyond: bool = False


@dataclass(frozen=True)
class Layer:
    """One thing in the scene.

    Parameters
    ----------
    key : str
        Its name in the list: the kind, and the horizon after a colon.
    kind : str
        "ground", "boundary", "holes", "adits", "sections", "dips", "points", "surface", "seams", "control",
        "upper", "lower" or "suggestions".
    horizon : str
        Name of the horizon; empty for what belongs to the whole site.
    colour : str
        Colour of the horizon, or of the layer where it is plain.
    visible, opacity
        Whether it is drawn; 0 (clear) to 1 (opaque).
    choices : tuple of str
        Ways of colouring it; ``colour_by`` is the one in use.
    isolines, labels : bool or None
        Whether lines of equal elevation, or names, are drawn; None where the layer has none.
    legend : Legend or None
        What the colours mean.
    """

    key: str
    kind: str
    horizon: str = ""
    colour: str = ""
    visible: bool = True
    opacity: float = 1.0
    choices: tuple[str, ...] = ("plain",)
    colour_by: str = "plain"
    isolines: bool | None = None
    labels: bool | None = None
    legend: Legend | None = None


class Layers:
    """The layers in the order of the list; ``subscribe`` to hear of changes."""

    def __init__(self) -> None:
        self._layers: dict[str, Layer] = {}
        #: Layers as they were when all were taken out: what a person chose holds if they come back.
        self.kept: dict[str, Layer] = {}
        self.listeners: list[Listener] = []

    def __iter__(self) -> Iterator[Layer]:
        return iter(tuple(self._layers.values()))

    def __len__(self) -> int:
        return len(self._layers)

    def __contains__(self, key: str) -> bool:
        return key in self._layers

    def __getitem__(self, key: str) -> Layer:
        return self._layers[key]

    def subscribe(self, listener: Listener) -> Callable[[], None]:
        """Call ``listener(what, key)`` after every change; returns the function that ends it."""
        self.listeners.append(listener)
        return lambda: self.listeners.remove(listener)

    def add(self, layer: Layer) -> Layer:
        """Add a layer, or renew one of the same key, which keeps what a person has chosen for it."""
        old, kept = self._layers.get(layer.key), self.kept.pop(layer.key, None)
        chosen = kept or old
        if chosen is not None:
            layer = _as_chosen(layer, chosen)
        self._layers[layer.key] = layer
        self._tell("changed" if old is not None else "added", layer.key)
        return layer

    def remove(self, key: str) -> None:
        """Take a layer out, if it is there, and forget what was chosen for it."""
        self.kept.pop(key, None)
        if self._layers.pop(key, None) is not None:
            self._tell("removed", key)

    def clear(self, *, keep: bool = False) -> None:
        """Take all layers out; ``keep`` what was chosen for them."""
        self.kept = {**self.kept, **self._layers} if keep else {}
        self._layers.clear()
        self._tell("cleared", "")

    def rename(self, present: Callable[[str], str | None]) -> None:
        """Keep what was chosen for horizons under their present names; None for one that is gone but may come back."""
        kept = {}
        for layer in self.kept.values():
            new = present(layer.horizon) if layer.horizon else None
            layer = layer if new is None else replace(layer, key=f"{layer.kind}:{new}", horizon=new)
            kept[layer.key] = layer
        self.kept = kept

    def take_over(self, other: Layers) -> None:
        """Take what was chosen in another list, for layers that are there and for those that come."""
        self.kept = {**other.kept, **other._layers}
        for layer in self:
            if layer.key in self.kept:
                self.add(layer)

    def change(self, key: str, **changes: Any) -> None:
        """Change fields of a layer; no signal is sent where nothing changes.

        Raises
        ------
        ValueError
            If ``colour_by`` is not among the layer's choices, or the opacity not in 0 to 1.
        """
        old = self._layers[key]
        new = replace(old, **changes)
        if new.colour_by not in new.choices:
            raise ValueError(f"{key} cannot be coloured by '{new.colour_by}'; choose one of {', '.join(new.choices)}.")
        if not 0 <= new.opacity <= 1:
            raise ValueError(f"The opacity of {key} is {new.opacity}; give a number from 0 to 1.")
        if new != old:
            self._layers[key] = new
            self._tell("changed", key)

    def only(self, key: str) -> None:
        """Show one layer and hide the others."""
        for layer in self:
            self.change(layer.key, visible=layer.key == key)

    def _tell(self, what: str, key: str) -> None:
        for listener in tuple(self.listeners):
            listener(what, key)


def _as_chosen(layer: Layer, old: Layer) -> Layer:
    """Return a layer with what a person has chosen for it before."""
    return replace(
        layer,
        visible=old.visible,
        opacity=old.opacity,
        colour_by=old.colour_by if old.colour_by in layer.choices else layer.colour_by,
        isolines=layer.isolines if old.isolines is None else old.isolines,
        labels=layer.labels if old.labels is None else old.labels,
    )
