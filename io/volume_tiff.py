"""Volumes in TIFF files: one file with many pages, or a folder with one slice a file."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from geofit.data.errors import InputError
from geofit.data.files import is_file
from geofit.data.messages import Untranslated, message

__all__ = ["read_pages", "read_tiff", "read_tiff_folder", "slice_files"]


def read_tiff(source: Any, name: str) -> NDArray[Any]:
    """Return the pages of a TIFF file as slices along axis 0.

    Raises
    ------
    InputError
        If pages differ in size, are in colour, or a single page states that it holds a whole stack.
    """
    from PIL import Image

    # A large slice is not an attack: the size of a scan is what the user has asked for.
    limit, Image.MAX_IMAGE_PIXELS = Image.MAX_IMAGE_PIXELS, None
    try:
        with Image.open(source) as image:
            count = getattr(image, "n_frames", 1)
            first = _page(image, name)
            stated = re.search(r"images=(\d+)", str(image.tag_v2.get(270, ""))) if hasattr(image, "tag_v2") else None
            if count == 1 and stated is not None and int(stated[1]) > 1:
                raise InputError(
                    message(
                        "io.stack-lists-one-slice",
                        "it states {count} slices, but lists only the first one",
                        count=int(stated[1]),
                    ),
                    message("io.save-stack-by-page", "Save the stack as a TIFF with one page a slice, or as raw."),
                    file=name,
                )
            return _pages(image, name, range(count), first)
    finally:
        Image.MAX_IMAGE_PIXELS = limit


def read_pages(source: Any, name: str, pages: range) -> NDArray[Any]:
    """Return some pages of a TIFF file as slices along axis 0."""
    from PIL import Image

    limit, Image.MAX_IMAGE_PIXELS = Image.MAX_IMAGE_PIXELS, None
    try:
        with Image.open(source) as image:
            return _pages(image, name, pages, _page(image, name))
    finally:
        Image.MAX_IMAGE_PIXELS = limit


def _pages(image: Any, name: str, pages: range, first: NDArray[Any]) -> NDArray[Any]:
    out = np.empty((len(pages), *first.shape), first.dtype)
    for row, page in enumerate(pages):
        image.seek(page)
        slice_ = _page(image, name)
        if slice_.shape != first.shape:
            raise InputError(
                message(
                    "io.page-size-differs",
                    "page {page} has {size} pixels, the first has {first}",
                    page=page + 1,
                    size=" x ".join(map(str, slice_.shape)),
                    first=" x ".join(map(str, first.shape)),
                ),
                message("io.export-slices-alike", "Export all slices with the same size."),
                file=name,
            )
        out[row] = slice_
    return out


def _page(image: Any, name: str) -> NDArray[Any]:
    values = np.asarray(image)
    if values.ndim != 2:
        raise InputError(
            message("io.colour-image", "it is a colour image"),
            message("io.export-labels-grey", "Export the labels or grey values as one channel."),
            file=name,
        )
    return values


def slice_files(path: Path) -> list[Path]:
    """Return the TIFF files of a folder in the order of the numbers in their names.

    Raises
    ------
    InputError
        If there is none, or the numbers have gaps.
    """
    files = [file for file in path.iterdir() if file.suffix.lower() in (".tif", ".tiff") and is_file(file)]
    if not files:
        raise InputError(
            message("io.folder-without-slice", "the folder has no TIFF slice"),
            message("io.name-slice-folder", "Name a folder of .tif files, or a file."),
            file=str(path),
        )
    files.sort(key=lambda file: [int(part) if part.isdigit() else part for part in re.split(r"(\d+)", file.name)])
    _require_all(files)
    return files


def _require_all(files: list[Path]) -> None:
    """Reject slices of which some are missing: their numbers rise by one step nearly always, else by several of it."""
    words = [re.split(r"(\d+)", file.stem)[1::2] for file in files]
    if len({len(one) for one in words}) != 1:
        return
    numbers = np.array(words, dtype=object).astype(np.float64).reshape(len(files), -1)
    varying = np.flatnonzero((numbers != numbers[0]).any(axis=0))
    if len(varying) != 1:
        return
    steps = np.diff(numbers[:, varying[0]])
    step = steps.min()
    if step <= 0 or (steps % step != 0).any() or np.median(steps) != step or (steps == step).all():
        return
    gap = int(np.argmax(steps > step))
    raise InputError(
        message(
            "io.slices-missing",
            "slices are missing by the numbers of the files: {count}, the first after {file}",
            count=int((steps / step - 1).sum()),
            file=Untranslated(files[gap].name),
        ),
        message("io.add-slices", "Add them to the folder, or number the files without gaps if none is missing."),
        file=str(files[0].parent),
    )


def read_tiff_folder(path: Path) -> NDArray[Any]:
    """Return the TIFF files of a folder as slices along axis 0, in the order of the numbers in their names."""
    files = slice_files(path)
    slices = [read_tiff(file, file.name) for file in files]
    odd = next((file for file, slice_ in zip(files, slices, strict=True) if slice_.shape != slices[0].shape), None)
    if odd is not None:
        raise InputError(
            message(
                "io.slice-size-differs",
                "its size differs from that of the first slice, {first}",
                first=files[0].name,
            ),
            message("io.export-slices-alike", "Export all slices with the same size."),
            file=str(odd),
        )
    return np.concatenate(slices)
