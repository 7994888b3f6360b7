"""``geofit metaballs``: the pores of a rock volume covered by metaballs."""

from __future__ import annotations

from typing import Annotated

import typer

from geofit.cli.app import app
from geofit.cli.console import listening, print_json, print_table, say, with_exit_code
from geofit.cli.options import Json, Out
from geofit.cli.volumes import ArrayName, PoreLabel, Shape, VolumeFile, VoxelEdge, read_options, stem_of

__all__ = ["metaballs"]


@app.command()
@with_exit_code
def metaballs(
    source: VolumeFile,
    out: Out,
    pore: PoreLabel,
    voxel: VoxelEdge = None,
    shape: Shape = None,
    name: ArrayName = None,
    balls: Annotated[int | None, typer.Option(help="Stop at this number of balls. Default: 99.5 % covered.")] = None,
    as_json: Json = False,
) -> int:
    """Cover pore voxels with metaballs on their medial axis."""
    from geofit.io.volumes import read_volume
    from geofit.project.metaballs_run import run_metaballs

    volume = read_volume(**read_options(source, pore, voxel, shape, name))
    with listening() as progress:
        run = run_metaballs(volume, out, stem_of(source), max_balls=balls, progress=progress)
    if as_json:
        print_json({**run.figures(), "files": [str(file) for file in run.files]})
    else:
        found, edge = run.body.figures, volume.unit
        rows = [
            ("balls", str(len(run.body.radius))),
            ("pore voxels", str(int(volume.pore.sum()))),
            ("Dice", f"{found.dice:.4f}"),
            ("covered, %", f"{100 * found.share:.2f}"),
            (
                "voxels whose middle is inside, % of the pore voxels",
                f"{100 * found.volume / found.volume_of_voxels:.2f}",
            ),
            (
                "volume of the triangles, % of the pore voxels",
                f"{100 * run.volume_of_triangles / found.volume_of_voxels:.2f}",
            ),
            ("Hausdorff distance, voxels", f"{found.hausdorff / edge:.2f}"),
            ("95 % of the boundary within, voxels", f"{found.hausdorff95 / edge:.2f}"),
        ]
        print_table(("metaballs", "value"), rows)
    say(f"Files: {', '.join(file.name for file in run.files)} in {out}")
    return 0
