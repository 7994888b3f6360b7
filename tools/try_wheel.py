"""Build the sdist and, from the sdist unpacked, the wheel; try the wheel in an environment of its own.

``make wheel`` runs it. The environment holds the wheel alone; its dependencies come from the environment that runs this
script, so nothing is downloaded. It fails if an archive lacks a file, or if the demo, an import or a translation fails.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tarfile
import tempfile
import venv
import zipfile
from pathlib import Path

__all__ = ["build", "missing", "names"]

ROOT = Path(__file__).resolve().parents[1]
DIST = ROOT / "dist"
#: Files that are not modules, by their place in the sources.
DATA = (
    "geofit/py.typed",
    "geofit/__init__.pyi",
    "io/__init__.pyi",
    "geofit/locale/zh_CN/LC_MESSAGES/geofit.mo",
    "geofit/report/templates/report.html.j2",
    "geofit/report/templates/report.css",
    "gui/icons/geofit.svg",
    "docs/tutorial.md",
    "docs/images/morph_modes.png",
    "docs/screenshots/en-light-1x/01_start.png",
    "docs/screenshots/zh-dark-1x/09_section.png",
)
#: And those of the sdist alone.
SOURCES = (
    "pyproject.toml", "README.md", "LICENSE", "SECURITY.md", "Makefile", "sample_data/site.toml",
    "sample_data/collar.csv", "geofit/locale/zh_CN/LC_MESSAGES/geofit.po", "constraints/hashes.txt",
    "tests/conftest.py",
)  # fmt: skip
TRIAL = r"""
import importlib, pkgutil, re, sys
from pathlib import Path
import geofit, geofit.io, geofit.gui.app, geofit.gui.main_window
from geofit.data.languages import ZH, translate
from geofit.data.errors import InputError
assert Path(geofit.__file__).is_relative_to(sys.prefix), geofit.__file__
for package in (geofit, geofit.io, geofit.project, geofit.gui):
    for module in pkgutil.walk_packages(package.__path__, package.__name__ + "."):
        if not module.name.endswith("__main__"):
            importlib.import_module(module.name)
try:
    geofit.io.read_site("none.toml")
except InputError as error:
    assert translate(error.message, ZH) != str(error), "there is no Chinese"
from geofit.gui.help_places import PAGES, PLACE_OF_DIALOG, PLACE_OF_PANEL, TUTORIAL
for place in {TUTORIAL, *PLACE_OF_PANEL.values(), *PLACE_OF_DIALOG.values()}:
    page = PAGES / place.partition("#")[0]
    links = re.findall(r"\]\((?!http)([^)#]+)", page.read_text(encoding="utf-8"))
    lost = [link for link in links if not (PAGES / link).is_file()]
    assert PAGES.is_relative_to(sys.prefix) and not lost, (page, lost)
print("imports, translations and pages of the help work")
"""


def build(folder: Path) -> tuple[Path, Path]:
    """Build both archives into a folder; return sdist and wheel."""
    present = set(ROOT.glob("*.egg-info"))
    code = "import sys; from setuptools import build_meta; build_meta.build_sdist(sys.argv[1])"
    _run([sys.executable, "-c", code, str(folder)], ROOT)
    for path in set(ROOT.glob("*.egg-info")) - present:
        shutil.rmtree(path)
    sdist = next(folder.glob("*.tar.gz"))
    with tempfile.TemporaryDirectory() as name:
        with tarfile.open(sdist) as archive:
            archive.extractall(name, filter="data")
        code = "import sys; from setuptools import build_meta; build_meta.build_wheel(sys.argv[1])"
        _run([sys.executable, "-c", code, str(folder)], next(Path(name).iterdir()))
    return sdist, next(folder.glob("*.whl"))


def names(archive: Path) -> set[str]:
    """Return the files of an sdist (without its outermost folder) or of a wheel."""
    if archive.suffix == ".whl":
        with zipfile.ZipFile(archive) as wheel:
            return set(wheel.namelist())
    with tarfile.open(archive) as sdist:
        return {one.name.partition("/")[2] for one in sdist.getmembers() if one.isfile()}


def missing(sdist: set[str], wheel: set[str]) -> list[str]:
    """Return the modules and data that an archive lacks, with its name in front."""
    modules = (path for room in ("geofit", "io", "gui") for path in (ROOT / room).rglob("*.py"))
    here = {*DATA, *(path.relative_to(ROOT).as_posix() for path in modules)}
    # io/ and gui/ are rooms at the top of the sources, and packages in geofit.
    placed = {name if name.startswith("geofit/") else f"geofit/{name}" for name in here}
    return [
        *(f"sdist: {name}" for name in sorted({*here, *SOURCES} - sdist)),
        *(f"wheel: {name}" for name in sorted(placed - wheel)),
    ]


def main() -> int:
    """Build, look into both archives, and try the wheel; return 0 if all is well."""
    shutil.rmtree(DIST, ignore_errors=True)
    DIST.mkdir()
    sdist, wheel = build(DIST)
    if gone := missing(names(sdist), names(wheel)):
        print("\n".join(gone), file=sys.stderr)
        return 1
    with tempfile.TemporaryDirectory() as name:
        place = Path(name)
        home = place / "env"
        venv.create(home, with_pip=False)
        (scripts,) = (path for path in (home / "bin", home / "Scripts") if path.is_dir())
        python = scripts / ("python.exe" if os.name == "nt" else "python")
        pip = [sys.executable, "-m", "pip", "--disable-pip-version-check", "--python", str(python)]
        _run([*pip, "install", "--quiet", "--no-deps", str(wheel)], place)
        # Directories only: the editable install of the same package, which is among them as a .pth file, stays unread.
        code = "import sysconfig; print(sysconfig.get_paths()['purelib'])"
        own = Path(_run([str(python), "-c", code], place).strip())
        lent = [path for path in sys.path if Path(path).name in ("site-packages", "dist-packages")]
        (own / "lent.pth").write_text("\n".join(lent) + "\n", encoding="utf-8")
        print(_run([str(python), "-I", "-c", TRIAL], place), end="")
        _run([str(scripts / "geofit-gui"), "--version"], place)
        _run([str(scripts / "geofit"), "demo", "--out", "out"], place)
        written = {path.name for path in (place / "out").iterdir()}
        if gone := {"T2-T1.step", "report.html", "report.json", "sample_data"} - written:
            print(f"The demo wrote no {', '.join(sorted(gone))}.", file=sys.stderr)
            return 1
    print(f"{sdist.name}, {wheel.name}: complete; the demo of the wheel wrote {len(written)} files")
    return 0


def _run(command: list[str], folder: Path) -> str:
    """Run a command; return what it printed, or end with it."""
    clean = {name: value for name, value in os.environ.items() if name not in ("PYTHONPATH", "PYTHONHOME")}
    done = subprocess.run(command, cwd=folder, env=clean, capture_output=True, text=True, encoding="utf-8", check=False)
    if done.returncode:
        raise SystemExit(f"{' '.join(command)[:300]}: exit code {done.returncode}\n{done.stdout}{done.stderr}")
    return done.stdout


if __name__ == "__main__":
    sys.exit(main())
