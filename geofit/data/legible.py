"""Names as text that can be written: on Linux the bytes of a file's name need not be UTF-8."""

from __future__ import annotations

import os

__all__ = ["legible"]


def legible(name: str) -> str:
    """Return the name of a file as text that can be printed and written.

    On Linux the bytes of a name need not be UTF-8: archives from Windows bring names in GBK.

    Examples
    --------
    >>> legible("picks.csv"), legible(os.fsdecode("钻孔".encode("gbk")))
    ('picks.csv', '钻孔')
    """
    if name.isascii():
        return name
    try:
        name.encode()
    except UnicodeEncodeError:
        try:
            return os.fsencode(name).decode("gb18030", "replace")
        except UnicodeEncodeError:  # a name that no file can have
            return name.encode("utf-8", "replace").decode()
    return name
