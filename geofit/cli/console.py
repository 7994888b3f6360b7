"""What the command line shows: results on stdout; progress, findings and errors on stderr."""

from __future__ import annotations

import json
import re
import signal
import sys
import threading
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, contextmanager, nullcontext, suppress
from functools import wraps
from pathlib import Path
from typing import TYPE_CHECKING, Any, ParamSpec

import typer

from geofit.data.errors import Cancelled, GeofitError, InputError, MissingDependencyError
from geofit.data.files import cannot_write, folder_for, inputs_kept
from geofit.data.messages import Message, gravest_first, message
from geofit.data.progress import Progress
from geofit.data.site import ImportIssue, TableCount

if TYPE_CHECKING:
    from rich.console import Console

    from geofit.report.result import HorizonResult

__all__ = [
    "list_issues",
    "listening",
    "print_counts",
    "print_error",
    "print_issues",
    "print_json",
    "print_results",
    "print_table",
    "say",
    "with_exit_code",
]

P = ParamSpec("P")

#: Debian's package of each system library that a dependency loads.
_PACKAGES = {
    "libGL.so": "libgl1",
    "libEGL.so": "libegl1",
    "libGLX.so": "libglx0",
    "libOpenGL.so": "libopengl0",
    "libX11.so": "libx11-6",
    "libXext.so": "libxext6",
    "libXrender.so": "libxrender1",
    "libxcb": "libxcb1",
    "libxkbcommon.so": "libxkbcommon0",
    "libfontconfig.so": "libfontconfig1",
    "libfreetype.so": "libfreetype6",
    "libexpat.so": "libexpat1",
    "libgomp.so": "libgomp1",
    "libstdc++.so": "libstdc++6",
    "libSM.so": "libsm6",
    "libICE.so": "libice6",
    "libglib-2.0.so": "libglib2.0-0",
    "libdbus-1.so": "libdbus-1-3",
}
_MISSING = re.compile(r"(lib[\w+.-]+\.so[.\d]*): cannot open shared object file")
#: Columns of a table that goes into a pipe.
PIPE_WIDTH = 160
FIRST_ISSUES = 5


def with_exit_code(command: Callable[P, int]) -> Callable[P, None]:
    """Turn a command's number into the exit code, and known errors into one clear line; keep the command's inputs.

    With ``--json`` stdout gets the error as a document, so that what reads it finds one in every case.
    """

    @wraps(command)
    def run(*args: P.args, **kwargs: P.kwargs) -> None:
        with _kept(kwargs):
            code = exit_code(*args, **kwargs)
        raise typer.Exit(code)

    def exit_code(*args: P.args, **kwargs: P.kwargs) -> int:
        try:
            return command(*args, **kwargs)
        except (GeofitError, KeyboardInterrupt, OSError, ImportError) as raised:
            error = _known(raised)
            if error is None:
                raise
        stopped = isinstance(error, Cancelled)
        code = 130 if stopped else 2
        _list_reasons(error, kwargs)
        say(str(error) if stopped else f"geofit: {error}")
        if kwargs.get("as_json"):
            with suppress(OSError):  # stdout itself may be on the disk that is full
                print_error(error, code)
        return code

    return run


def _known(error: BaseException) -> GeofitError | None:
    """Return an error as one with a sentence for the user; None for one that is a defect of the program."""
    match error:
        case GeofitError():
            return error
        case KeyboardInterrupt():
            return Cancelled(
                message("cli.stopped", "Stopped. Files that were begun have been removed; finished ones are whole.")
            )
        case BrokenPipeError():
            return None
        case OSError():
            # A full disk, a folder that may not be written: the user's to correct.
            return cannot_write(error, error.filename or "a file")
        case ImportError():
            return _system_library(str(error))
    return None


def print_error(error: GeofitError, code: int) -> None:
    """Write an error and the exit code as one JSON document to stdout."""
    from geofit.report.schema import error_document

    print_json(error_document(error, code))


def _kept(options: Mapping[str, object]) -> AbstractContextManager[None]:
    """Keep the files that a command names from its results; a command without results may save what it opened."""
    target = next((name for name in ("out", "site") if name in options), None)
    if target is None:
        return nullcontext()
    given = [value for name, value in options.items() if name != target]
    several = (value if isinstance(value, list) else [value] for value in given)
    return inputs_kept(path for values in several for path in values if isinstance(path, Path))


