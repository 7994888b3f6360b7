"""Damaged files end in rows, listed rows or an InputError, with no row lost in the count."""

from __future__ import annotations

import random

from geofit.data.errors import InputError
from geofit.io import read_site


def damage(data: bytes, rng: random.Random) -> bytes:
    lines = data.split(b"\n")
    match rng.randrange(6):
        case 0:
            spot = rng.randrange(len(data))
            return data[:spot] + bytes([rng.randrange(256)]) + data[spot + 1 :]
        case 1:
            return data[: rng.randrange(len(data))]
        case 2:
            del lines[rng.randrange(len(lines))]
        case 3:
            k = rng.randrange(len(lines))
            cells = lines[k].split(b",")
            rng.shuffle(cells)
            lines[k] = b",".join(cells)
        case 4:
            lines.insert(rng.randrange(len(lines)), rng.choice(lines) + b',"' + rng.choice(lines))
        case 5:
            return data.decode().encode(rng.choice(["utf-16", "gb18030", "utf-8-sig"])) + b"\xff\xd6\xd0"
    return b"\n".join(lines)


def test_damaged_tables_never_end_in_a_traceback(make_site, files):
    rng = random.Random(7)
    errors = listed = 0
    for _ in range(150):
        file = rng.choice(sorted(files))
        data = files[file].encode()
        for _ in range(rng.randrange(1, 4)):
            data = damage(data, rng) if data else data
            try:
                data.decode()
            except UnicodeDecodeError:
                break
        try:
            site = read_site(make_site(**{file: data}))
        except InputError:
            errors += 1
            continue
        assert all(count.read == count.used + count.listed for count in site.counts)
        listed += sum(count.listed for count in site.counts)
    assert errors > 8
    assert listed > 8
