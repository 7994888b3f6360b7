"""What a text file does not say about itself: encoding, separator, decimal mark, header."""

from __future__ import annotations

import csv
import re
from collections import Counter
from collections.abc import Iterator, Sequence
from itertools import zip_longest

from geofit.data.errors import InputError
from geofit.data.messages import message
from geofit.io.parser_errors import parser_message
from geofit.io.unit_names import is_unit

__all__ = [
    "HEAD",
    "decimal_of_groups",
    "decode",
    "find_decimal",
    "find_header",
    "find_separator",
    "grouped_number",
    "is_header",
    "is_number",
    "is_units_row",
    "joined_header",
    "quoted_cells",
    "split_line",
]

#: How the first file within a workbook (xlsx, ods) is called.
WORKBOOK = (b"[Content_Types].xml", b"_rels", b"docProps", b"xl/", b"mimetype")
#: In order of preference where several fit equally well; " " represents runs of blanks.
SEPARATORS = (";", "\t", ",", "|", " ")

_BOMS = (
    (b"\xef\xbb\xbf", "utf-8-sig"),
    (b"\xff\xfe\x00\x00", "utf-32"),
    (b"\x00\x00\xfe\xff", "utf-32"),
    (b"\xff\xfe", "utf-16"),
    (b"\xfe\xff", "utf-16"),
)
_NUMBER = re.compile(r"[+-]?(\d+([.,]\d*)?|[.,]\d+)([eE][+-]?\d+)?")
_DECIMAL_COMMA = re.compile(r"(?<![\d.,])\d*,\d+(?:[eE][+-]?\d+)?(?![\d.,])")
_DECIMAL_POINT = re.compile(r"(?<![\d.,])\d*\.\d+(?:[eE][+-]?\d+)?(?![\d.,])")
#: Thousands between blanks or apostrophes, and between points or commas where a second mark tells which it is:
#: "1,234" alone may be 1234 or 1.234.
_BLANKS = re.compile(r"[+-]?[1-9]\d{0,2}([ \u00a0\u2009\u202f'’])\d{3}(?:\1\d{3})*([.,]\d*)?")
_POINTED = r"[1-9]\d{0,2}(?:,\d{3})+\.\d+"
_COMMAED = r"[1-9]\d{0,2}(?:\.\d{3})+,\d+"
#: Numbers of which one mark can only be the decimal one: no group of three digits, or a mark of thousands twice.
_SURE_COMMA = r"(?![1-9]\d{0,2},\d{3}(?!\d))\d*,\d+|[1-9]\d{0,2}(?:\.\d{3}){2,}"
_SURE_POINT = r"(?![1-9]\d{0,2}\.\d{3}(?!\d))\d*\.\d+|[1-9]\d{0,2}(?:,\d{3}){2,}"
_MARKS = re.compile(rf"[+-]?(?:{_POINTED}|{_COMMAED}|[1-9]\d{{0,2}}([.,])\d{{3}}(?:\1\d{{3}})+)")
#: Commas that separate cells, and cells in quotes, whose commas do not.
_OUTSIDE_QUOTES = re.compile(r'("[^"\n]*")|,')
#: Bytes of no ASCII; three of them that are one character of UTF-8; and two that are one, next to no others. Pairs of
#: GB18030 make the former hardly ever and the latter now and then, Windows-1252 neither.
_HIGH = re.compile(rb"[\x80-\xff]")
_THREE = re.compile(rb"[\xe1-\xef][\x80-\xbf]{2}")
_ALONE = re.compile(rb"(?<![\x80-\xff])(?:[\xc3-\xdf][\x80-\xbf])(?![\x80-\xff])|[\xe1-\xef][\x80-\xbf]{2}")
#: Letters of a text in which they are looked for.
HEAD = 65_536
#: Titles have at most this share of the usual cells; a header lies at most so many rows below the first of them.
NARROW, TITLES = 0.6, 20


