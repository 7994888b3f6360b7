"""The Chinese of the windows: ``geofit_zh_CN.ts`` from the sources, ``geofit_zh_CN.qm`` from the ``.ts``.

``python tools/update_translations.py`` takes new texts of ``gui/`` into the ``.ts`` and compiles it; new ones wait
there, unfinished, for a person. With ``--check`` nothing is written: it fails where a text is missing, unfinished or
not used any more, where a place for a value differs, and where the ``.qm`` is not that of the ``.ts``.
"""

from __future__ import annotations

import argparse
import re
import subprocess
import sys
import sysconfig
import tempfile
import xml.etree.ElementTree as ET
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
GUI = ROOT / "gui"
TS = GUI / "translations" / "geofit_zh_CN.ts"

#: A text in the .ts: its context, the text, and its translation; None while it is unfinished or not used any more.
Texts = dict[tuple[str, str], str | None]


def main() -> int:
    """Update the files, or check them."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--check", action="store_true", help="write nothing, fail if the files are not up to date")
    if parser.parse_args().check:
        faults = check()
        print("\n".join(faults) or f"{len(texts(TS))} texts, all translated.")
        return 1 if faults else 0
    extract(TS)
    TS.with_suffix(".qm").write_bytes(compiled(TS))
    waiting = [text for (_, text), told in texts(TS).items() if told is None]
    print(f"{len(texts(TS))} texts, {len(waiting)} without a translation.")
    return 0


def check(ts: Path = TS) -> list[str]:
    """Return what is wrong with the translations, a line each."""
    with tempfile.TemporaryDirectory(dir=ts.parent) as folder:  # lupdate names the sources relative to the .ts
        fresh = Path(folder) / ts.name
        extract(fresh)
        wanted = set(texts(fresh))
        right = compiled(ts)
    known = texts(ts)
    faults = [f"missing: {context}: {text}" for context, text in sorted(wanted - set(known))]
    faults += [f"not used any more: {context}: {text}" for context, text in sorted(set(known) - wanted)]
    for (context, text), told in sorted(known.items()):
        if (context, text) not in wanted:
            continue
        if told is None:
            faults.append(f"unfinished: {context}: {text}")
        elif _values(text) != _values(told):
            faults.append(f"the values differ: {context}: {text} -> {told}")
    qm = ts.with_suffix(".qm")
    if not qm.is_file() or qm.read_bytes() != right:
        faults.append(f"{qm.name} is not that of {ts.name}: run tools/update_translations.py")
    return faults


def texts(ts: Path) -> Texts:
    """Return the texts of a ``.ts`` file."""
    found: Texts = {}
    for context in ET.parse(ts).getroot().iter("context"):
        for message in context.iter("message"):
            told = message.find("translation")
            done = told is not None and not told.get("type") and told.text
            found[context.findtext("name", ""), message.findtext("source", "")] = (
                told.text if told is not None and done else None
            )
    return found


def extract(ts: Path) -> None:
    """Take the texts of the sources into a ``.ts``; those that are gone are dropped."""
    sources = sorted(str(path) for path in GUI.rglob("*.py"))
    _run("lupdate", *sources, "-no-obsolete", "-locations", "none", "-source-language", "en", "-target-language",
         "zh_CN", "-ts", str(ts))  # fmt: skip


def compiled(ts: Path) -> bytes:
    """Return the ``.qm`` of a ``.ts``."""
    with tempfile.TemporaryDirectory() as folder:
        qm = Path(folder) / "made.qm"
        _run("lrelease", "-silent", str(ts), "-qm", str(qm))
        return qm.read_bytes()


def _run(tool: str, *words: str) -> None:
    program = Path(sysconfig.get_path("scripts")) / f"pyside6-{tool}"
    done = subprocess.run([str(program), *words], capture_output=True, text=True)
    if done.returncode:
        sys.exit(f"pyside6-{tool}: {done.stderr or done.stdout}")


def _values(text: str) -> list[str]:
    return sorted(re.findall(r"\{[^}]*\}", text))


if __name__ == "__main__":
    sys.exit(main())
