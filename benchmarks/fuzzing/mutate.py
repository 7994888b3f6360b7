"""Seeded damage: bytes flipped, lines cut and repeated, cells and columns exchanged, encodings mixed, files cut off."""

from __future__ import annotations

import random

__all__ = ["damaged", "mutate"]

KINDS = ("flip", "cut line", "cut off", "swap cells", "swap columns", "mix encodings", "repeat", "insert")
JUNK = (
    b'"',
    b"\0\0",
    b",,,,,,,,",
    b"\xff\xfe",
    b"1e999",
    b"nan",
    b"-" * 40,
    b"\r",
    b"\t",
    b"9" * 400,
    b"1" + b"0" * 400,
)


def damaged(data: bytes, rng: random.Random) -> tuple[bytes, list[str]]:
    """Return bytes that were damaged one to three times, and how."""
    done: list[str] = []
    for _ in range(rng.randrange(1, 4)):
        if data:
            data, kind = mutate(data, rng)
            done.append(kind)
    return data, done


def mutate(data: bytes, rng: random.Random) -> tuple[bytes, str]:
    """Return damaged bytes, and the name of what was done."""
    lines = data.split(b"\n")
    k = rng.randrange(len(lines))
    sep = b";" if data.count(b";") > data.count(b",") else b","
    kind = rng.choice(KINDS)
    if kind == "flip":
        spots = bytearray(data)
        for _ in range(rng.randrange(1, 6)):
            spots[rng.randrange(len(spots))] = rng.randrange(256)
        return bytes(spots), kind
    if kind == "cut off":
        return data[: rng.randrange(1, len(data) + 1)], kind
    if kind == "cut line":
        del lines[k]
    elif kind == "swap cells":
        cells = lines[k].split(sep)
        rng.shuffle(cells)
        lines[k] = sep.join(cells)
    elif kind == "swap columns":
        order = list(range(lines[0].count(sep) + 1))
        rng.shuffle(order)
        rows = [line.split(sep) for line in lines]
        lines = [sep.join(row[j] for j in order) if len(row) == len(order) else sep.join(row) for row in rows]
    elif kind == "mix encodings":
        text = data.decode("utf-8", "replace")
        half = rng.randrange(len(text))
        codecs = ("utf-8", "utf-16", "gb18030", "cp1252", "utf-8-sig", "utf-32")
        first, second = rng.choice(codecs), rng.choice(codecs)
        return text[:half].encode(first, "replace") + text[half:].encode(second, "replace"), kind
    elif kind == "repeat":
        lines.insert(rng.randrange(len(lines) + 1), lines[k])
    else:
        junk = rng.choice(JUNK)
        spot = rng.randrange(len(data))
        return data[:spot] + junk + data[spot:], kind
    return b"\n".join(lines), kind
