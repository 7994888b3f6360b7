"""Paper of drawings to scale: a frame, a title block, pages as PDF and SVG; sections and plans use the same."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

from geofit.data.files import file_stems, replacing
from geofit.data.languages import Language
from geofit.report.style import MUTED, TEXT, drawing

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["BLOCK", "EDGE", "PAPERS", "SCALES", "SheetTitle", "framed_page", "save_pdf", "save_svg"]

#: Paper in landscape, millimetres.
PAPERS = {"A4": (297.0, 210.0), "A3": (420.0, 297.0), "A1": (841.0, 594.0), "A0": (1189.0, 841.0)}
#: Scales on offer, 1 : so many.
SCALES = (100, 200, 250, 500, 1000, 2000, 2500, 5000, 10_000, 20_000, 25_000, 50_000, 100_000)
#: Millimetres: frame from the paper's edge, title block.
EDGE, BLOCK = 10.0, 24.0
#: Lines of the patterns, and letters of the PDF as text.
_THIN: dict[Any, Any] = {"hatch.linewidth": 0.25, "pdf.fonttype": 42}


@dataclass(frozen=True)
class SheetTitle:
    """What the title block says; empty lines stay empty. ``date`` is ISO 8601."""

    title: str
    project: str = ""
    number: str = ""
    author: str = ""
    date: str = ""


def framed_page(
    paper: str, block: SheetTitle, name: str, line: str, scale: str, sheet: tuple[int, int], t: Language
) -> Figure:
    """Return a page with frame, title and title block.

    ``name`` follows the title over the drawing, ``line`` is the small line below them; ``scale`` as it is printed;
    ``sheet`` is the number of the page and of all pages.
    """
    from matplotlib.figure import Figure
    from matplotlib.patches import Rectangle

    wide, high = PAPERS[paper]
    figure = Figure(figsize=(wide / 25.4, high / 25.4), dpi=72)

    def box(x: float, y: float, width: float, height: float) -> None:
        figure.add_artist(
            Rectangle((x / wide, y / high), width / wide, height / high, fill=False, ec=TEXT, lw=0.7,
                      transform=figure.transFigure)
        )  # fmt: skip

    box(EDGE, EDGE, wide - 2 * EDGE, high - 2 * EDGE)
    title = f"{block.title} · {name}" if name else block.title
    figure.text((EDGE + 6) / wide, (high - EDGE - 9) / high, title, size=13, weight="bold", color=TEXT)
    figure.text((EDGE + 6) / wide, (high - EDGE - 14) / high, line, size=7, color=MUTED)
    cells = (
        (t("Project"), block.project, 0.28),
        (t("Drawing number"), block.number, 0.16),
        (t("Prepared"), block.author, 0.16),
        (t("Date"), block.date, 0.12),
        (t("Scale"), scale, 0.2),
        (t("Sheet"), f"{sheet[0]} / {sheet[1]}", 0.08),
    )
    at, width = EDGE, wide - 2 * EDGE
    for word, value, share in cells:
        box(at, EDGE, share * width, BLOCK - 8)
        figure.text((at + 2) / wide, (EDGE + BLOCK - 12) / high, word, size=6, color=MUTED)
        figure.text((at + 2) / wide, (EDGE + 4) / high, value, size=8.5, color=TEXT)
        at += share * width
    return figure


def save_pdf(pages: Iterable[Callable[[], Figure]], title: str, path: str | PathLike[str]) -> None:
    """Write pages, each made when its turn comes, as one PDF."""
    import matplotlib as mpl
    from matplotlib.backends.backend_pdf import PdfPages

    information: dict[str, Any] = {"CreationDate": None, "ModDate": None, "Title": title}
    with drawing(8.0), mpl.rc_context(_THIN), replacing(path) as part, PdfPages(part, metadata=information) as written:
        for page in pages:
            written.savefig(page())


def save_svg(
    pages: Iterable[Callable[[], Figure]], names: Sequence[str], path: str | PathLike[str]
) -> tuple[Path, ...]:
    """Write pages as SVG, one file each; several get their names. Return the files."""
    import matplotlib as mpl

    path, files = Path(path), []
    stems = file_stems([name or str(k) for k, name in enumerate(names, 1)])
    with drawing(8.0), mpl.rc_context({**_THIN, "svg.hashsalt": "geofit", "svg.fonttype": "path"}):
        for page, stem in zip(pages, stems.values(), strict=True):
            file = path if len(names) == 1 else path.with_name(f"{path.stem}_{stem}{path.suffix}")
            figure = page()
            with replacing(file) as part:
                figure.savefig(part, format="svg", metadata={"Date": None})
            files.append(file)
    return tuple(files)
