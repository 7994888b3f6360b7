"""Names of the files that a run leaves in its folder, and what an earlier run left there."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path

from geofit.data.files import file_stems, refuse_inputs

__all__ = ["RunFiles", "earlier_files", "files_in", "removed", "run_files"]

#: Files of the run as a whole.
RUN_FILES = ("report.html", "report.json", "report.pdf", "site.png", "import_issues.csv")
#: Endings of the files of a horizon or of a block of it, and of a body.
HORIZON_ENDINGS = (
    ".step", "_certificate.pdf", "_upper90.step", "_lower90.step", ".png", ".json", "_residuals.csv",
)  # fmt: skip
BODY_ENDINGS = (".step", "_certificate.pdf", ".stl", ".stl.origin.txt", ".vtp", ".json", "_contacts.csv")
_ENDINGS = tuple(dict.fromkeys(HORIZON_ENDINGS + BODY_ENDINGS))
#: Tables that geofit alone writes: a stem with one of them is that of an earlier run.
_TABLES = ("_residuals.csv", "_contacts.csv")


@dataclass(frozen=True, eq=False)
class RunFiles:
    """Where the files of a run are, by ``stems``: no file of one horizon is that of another, of a body or of the run.

    ``horizons`` are those of the run and their blocks, ``bodies`` the name of each body by its code.
    """

    folder: Path
    stems: Mapping[str, str]
    horizons: tuple[str, ...]
    bodies: Mapping[str, str]

    def stem(self, name: str) -> Path:
        """Return folder and name of the files of a horizon, a block or a body, without ending."""
        return self.folder / self.stems[name]

    @property
    def names(self) -> list[str]:
        """All files that the run could write."""
        kinds = (self.horizons, HORIZON_ENDINGS), (self.bodies.values(), BODY_ENDINGS)
        return [*RUN_FILES, *(self.stems[name] + end for some, endings in kinds for name in some for end in endings)]


def run_files(
    folder: Path, known: Iterable[str], chosen: Iterable[str], codes: Iterable[str], blocks: Iterable[str] = ()
) -> RunFiles:
    """Decide where the files of a run go.

    Parameters
    ----------
    folder : Path
        Folder of the results.
    known : iterable of str
        All horizons of the site: a run of some of them writes no file of another.
    chosen : iterable of str
        Those that are fitted.
    codes : iterable of str
        Codes of the bodies that are fitted.
    blocks : iterable of str
        Surfaces that were fitted, where a faulted horizon has several.

    Raises
    ------
    InputError
        If one of the files is an input of the run.
    """
    horizons = tuple(dict.fromkeys((*known, *blocks)))
    bodies: dict[str, str] = {}
    for code in dict.fromkeys(codes):
        name = code
        while name in (*horizons, *bodies.values()):
            name = f"{name} body"
        bodies[code] = name
    stems = file_stems((*horizons, *bodies.values()), _ENDINGS, RUN_FILES)
    found = RunFiles(folder, stems, tuple(dict.fromkeys((*chosen, *blocks))), bodies)
    refuse_inputs(folder / name for name in found.names)
    return found


def files_in(folder: Path) -> dict[str, tuple[int, int]]:
    """Return what changes of each file when it is written anew: inode and time."""
    found = ((path.name, path.stat()) for path in folder.iterdir() if path.is_file())
    return {name: (state.st_ino, state.st_mtime_ns) for name, state in found}


def earlier_files(files: RunFiles, before: Mapping[str, tuple[int, int]]) -> tuple[list[str], list[str]]:
    """Return the files of an earlier run that lie in the folder of a run.

    Parameters
    ----------
    files : RunFiles
        The run.
    before : mapping of str to (int, int)
        What :func:`files_in` returned when the run began.

    Returns
    -------
    stale : list of str
        Those of the run's horizons, bodies and report that the run did not write: they contradict its results.
    others : list of str
        Those of horizons and bodies that are not part of the run, and other files with the name of one that is: they
        may be exports of the earlier surface.
    """
    now, mine = files_in(files.folder), set(files.names)
    old = sorted(name for name in now.keys() & before.keys() if now[name] == before[name])
    stems = [name.removesuffix(table) for name in old for table in _TABLES if name.endswith(table)]
    others = {stem + ending for stem in stems for ending in _ENDINGS} - mine
    return [name for name in old if name in mine], [name for name in old if name in others]


def removed(folder: Path, names: Iterable[str]) -> list[str]:
    """Remove files; return those that are gone: another program may have one open."""
    gone = []
    for name in names:
        try:
            (folder / name).unlink()
        except OSError:
            continue
        gone.append(name)
    return gone
