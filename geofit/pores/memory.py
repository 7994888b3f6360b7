"""Whether a volume fits into memory, asked before the work begins."""

from __future__ import annotations

import os
import sys

from geofit.data.messages import Message, message
from geofit.pores.volume import VolumeError

__all__ = ["available_memory", "check_memory"]


def available_memory() -> int | None:
    """Return the bytes of memory that are free, None if the system does not say."""
    if sys.platform == "win32":
        import ctypes

        class Status(ctypes.Structure):
            _fields_ = (
                ("length", ctypes.c_ulong),
                ("load", ctypes.c_ulong),
                *((f"n{i}", ctypes.c_ulonglong) for i in range(7)),
            )

        status = Status(length=ctypes.sizeof(Status))
        if not ctypes.windll.kernel32.GlobalMemoryStatusEx(ctypes.byref(status)):
            return None
        return int(status.n1)
    try:
        with open("/proc/meminfo", encoding="ascii") as lines:
            return next(int(line.split()[1]) * 1024 for line in lines if line.startswith("MemAvailable"))
    except (OSError, StopIteration, ValueError):
        pass
    try:
        return os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    except (OSError, ValueError, AttributeError):
        return None


def check_memory(needed: int, task: str | Message) -> None:
    """Raise an error with the remedy if a task needs more memory than there is.

    Raises
    ------
    VolumeError
    """
    free = available_memory()
    if free is not None and needed > free:
        raise VolumeError(
            message(
                "pores.memory-too-small",
                "{task} needs {needed:.1f} GB of memory, and {free:.1f} GB are free. Leave the volume on the disk "
                "(geofit.open_volume, geofit pores --slabs), take a part of it, or close other programs.",
                task=task,
                needed=needed / 1e9,
                free=free / 1e9,
            )
        )
