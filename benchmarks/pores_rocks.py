"""The real rock volumes that the pore benchmarks read, from GEOFIT_DATA or ../shared/data next to the checkout."""

from __future__ import annotations

import os
from pathlib import Path

from geofit.io.volumes import read_volume
from geofit.pores import RockVolume

__all__ = ["ROCKS", "ROOT", "folder", "volume_of"]

ROOT = Path(__file__).resolve().parents[1]
ROCKS = {
    "berea_110": ("berea_110.raw.gz", 0, 3e-6),
    "berea_200": ("berea_200.npz", True, 5.345e-6),
    "ketton_256": ("ketton_256.zip", 0, 15.2e-6),
    "berea_400": ("berea_400.zip", 255, 5.345e-6),
}
#: The middle 128 voxels of Berea 200³ along each axis.
ROCKS["berea_128"] = ROCKS["berea_200"]


def folder() -> Path:
    return Path(os.environ.get("GEOFIT_DATA", ROOT / ".." / "shared" / "data")) / "pores"


def volume_of(name: str) -> RockVolume:
    file, pore, voxel = ROCKS[name]
    volume = read_volume(folder() / file, pore=pore, voxel=voxel)
    return RockVolume(volume.pore[36:164, 36:164, 36:164], pore=True, voxel=voxel) if name == "berea_128" else volume
