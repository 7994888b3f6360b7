"""Options of the commands that read rock volumes."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from geofit.data.errors import SettingsError
from geofit.data.legible import legible
from geofit.data.messages import message

__all__ = ["ArrayName", "PoreLabel", "Shape", "VolumeFile", "VoxelEdge", "read_options", "stem_of"]

VolumeFile = Annotated[
    Path, typer.Argument(metavar="VOLUME", help="tif, raw, mhd, npy, npz, zarr (also .gz, .zip), folder of slices.")
]
PoreLabel = Annotated[list[float], typer.Option(help="Value of pore voxels; may be repeated. Never guessed.")]
VoxelEdge = Annotated[
    str | None, typer.Option(help="Edge of a voxel, m; or three, by comma. Default: the file's, where it states one.")
]
Shape = Annotated[str | None, typer.Option(help="Raw file: voxels along each axis, slowest first: 200,200,100.")]
ArrayName = Annotated[
    str | None,
    typer.Option("--name", help="Which of several: array of an npz file or zarr store, file of a zip archive."),
]


def read_options(
    source: Path, pore: list[float], voxel: str | None, shape: str | None, name: str | None
) -> dict[str, Any]:
    """Return the options of a volume as :func:`geofit.read_volume` and :func:`geofit.open_volume` take them.

    Raises
    ------
    SettingsError
        If the voxel or the shape is not a list of numbers.
    """
    edges = None if voxel is None else _numbers(voxel, "--voxel")
    return {
        "path": source,
        "pore": pore[0] if len(pore) == 1 else pore,
        "voxel": edges[0] if edges is not None and len(edges) == 1 else edges,
        "shape": None if shape is None else [round(n) for n in _numbers(shape, "--shape")],
        "name": name,
    }


def stem_of(source: Path) -> str:
    """Return the name of a volume without its endings: ``berea.raw.gz`` is ``berea``."""
    return legible(source.name.split(".")[0]) or "volume"


def _numbers(text: str, option: str) -> list[float]:
    try:
        numbers = [float(part) for part in text.split(",")]
    except ValueError:
        numbers = []
    if len(numbers) not in (1, 3):
        raise SettingsError(
            message(
                "cli.not-one-or-three-numbers",
                "{option} '{text}' is not a number, or three with commas between them.",
                option=option,
                text=text,
            )
        )
    return numbers
