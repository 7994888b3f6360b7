"""Fit and examine the real sets as ``geofit fit`` does, score them on points left out, write ``docs/real_data.md``.

Run ``make real``, or ``python benchmarks/real.py [--scheduler WHERE] [SET ...]`` for some sets (then only the table is
printed). WHERE is the address of a Dask scheduler or its file; its workers need this folder on PYTHONPATH, and one disk
with this machine. Needs ``GEOFIT_DATA`` or ``../shared/data``; without them it reports it and exits with 2.
"""

from __future__ import annotations

import argparse
import os
import sys
import time
from pathlib import Path

from realdata.page import ERRORS, FITS, Row, error_cells, fit_cells, markdown
from realdata.prediction import PREDICTION, off_cells
from realdata.sets import SETS, data_folder
from realdata.tasks import OUT, done, real_set, tolerances

from geofit.cli.console import print_table
from geofit.data.files import replacing
from geofit.streaming.executors import run_tasks

PAGE = Path(__file__).resolve().parents[1] / "docs" / "real_data.md"
PROCESSES = 2


def rows_of(keys: list[str], scheduler: str = "local") -> list[Row]:
    """Run all sets side by side and return their rows in order."""
    names = [(key, name) for key in keys for name in real_set(key).site.horizons]
    tasks: list[tuple[str, tuple[str, ...]]] = [("score_horizon", pair) for pair in names]
    tasks += [("deliver_set", (key,)) for key in keys]
    tasks += [("fit_at_scale", pair) for pair in names if real_set(pair[0]).scale]
    found = {tasks[k]: result for k, result in run_tasks(done, tasks, scheduler, PROCESSES)}
    rows = []
    for pair in names:
        key, name = pair
        real = real_set(key)
        fits = [found["deliver_set", (key,)][name]]
        if real.scale:
            fits.append(found["fit_at_scale", pair])
        for (fit, off), settings, (errors, trial) in zip(
            fits, tolerances(real), found["score_horizon", pair], strict=True
        ):
            figures, failure = (None, fit) if isinstance(fit, str) else (fit, "")
            n = len(real.site.horizons[name])
            rows.append(Row(f"{real.title}: {name}", n, settings, figures, errors, trial, failure, off))
    return rows


def main() -> int:
    """Run the sets that are named, or all."""
    if data_folder() is None:
        print(
            "The real data are not here. Set GEOFIT_DATA to their folder, or lay them at ../shared/data.",
            file=sys.stderr,
        )
        return 2
    parser = argparse.ArgumentParser(description="Score the real sets on points left out.")
    parser.add_argument("--scheduler", default="local", help="address of a Dask scheduler, or the file that it writes")
    parser.add_argument("sets", nargs="*", metavar="SET", help="sets to run; none: all")
    given = parser.parse_args()
    unknown = [key for key in given.sets if key not in SETS]
    if unknown:
        print(f"There is no set '{unknown[0]}'; the sets are: {', '.join(SETS)}.", file=sys.stderr)
        return 2
    # One thread a process: two processes share two cores, and sums come out alike on every machine.
    os.environ["OMP_NUM_THREADS"] = os.environ["OPENBLAS_NUM_THREADS"] = "1"
    start = time.perf_counter()
    keys = [key for key in SETS if key in given.sets] or list(SETS)
    rows = rows_of(keys, given.scheduler)
    print_table(FITS, [fit_cells(row, exact_seconds=True) for row in rows])
    print_table(ERRORS, [error_cells(row) for row in rows])
    settled = [(row.title, row.settings.interior_tolerance, row.off) for row in rows if row.off is not None]
    print_table(PREDICTION, [off_cells(*figures) for figures in settled])
    print(f"{len(rows)} lines in {time.perf_counter() - start:.0f} s; surfaces and reports are in {OUT}")
    if len(keys) == len(SETS):
        sources = [(real_set(key).title, real_set(key).given) for key in keys]
        with replacing(PAGE) as part:
            part.write_text(markdown(rows, sources), encoding="utf-8")
        print(f"written: {PAGE}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