def _list_reasons(error: GeofitError, options: Mapping[str, object]) -> None:
    """List what was found before an error, where the command lists what it finds."""
    if not error.issues:
        return
    try:
        _list(error.issues, _issue_file(options))
    except GeofitError:  # the file cannot be written: the reason is still to be seen
        _list(error.issues, None)


def _issue_file(options: Mapping[str, object]) -> Path | None:
    """Return where the issues are written: in the results folder or beside the new site file, else None."""
    out, site = options.get("out"), options.get("site")
    if isinstance(out, Path):
        # geofit export names a file there.
        return out / "import_issues.csv" if out.is_dir() or not out.suffix else None
    if isinstance(site, Path):
        from geofit.project.importing import issue_file_of

        return issue_file_of(site)
    return None


def _system_library(text: str) -> MissingDependencyError | None:
    found = _MISSING.search(text)
    if found is None:
        return None
    library = found[1]
    package = next((package for stem, package in _PACKAGES.items() if library.startswith(stem)), None)
    if package is None:
        return MissingDependencyError(
            message(
                "cli.library-missing",
                "The system library {library} is missing. Find its package (Debian: apt-file search {library}).",
                library=library,
            )
        )
    return MissingDependencyError(
        message(
            "cli.library-of-package-missing",
            "The system library {library} is missing. Install it (Debian and Ubuntu: apt-get install {package}).",
            library=library,
            package=package,
        )
    )


def say(text: Message | str) -> None:
    """Write a line to stderr as it stands."""
    sys.stderr.write(f"{text}\n")


@contextmanager
def listening() -> Iterator[Progress]:
    """Show stages and the time left on a terminal; nothing in a pipe. Ctrl-C stops at the next stage at last."""
    with _interrupts() as stopped, _bars() as show:

        def listen(stage: str | Message, fraction: float, /) -> bool:
            show(str(stage), fraction)
            return not stopped()

        yield listen


@contextmanager
def _interrupts() -> Iterator[Callable[[], bool]]:
    """Remember Ctrl-C: a library's callback in which the exception is raised may lose it."""
    elsewhere = threading.current_thread() is not threading.main_thread()
    if elsewhere or signal.getsignal(signal.SIGINT) is not signal.default_int_handler:
        yield lambda: False
        return
    asked = threading.Event()

    def handle(_number: int, _frame: object) -> None:
        asked.set()
        raise KeyboardInterrupt

    signal.signal(signal.SIGINT, handle)
    try:
        yield asked.is_set
        if asked.is_set():
            raise KeyboardInterrupt
    finally:
        signal.signal(signal.SIGINT, signal.default_int_handler)


@contextmanager
def _bars() -> Iterator[Callable[[str, float], None]]:
    if not sys.stderr.isatty():
        yield lambda stage, fraction: None
        return
    from rich.console import Console
    from rich.markup import escape
    from rich.progress import BarColumn, TextColumn, TimeRemainingColumn
    from rich.progress import Progress as Bars

    columns = (
        BarColumn(28),
        TextColumn("{task.percentage:>3.0f} %"),
        TimeRemainingColumn(),
        TextColumn("{task.description}"),
    )
    with Bars(*columns, console=Console(stderr=True), transient=True) as bars:
        task = bars.add_task("starting", total=1.0)

        def show(stage: str, fraction: float) -> None:
            bars.update(task, completed=fraction, description=escape(stage))

        yield show


def print_results(results: Sequence[HorizonResult]) -> None:
    """Print one line a horizon."""
    from geofit.report.digits import metres

    header = (
        "horizon",
        "n",
        "core/periphery",
        "sigma, m",
        "epsilon, m",
        "max, m",
        "verdict",
        "seams",
        "fit, s",
        "all, s",
    )
    rows = []
    for r in results:
        a, core = r.accuracy, int(r.core.sum())
        rows.append(
            (
                r.name, str(a.n), f"{core}/{a.n - core}", metres(a.sigma), f"{a.epsilon:g}", metres(a.max_abs),
                r.verdict.word, _seams(r), _time(r.seconds.get("fit")), _time(sum(r.seconds.values())),
            )
        )  # fmt: skip
    print_table(header, rows, left=(0, 6, 7))
    for r in results:
        a = r.accuracy
        say(f"{r.name}: {r.verdict.text}")
        failed = [c for c in (*a.checks, *(r.read_back.checks if r.read_back else ())) if c.passed is False]
        for check in failed:
            say(f"{r.name}: check '{check.name}' fails: {check.text}")
        partition = r.surface.partition
        lost = () if partition is None or partition.reason.severity == "info" else (partition.reason,)
        for note in gravest_first((*lost, *a.notes)):
            say(f"{r.name}: {'' if note.severity == 'info' else f'{note.severity}: '}{note}")


