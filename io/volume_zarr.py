"""Volumes in zarr stores (extra ``volumes``)."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from geofit.data.errors import InputError
from geofit.data.messages import Untranslated, message
from geofit.io.extra import need

__all__ = ["open_zarr"]


def open_zarr(path: Path, name: str | None) -> Any:
    """Return, unread, an array of a zarr store; ``name`` is its place in a group, such as "0" in OME-Zarr."""
    zarr = need("zarr", "volumes", message("io.reading-zarr-store", "Reading the zarr store {file}", file=path.name))
    node = zarr.open(str(path), mode="r")
    if name is not None:
        node = node[name]
    if not hasattr(node, "shape"):
        names = sorted(node.array_keys())
        if len(names) != 1:
            raise InputError(
                message(
                    "io.several-arrays",
                    "it has {count} arrays: {names}",
                    count=len(names),
                    names=", ".join(names[:8]),
                ),
                message(
                    "io.name-volume",
                    "Leave one in the file, or name it: --name {example} of geofit pores and metaballs, "
                    "name='{example}' in Python.",
                    example=Untranslated(names[0] if names else "..."),
                ),
                file=str(path),
            )
        node = node[names[0]]
    return node
