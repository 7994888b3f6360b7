"""The page of the settings: ``docs/settings.md`` from what the fit panel, the command line and the report read, too.

``python tools/settings_page.py`` writes it; with ``--check`` nothing is written, and an outdated page fails.
"""

from __future__ import annotations

import argparse
import sys
from dataclasses import fields
from pathlib import Path
from typing import Any

from geofit.data.setting_texts import SETTINGS, SettingText
from geofit.data.settings import FitSettings

PAGE = Path(__file__).resolve().parents[1] / "docs" / "settings.md"
HEAD = """# Settings of a fit

Use the same names in a script (`geofit.FitSettings(epsilon=0.25)`), in a site file (`epsilon = 0.25` under a horizon)
and, with dashes, on the command line (`geofit fit --epsilon 0.25`). The fit panel shows the labels.
"""


def page() -> str:
    """Return the page."""
    defaults = {field.name: field.default for field in fields(FitSettings)}
    parts = [HEAD]
    for name, text in SETTINGS.items():
        parts.append(f"## `{name}`\n\n**{text.label}.** {text.about}\n")
        polygon = ["a polygon of at least three corners, map coordinates in metres"] if name == "core" else []
        parts.append("\n".join(f"- {line}" for line in (*polygon, *_facts(text, defaults[name]))) + "\n")
    return "\n".join(parts)


def _facts(text: SettingText, default: Any) -> list[str]:
    """Return the lines of a setting's values: choices, range, default."""
    facts = [f"`{_written(value)}`: {words}" for value, words in text.choices.items()]
    if text.number == "real":
        facts.append("a number above 0" + (f", {text.unit}" if text.unit else ""))
    if text.number == "whole":
        facts.append(f"a whole number of at least {text.least}")
    return [*facts, f"default: `{_written(default)}`"]


def _written(value: object) -> str:
    """Return a value as a site file has it; there ``None`` is a key left out."""
    return str(value).lower() if isinstance(value, bool) else str(value)


def main() -> int:
    """Write the page, or check it."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--check", action="store_true", help="write nothing, fail if the page is out of date")
    if not parser.parse_args().check:
        PAGE.write_text(page(), encoding="utf-8")
        return 0
    if PAGE.is_file() and PAGE.read_text(encoding="utf-8") == page():
        return 0
    print(f"{PAGE.name} is out of date; run python tools/settings_page.py", file=sys.stderr)
    return 1


if __name__ == "__main__":
    sys.exit(main())
