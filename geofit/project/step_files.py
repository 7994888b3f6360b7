"""Writing STEP with its read-back as a task with progress; without Qt, because it runs in a process of its own."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, TypedDict

import numpy as np
from numpy.typing import NDArray

from geofit.cad.step import Unit, write_step
from geofit.cad.step_origin import Origin, offset_of
from geofit.data.accuracy import ReadBack
from geofit.data.files import file_stems
from geofit.data.languages import language
from geofit.data.progress import Progress, tell
from geofit.surfaces.protocol import Surface
from geofit.surfaces.unfitted import as_fitted

if TYPE_CHECKING:
    from geofit.cad.solid_read_back import SolidReadBack

__all__ = ["Signed", "StepFile", "certified", "step_paths", "write_step_files"]


class SignedKeywords(TypedDict):
    """Keywords of :func:`geofit.cad.step.write_step` and of a body's ``write_step``."""

    author: str
    organisation: str
    origin: Origin


@dataclass(frozen=True, eq=False)
class StepFile:
    """A file that was written: where it is, its size in bytes, what the reader found in it, its certificate."""

    path: Path
    size: int
    read_back: Mapping[str, ReadBack]
    certificate: Path | None = None


@dataclass(frozen=True)
class Signed:
    """What a file states: who answers for it, and where its zero is (:data:`geofit.cad.step_origin.Origin`).

    ``certificate`` is the language of its certificate, empty for none.
    """

    author: str = ""
    organisation: str = ""
    certificate: str = ""
    origin: Origin = "map"

    def about(self, corners: Iterable[NDArray[np.float64]]) -> Signed:
        """Return the same with the origin as numbers, so that all files of one run have one offset.

        ``corners`` are the lowest coordinates (3,) of each surface or body, metres.

        Raises
        ------
        SettingsError
            If the origin is neither a known word nor three numbers.
        """
        offset = offset_of(self.origin, corners)
        return replace(self, origin=tuple(offset.tolist()) if offset.any() else "map")

    @property
    def offset(self) -> NDArray[np.float64]:
        """Offset (3,) of the file's coordinates, metres; of an origin that :meth:`about` has made numbers."""
        return offset_of(self.origin, ())

    @property
    def fields(self) -> SignedKeywords:
        """What the writers of STEP take."""
        return {"author": self.author, "organisation": self.organisation, "origin": self.origin}


def step_paths(names: list[str], target: Path, *, separate: bool) -> dict[Path, list[str]]:
    """Return which horizons go into which file: all into ``target``, or each into ``TARGET_HORIZON.step``.

    Examples
    --------
    >>> {path.name: names for path, names in step_paths(["T1", "T2"], Path("dam.step"), separate=True).items()}
    {'dam_T1.step': ['T1'], 'dam_T2.step': ['T2']}
    """
    if not separate or len(names) < 2:
        return {target: names}
    stems = file_stems(names)
    return {target.with_name(f"{target.stem}_{stems[name]}{target.suffix}"): [name] for name in names}


def write_step_files(
    surfaces: Mapping[str, Surface],
    target: Path,
    unit: Unit,
    separate: bool,
    signed: Signed | None = None,
    stale: Collection[str] = (),
    *,
    progress: Progress,
) -> list[StepFile]:
    """Write surfaces as STEP, in one file or one each, and read every file back.

    With a certificate, the page goes next to each file under its name: ``dam.step`` gets ``dam_certificate.pdf``. It
    names ``stale`` surfaces, which were fitted to earlier data or settings.

    Raises
    ------
    Cancelled
        If ``progress`` returned False between two files.
    GeofitError
        Of :func:`geofit.cad.step.write_step`; files that were ready stay.
    """
    written, by = [], (signed or Signed()).about(surface.bounds[0] for surface in surfaces.values())
    plan = step_paths(list(surfaces), target, separate=separate)
    for k, (path, names) in enumerate(plan.items()):
        tell(progress, path.name, k / len(plan))
        mine = {name: surfaces[name] for name in names}
        found = write_step(mine, path, unit=unit, **by.fields)
        epsilon = {name: as_fitted(surface).settings.epsilon for name, surface in mine.items()}
        page = certified(path, found, epsilon, by, stale)
        written.append(StepFile(path, path.stat().st_size, found, page))
    return written


def certificate_of(path: Path) -> Path:
    """Return the page that is the certificate of a STEP file."""
    return path.with_name(f"{path.stem}_certificate.pdf")


def certified(
    path: Path,
    found: Mapping[str, ReadBack | SolidReadBack],
    epsilon: Mapping[str, float],
    by: Signed,
    stale: Collection[str] = (),
) -> Path | None:
    """Write the certificate of a file next to it; return its page, None where none is wanted.

    Parameters
    ----------
    path : Path
        The file.
    found : mapping of str to ReadBack or SolidReadBack
        What the reader found, by horizon or body.
    epsilon : mapping of str to float
        Control error of each, metres.
    by : Signed
        What the file states.
    stale : collection of str
        Horizons whose surfaces were fitted to earlier data or settings.

    Raises
    ------
    MissingDependencyError
        If the certificate is in Chinese and the machine has no font for it.
    """
    if not by.certificate:
        return None
    from geofit.report.certificate import write_certificate

    page = certificate_of(path)
    write_certificate(
        page, path, found, epsilon, language(by.certificate), author=by.author, organisation=by.organisation,
        offset=tuple(by.offset.tolist()), stale=stale,
    )  # fmt: skip
    return page
