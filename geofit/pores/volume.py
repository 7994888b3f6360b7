"""A rock volume: which voxels are pore, and how large a voxel is."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from geofit.data.errors import GeofitError
from geofit.data.given import arguments_checked, keywords_known
from geofit.data.messages import message

__all__ = ["RockVolume", "VolumeError", "check_array", "label_shares", "pore_mask", "voxel_edges"]

_SHOWN = 8


class VolumeError(GeofitError, ValueError):
    """An array that is not a usable rock volume, or a step that this volume does not allow."""


@keywords_known
@dataclass(frozen=True, eq=False, init=False)
class RockVolume:
    """Pore space of a rock sample on a grid of voxels.

    Parameters
    ----------
    array : array_like, shape (n0, n1, n2)
        Labels or grey values of the voxels; axis 0 is usually the number of the slice.
    pore : int, bool, float, or a collection of them
        The value of pore voxels. One value: the volume may have two labels at most. A collection: every voxel with one
        of its values is pore and all others are rock, so ``pore=[0]`` accepts any number of minerals and
        ``pore=range(87)`` thresholds a grey volume. It is never guessed.
    voxel : float or three floats
        Edge length of a voxel along each axis, in metres.

    Attributes
    ----------
    pore : ndarray of bool, shape (n0, n1, n2)
        True in the pore space; read-only.
    voxel : tuple of three floats
        Edge lengths in metres.

    Raises
    ------
    VolumeError
        If a label or the voxel size is missing, the array has not three axes, has NaN, has no pore voxel, or has more
        than two labels and ``pore`` names one of them.

    Examples
    --------
    >>> volume = RockVolume([[[0, 1, 0, 0]]], pore=0, voxel=5e-6)
    >>> volume.porosity, volume.shape
    (0.75, (1, 1, 4))
    """

    pore: NDArray[np.bool_]
    voxel: tuple[float, float, float]

    def __init__(
        self,
        array: ArrayLike,
        *,
        pore: Any | Collection[Any] | None = None,
        voxel: float | Collection[float] | None = None,
    ) -> None:
        values = np.asarray(array)
        check_array(values)
        mask = pore_mask(values, pore)
        mask.flags.writeable = False
        object.__setattr__(self, "pore", mask)
        object.__setattr__(self, "voxel", voxel_edges(voxel))

    @property
    def shape(self) -> tuple[int, int, int]:
        """Number of voxels along each axis."""
        n0, n1, n2 = self.pore.shape
        return n0, n1, n2

    @arguments_checked
    def slab(self, first: int, end: int) -> NDArray[np.bool_]:
        """Return the slices ``first`` ... ``end - 1``, True in pores."""
        return self.pore[first:end]

    @property
    def porosity(self) -> float:
        """Share of pore voxels, connected or not."""
        return float(np.count_nonzero(self.pore) / self.pore.size)

    @property
    def size(self) -> tuple[float, float, float]:
        """Lengths of the sample in metres."""
        (n0, n1, n2), (e0, e1, e2) = self.shape, self.voxel
        return n0 * e0, n1 * e1, n2 * e2

    @property
    def unit(self) -> float:
        """Length in metres of what is called one voxel: the shortest edge."""
        return min(self.voxel)

    @property
    def edges(self) -> tuple[float, float, float]:
        """Edge lengths in units of the shortest edge; exactly (1, 1, 1) for cubic voxels."""
        e0, e1, e2 = (edge / self.unit for edge in self.voxel)
        return e0, e1, e2

    @property
    def cubic(self) -> bool:
        """Whether all edges of a voxel are equal."""
        return self.edges == (1.0, 1.0, 1.0)


def label_shares(array: NDArray[Any]) -> dict[Any, float]:
    """Return the share of each value of the array, the most frequent first.

    Examples
    --------
    >>> label_shares(np.array([0, 1, 1, 1]))
    {1: 0.75, 0: 0.25}
    """
    if array.dtype == bool or (array.dtype.kind == "u" and array.dtype.itemsize == 1):
        # Slice by slice: counting converts to eight bytes a voxel.
        counts = np.zeros(256, np.int64)
        for slice_ in np.atleast_2d(array.view(np.uint8)):
            counts += np.bincount(slice_.ravel(), minlength=256)
        values: NDArray[Any] = np.flatnonzero(counts).astype(array.dtype)
        counts = counts[counts > 0]
    else:
        values, counts = np.unique(array, return_counts=True)
    order = np.argsort(-counts, kind="stable")
    return {values[i].item(): float(counts[i] / array.size) for i in order}


def check_array(values: NDArray[Any]) -> None:
    """Raise if an array is not one of voxels: three axes, numbers, none of them NaN."""
    if values.ndim != 3:
        raise VolumeError(
            message(
                "pores.array-not-three-axes",
                "The array has {count} axes; a rock volume has three. Give a single slice the shape "
                "(1, rows, columns).",
                count=values.ndim,
            )
        )
    if values.size == 0:
        raise VolumeError(message("pores.array-empty", "The array of shape {shape} has no voxel.", shape=values.shape))
    if values.dtype.kind not in "buif":
        raise VolumeError(
            message(
                "pores.array-type-unusable",
                "The array has the type {kind}; voxels need numbers or booleans.",
                kind=str(values.dtype),
            )
        )
    if values.dtype.kind == "f" and not np.isfinite(values).all():
        raise VolumeError(
            message(
                "pores.voxels-not-finite",
                "{count} voxels are NaN or infinite. Give them the value of rock or of pore before reading.",
                count=int((~np.isfinite(values)).sum()),
            )
        )


def pore_mask(values: NDArray[Any], pore: Any, shares: dict[Any, float] | None = None) -> NDArray[np.bool_]:
    """Return the pore voxels, or raise if the label leaves a doubt; ``shares`` are those of the values, if known."""
    if isinstance(pore, np.ndarray) and pore.ndim == 0:
        pore = pore.item()
    several = isinstance(pore, Collection) and not isinstance(pore, str | bytes)
    if pore is None or not several:
        shares = shares or label_shares(values)
        if pore is None:
            raise VolumeError(
                message(
                    "pores.pore-value-missing",
                    "Which value is pore? The volume has the values {labels}. State it: pore={example}.",
                    labels=_listed(shares),
                    example=next(iter(reversed(shares))),
                )
            )
        if len(shares) > 2:
            raise VolumeError(
                message(
                    "pores.too-many-values",
                    "The volume has {count} different values ({labels}), but pore={pore} names only one. List all "
                    "values of pore voxels, for example pore=[{pore}] if all others are rock, or pore=range(0, 100) "
                    "for a threshold.",
                    count=len(shares),
                    labels=_listed(shares),
                    pore=pore,
                )
            )
        mask = values == _as_stored(pore, values)
    else:
        mask = np.isin(values, _as_stored(list(pore), values))
    if not mask.any():
        raise VolumeError(
            message(
                "pores.pore-value-absent",
                "No voxel has the pore value {pore}; the volume has the values {labels}. Check which value is pore.",
                pore=list(pore) if several and len(pore) <= _SHOWN else pore,
                labels=_listed(shares or label_shares(values)),
            )
        )
    return np.ascontiguousarray(mask)


def _as_stored(pore: Any, values: NDArray[Any]) -> Any:
    """Return pore values as the voxels store them: 0.1 has other digits in four bytes than in eight."""
    stated = np.asarray(pore)
    if values.dtype.kind != "f" or stated.dtype.kind not in "buif":
        return stated
    with np.errstate(over="ignore"):  # beyond the largest number of the type: no voxel has it
        return stated.astype(values.dtype)


def _listed(shares: dict[Any, float]) -> str:
    shown = ", ".join(f"{label} ({100 * share:.4g} %)" for label, share in list(shares.items())[:_SHOWN])
    return shown if len(shares) <= _SHOWN else f"{shown}, ..."


@arguments_checked
def voxel_edges(voxel: float | Collection[float] | None) -> tuple[float, float, float]:
    """Return the edges of a voxel, or raise if they are missing or not lengths."""
    if voxel is None:
        raise VolumeError(
            message(
                "pores.voxel-size-missing",
                "The size of a voxel is missing. State its edge length in metres: voxel=5e-6 (--voxel 5e-6).",
            )
        )
    edges = np.asarray(list(voxel) if isinstance(voxel, Collection) else [voxel] * 3, dtype=float)
    if edges.shape != (3,) or not np.isfinite(edges).all() or (edges <= 0).any():
        raise VolumeError(
            message(
                "pores.voxel-size-unusable",
                "voxel={voxel} is not a voxel size. Give one positive edge length in metres, or three, one for each "
                "axis of the array.",
                voxel=voxel,
            )
        )
    return float(edges[0]), float(edges[1]), float(edges[2])
