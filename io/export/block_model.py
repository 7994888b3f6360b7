"""Block model of a body as CSV, OMF or geoh5: centre, edge, field and chance of lying inside."""

from __future__ import annotations

from math import isnan
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING

from geofit.bodies.blocks import BlockModel, block_model
from geofit.data.errors import InputError
from geofit.data.files import replacing
from geofit.data.messages import message

if TYPE_CHECKING:
    from geofit.bodies.body import BodyFit

__all__ = ["write_block_model"]


def write_block_model(body: BodyFit, path: str | PathLike[str], spacing: float | None = None) -> None:
    """Write every block around a body, in the format of the file's ending.

    ``.csv``: columns ``x``, ``y``, ``z`` of the centre in map coordinates and the edge ``size``, metres; ``field``,
    negative inside, near the surface about the distance in metres; ``probability`` that the centre lies inside, empty
    where it is not estimated (:meth:`geofit.bodies.posterior.BodyPosterior.probability`), which is nan in other files.
    ``.omf`` and ``.geoh5``: a block model with ``field`` and ``probability`` at its cells.

    Parameters
    ----------
    body : BodyFit
        The body.
    path : path
        The file.
    spacing : float, optional
        Edge of the blocks, metres; by default 1/48 of the longest side of the body.

    Raises
    ------
    InputError
        If the file's ending is none of these.
    MissingDependencyError
        If h5py, which writes geoh5, is not installed.
    SettingsError
        If the spacing is not a length, or gives more than five million blocks.
    """
    ending = Path(path).suffix.casefold()
    if ending == ".omf":
        from geofit.io.export.omf import write_omf_blocks

        write_omf_blocks({body.name: block_model(body, spacing)}, path)
    elif ending == ".geoh5":
        from geofit.io.export.geoh5 import write_geoh5_blocks

        write_geoh5_blocks({body.name: block_model(body, spacing)}, path)
    elif ending == ".csv":
        _write_csv(block_model(body, spacing), path)
    else:
        raise InputError(
            message("io.block-model-ending", "A block model cannot be written as '{ending}'", ending=ending),
            message("io.block-model-endings", "Name the file .csv, .omf or .geoh5."),
            file=str(path),
        )


def _write_csv(model: BlockModel, path: str | PathLike[str]) -> None:
    rows = zip(*model.centres.T.tolist(), model.value.tolist(), model.probability.tolist(), strict=True)
    with replacing(path) as part, part.open("w", encoding="utf-8", newline="\n") as out:
        out.write("x,y,z,size,field,probability\n")
        out.writelines(
            f"{x:.4f},{y:.4f},{z:.4f},{model.spacing:.4f},{f:.6g},{'' if isnan(p) else f'{p:.4f}'}\n"
            for x, y, z, f, p in rows
        )