def decode(data: bytes, name: str, encoding: str | None = None) -> tuple[str, str]:
    """Return the text of a file and its encoding.

    In order: what the caller says, a byte order mark, strict UTF-8, UTF-16 by its zero bytes, UTF-8 with lines in
    another encoding or with damaged characters, GB18030 where the bytes look like Chinese, Windows-1251 where they
    look like Cyrillic, Windows-1252. A character that is damaged becomes U+FFFD.
    """
    if encoding is not None:
        try:
            return data.decode(encoding).removeprefix("\ufeff"), encoding
        except LookupError:
            raise InputError(
                message("io.encoding-unknown", "The encoding {encoding!r} is unknown", encoding=encoding),
                message("io.give-known-encoding", "Give utf-8, utf-16, gb18030 or cp1252."),
                file=name,
            ) from None
        except UnicodeError as error:
            what, _ = parser_message(error)
            raise InputError(
                message(
                    "io.not-in-encoding",
                    "The file is not written in {encoding}: {error}",
                    encoding=encoding,
                    error=what,
                ),
                message("io.leave-encoding-out", "Leave the encoding out."),
                file=name,
            ) from None
    if data[:4] == b"PK\x03\x04" and not _first_entry(data).startswith(WORKBOOK):
        raise InputError(
            message("io.archive-not-text", "This is a ZIP archive or an array of NumPy, not a text table"),
            message("io.unpack-table", "Unpack it and name the table; rock volumes are read by geofit pores."),
            file=name,
        )
    if data[:3] == b"\x1f\x8b\x08":
        raise InputError(
            message("io.compressed-not-text", "This is a file compressed with gzip, not a text table"),
            message("io.unpack-table", "Unpack it and name the table; rock volumes are read by geofit pores."),
            file=name,
        )
    if data[:4] in (b"PK\x03\x04", b"\xd0\xcf\x11\xe0"):
        raise InputError(
            message("io.workbook-not-text", "This is a workbook, not a text table"),
            message("io.save-sheet-as-csv", "Save the sheet as CSV UTF-8."),
            file=name,
        )
    for codec in _candidates(data):
        try:
            return data.decode(codec), codec
        except UnicodeError:
            pass
        if codec == "utf-8" and _mostly_utf8(data):
            return _mixed(data)
        if codec == "gb18030":
            text = data.decode(codec, "replace")
            if 100 * text.count("\ufffd") <= len(text) - sum(map(str.isascii, text)):
                return text, codec
        elif codec.startswith("utf-16"):
            # A byte too many at the end is the line end of another program.
            text = data[: len(data) // 2 * 2].decode(codec, "replace")
            if 10 * text.count("\ufffd") <= len(text):
                return text, codec
    raise InputError(
        message("io.not-text", "The file is not text in UTF-8, UTF-16, GB18030 or Windows-1252"),
        message("io.save-as-utf8", "Save it as CSV UTF-8, or state its encoding."),
        file=name,
    )


def _first_entry(data: bytes) -> bytes:
    """Return the name of the first file in a ZIP archive (APPNOTE 4.3.7)."""
    return data[30 : 30 + int.from_bytes(data[26:28], "little")] or WORKBOOK[0]


def _candidates(data: bytes) -> Iterator[str]:
    yield from [codec for bom, codec in _BOMS if data.startswith(bom)][:1]
    if b"\0" in data:
        yield from _utf16(data)
        return
    yield "utf-8"
    if _looks_chinese(data):
        yield "gb18030"
    if _looks_cyrillic(data):
        yield "cp1251"
    yield "cp1252"


def _utf16(data: bytes) -> list[str]:
    head = data[:4000]
    if len(head) < 4:
        return []
    even, odd = head[0::2].count(0) / len(head), head[1::2].count(0) / len(head)
    return ["utf-16-le"] if odd > 0.2 > even else ["utf-16-be"] if even > 0.2 > odd else []


def _looks_chinese(data: bytes) -> bool:
    """Whether the bytes above 127 come in pairs of the common characters of GB 2312."""
    high = re.findall(rb"[\x80-\xff]+", data)
    common = sum(len(re.findall(rb"[\xa1-\xa3\xb0-\xd7][\xa1-\xfe]", run)) for run in high if len(run) % 2 == 0)
    return common * 2 > 0.6 * sum(map(len, high)) > 0


def _mostly_utf8(data: bytes) -> bool:
    """Whether a tenth of the lines that are not ASCII are UTF-8 that no text in another encoding is by chance."""
    lines = [line for line in data.split(b"\n") if not line.isascii()]
    sure = _ALONE if not _looks_chinese(data) else _THREE
    found = sum(bool(_decoded(line) and sure.search(line)) for line in lines)
    return 10 * found >= len(lines)


def _mixed(data: bytes) -> tuple[str, str]:
    """Return a text whose lines are UTF-8 or, each, in another encoding, and the encodings."""
    codecs = {"utf-8": True}
    lines = []
    for line in data.split(b"\n"):
        text = _decoded(line)
        if text is None and 2 * sum(map(len, _THREE.findall(line))) < len(_HIGH.findall(line)):
            other = "gb18030" if _looks_chinese(line) else "cp1252"
            text = _decoded(line, other)
            codecs.update({} if text is None else {other: True})
        lines.append(line.decode("utf-8", "replace") if text is None else text)
    return "\n".join(lines), " + ".join(codecs)


def _decoded(line: bytes, codec: str = "utf-8") -> str | None:
    try:
        return line.decode(codec)
    except UnicodeError:
        return None


def _looks_cyrillic(data: bytes) -> bool:
    """Whether the bytes above 127 are whole words: letters with accents stand alone, or two of them together."""
    high = re.findall(rb"[\x80-\xff]+", data)
    words = sum(map(len, (run for run in high if re.fullmatch(rb"[\xa8\xb8\xc0-\xff]{3,}", run))))
    return words > 0.6 * sum(map(len, high)) > 0


def split_line(line: str, sep: str) -> list[str]:
    """Return the cells of one line; quotes keep a separator inside a cell."""
    if sep == " ":
        return line.split()
    if '"' not in line:
        return line.split(sep)
    return quoted_cells([line], sep)


def quoted_cells(lines: Sequence[str], sep: str) -> list[str]:
    """Return the cells of one row that runs over ``lines``, each with its line break but perhaps the last.

    A cell may be as long as the text: the limit of the standard reader is that of the whole process.
    """
    longest = max(map(len, lines), default=0) * len(lines)
    if longest > csv.field_size_limit():
        csv.field_size_limit(longest)
    return next(csv.reader(lines, delimiter=sep), [])


def is_number(cell: str) -> bool:
    """Whether a cell is a number under one of the two decimal marks, with marks of thousands or without.

    Examples
    --------
    >>> [is_number(cell) for cell in ("1.5", "1,5", "500.636,96", "4.300.551", "1 234,5", "T2")]
    [True, True, True, True, True, False]
    """
    text = cell.strip()
    return any(form.fullmatch(text) is not None for form in (_NUMBER, _MARKS, _BLANKS))


def grouped_number(cell: str, decimal: str) -> float:
    """Return the number of a cell with marks of thousands; nan where it has none or may be read in two ways.

    Examples
    --------
    >>> [grouped_number(cell, ".") for cell in ("1,234.5", "1.234,5", "1 234.5", "1'234", "1,234,567", "1,234")]
    [1234.5, 1234.5, 1234.5, 1234.0, 1234567.0, nan]
    """
    text = cell.strip()
    if found := _BLANKS.fullmatch(text):
        if found.group(2) and found.group(2)[0] != decimal:
            return float("nan")
        return float(text.replace(found.group(1), "").replace(",", "."))
    found = _MARKS.fullmatch(text)
    if found is None:
        return float("nan")
    if mark := found.group(1):
        return float(text.replace(mark, ""))
    last = max(".,", key=text.rfind)
    return float(text.replace("," if last == "." else ".", "").replace(",", "."))


def find_separator(lines: Sequence[str]) -> str:
    """Return the separator under which the lines have equally many cells, and most of them numbers."""

    def merit(sep: str) -> float:
        rows = [split_line(line, sep) for line in lines]
        width, times = Counter(map(len, rows)).most_common(1)[0]
        if width < 2:
            return 0.0
        cells = [cell for row in rows for cell in row]
        return times / len(rows) + 0.5 * sum(map(is_number, cells)) / len(cells)

    best = max(SEPARATORS, key=merit)
    return best if merit(best) > 0 else ","


def find_decimal(text: str, sep: str) -> str:
    """Return the decimal mark that most fractions of the text have; between commas only quotes can hold another one.

    Examples
    --------
    >>> [find_decimal(text, sep) for text, sep in (('"1,5","2,5"', ","), ("1,5,2.5", ","), ("1,5;2,25", ";"))]
    [',', '.', ',']
    """
    if sep == ",":
        text = _OUTSIDE_QUOTES.sub(lambda found: found[1] or " ", text)
    if mark := decimal_of_groups(text[:HEAD]):
        return mark
    commas, points = len(_DECIMAL_COMMA.findall(text)), len(_DECIMAL_POINT.findall(text))
    return "," if commas > points else "."


def decimal_of_groups(text: str) -> str:
    """Return the decimal mark of numbers that can be read in one way only; "" without any.

    First those with both marks, then fractions and several groups of thousands: "1.234" alone may be 1234.

    Examples
    --------
    >>> [decimal_of_groups(text) for text in ("1,234.5 2,5", "1.234 97,8", "3,101,234 501,111", "1.234")]
    ['.', ',', '.', '']
    """
    for forms in ((_COMMAED, _POINTED), (_SURE_COMMA, _SURE_POINT)):
        commas, points = (len(re.findall(rf"(?<![\d.,])(?:{form})(?![\d.,])", text)) for form in forms)
        if commas != points:
            return "," if commas > points else "."
    return ""


def is_header(first: Sequence[str], following: Sequence[Sequence[str]]) -> bool:
    """Whether the first row names the columns: words are above numbers more often than numbers do."""
    numeric = [is_number(cell) for cell in first]
    if not any(numeric):
        return True
    words = numbers = 0
    for j, number in enumerate(numeric):
        below = [row[j] for row in following if j < len(row) and row[j].strip()]
        if below and sum(map(is_number, below)) > 0.5 * len(below):
            words, numbers = words + (not number and bool(first[j].strip())), numbers + number
    return words > numbers


def is_units_row(cells: Sequence[str]) -> bool:
    """Whether a row under the header holds units, such as "m", "[ft]" or "m a.s.l.", and hardly anything else."""
    filled = [cell for cell in cells if cell.strip()]
    units = sum(map(is_unit, filled))
    return 2 * units > len(filled) and not any(map(is_number, filled))


def find_header(rows: Sequence[Sequence[str]]) -> tuple[int, int]:
    """Return the first and the last row of the header among the filled rows of a table; those above it are titles.

    Titles have one cell, or far fewer than a row of names below them. Under merged cells a header has two rows, of
    which the lower one fills the gaps of the upper.
    """
    filled = [sum(map(bool, map(str.strip, row))) for row in rows]
    least = NARROW * Counter(filled).most_common(1)[0][0] if rows else 0.0
    names = [not any(map(is_number, row)) and not is_units_row(row) for row in rows]
    for k in range(len(rows) - 1):
        if k + 2 < len(rows) and names[k] and names[k + 1] and not names[k + 2] and _complete(rows[k], rows[k + 1]):
            return k, k + 1
        title = filled[k] == 1 and sum(width > 1 for width in filled[k:]) > len(filled[k:]) // 2
        below = range(k + 1, min(k + TITLES, len(rows) - 1))
        if not title and not (filled[k] <= least and any(names[j] and filled[j] > least for j in below)):
            return k, k
    return len(rows) - 1, len(rows) - 1


def _complete(upper: Sequence[str], lower: Sequence[str]) -> bool:
    """Whether the lower of two rows fills gaps of the upper one: between its cells, or where each has some alone."""
    pairs = [(bool(up.strip()), bool(low.strip())) for up, low in zip_longest(upper, lower, fillvalue="")]
    end = max((j for j, (up, _) in enumerate(pairs) if up), default=0)
    return (False, True) in (pairs if (True, False) in pairs else pairs[:end])


def joined_header(upper: Sequence[str], lower: Sequence[str]) -> list[str]:
    """Return the names of a header of two rows: the lower one's, where it has one."""
    return [low.strip() or up.strip() for up, low in zip_longest(upper, lower, fillvalue="")]
