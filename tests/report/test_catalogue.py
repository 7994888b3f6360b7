"""The catalogue is complete, keeps the fields, and is compiled."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

from geofit.data.languages import EN, ZH, translate
from geofit.data.messages import Untranslated, message, plural_message

ROOT = Path(__file__).resolve().parents[2]


def test_every_message_is_translated_and_compiled():
    script = ROOT / "tools" / "catalogue.py"
    done = subprocess.run([sys.executable, str(script), "--check"], capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr


def test_a_message_is_formatted_only_where_it_is_shown():
    text = message("check.folded", "{count} of {total} places folded or degenerate", count=3, total=40)
    assert (text.code, text.params) == ("check.folded", {"count": 3, "total": 40})
    assert translate(text, EN) == str(text) == "3 of 40 places folded or degenerate"
    assert translate(text, ZH) == "40 处中有 3 处折叠或退化"


def test_lists_terms_and_names_are_shown_in_the_language():
    assert translate(message("x", "{point}", point="core"), ZH) != "core"
    assert translate(message("x", "{point}", point=Untranslated("core")), ZH) == "core"
    rows = tuple(message("data.place-row", "row {row}", row=row) for row in (2, 5))
    assert translate(message("x", "{rows}", rows=rows), ZH) == "第 2 行，第 5 行"


def test_plurals_follow_the_count():
    texts = [str(plural_message("x", "{count} point", "{count} points", count=n)) for n in (1, 2)]
    assert texts == ["1 point", "2 points"]
