"""The exporters as a task with progress; without Qt, because it runs in a process of its own."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from geofit.data.progress import Progress, tell
from geofit.fitting.horizon_fit import HorizonFit
from geofit.project.export import Request, export

__all__ = ["export_surfaces"]


def export_surfaces(
    surfaces: Mapping[str, HorizonFit], to: str, target: Path, request: Request, *, progress: Progress
) -> list[Path]:
    """Write surfaces in a format of :data:`geofit.project.export.FORMATS`; return the files."""
    tell(progress, "write", 0.1)
    return export(surfaces, to, target, request)
