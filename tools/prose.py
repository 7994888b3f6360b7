"""The words of the project: retired names in the code, and phrases that no native editor would let pass.

``python tools/prose.py`` lists what it finds, one line each, and fails if there is anything: in identifiers, in
docstrings and comments, in the messages of the catalogue, and in the pages. The tables follow ``docs/glossary.md``; a
word that is retired there enters here in the same commit.
"""

from __future__ import annotations

import ast
import io
import re
import sys
import tokenize
from collections.abc import Iterator
from pathlib import Path

from babel.messages.pofile import read_po

ROOT = Path(__file__).resolve().parents[1]
FOLDERS = ("geofit", "io", "gui")
CATALOGUE = Path("geofit/locale/zh_CN/LC_MESSAGES/geofit.po")

#: Retired parts of names, with what to use.
NAMES = {
    "chart": "parametrization",
    "recipe": "provenance",
    "recipes": "provenances",
    "ingredients": "ancestors",
    "offdata": "prediction",
    "off_data": "prediction",
    "ink": "colours, or painter",
    "eye": "viewpoint",
    "grip": "handle",
    "grips": "handles",
    "shoot": "screenshot",
    "dress": "set_look",
    "ledger": "observations",
    "deliver": "run",
    "delivery": "result",
    "conflict_distance": "coincidence_distance",
    "least_change": "minimum_norm_correction",
    "damped": "regularized",
    "zero_lines": "zero_contours",
    "folds_of": "cross_validation_folds",
    "push_apart": "separate",
    "pushed_apart": "separated",
    "parting": "fault blocks",
    "parted": "split",
    "honoured": "active",
    "facet": "triangle",
    "facets": "triangles",
    "verbatim": "untranslated",
    "told": "reported",
    "spoken": "translated",
    "handwork": "manual edit",
    "peers": "references",
    "surroundings": "site",
    "descend": "refine",
    "borrowed": "fixed",
}
#: Names that libraries own.
FOREIGN = {"eye", "setSizeGripEnabled"}
#: Phrases to reword, with what to write.
PHRASES = {
    r"(?<!here )\b(?:is|are|was|were) no (?!longer|more|less|fewer|way|such|need|better|worse|larger|smaller|later"
    r"|wider|nearer|steeper|later|linear|\d)": "is not a ...",
    r"\bpush(?:ed|es|ing)? (?:\w+ )?apart\b": "separate",
    r"\bbears? (?:\w+ ){0,2}out\b|\bborne out\b": "support, contradict",
    r"\bnobody drilled\b": "away from the data",
    r"\boff (?:the|its|their) data\b": "away from the data",
    r"\bgap(?:e|es|ing)\b": "have a gap",
    r"\b(?:lay|lays|laid|laying) (?:a surface|over the map)\b": "fit",
    r"\bif it is not there\b": "if missing",
    r"\bchecks? (?:does|do) not hold\b|\bcheck holds\b": "fail, pass",
    r"\bstands? for\b": "represents",
    r"\bchanges? by hand\b": "manual edit",
    r"\b(?:gives?|gave) way\b": "is dropped",
    r"\bat one place\b": "at one location",
    r"\brecipes?\b|\bingredients\b": "provenance",
    r"\b(?:tells?|told|says|said) (?:whether|why|how many|that it)\b": "shows, states, reports",
    r"\bas it lay\b": "as it was",
}
COMPILED = {re.compile(pattern): cure for pattern, cure in PHRASES.items()}


def names(root: Path = ROOT) -> Iterator[str]:
    """Yield a line for each retired name that is defined or stored in the code."""
    for file in sources(root):
        where = file.relative_to(root)
        defined = {(file.stem, 1)} | set(_defined(ast.parse(file.read_text(encoding="utf-8"))))
        for name, line in sorted(defined, key=lambda found: (found[1], found[0])):
            parts = "_" + re.sub(r"(?<=[a-z])(?=[A-Z])", "_", name).lower().strip("_") + "_"
            for retired, cure in NAMES.items():
                if f"_{retired}_" in parts and name not in FOREIGN:
                    yield f"{where}:{line}: '{name}' has the retired word '{retired}'; use {cure}"


def phrases(root: Path = ROOT) -> Iterator[str]:
    """Yield a line for each rejected phrase in docstrings, comments, messages and pages."""
    for file in sources(root):
        for line, text in _prose(file.read_text(encoding="utf-8")):
            yield from _faults(text, f"{file.relative_to(root)}:{line}")
    with (root / CATALOGUE).open("rb") as stream:
        for message in read_po(stream):
            for text in (message.id,) if isinstance(message.id, str) else message.id:
                yield from _faults(text, f"message '{text[:60]}'")
    for page in sorted([root / "README.md", *(root / "docs").glob("*.md")]):
        if page.name != "glossary.md":
            yield from _faults(page.read_text(encoding="utf-8"), str(page.relative_to(root)))


def sources(root: Path) -> list[Path]:
    """Return the files of the library and the windows, sorted."""
    return sorted(file for folder in FOLDERS for file in (root / folder).rglob("*.py"))


def _defined(tree: ast.Module) -> Iterator[tuple[str, int]]:
    for node in ast.walk(tree):
        if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef)):
            yield node.name, node.lineno
        elif isinstance(node, ast.arg):
            yield node.arg, node.lineno
        elif isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
            yield node.id, node.lineno
        elif isinstance(node, ast.Attribute):
            yield node.attr, node.lineno


def _prose(source: str) -> Iterator[tuple[int, str]]:
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, (ast.Module, ast.ClassDef, ast.FunctionDef)) and (text := ast.get_docstring(node)):
            yield getattr(node, "lineno", 1), text
    for token in tokenize.generate_tokens(io.StringIO(source).readline):
        if token.type == tokenize.COMMENT:
            yield token.start[0], token.string


def _faults(text: str, where: str) -> Iterator[str]:
    for pattern, cure in COMPILED.items():
        for found in pattern.finditer(text):
            yield f"{where}: '{' '.join(found[0].split())}'; write: {cure}"


def main() -> int:
    """List what is found; 1 if there is anything."""
    found = [*names(), *phrases()]
    print("\n".join(found) or "No retired word, no rejected phrase.")
    return int(bool(found))


if __name__ == "__main__":
    sys.exit(main())
