"""Time and memory of balls and network on the rock volumes, as CPU time of one process.

Run ``python benchmarks/pores.py [name ...]``. The data are looked for in GEOFIT_DATA, else in ../shared/data beside the
checkout. Compiled code is warmed up first.
"""

from __future__ import annotations

import os
import sys
import time
from pathlib import Path

from geofit.io.volumes import read_volume
from geofit.pores import maximal_balls, network_permeability, pore_network

ROCKS = {
    "berea_110": ("berea_110.raw.gz", 0, 3e-6),
    "berea_200": ("berea_200.npz", True, 5.345e-6),
    "ketton_256": ("ketton_256.zip", 0, 15.2e-6),
    "berea_400": ("berea_400.zip", 255, 5.345e-6),
}


def measure(folder: Path, name: str) -> None:
    file, pore, voxel = ROCKS[name]
    volume = read_volume(folder / file, pore=pore, voxel=voxel)
    times = [time.process_time()]
    balls = maximal_balls(volume)
    times.append(time.process_time())
    wrong = int((balls.union() != volume.pore).sum())
    times.append(time.process_time())
    network = pore_network(volume)
    times.append(time.process_time())
    k = network_permeability(network).millidarcy
    print(
        f"{name}: balls {len(balls)} in {times[1] - times[0]:.2f} s, union differs in {wrong} voxels; "
        f"{len(network.pores)} pores, {len(network.throats)} throats in {times[3] - times[2]:.2f} s; "
        f"K {k[0]:.0f} / {k[1]:.0f} / {k[2]:.0f} mD; {memory():.2f} GB",
        flush=True,
    )


def memory() -> float:
    """Return the peak memory of this process in GB, NaN where the system does not report it."""
    try:
        import resource
    except ImportError:
        return float("nan")
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / (1e9 if sys.platform == "darwin" else 1e6)


def main() -> int:
    folder = Path(os.environ.get("GEOFIT_DATA", Path(__file__).parents[1] / ".." / "shared" / "data")) / "pores"
    if not folder.is_dir():
        print(f"rock volumes are not at {folder}; set GEOFIT_DATA", file=sys.stderr)
        return 2
    measure(folder, "berea_110")
    for name in sys.argv[1:] or list(ROCKS):
        measure(folder, name)
    return 0


if __name__ == "__main__":
    sys.exit(main())
