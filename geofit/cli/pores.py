"""``geofit pores``: a rock volume to its pore network and surface."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Annotated, Any

import typer

from geofit.cli.app import app
from geofit.cli.console import listening, print_json, print_table, say, with_exit_code
from geofit.cli.options import Json, Lang, LanguageCode, Out, Report
from geofit.cli.volumes import ArrayName, PoreLabel, Shape, VolumeFile, VoxelEdge, read_options, stem_of

if TYPE_CHECKING:
    from geofit.pores.table import PoreFigures
    from geofit.project.pores_run import PoresRun

__all__ = ["pores"]

NETWORK_K = "network permeability along axis 0, 1, 2, mD"


@app.command()
@with_exit_code
def pores(
    source: VolumeFile,
    out: Out,
    pore: PoreLabel,
    voxel: VoxelEdge = None,
    shape: Shape = None,
    name: ArrayName = None,
    slabs: Annotated[
        bool, typer.Option("--slabs", help="Leave the volume on the disk: balls and network, but no surface.")
    ] = False,
    report: Report = False,
    lang: Lang = LanguageCode.EN,
    as_json: Json = False,
) -> int:
    """Extract pores, throats and the pore surface; compare the rock before and after."""
    from geofit.io.volume_slices import open_volume
    from geofit.io.volumes import read_volume
    from geofit.project.pores_run import run_pores

    options = read_options(source, pore, voxel, shape, name)
    volume = open_volume(**options) if slabs else read_volume(**options)
    with listening() as progress:
        run = run_pores(volume, out, stem_of(source), progress)
        if report:
            from geofit.data.languages import language
            from geofit.project.single_reports import write_pores_report

            pages = write_pores_report(run, stem_of(source), out, language(lang.value))
            run = replace(run, files=(*run.files, *pages))
    if as_json:
        print_json({**run.figures(), "files": [str(file) for file in run.files]})
    else:
        _print(run)
    for text in run.messages:
        say(text)
    say(f"Files: {', '.join(file.name for file in run.files)} in {out}")
    return 0


def _print(run: PoresRun) -> None:
    network = run.network
    counts = {
        "maximal balls": "–" if run.balls is None else len(run.balls),
        "pores": len(network.pores),
        "throats": len(network.throats),
        "pores without a path to a face, left out": len(network.dropped),
        "mean coordination": f"{network.coordination.mean():.2f}" if len(network.pores) else "–",
    }
    print_table(("network", "count"), [(name, str(count)) for name, count in counts.items()])
    if run.table is None:
        along = ", ".join(f"{k:.4g}" for k in run.permeability.millidarcy)
        rows = [("porosity, %", f"{100 * run.volume.porosity:.2f}"), (NETWORK_K, along)]
        print_table(("figure", "voxels"), rows)
        return
    before, after = _column(run.table.before), _column(run.table.after)
    columns = [(name, value, after[name]) for name, value in before.items()]
    columns.insert(1, ("porosity by the triangles, %", "–", f"{100 * run.table.triangles:.2f}"))
    print_table(("figure", "voxels", "rebuilt"), columns)


def _column(figures: PoreFigures) -> dict[str, str]:
    from geofit.pores.permeability import MILLIDARCY

    found = figures.connectivity
    rows: dict[str, Any] = {
        "porosity, %": f"{100 * found.porosity:.2f}",
        "connected porosity, %": f"{100 * found.connected:.2f}",
        "percolates along axis 0, 1, 2": ", ".join("yes" if along else "no" for along in found.percolates),
        "Euler number": str(found.euler),
        "specific surface, 1/mm": f"{figures.specific_surface / 1e3:.2f}",
        "grain diameter, mm": f"{figures.grain_diameter * 1e3:.4f}",
        "Kozeny permeability, mD": f"{figures.kozeny / MILLIDARCY:.4g}",
    }
    if figures.network is not None:
        rows[NETWORK_K] = ", ".join(f"{k:.4g}" for k in figures.network.millidarcy)
    return rows
