"""The package as a whole: what an import costs, who may import whom, what the repository may hold."""

from __future__ import annotations

import ast
import graphlib
import itertools
import re
import shutil
import subprocess
import sys
import tomllib
from fnmatch import fnmatch
from pathlib import Path

import pytest
import try_wheel

import geofit
from geofit.data.distribution import DISTRIBUTION
from geofit.data.terms import TERMS

ROOT = Path(__file__).resolve().parents[1]

#: Floors of docs/architecture.md, the lowest first: a folder stands on exactly one. A module imports from its own
#: folder and those below; names imported inside functions count.
FLOORS = (
    "data", "sample", "splines", "geometry", "implicit", "surfaces", "sampling", "cad", "checks", "fitting",
    "streaming", "prediction", "site", "bodies", "morphing", "pores", "medial", "caves", "io", "report", "project",
    "cli", "gui",
)  # fmt: skip
FLOOR = {folder: height for height, folder in enumerate(FLOORS)}
#: Who alone may import these, at the named places.
RESERVED = {
    "OCP": ("geofit/cad/",),
    "cadquery": ("geofit/cad/",),
    "PySide6": ("gui/",),
    "pyvistaqt": ("gui/",),
    "pyvista": ("geofit/report/scene.py", "geofit/report/film.py", "gui/"),
    "vtkmodules": ("geofit/report/scene.py", "geofit/implicit/", "gui/"),
    "matplotlib": ("geofit/report/", "gui/"),
    "fpdf": ("geofit/report/pdf.py", "geofit/report/pdf_table.py", "geofit/report/pdf_text.py"),
    "typer": ("geofit/cli/",),
    "rich": ("geofit/cli/",),
}
#: Names that are defined in several modules because they mean the same: a command is called what it runs.
FAMILIES = {"main": "starts a program"} | dict.fromkeys(("check", "metaballs", "morph", "section"), "a command")
HEAVY = ("scipy", "pandas", "shapely", "matplotlib", "pyvista", "vtkmodules", "OCP", "cadquery", "PySide6", "ezdxf")


