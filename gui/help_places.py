"""Where the pages explain what: a page and a heading of it for each panel and each dialog.

A place is a page's file and the anchor of a heading, as links between the pages name it: ``tutorial.md#4-fit``.
"""

from __future__ import annotations

import re
from pathlib import Path

__all__ = ["PAGES", "PLACE_OF_DIALOG", "PLACE_OF_PANEL", "TUTORIAL", "anchor"]

#: In a checkout next to ``gui``; in an installed package too, as ``geofit/docs``.
PAGES = Path(__file__).resolve().parents[1] / "docs"
TUTORIAL = "tutorial.md"
#: By the names of the docks; ``view`` is the 3D view, ``start`` the page before a site is open.
PLACE_OF_PANEL = {
    "start": "tutorial.md#1-open-a-site",
    "view": "tutorial.md#3-look-at-it",
    "tree": "tutorial.md#project-tree-and-scene-list",
    "fit": "tutorial.md#4-fit",
    "adjust": "tutorial.md#9-edit-manually",
    "bodies": "tutorial.md#13-a-closed-body",
    "residuals": "tutorial.md#5-the-worst-point",
    "section": "tutorial.md#7-cut-a-section",
    "histogram": "tutorial.md#deviations-and-their-histogram",
    "plan": "tutorial.md#6-the-core",
    "seams": "tutorial.md#8-seams",
    "checks": "tutorial.md#10-check-it",
    "prediction": "tutorial.md#away-from-the-data",
    "changes": "tutorial.md#15-new-holes",
    "stereonet": "tutorial.md#16-dips-and-two-fits-side-by-side",
    "body_figures": "tutorial.md#body-figures",
    "morph": "morph.md#in-the-window",
    "log": "tutorial.md#when-something-fails",
}
#: By the names of their classes; all others have the beginning of the tutorial.
PLACE_OF_DIALOG = {
    "ImportWizard": "formats_in.md",
    "IssuesDialog": "formats_in.md",
    "RockVolumeDialog": "formats_in.md#rock-volumes",
    "RawVolumeDialog": "formats_in.md#rock-volumes",
    "SurveyDialog": "formats_in.md#cave-surveys-and-centre-lines",
    "ExportDialog": "formats_out.md#exact-geometry",
    "BodyStepDialog": "formats_out.md#exact-geometry",
    "SectionSheetDialog": "formats_out.md#sections",
    "PlanSheetDialog": "formats_out.md#grids-and-contours",
    "CompareDialog": "settings.md",
    "HorizonBuilder": "tutorial.md#2-import-your-tables",
    "PreferencesDialog": "tutorial.md#mouse-and-unit-of-lengths",
    "OrderDialog": "tutorial.md#10-check-it",
    "HorizonBodies": "morph.md#in-the-window",
    "ReportDialog": "tutorial.md#12-report",
    "RecoveryDialog": "tutorial.md#14-save",
    "ErrorDialog": "tutorial.md#when-something-fails",
    "SystemReport": "tutorial.md#when-something-fails",
}


def anchor(heading: str) -> str:
    """Return the anchor of a heading, as GitHub and MkDocs form it."""
    return re.sub(r"[^\w\- ]", "", heading.strip().lower()).replace(" ", "-")
