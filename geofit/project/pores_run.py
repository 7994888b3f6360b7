"""From a rock volume to the files of its pore space: network, figures before and after, surface."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from geofit.data.accuracy import plain
from geofit.data.files import file_stems, folder_for
from geofit.data.progress import Progress, tell, within
from geofit.project.body_files import write_figures, write_triangles

if TYPE_CHECKING:
    from geofit.data.messages import Message
    from geofit.pores.balls import MaximalBalls
    from geofit.pores.network import PoreNetwork
    from geofit.pores.permeability import Permeability
    from geofit.pores.sliced import SlicedVolume
    from geofit.pores.surface import PoreSurface
    from geofit.pores.table import BeforeAfter
    from geofit.pores.volume import RockVolume

__all__ = ["PoresRun", "rebuild_pores", "run_pores"]


@dataclass(frozen=True, eq=False)
class PoresRun:
    """Pore space of a rock volume: maximal balls, network, surface, figures before and after, files.

    A volume that is read slab by slab has neither surface nor table, which need all voxels at once.
    """

    volume: RockVolume | SlicedVolume
    balls: MaximalBalls | None
    network: PoreNetwork
    permeability: Permeability
    surface: PoreSurface | None
    table: BeforeAfter | None
    files: tuple[Path, ...]

    @property
    def surface_note(self) -> Message | None:
        """What the triangles of the surface have more or less than the voxels of the network, if it is much."""
        from geofit.pores.surface import volume_note

        return None if self.surface is None else volume_note(self.surface.porosity, self.network.porosity)

    @property
    def messages(self) -> tuple[Message, ...]:
        """What a reader of the figures must know: of the flow, and of the surface."""
        note = self.surface_note
        return (*self.permeability.messages, *((note,) if note is not None else ()))

    def figures(self) -> dict[str, Any]:
        """Return everything that the JSON file has, as plain data; lengths in metres."""
        from geofit import __version__
        from geofit.report.schema import enveloped

        network = self.network
        return enveloped(
            "pores" if self.table is not None else "pore-network",
            {
                "shape": plain(self.volume.shape),
                "voxel": plain(self.volume.voxel),
                "porosity": self.volume.porosity,
                "maximal_balls": None if self.balls is None else len(self.balls),
                "pores": len(network.pores),
                "throats": len(network.throats),
                "dropped_pores": len(network.dropped),
                "mean_coordination": float(network.coordination.mean()) if len(network.pores) else 0.0,
                "percolates": plain(network.percolates),
                "settings": plain(network.settings),
                "network_permeability": plain(self.permeability.square_metres),
                "messages": plain(self.messages),
                **(plain(self.table) if self.table is not None else {}),
                "version": __version__,
            },
        )


def rebuild_pores(volume: RockVolume | SlicedVolume, progress: Progress | None = None) -> PoresRun:
    """Extract balls, network and surface of a pore space, and compare the rock before and after; nothing is written.

    Parameters
    ----------
    volume : RockVolume or SlicedVolume
        The voxels; of those on the disk there is neither surface nor table.
    progress : callable, optional
        ``progress(stage, fraction)``; False stops.

    Raises
    ------
    VolumeError
        If all voxels are pore.
    """
    from geofit.pores.balls import maximal_balls
    from geofit.pores.extraction import pore_network
    from geofit.pores.permeability import network_permeability
    from geofit.pores.surface import pore_surface, require_rock
    from geofit.pores.table import before_after
    from geofit.pores.volume import RockVolume

    require_rock(volume)
    balls = None
    if volume.cubic or isinstance(volume, RockVolume):
        balls = maximal_balls(volume, progress=within(progress, 0.0, 0.2))
    network = pore_network(volume, progress=within(progress, 0.2, 0.4))
    tell(progress, "permeability", 0.4)
    permeability = network_permeability(network)
    surface, table = None, None
    if isinstance(volume, RockVolume):
        surface = pore_surface(volume, network, progress=within(progress, 0.4, 0.5))
        table = before_after(volume, network, surface, progress=within(progress, 0.5, 0.8))
    return PoresRun(volume, balls, network, permeability, surface, table, ())


def run_pores(volume: RockVolume | SlicedVolume, out: Path, name: str, progress: Progress | None = None) -> PoresRun:
    """Extract balls, network and surface of a pore space and write them.

    The files: ``NAME_pores.csv``, ``_throats.csv``, ``_face_throats.csv`` and ``_dropped.csv``, ``NAME_openpnm.json``,
    Statoil's ``NAME_node1.dat`` to ``NAME_link2.dat``, ``NAME_network.vtp``, the surface as ``NAME_surface.stl`` and
    ``.vtp``, and ``NAME.json`` with the figures. A volume that is read slab by slab gets no surface.

    Parameters
    ----------
    volume : RockVolume
        The voxels.
    out : Path
        Folder for the files; created if missing. Each file is whole or absent.
    name : str
        Name of the sample: the stem of all files.
    progress : callable, optional
        ``progress(stage, fraction)``; False stops.

    Raises
    ------
    VolumeError
        If all voxels are pore.
    InputError
        If a file cannot be written.
    """
    from geofit.io.export.network import write_network_csv, write_network_vtp, write_openpnm_json, write_statoil
    from geofit.pores.surface import require_rock

    require_rock(volume)
    stem = folder_for(out) / file_stems([name])[name]
    run = rebuild_pores(volume, progress)
    network, surface = run.network, run.surface
    tell(progress, "files", 0.8)
    openpnm, lines = stem.with_name(f"{stem.name}_openpnm.json"), stem.with_name(f"{stem.name}_network.vtp")
    tables = write_network_csv(network, out, stem.name)
    write_openpnm_json(network, openpnm)
    write_network_vtp(network, lines)
    statoil = write_statoil(network, out, stem.name)
    figures = stem.with_name(f"{stem.name}.json")
    triangles = (
        write_triangles(surface.triangulate(), stem.with_name(f"{stem.name}_surface"), sample=True) if surface else ()
    )
    run = replace(run, files=(figures, *tables, openpnm, *statoil, lines, *triangles))
    write_figures(run.figures(), figures)
    return run
