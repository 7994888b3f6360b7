"""Import the real, messy data folder by folder and write docs/real_import.md.

Run ``python benchmarks/real_import.py``. The data are looked for in GEOFIT_DATA, else in ../shared/data beside the
repository. Each folder is one ``geofit import`` of all its files; where the files do not say which column is meant,
the mapping that says it is shown.
"""

from __future__ import annotations

import os
import re
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

from geofit.io import read_points
from geofit.io.mapping import ColumnMapping
from geofit.project.importing import Import, import_files

ROOT = Path(__file__).parents[1]
PAGE = ROOT / "docs" / "real_import.md"

FOLDERS: dict[str, tuple[str, list[ColumnMapping]]] = {
    "copper_creek": ("collar, survey, lithology of 545 holes", []),
    "babbitt": (
        "collars and surveys in feet (the tables do not say so)",
        [
            ColumnMapping(file="collar_*.csv", kind="collar", unit="ft"),
            ColumnMapping(file="survey_*.csv", kind="survey", unit="ft"),
        ],
    ),
    "weka_hills": ("locations and geology", []),
    "ags": ("AGS 3, AGS 4 without ground levels, encoding cases", []),
    "kimberlina": (
        "tops of formations in 69 wells",
        [
            ColumnMapping(
                file="kim_ready.csv",
                kind="picks",
                columns={"x": "x", "y": "y", "z": "_top_abs", "horizon": "formation", "hole": "name"},
            )
        ],
    ),
    "oise": (
        "thickness of the alluvium, decimal comma",
        [ColumnMapping(file="Oise_Thickness.csv", kind="picks", columns={"z": "Thickness"})],
    ),
    "import_fixtures": ("one defect a file", []),
}


def shape(reason: str) -> str:
    """Return a reason without its numbers and names, so that equal findings count together."""
    reason = re.sub(r"\S*/", "", reason)
    reason = re.sub(r"'[^']*'", "'…'", reason)
    reason = re.sub(r"\bHole \S+: \S+ occurs", "Hole …: … occurs", reason)
    reason = re.sub(r"\b(Hole|Horizon|hole(?= \S+ \(row)|base of|top of) [^\s:]+", r"\1 …", reason)
    return re.sub(r"[-+−]?\d+(\.\d+)?(e[-+]?\d+)?", "#", reason)


def _order(item: tuple[tuple[str, str], list[str]]) -> tuple[str, int, str]:
    (severity, reason), texts = item
    return severity, -len(texts), reason


def chapter(name: str, found: Import) -> list[str]:
    title, mappings = FOLDERS[name]
    lines = [f"## {name}: {title}", "", f"Exit code {found.exit_code}.", ""]
    for mapping in mappings:
        said = [f"unit = {mapping.unit}"] if mapping.unit else []
        said += [f"{role} = {column}" for role, column in mapping.columns.items()]
        lines += [f"Stated: `{mapping.file}` is {mapping.kind}, {', '.join(said)}.", ""]
    lines += ["| file | rows read | used | listed |", "|---|---:|---:|---:|"]
    for count in sorted(found.counts, key=lambda count: count.file):
        lines.append(f"| {Path(count.file).name} | {count.read} | {count.used} | {count.listed} |")
    horizons = found.site.horizons
    points = sum(map(len, horizons.values()))
    lines += ["", f"{len(found.site.holes)} holes; {len(horizons)} horizons with {points} points.", ""]
    findings: dict[tuple[str, str], list[str]] = {}
    for issue in found.issues:
        reason = str(issue.reason)
        if issue.severity != "note" or reason.startswith("Read as"):
            findings.setdefault((issue.severity, shape(reason)), []).append(re.sub(r"\S*/", "", reason))
    if findings:
        lines += ["| times | severity | finding |", "|---:|---|---|"]
        for (severity, reason), texts in sorted(findings.items(), key=_order):
            # What was found once stands as it is, numbers and all.
            text = (texts[0] if len(set(texts)) == 1 else reason).replace("|", "/")
            lines.append(f"| {len(texts)} | {severity} | {text if len(text) < 160 else text[:157] + '...'} |")
        lines.append("")
    return lines


def write_page(data: Path) -> None:
    lines = [
        "# Real data, imported",
        "",
        "Made by `python benchmarks/real_import.py`: each folder is one `geofit import` of all its files.",
        "Rows read = rows used + rows listed, in every file.",
        "",
    ]
    for name, (_, mappings) in FOLDERS.items():
        files = sorted(p for p in (data / name).iterdir() if p.suffix in (".csv", ".ags"))
        with tempfile.TemporaryDirectory() as folder:
            found = import_files(files, Path(folder) / f"{name}.toml", mappings=mappings)
        assert all(count.read == count.used + count.listed for count in found.counts), name
        lines += chapter(name, found)
    PAGE.write_text("\n".join(lines).rstrip() + "\n", encoding="utf-8")
    print(f"wrote {PAGE}")


def million() -> None:
    """Print how long a pick file of a million rows takes, with progress."""
    rng = np.random.default_rng(0)
    n = 1_000_000
    xyz = np.column_stack([500000 + rng.uniform(0, 2000, n), 3100000 + rng.uniform(0, 2000, n), rng.normal(0, 30, n)])
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "picks.csv"
        np.savetxt(path, xyz, fmt="%.3f", delimiter=",", header="x,y,z", comments="")
        stages: list[tuple[str, float]] = []
        start = time.perf_counter()
        picks = read_points(path, progress=lambda stage, fraction: stages.append((stage, fraction)))
        seconds = time.perf_counter() - start
    print(f"{picks.counts[0].used} rows in {seconds:.1f} s, progress told {len(stages)} times")


def main() -> int:
    data = Path(os.environ.get("GEOFIT_DATA", ROOT / ".." / "shared" / "data"))
    if not data.is_dir():
        print(f"The real data are not at {data}; set GEOFIT_DATA.", file=sys.stderr)
        return 2
    write_page(data)
    million()
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
