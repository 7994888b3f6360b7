"""Peers of the pore network on the same voxels: pnextract, PoreSpy's snow2, and OpenPNM's Stokes flow through that.

``python benchmarks/pores_peers.py VOLUME.npy EDGE OUT.json`` is run by ``pores.py --peers PYTHON`` with the Python of
an environment that has porespy, openpnm and pnextract (all on PyPI); geofit need not be there. A small volume comes
first, to compile. pnextract is a program of its own; its time is CPU time, of reading and writing files too.
"""

from __future__ import annotations

import json
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

MILLIDARCY = 9.869233e-16


def snow2(pore, edge):
    import porespy as ps

    ps.settings.tqdm["disable"] = True
    return ps.networks.snow2(pore, voxel_size=edge, boundary_width=[3, 3, 3]).network


def pnextract(pore, edge):
    """Return CPU seconds, pores and throats of pnextract; None where it is not installed."""
    program = Path(sys.executable).with_name("pnextract")
    if not program.exists():
        return None
    with tempfile.TemporaryDirectory() as folder:
        (~pore).astype(np.uint8).tofile(Path(folder) / "rock.raw")
        head = f"""ObjectType = Image
NDims = 3
ElementType = MET_UCHAR
ElementByteOrderMSB = False
DimSize = {" ".join(map(str, pore.shape[::-1]))}
ElementSize = {" ".join([str(1e6 * edge)] * 3)}
Offset = 0 0 0
ElementDataFile = rock.raw
"""
        (Path(folder) / "rock.mhd").write_text(head)
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        subprocess.run([program, "rock.mhd"], cwd=folder, check=True, capture_output=True)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        pores, throats = (
            int((Path(folder) / f"rock_{table}1.dat").read_text().split(maxsplit=1)[0]) for table in ("node", "link")
        )
    seconds = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return {"seconds": seconds, "pores": pores, "throats": throats}


def permeability(net, shape, edge):
    """Return K (3,) in mD by OpenPNM's Stokes flow through PoreSpy's network, with its recommended geometry models."""
    import openpnm as op

    found = op.io.network_from_porespy(net)
    found["pore.diameter"] = found["pore.inscribed_diameter"]
    found["throat.diameter"] = found["throat.inscribed_diameter"]
    found["throat.spacing"] = found["throat.total_length"]
    sizes = op.models.geometry.hydraulic_size_factors.pyramids_and_cuboids
    found.add_model("throat.hydraulic_size_factors", model=sizes)
    found.regenerate_models()
    health = op.utils.check_network_health(found)
    op.topotools.trim(network=found, pores=health["disconnected_pores"])
    phase = op.phase.Phase(network=found)
    phase["pore.viscosity"] = 1.0
    phase.add_model("throat.hydraulic_conductance", model=op.models.physics.hydraulic_conductance.generic_hydraulic)
    lengths = np.array(shape) * edge
    values = []
    for axis, (low, high) in enumerate((("xmin", "xmax"), ("ymin", "ymax"), ("zmin", "zmax"))):
        flow = op.algorithms.StokesFlow(network=found, phase=phase)
        flow.set_value_BC(pores=found.pores(low), values=1.0)
        flow.set_value_BC(pores=found.pores(high), values=0.0)
        flow.run()
        rate = float(flow.rate(pores=found.pores(low))[0])
        values.append(rate * lengths[axis] ** 2 / lengths.prod() / MILLIDARCY)
    return values


def main() -> int:
    volume, edge, out = Path(sys.argv[1]), float(sys.argv[2]), Path(sys.argv[3])
    pore = np.load(volume)
    snow2(pore[:48, :48, :48], edge)
    began = time.process_time()
    net = snow2(pore, edge)
    took = time.process_time() - began
    inner = ~np.array(net["pore.boundary"]) if "pore.boundary" in net else np.ones(len(net["pore.coords"]), bool)
    conns = np.array(net["throat.conns"])
    links = inner[conns].all(axis=1)
    try:
        k, why = permeability(net, pore.shape, edge), ""
    except Exception as error:  # what a peer raises is part of the result
        k, why = None, f"{type(error).__name__}: {error}"
    figures = {
        "pnextract": pnextract(pore, edge),
        "seconds": took,
        "memory_gb": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6,
        "pores": int(inner.sum()),
        "throats": int(links.sum()),
        "permeability": k,
        "permeability_error": why,
    }
    out.write_text(json.dumps(figures), encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
