"""Real rock volumes, where they are present."""

from __future__ import annotations

import os
import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parent))

#: File, pore label, voxel edge in metres.
ROCKS = {
    "berea_110": ("berea_110.raw.gz", 0, 3e-6),
    "berea_200": ("berea_200.npz", True, 5.345e-6),
    "berea_400": ("berea_400.zip", 255, 5.345e-6),
    "ketton_256": ("ketton_256.zip", 0, 15.2e-6),
    "fractures_100": ("fractures_100.raw.gz", 255, 5e-6),
}


@pytest.fixture(scope="session")
def pore_data():
    folder = Path(os.environ.get("GEOFIT_DATA", Path(__file__).parents[2] / ".." / "shared" / "data")) / "pores"
    if not folder.is_dir():
        pytest.skip(f"rock volumes are not at {folder}; set GEOFIT_DATA")
    return folder


@pytest.fixture(scope="session")
def rock(pore_data):
    """Function that reads a real volume by name."""
    from geofit.io.volumes import read_volume

    def read(name):
        file, pore, voxel = ROCKS[name]
        return read_volume(pore_data / file, pore=pore, voxel=voxel)

    return read
