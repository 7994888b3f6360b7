"""The template of the HTML report chooses by the kinds of blocks: a kind that is renamed there must be renamed here."""

from __future__ import annotations

import re
from pathlib import Path

from geofit.report import document


def test_the_template_knows_every_kind_of_block_and_no_other():
    text = (Path(document.__file__).parent / "templates" / "report.html.j2").read_text(encoding="utf-8")
    named = set(re.findall(r'kind == "(\w+)"', text))
    defined = {
        name for name, kind in vars(document).items() if isinstance(kind, type) and kind.__module__ == document.__name__
    }
    assert named == defined - {"Chapter", "Column", "ReportDocument"}
