"""The translations: ``geofit/locale/LANGUAGE/LC_MESSAGES/geofit.po`` from the sources, ``geofit.mo`` from the ``.po``.

``python tools/catalogue.py`` adds new messages of the library, the reports and the windows to each ``.po`` and compiles
it; new ones wait there, without a translation, for a translator. With ``--check`` nothing is written: it fails where a
message is missing, untranslated, fuzzy or no longer used, where the fields of a translation differ from those of its
message, and where a ``.mo`` is not that of its ``.po``. Needs Babel (extra ``test``).
"""

from __future__ import annotations

import argparse
import string
import sys
from datetime import UTC, datetime
from io import BytesIO
from pathlib import Path

from babel.messages.catalog import Catalog, Message
from babel.messages.extract import extract_from_dir
from babel.messages.frontend import parse_keywords
from babel.messages.mofile import write_mo
from babel.messages.pofile import read_po, write_po

from geofit.data.terms import TERMS

ROOT = Path(__file__).resolve().parents[1]
LOCALE = ROOT / "geofit" / "locale"
FOLDERS = ("geofit", "io", "gui")
#: What takes a text, and in which arguments: messages, labels of reports, texts of widgets.
KEYWORDS = parse_keywords(
    [
        "message:2",
        "plural_message:2,3",
        "t:1",
        "tr:1,1t",
        "tr:1,2c,2t",
        "translate:1c,2",
        "QT_TRANSLATE_NOOP:1c,2",
    ]
)
#: A fixed day in the header: the same messages make the same bytes.
DAY = datetime(2026, 1, 1, tzinfo=UTC)
#: The comma of lists (:mod:`geofit.data.messages`).
LISTS = ("{first}, {second}",)


def main() -> int:
    """Update the catalogues, or check them."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--check", action="store_true", help="write nothing, fail if a catalogue is not up to date")
    checking = parser.parse_args().check
    sources = extracted()
    failed = False
    for po in sorted(LOCALE.glob("*/LC_MESSAGES/geofit.po")):
        if checking:
            faults = check(po, sources)
            print("\n".join(faults) or f"{po.relative_to(ROOT)}: {len(sources)} messages, all translated.")
            failed |= bool(faults)
            continue
        known = load(po)
        known.update(sources, no_fuzzy_matching=True)
        known.obsolete.clear()
        save(known, po)
        po.with_suffix(".mo").write_bytes(compiled(known))
        waiting = sum(not translated(message) for message in known if message.id)
        print(f"{po.relative_to(ROOT)}: {len(known)} messages, {waiting} without a translation.")
    return int(failed)


def extracted(root: Path = ROOT) -> Catalog:
    """Return the messages of the sources, each with the files that it is in and the comments for translators."""
    found = Catalog(project="geofit", charset="utf-8", fuzzy=False, creation_date=DAY)
    for folder in FOLDERS:
        for name, _, text, comments, context in extract_from_dir(
            root / folder, method_map=[("**.py", "python")], keywords=KEYWORDS, comment_tags=("Translators:",)
        ):
            file = f"{folder}/{Path(name).as_posix()}"
            known = found.get(text if isinstance(text, str) else text[0], context)
            if known is None or (file, None) not in known.locations:
                found.add(text, locations=[(file, None)], auto_comments=comments, context=context)
    for term in (*LISTS, *sorted(TERMS)):
        found.add(term, locations=[("geofit/data/terms.py", None)])
    return found


def check(po: Path, sources: Catalog) -> list[str]:
    """Return what is wrong with a catalogue, a line each."""
    known = load(po)
    wanted = {_key(message): message for message in sources if message.id}
    have = {_key(message): message for message in known if message.id}
    faults = [f"missing: {key}" for key in wanted if key not in have]
    faults += [f"not used any more: {key}" for key in have if key not in wanted]
    for key, message in have.items():
        if not translated(message) or message.fuzzy:
            faults.append(f"without a translation: {key}")
            continue
        source = message.id if isinstance(message.id, tuple) else (message.id,)
        texts = message.string if isinstance(message.string, tuple) else (message.string,)
        if any(_fields(text) != _fields(source[-1]) for text in texts):
            faults.append(f"the fields differ: {key} -> {message.string}")
    mo = po.with_suffix(".mo")
    if not mo.is_file() or mo.read_bytes() != compiled(known):
        faults.append(f"{mo.name} is not that of {po.name}: run tools/catalogue.py")
    return faults


def load(po: Path) -> Catalog:
    """Read a catalogue."""
    with po.open("rb") as stream:
        return read_po(stream, locale=po.parents[1].name)


def save(catalogue: Catalog, po: Path) -> None:
    """Write a catalogue, sorted by message, so that the same messages make the same bytes."""
    with po.open("wb") as stream:
        write_po(stream, catalogue, width=120, sort_output=True, omit_header=False, include_lineno=False)


def compiled(catalogue: Catalog) -> bytes:
    """Return the ``.mo`` of a catalogue."""
    stream = BytesIO()
    write_mo(stream, catalogue)
    return stream.getvalue()


def translated(message: Message) -> bool:
    """Whether every form of a message has a translation."""
    return all(message.string) if isinstance(message.string, tuple) else bool(message.string)


def _key(message: Message) -> tuple[str | None, str]:
    return message.context, message.id if isinstance(message.id, str) else message.id[0]


def _fields(text: str) -> set[str]:
    try:
        return {name for _, name, _, _ in string.Formatter().parse(text) if name}
    except ValueError:  # no template: a brace of its own
        return set()


if __name__ == "__main__":
    sys.exit(main())