def python(code: str, cwd: Path, *options: str) -> str:
    done = subprocess.run([sys.executable, *options, "-c", code], cwd=cwd, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout.strip()


def sources() -> dict[str, ast.Module]:
    files = [p for folder in ("geofit", "io", "gui") for p in sorted((ROOT / folder).rglob("*.py"))]
    return {p.relative_to(ROOT).as_posix(): ast.parse(p.read_text(encoding="utf-8")) for p in files}


def module_of(path: str) -> str:
    """Dotted name of a file: io/ and gui/ live in geofit."""
    dotted = path.removesuffix(".py").removesuffix("/__init__").replace("/", ".")
    return dotted if dotted.startswith("geofit") else f"geofit.{dotted}"


def room_of(dotted: str) -> str | None:
    """The folder that a module is in; None for the front door and for what is not geofit's."""
    parts = dotted.split(".")
    return parts[1] if parts[0] == "geofit" and len(parts) > 1 and parts[1] in FLOOR else None


def imports(tree: ast.Module, *, typing_too: bool, members: bool = False) -> set[str]:
    """Return the modules that a file imports, lazily too; ``members``: and the members of packages."""
    found: set[str] = set()
    skipped: set[ast.AST] = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.If) and "TYPE_CHECKING" in ast.unparse(node.test) and not typing_too:
            skipped.update(child for statement in node.body for child in ast.walk(statement))
    for node in ast.walk(tree):
        if node in skipped:
            continue
        if isinstance(node, ast.Import):
            found.update(alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.level == 0:
            found.add(node.module or "")
            if members or node.module == "geofit":
                found.update(f"{node.module}.{alias.name}" for alias in node.names)
    return found


def tracked() -> list[Path]:
    listed = subprocess.run(
        ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"],
        cwd=ROOT, capture_output=True, text=True, check=False,
    )  # fmt: skip
    if listed.returncode:
        pytest.skip("no git repository: the package was unpacked, not cloned")
    return [ROOT / name for name in listed.stdout.split("\0") if name and (ROOT / name).is_file()]


def test_importing_geofit_loads_nothing_heavy(tmp_path):
    code = "import sys, geofit, geofit.io; print(*sorted({m.split('.')[0] for m in sys.modules}))"
    assert not set(python(code, tmp_path).split()) & set(HEAVY)


def test_help_loads_nothing_heavy(tmp_path):
    code = "import sys, geofit.cli.main; print(*sorted({m.split('.')[0] for m in sys.modules}))"
    assert not set(python(code, tmp_path).split()) & set(HEAVY)


@pytest.mark.parametrize("where", ["root", "elsewhere"])
def test_the_folder_io_never_shadows_the_standard_library(where, tmp_path):
    cwd = ROOT if where == "root" else tmp_path
    code = (
        "import io, sys; assert io.StringIO('a').read() == 'a'; import geofit.io;"
        "assert sys.modules['io'] is not sys.modules['geofit.io']; assert not hasattr(io, 'read_site'); print('ok')"
    )
    assert python(code, cwd) == "ok"
    assert python(code, cwd, "-I") == "ok"


def test_everything_but_the_windows_works_without_their_packages(tmp_path):
    code = (
        "import importlib, importlib.abc, pkgutil, sys\n"
        "class Blocked(importlib.abc.MetaPathFinder):\n"
        "    def find_spec(self, name, path=None, target=None):\n"
        "        if name.split('.')[0] in ('PySide6', 'shiboken6', 'pyvistaqt', 'qtpy'):\n"
        "            raise ModuleNotFoundError(name)\n"
        "sys.meta_path.insert(0, Blocked())\n"
        "import geofit, geofit.io, geofit.project\n"
        "for package in (geofit, geofit.io, geofit.project):\n"
        "    for module in pkgutil.walk_packages(package.__path__, package.__name__ + '.'):\n"
        "        if not module.name.startswith('geofit.gui.'):\n"
        "            if not module.name.endswith('__main__'):\n"
        "                importlib.import_module(module.name)\n"
        "from geofit.project.document import Document\n"
        "from geofit.gui.app import main\n"
        "sys.argv = ['geofit-gui']\n"
        "print(main([]))\n"
    )
    done = subprocess.run([sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.stdout.split() == ["2"], done.stderr
    assert f'pip install "{DISTRIBUTION}[gui]"' in done.stderr


def test_no_text_installs_the_program_of_the_same_name():
    """On the public index, the name geofit belongs to somebody else."""
    foreign = re.compile(
        r"""(?:install|download|index versions)(?: -\S+)*[ '"]+geofit(?![\w/\\-]|\.whl)|['"`]geofit\[\w"""
    )
    # What a pattern must find, written so that this file does not hold it.
    for line in ("pip install {}", "pip install -U {}", "pip install '{}[gui]'", '"{}[gis]"'):
        assert foreign.search(line.format("geofit"))
    assert not foreign.search(f"pip install {DISTRIBUTION}")
    wrong = []
    for path in tracked():
        if path.suffix in {".py", ".md", ".toml", ".po", ".txt", ".yml", ".spec", ".cff", ""}:
            text = path.read_text(encoding="utf-8", errors="replace")
            lines = enumerate(text.splitlines(), 1)
            wrong += [f"{path.relative_to(ROOT)}:{k}: {line}" for k, line in lines if foreign.search(line)]
    assert not [line for line in wrong if '"geofit[*]"' not in line], wrong


def test_the_name_is_that_of_the_project_file():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    assert project["name"] == DISTRIBUTION != "geofit"
    assert {**project["scripts"], **project["gui-scripts"]}.keys() == {"geofit", "geofit-gui"}
    wheel = f"{DISTRIBUTION.replace('-', '_')}-{project['version']}-py3-none-any.whl[gui]"
    for page in ("README.md", "docs/tutorial.md"):
        text = (ROOT / page).read_text(encoding="utf-8")
        assert wheel in text, page
        assert "make gui" in text, page


def test_install_lines_name_extras_that_exist():
    extras = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["optional-dependencies"]
    place = {"need": 1, "install_line": 0}
    calls = [
        (node.func.id, node.args)
        for tree in sources().values()
        for node in ast.walk(tree)
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id in place
    ]
    named = {arg.value for name, args in calls if isinstance(arg := args[place[name]], ast.Constant)}
    assert {"gui", "gis", "xlsx"} <= named <= set(extras)


def test_every_module_stands_on_a_floor():
    homeless = [path for path in sources() if "/" in path.removeprefix("geofit/") and room_of(module_of(path)) is None]
    assert not homeless, f"not in docs/architecture.md and FLOORS: {homeless}"


def test_rooms_import_only_from_their_floor_and_below():
    wrong = []
    for path, tree in sources().items():
        room = room_of(module_of(path))
        for name in imports(tree, typing_too=False):
            other = room_of(name)
            if room is not None and other is not None and FLOOR[other] > FLOOR[room]:
                wrong.append(f"{path} imports {name}")
    assert not wrong, "\n".join(wrong)


def test_a_public_name_is_defined_once():
    """A reader who meets a name knows what it is, wherever it stands."""
    homes = {}
    for path, tree in sources().items():
        for node in tree.body:
            if isinstance(node, ast.FunctionDef | ast.ClassDef) and not node.name.startswith("_"):
                homes.setdefault(node.name, []).append(path)
    twice = {name: paths for name, paths in homes.items() if len(paths) > 1 and name not in FAMILIES}
    assert not twice, "say in the name what it is of:\n" + "\n".join(f"{n}: {', '.join(p)}" for n, p in twice.items())
    gone = [name for name in FAMILIES if len(homes.get(name, ())) < 2]
    assert not gone, f"no family any more: {gone}"


def test_no_cycle_of_files():
    files = {module_of(path): tree for path, tree in sources().items()}
    graph = {}
    for module, tree in files.items():
        names = {name for name in imports(tree, typing_too=False, members=True) if name in files}
        graph[module] = names - {module}
    try:
        tuple(graphlib.TopologicalSorter(graph).static_order())
    except graphlib.CycleError as error:
        pytest.fail("imports run in a circle: " + " -> ".join(error.args[1]))


def test_reserved_libraries_stay_in_their_rooms():
    wrong = []
    for path, tree in sources().items():
        for name in imports(tree, typing_too=False):
            allowed = RESERVED.get(name.split(".")[0])
            if allowed is not None and not path.startswith(allowed):
                wrong.append(f"{path} imports {name}; allowed in {', '.join(allowed)}")
    assert not wrong, "\n".join(wrong)


def test_the_floors_are_those_of_the_architecture_page():
    page = (ROOT / "docs" / "architecture.md").read_text(encoding="utf-8")
    picture = page.split("```")[1]
    absent = [room for room in FLOOR if not re.search(rf"\b{room}/", picture)]
    assert not absent


def test_versions_agree():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    citation = (ROOT / "CITATION.cff").read_text(encoding="utf-8")
    changes = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    assert project["version"] == geofit.__version__
    assert re.search(r"^version: (.+)$", citation, re.M)[1].strip('"') == geofit.__version__
    assert re.search(r"^## (\S+)", changes, re.M)[1] == geofit.__version__


def test_every_dependency_is_explained_and_locked():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    extras = project["optional-dependencies"]
    wanted = [*project["dependencies"], *extras["gui"], *extras["test"], *extras["docs"]]
    names = {re.match(r"[\w-]+", line)[0].casefold() for line in wanted}
    page = (ROOT / "docs" / "architecture.md").read_text(encoding="utf-8").casefold()
    locked = {
        line.split("==")[0].casefold()
        for line in (ROOT / "constraints" / "constraints.txt").read_text(encoding="utf-8").splitlines()
    }
    assert not [name for name in names if name not in page]
    assert names <= locked


def test_constraints_hold_names_versions_and_markers_only():
    for line in (ROOT / "constraints" / "constraints.txt").read_text(encoding="utf-8").splitlines():
        assert re.fullmatch(r"[\w.-]+==[\w.+!]+( ; [\w .<>=!'()-]+)?", line), line


def test_hashes_are_those_of_the_constraints():
    folder = ROOT / "constraints"
    locked = (folder / "constraints.txt").read_text(encoding="utf-8").splitlines()
    hashed = (folder / "hashes.txt").read_text(encoding="utf-8").replace(" \\\n", "\n").splitlines()
    assert [line for line in hashed if not line.startswith(" ")] == locked
    for before, line in itertools.pairwise(hashed):
        assert line.startswith(" ") or before.startswith(" "), f"{before} has no hash"
        assert not line.startswith(" ") or re.fullmatch(r"    --hash=sha256:[0-9a-f]{64}", line), line
    assert hashed[-1].startswith(" ")
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    assert "--require-hashes --requirement $(HASHES)" in makefile
    for target in ("test", "lint", "docs", "package", "wheel"):
        assert f"\n{target}: .venv/.installed-all\n" in makefile


def test_the_wheel_has_the_pages_of_the_help_with_their_pictures():
    """An installed package opened a box of six lines for F1: the pages were in a checkout only."""
    own = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["tool"]["setuptools"]
    # gui/help_places.py has docs/ next to gui/, in a checkout as in the package.
    assert "geofit.docs" in own["packages"]
    assert own["package-dir"]["geofit.docs"] == "docs"
    pages = sorted((ROOT / "docs").glob("*.md"))
    linked = {link for page in pages for link in re.findall(r"\]\((?!http)([^)#]+)", page.read_text(encoding="utf-8"))}
    kept = {path.name for path in pages}
    rules = [line.split() for line in (ROOT / "MANIFEST.in").read_text(encoding="utf-8").splitlines()]
    for link in linked:
        # Of the rules of the sdist the last one that applies counts.
        verbs = [verb for verb, *names in rules if any(f"docs/{link}/".startswith(f"{name}/") for name in names)]
        if verbs[-1:] != ["prune"] and any(fnmatch(link, form) for form in own["package-data"]["geofit.docs"]):
            kept.add(link)
    assert len(linked) > 20
    assert linked <= kept


def test_the_trial_of_the_wheel_finds_what_is_missing():
    modules = {p.relative_to(ROOT).as_posix() for r in ("geofit", "io", "gui") for p in (ROOT / r).rglob("*.py")}
    sdist = modules | set(try_wheel.DATA) | set(try_wheel.SOURCES)
    wheel = {name if name.startswith("geofit/") else f"geofit/{name}" for name in modules | set(try_wheel.DATA)}
    assert try_wheel.missing(sdist, wheel) == []
    gone = {"geofit/py.typed", "geofit/locale/zh_CN/LC_MESSAGES/geofit.mo", "geofit/io/__init__.pyi"}
    assert try_wheel.missing(sdist, wheel - gone) == [f"wheel: {name}" for name in sorted(gone)]
    assert try_wheel.missing(sdist - {"sample_data/site.toml"}, wheel) == ["sdist: sample_data/site.toml"]
    assert "make wheel" in (ROOT / ".ci" / "run").read_text(encoding="utf-8")


def test_no_machine_path_and_no_registry_host_in_the_repository():
    # Put together here, so that this file does not hold what it looks for.
    hosts = [".".join(parts) for parts in (("pypi", "org"), ("pythonhosted", "org"), ("deb", "debian", "org"))]
    places = ["/" + "/".join(parts) + "/" for parts in (("work", "main"), ("work", "shared"), ("root",), ("home",))]
    wrong = []
    for path in tracked():
        if path.suffix in (".png", ".dxf"):
            continue
        text = path.read_bytes().decode("utf-8", errors="replace")
        wrong += [f"{path.relative_to(ROOT)}: {word}" for word in hosts + places if word in str(text)]
    assert not wrong, "\n".join(wrong)


def test_the_readme_example_runs_as_written(tmp_path):
    page = (ROOT / "README.md").read_text(encoding="utf-8")
    example = re.search(r"```python\n(.*?)```", page, re.S)[1]
    assert len([line for line in example.splitlines() if line.strip()]) == 5
    shutil.copytree(ROOT / "sample_data", tmp_path / "sample_data")
    printed = python(example, tmp_path).split()
    assert printed[0] == "PASS"
    assert 0 < float(printed[1]) < 0.5
    assert 1300 < float(printed[2]) < 1700
    assert (tmp_path / "T2-T1.step").stat().st_size > 10_000


def test_the_readme_tour_of_examination_and_changes_by_hand_runs_as_written(tmp_path):
    page = (ROOT / "README.md").read_text(encoding="utf-8")
    tour = re.findall(r"```python\n(.*?)```", page, re.S)[1]
    shutil.copytree(ROOT / "sample_data", tmp_path / "sample_data")
    printed = python(tour, tmp_path)
    assert "T3-T2 lies above T2-T1 everywhere" in printed
    assert "'kriging'" in printed
    assert "manual edit: moved by 100%" in printed
    assert "has weight 3" in printed


def test_every_check_is_explained():
    page = (ROOT / "docs" / "checks.md").read_text(encoding="utf-8")
    names = {
        call.args[0].value
        for path, tree in sources().items()
        if not path.startswith("gui/")
        for call in ast.walk(tree)
        if isinstance(call, ast.Call) and getattr(call.func, "id", "") == "Check" and call.args
        if isinstance(call.args[0], ast.Constant)
    }
    assert len(names) > 15
    assert not [
        name for name in names if f"| {name} |" not in page and f"{name}," not in page and f", {name} |" not in page
    ]
    assert names <= TERMS, f"not in geofit/data/terms.py, so never translated: {sorted(names - TERMS)}"


def test_the_readme_links_to_files_that_exist():
    for page in ("README.md", "docs/architecture.md", "docs/checks.md"):
        text = (ROOT / page).read_text(encoding="utf-8")
        for target in re.findall(r"\]\(([^)#:]+)\)", text):
            assert ((ROOT / page).parent / target).exists(), f"{page} links to {target}"
