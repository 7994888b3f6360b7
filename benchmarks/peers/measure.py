"""One program on sets of points, in a process of its own: ``python measure.py TOOL POINTS.npz ...`` prints JSON."""

from __future__ import annotations

import json
import sys
import time
from pathlib import Path

import numpy as np

sys.path.append(str(Path(__file__).resolve().parents[1]))
from peers.tools import TOOLS

#: Fits of each set, and processor time, s, after which a fit is not repeated.
REPEATS, LONGEST = 3, 1.0


def memory(key: str) -> float:
    """Return the resident memory of this process, MB: "VmRSS" now, "VmHWM" the largest (Linux)."""
    lines = Path("/proc/self/status").read_text(encoding="utf-8").splitlines()
    return next(int(line.split()[1]) / 1024 for line in lines if line.startswith(key))


def main() -> None:
    tool = TOOLS[sys.argv[1]]
    fits: list[float] = []
    evaluations, errors, missing, count, before = [], [], 0, 0, 0.0
    for path in sys.argv[2:]:
        data = np.load(path)
        xyz, places, truth = data["grid" if tool.grid else "xyz"], data["places"], data["truth"]
        xyz.setflags(write=False)
        if not before:
            # The largest begins anew: reading the points takes more for a while.
            Path("/proc/self/clear_refs").write_text("5", encoding="utf-8")
            before = memory("VmRSS")
        for _ in range(REPEATS):
            start = time.process_time()
            elevation, count = tool.make(xyz)
            fits.append(time.process_time() - start)
            if fits[-1] > LONGEST:
                break
        start = time.process_time()
        found = elevation(places)
        evaluations.append(time.process_time() - start)
        errors.append(float(np.sqrt(np.nanmean((found - truth) ** 2))))
        missing += int((~np.isfinite(found)).sum())
    figures = {
        # The first fit loads what the others find ready.
        "seconds": float(np.median(fits[1:] or fits)),
        "fits": len(fits),
        "evaluation": float(np.median(evaluations)),
        "memory": memory("VmHWM") - before,
        "count": int(count),
        "errors": errors,
        "missing": missing,
    }
    print(json.dumps(figures))


if __name__ == "__main__":
    main()
