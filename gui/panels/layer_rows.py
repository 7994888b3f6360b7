"""Layers of the scene as rows of the project tree: each hangs under what it belongs to."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from geofit.gui.panels.marks import icon
from geofit.gui.panels.tree_model import TreeRow
from geofit.gui.view3d.layer_names import layer_title, word
from geofit.gui.view3d.layers import Layer, Layers

__all__ = ["LAYERS_OF_GROUPS", "hang", "layers_of_row", "renew_row"]

#: Which layer a heading of the tree has.
LAYERS_OF_GROUPS = {"borehole": "holes", "adit": "adits", "sections": "sections"}
#: What is seen only when somebody asks for it: opening the eye of a horizon leaves it closed.
ASIDE = ("upper", "lower", "suggestions")


def hang(layers: Layers, groups: Iterable[TreeRow]) -> list[TreeRow]:
    """Give rows their layers, hang further layers below them, and return rows of the layers that belong to none."""
    every = list(groups)
    owners = {row.target: row for group in every for row in group.rows}
    heads = {LAYERS_OF_GROUPS.get(head.target[1]): head for head in every}
    rest: list[TreeRow] = []
    under: dict[tuple[str, str], list[TreeRow]] = {}
    for layer in layers:
        owner = owners.get(("body" if layer.kind.startswith("body") else "horizon", layer.horizon))
        if owner is not None and layer.key == _main(layers, layer):
            owner.layer = layer.key
        elif owner is not None:
            under.setdefault(owner.target, []).append(_row(layer, word(layer.kind)))
        elif layer.key in heads:
            heads[layer.key].layer = layer.key
        else:
            rest.append(_row(layer, layer_title(layer.kind, layer.horizon)))
    for target, rows in under.items():
        owners[target].rows[:0] = rows
    for row in [*owners.values(), *heads.values()]:
        renew_row(row, layers)
    return rest


def renew_row(row: TreeRow, layers: Layers) -> None:
    """Give a row the eye and the opacity of its layer; a horizon is shown where anything of it is."""
    if row.layer not in layers:
        return
    layer = layers[row.layer]
    row.opacity = layer.opacity
    if row.target[0] != "body":
        row.checked = any(layers[key].visible for key in layers_of_row(row, layers))


def layers_of_row(row: TreeRow, layers: Layers, *, opened: bool = False) -> Iterator[str]:
    """Yield the layers that the eye of a row closes, or those that it opens."""
    if row.target[0] != "horizon":
        yield row.layer
        return
    for layer in layers:
        own = layer.horizon == row.target[1] and not layer.kind.startswith("body")
        if own and not (opened and layer.kind in ASIDE):
            yield layer.key


def _main(layers: Layers, layer: Layer) -> str:
    """Return the layer that the row of a horizon or a body has."""
    if layer.kind.startswith("body"):
        return f"body:{layer.horizon}"
    surface = f"surface:{layer.horizon}"
    return surface if surface in layers else f"points:{layer.horizon}"


def _row(layer: Layer, text: str) -> TreeRow:
    mark = icon(f"layer:{layer.colour}") if layer.colour else None
    words = layer_title(layer.kind, layer.horizon)
    return TreeRow(
        text, ("layer", layer.key), None, mark, words, layer=layer.key, checked=layer.visible, opacity=layer.opacity
    )
