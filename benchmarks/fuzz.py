"""Messy sites and damaged files of every reader: each ends in results or a geofit error.

Run ``python benchmarks/fuzz.py [SITES] [FILES] [SEED]`` (default 10,000 each, seed 1). A case fails by any other
exception, by an unforeseen error in the notes of a fit or of its examination, by a point that is called exact and is
missed, by rows that are neither used nor listed, by a file outside its folder that is touched, or by taking longer than
its limit. A case that failed is run again by its number: ``python benchmarks/fuzz.py case NUMBER``.
"""

from __future__ import annotations

import json
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable
from pathlib import Path

from fuzzing import others, sites, surfaces, tables
from fuzzing.harness import Files, run

#: What is run: share of all files (the first: of the sites) and seconds of processor time for a case.
SHARES = {"messy sites": (1.0, 120), "tables and drawings": (0.5, 20), "maps, logs, volumes, caves": (0.3, 20),
          "surfaces and projects": (0.2, 60)}  # fmt: skip


def cases(folder: Path) -> dict[str, Callable[[int], Counter[str]]]:
    """Return what a case is, by the name of what is run."""
    groups = dict(zip(list(SHARES)[1:], (tables, others, surfaces), strict=True))
    found: dict[str, Callable[[int], Counter[str]]] = {"messy sites": sites.fit_one}
    for name, group in groups.items():
        place = folder / name.replace(" ", "_")
        place.mkdir()
        found[name] = Files(group, place)
    return found


def main(words: list[str]) -> int:
    with tempfile.TemporaryDirectory() as name:
        known = cases(Path(name))
        if words[:1] == ["case"]:
            for what, one in known.items():
                outcomes, failures = run(1, 0, lambda _, one=one: one(int(words[1])), SHARES[what][1])
                print(what, json.dumps(outcomes), *failures)
            return 0
        most, files, seed = (int(word) for word in (*words, *("10000", "10000", "1")[len(words) :]))
        failed = 0
        for what, one in known.items():
            share, limit = SHARES[what]
            count = most if what == "messy sites" else round(share * files)
            start = time.process_time()  # of this process: CAD files have their own
            outcomes, failures = run(count, seed, one, limit)
            failed += outcomes["failed"]
            print("\n".join(failures), end="")
            seconds = time.process_time() - start
            print(f"{count} {what}, seed {seed}, {seconds:.0f} s: {json.dumps(outcomes)}", flush=True)
    return 1 if failed else 0


if __name__ == "__main__":
    raise SystemExit(main(sys.argv[1:]))
