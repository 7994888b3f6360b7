"""Time, memory and figures of balls and network on the rock volumes, compared with PoreSpy and OpenPNM in the same run.

Run ``python benchmarks/pores.py [--peers PYTHON] [--page] [name ...]``. The data are looked for in GEOFIT_DATA, else in
../shared/data beside the checkout. Each volume has a process of its own, so that its peak memory is its own; compiled
code is warmed up first, and times are CPU time. ``--peers`` names the Python of an environment with porespy and
openpnm. ``--page`` writes docs/pores.md and its picture from what was measured.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np
from pores_rocks import ROCKS, ROOT, folder, volume_of

from geofit.pores import (
    connectivity,
    laplace_permeability,
    maximal_balls,
    network_permeability,
    pore_network,
)

#: Voxels of the largest volume on which Laplace's equation is solved too.
LAPLACE = 200**3
#: Permeability by lattice Boltzmann along the axes from the first, mD.
PUBLISHED = {"berea_200": (1433.0,), "berea_128": (2370.0, 2126.0, 2435.0)}


def measure(name: str) -> dict[str, Any]:
    """Return the figures of one volume; in this process."""
    small = volume_of("berea_110")
    maximal_balls(small)
    network_permeability(pore_network(small))
    volume = volume_of(name)
    times = [time.process_time()]
    network = pore_network(volume)
    times.append(time.process_time())
    balls = maximal_balls(volume)
    times.append(time.process_time())
    peak = memory()
    wrong = int((balls.union() != volume.pore).sum())
    pores, throats = network.pores, network.throats
    seconds = times[1] - times[0], times[2] - times[1]
    return {
        "voxels": int(np.prod(volume.shape)),
        "balls": len(balls),
        "union_differs": wrong,
        "seconds_network": seconds[0],
        "seconds_balls": seconds[1],
        "memory_gb": peak,
        "pores": len(pores),
        "throats": len(throats),
        "coordination": float(network.coordination.mean()),
        "radius_um": [float(table.radius.mean() * network.unit * 1e6) for table in (pores, throats)],
        "porosity_gap": network.porosity / connectivity(volume).connected - 1,
        "laplace": laplace_permeability(volume).millidarcy if volume.pore.size <= LAPLACE else None,
        "permeability": network_permeability(network).millidarcy,
        "radii_um": [(pores.radius * network.unit * 1e6).tolist(), (throats.radius * network.unit * 1e6).tolist()],
    }


def memory() -> float:
    """Return the peak memory of this process in GB, NaN where the system does not report it."""
    try:
        import resource
    except ImportError:
        return float("nan")
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / (1e9 if sys.platform == "darwin" else 1e6)


def apart(command: list[str], out: Path) -> dict[str, Any]:
    """Run a process that writes JSON, and return that; the error where it fails."""
    ended = subprocess.run(command, capture_output=True, text=True, check=False)
    if ended.returncode or not out.exists():
        return {"error": ended.stderr.strip().splitlines()[-1] if ended.stderr.strip() else "no result"}
    found: dict[str, Any] = json.loads(out.read_text(encoding="utf-8"))
    return found


def compare(name: str, peers: str | None) -> dict[str, Any]:
    """Return the figures of one volume, each tool in a process of its own."""
    with tempfile.TemporaryDirectory() as scratch:
        out = Path(scratch) / "own.json"
        row = {"own": apart([sys.executable, __file__, "--one", name, "--out", str(out)], out)}
        if peers is not None:
            voxels, out = Path(scratch) / "pore.npy", Path(scratch) / "peer.json"
            np.save(voxels, volume_of(name).pore)
            edge = str(ROCKS[name][2])
            row["peer"] = apart(
                [peers, str(Path(__file__).with_name("pores_peers.py")), str(voxels), edge, str(out)], out
            )
    return row


def line(name: str, row: dict[str, Any]) -> str:
    own, peer = row["own"], row.get("peer")
    if "error" in own:
        return f"{name}: {own['error']}"
    k = " / ".join(f"{value:.0f}" for value in own["permeability"])
    text = (
        f"{name}: network {own['seconds_network']:.2f} s, balls {own['seconds_balls']:.2f} s ({own['balls']}, union "
        f"differs in {own['union_differs']} voxels), {own['memory_gb']:.2f} GB; {own['pores']} pores, {own['throats']} "
        f"throats, coordination {own['coordination']:.2f}; K {k} mD"
    )
    if peer is None:
        return text
    if "error" in peer:
        return f"{text}; peers: {peer['error']}"
    ratio = peer["seconds"] / (own["seconds_network"] + own["seconds_balls"])
    return (
        f"{text}; snow2 {peer['seconds']:.1f} s ({ratio:.1f} times), {peer['pores']} pores, {peer['throats']} throats"
    )


def main() -> int:
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("names", nargs="*", metavar="name")
    options.add_argument("--peers", metavar="PYTHON")
    options.add_argument("--page", action="store_true")
    options.add_argument("--one", choices=list(ROCKS))
    options.add_argument("--out", type=Path)
    given = options.parse_args()
    if unknown := set(given.names) - set(ROCKS):
        options.error(f"no such volume: {', '.join(sorted(unknown))}; there are {', '.join(ROCKS)}")
    if not folder().is_dir():
        print(f"rock volumes are not at {folder()}; set GEOFIT_DATA", file=sys.stderr)
        return 2
    if given.one:
        given.out.write_text(json.dumps(measure(given.one)), encoding="utf-8")
        return 0
    rows = {}
    for name in given.names or list(ROCKS):
        rows[name] = compare(name, given.peers)
        print(line(name, rows[name]), flush=True)
    if given.page:
        from pores_page import write_page
        from pores_truths import truths

        write_page(rows, PUBLISHED, truths(volume_of("berea_110")), ROOT / "docs")
    return 0


if __name__ == "__main__":
    sys.exit(main())
