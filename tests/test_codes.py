"""Codes of messages: one scheme, so that whoever reads a log, a report's JSON or a test finds the module at once."""

from __future__ import annotations

import ast
import re
from collections import defaultdict
from functools import cache
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
MAKERS = ("message", "plural_message", "Message")
CODE = re.compile(r"[a-z]+\.[a-z0-9]+(-[a-z0-9]+)*")
#: Characters and words of what follows the room.
LONGEST, MOST_WORDS = 40, 5
#: A code that ends so was cut out of a sentence.
DANGLING = re.compile(
    r"-(an?|the|of|to|in|on|at|by|for|from|with|where|which|when|that|so|is|are|be|been|was|no|needs|give|around|than"
    r"|its?|as|has|have|had|cannot|may|lies?|some|neither|through|each|\d)$"
)
#: Words that docs/glossary.md retires or translates.
RETIRED = re.compile(
    r"\b(beside|bear|chased|drilled|feet|gape|handwork|holds?|laid|lay|mend|nobody|pulled|recipe|stands?|swings?|tells?"
    r"|told|parted)\b"
)


@cache
def codes() -> dict[str, list[tuple[str, int, str]]]:
    """By code: room, line and template of every message that the product makes."""
    found = defaultdict(list)
    for folder in ("geofit", "io", "gui"):
        for path in sorted((ROOT / folder).rglob("*.py")):
            parts = path.relative_to(ROOT).parts
            room = parts[1] if parts[0] == "geofit" else parts[0]
            for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
                if isinstance(node, ast.Call) and getattr(node.func, "id", "") in MAKERS and len(node.args) > 1:
                    code, template = node.args[:2]
                    if isinstance(code, ast.Constant) and isinstance(template, ast.Constant) and code.value:
                        found[code.value].append((room, node.lineno, template.value))
    return found


def listed(wrong: dict[str, object]) -> str:
    return "see 'Codes of messages' in docs/architecture.md:\n" + "\n".join(f"{c}: {why}" for c, why in wrong.items())


def test_codes_are_short_and_kebab_case():
    assert len(codes()) > 1400
    wrong = {
        code: "not room.words-in-kebab-case, or too long"
        for code in codes()
        if not CODE.fullmatch(code)
        or len(code.split(".")[1]) > LONGEST
        or len(code.split(".")[1].split("-")) > MOST_WORDS
    }
    assert not wrong, listed(wrong)


def test_a_code_begins_with_the_room_that_makes_it():
    """Of several rooms, with data, which all of them stand on."""
    wrong = {}
    for code, uses in codes().items():
        rooms = {room for room, *_ in uses}
        owner = rooms.pop() if len(rooms) == 1 else "data"
        if code.split(".")[0] != owner:
            wrong[code] = f"made in {owner}"
    assert not wrong, listed(wrong)


def test_a_code_means_one_sentence_and_a_sentence_has_one_code():
    sentences = {code: {template for *_, template in uses} for code, uses in codes().items()}
    several = {code: texts for code, texts in sentences.items() if len(texts) > 1}
    assert not several, listed(several)
    owners = defaultdict(set)
    for code, texts in sentences.items():
        for text in texts:
            # What is only parameters says nothing by itself.
            if re.search("[A-Za-z]", re.sub(r"{.*?}", "", text)):
                owners[text].add(code)
    twice = {" and ".join(sorted(found)): text for text, found in owners.items() if len(found) > 1}
    assert not twice, listed(twice)


def test_no_code_is_a_piece_of_a_sentence():
    wrong = {code: "ends like a piece of a sentence, or in a number" for code in codes() if DANGLING.search(code)}
    wrong |= {code: f"'{word[0]}' is retired" for code in codes() if (word := RETIRED.search(code))}
    assert not wrong, listed(wrong)
