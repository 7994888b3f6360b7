"""The exporters as a task with progress; without Qt, because it runs in a process of its own."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from geofit.exporting import Request, export
from geofit.progress import Progress, tell
from geofit.surface import HorizonSurface

__all__ = ["export_surfaces"]


def export_surfaces(
    surfaces: Mapping[str, HorizonSurface], to: str, target: Path, request: Request, *, progress: Progress
) -> list[Path]:
    """Write surfaces in a format of :data:`geofit.exporting.FORMATS`; return the files."""
    tell(progress, "write", 0.1)
    return export(surfaces, to, target, request)