def _time(seconds: float | None) -> str:
    return f"{seconds:.1f}" if seconds else "–"


def _seams(result: HorizonResult) -> str:
    seams = result.read_back.seams if result.read_back else result.accuracy.seams
    if not seams:
        return "none"
    return f"{len(seams)}: gap {max(s.gap for s in seams):.0e} m, angle {max(s.angle for s in seams):.1g}°"


def print_table(header: Sequence[str], rows: Sequence[Sequence[str]], left: Sequence[int] = (0,)) -> None:
    """Print a table to stdout; numbers stand right, the columns ``left`` left."""
    from rich.box import SIMPLE_HEAD
    from rich.table import Table
    from rich.text import Text

    table = Table(box=SIMPLE_HEAD, pad_edge=False)
    for i, word in enumerate(header):
        table.add_column(word, justify="left" if i in left else "right", overflow="fold", no_wrap=i not in left)
    styles = {"PASS": "green", "FAIL": "bold red", "WARNING": "yellow"}
    for row in rows:
        table.add_row(*(Text(cell, style=styles.get(cell, "")) for cell in row))
    _stdout().print(table)


def list_issues(issues: Sequence[ImportIssue], folder: Path | None) -> None:
    """Write what the readers found to ``import_issues.csv`` and summarise it; without a folder, print all of it."""
    _list(issues, None if folder is None else folder / "import_issues.csv")


def _list(issues: Sequence[ImportIssue], file: Path | None) -> None:
    # An earlier run's list would be taken for this one's.
    if file is not None and (issues or file.exists()):
        from geofit.report.tables import write_issues

        folder_for(file.parent)
        write_issues(issues, file)
    print_issues(issues, str(file or ""))


def print_issues(issues: Sequence[ImportIssue], where: str = "") -> None:
    """Summarise what the readers found on stderr: counts, and the first kinds of errors and warnings.

    Errors come before warnings, and what was found seldom before what was found at every other row. Where nothing else
    lists them, every error and warning is printed, and one of each kind of notes.
    """
    if not issues:
        return
    counts = {word: sum(issue.severity == word for issue in issues) for word in ("error", "warning", "note")}
    summary = ", ".join(f"{count} {word}{'s' * (count != 1)}" for word, count in counts.items() if count)
    say(f"Import: {summary}." + (f" All of them: {where}" if where else ""))
    kinds: dict[tuple[str, str, str], list[ImportIssue]] = {}
    for issue in issues:
        kinds.setdefault((issue.severity, issue.file, issue.reason.code), []).append(issue)
    ordered = sorted(kinds.values(), key=len)
    for severity in ("error", "warning") if where else ("error", "warning", "note"):
        shown = [alike for alike in ordered if alike[0].severity == severity]
        if not where and severity != "note":
            shown = [[issue] for alike in shown for issue in alike]
        first = FIRST_ISSUES if where else len(shown)
        for alike in shown[:first]:
            say("  " + _sentence(alike[0]) + (f" ({len(alike) - 1} more like it)" if len(alike) > 1 else ""))
        if rest := sum(map(len, shown[first:])):
            say(f"  ... and {rest} more {severity}{'s' * (rest != 1)}.")


def _sentence(issue: ImportIssue) -> str:
    console_error = InputError(
        issue.reason,
        issue.remedy,
        file=issue.file,
        row=issue.row or None,
        column=issue.column or None,
        value=issue.value or None,
    )
    return f"{issue.severity}: {console_error}"


def print_counts(counts: Sequence[TableCount]) -> None:
    """Say on stderr how many rows were read, used and listed."""
    read, used, listed = (sum(getattr(c, name) for c in counts) for name in ("read", "used", "listed"))
    files = f"{len(counts)} file{'s' * (len(counts) != 1)}"
    say(f"Rows of {files}: {read} read = {used} used + {listed} listed.")


def print_json(data: Any) -> None:
    """Write one JSON document to stdout."""
    sys.stdout.write(json.dumps(data, ensure_ascii=False, indent=1, allow_nan=False) + "\n")


def _stdout() -> Console:
    from rich.console import Console

    console = Console()
    return console if console.is_terminal else Console(width=PIPE_WIDTH, no_color=True)
