"""From logged intervals to the files of a closed body: STEP solid, triangles, figures, residuals of the contacts."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields
from pathlib import Path
from typing import TYPE_CHECKING, Any

from geofit.bodies.crossval import left_out_body
from geofit.bodies.fit import fit_body
from geofit.bodies.settings import BodySettings
from geofit.data.accuracy import plain
from geofit.data.files import file_stems, folder_for
from geofit.data.messages import Message
from geofit.data.progress import Progress, tell
from geofit.data.verdict import Verdict, verdict_of
from geofit.project.body_files import write_figures, write_triangles
from geofit.project.step_files import Signed, certified

if TYPE_CHECKING:
    from geofit.bodies.accuracy import BodyAccuracy
    from geofit.bodies.body import BodyFit
    from geofit.bodies.data import BodyData
    from geofit.bodies.simulate import BodyVolumes
    from geofit.cad.solid_read_back import SolidReadBack
    from geofit.data.prediction import LeftOutBody
    from geofit.data.site import Site
    from geofit.io.boreholes import Boreholes

__all__ = ["BodyRun", "run_body"]


@dataclass(frozen=True, eq=False)
class BodyRun:
    """A fitted body with its volumes, its STEP file as read back, and all files that were written."""

    body: BodyFit
    volumes: BodyVolumes
    read_back: SolidReadBack
    files: tuple[Path, ...]
    left_out: LeftOutBody | None = None

    @property
    def verdict(self) -> Verdict:
        """The verdict with its three lamps."""
        return verdict_of(self.accuracy, self.left_out)

    @property
    def accuracy(self) -> BodyAccuracy:
        """The verdict."""
        assert self.body.accuracy is not None
        return self.body.accuracy

    @property
    def failed_checks(self) -> tuple[Message, ...]:
        """What each failed check of the body and of its file found."""
        checks = (*self.accuracy.checks, *self.read_back.checks)
        return tuple(check.text for check in checks if check.passed is False)

    @property
    def exit_code(self) -> int:
        """0: sigma < epsilon; 1: not."""
        return 0 if self.accuracy.passed else 1

    def figures(self) -> dict[str, Any]:
        """Return everything that the JSON file has, as plain data."""
        from geofit import __version__
        from geofit.report.schema import enveloped

        accuracy = plain(self.accuracy)
        for per_contact in ("residuals", "patch"):
            accuracy.pop(per_contact)
        volumes = plain(self.volumes)
        volumes.pop("values")
        settings = self.body.settings
        return enveloped(
            "body",
            {
                "body": self.body.name,
                "verdict": self.verdict.word,
                "settings": {f.name: plain(getattr(settings, f.name)) for f in fields(settings)},
                **accuracy,
                "volumes": volumes,
                "lamps": plain(self.verdict.lamps),
                "left_out": None if self.left_out is None else plain(self.left_out),
                "read_back": {**plain(self.read_back), "file": Path(self.read_back.file).name},
                "issues": plain(self.body.issues),
                "version": __version__,
            },
        )


def run_body(
    source: Boreholes | Site | BodyData,
    out: Path,
    *,
    codes: str | Sequence[str] | None = None,
    name: str = "",
    settings: BodySettings | None = None,
    progress: Progress | None = None,
    signed: Signed | None = None,
    stem: str = "",
    workers: int | None = 1,
) -> BodyRun:
    """Fit a body, examine it, and write ``NAME.step``, ``.stl``, ``.vtp``, ``.json`` and ``NAME_contacts.csv``.

    Parameters
    ----------
    source, codes, name, settings
        As for :func:`geofit.fit_body`.
    out : Path
        Folder for the files; created if missing. Each file is whole or absent.
    progress : callable, optional
        ``progress(stage, fraction)``; False stops.
    signed : Signed, optional
        What the STEP file states, and whether it gets a certificate.
    stem : str
        Name of the files without ending; empty: from the body's name.
    workers : int, optional
        Processes that leave holes out of a large body, see :func:`geofit.bodies.crossval.left_out_body`.

    Raises
    ------
    FitError, SettingsError
        As for :func:`geofit.fit_body`.
    InputError
        If a file cannot be written, or the body is empty.
    """
    from geofit.report.tables import write_contacts

    folder = folder_for(out)
    tell(progress, "fit", 0.0)
    body = fit_body(source, settings, codes=codes, name=name)
    path = folder / (stem or file_stems([body.name])[body.name])
    tell(progress, "volumes", 0.3)
    volumes = body.volumes()
    tell(progress, "holes left out", 0.5)
    left_out = left_out_body(body, workers)
    tell(progress, "STEP", 0.6)
    step, contacts = path.with_name(f"{path.name}.step"), path.with_name(f"{path.name}_contacts.csv")
    stated = (signed or Signed()).about([body.extent[0] + body.origin])
    read_back = body.write_step(step, **stated.fields)
    page = certified(step, {body.name: read_back}, {body.name: body.epsilon}, stated)
    tell(progress, "files", 0.9)
    write_contacts(body, contacts)
    figures = path.with_name(f"{path.name}.json")
    files = (step, figures, contacts, *write_triangles(body.overview, path, body.origin))
    files = files if page is None else (*files, page)
    run = BodyRun(body, volumes, read_back, files, left_out)
    write_figures(run.figures(), figures)
    return run
