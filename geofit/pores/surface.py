"""The pore space as a smooth implicit body: steps 4 and 5 of Huang et al. (2007).

Two constructions with one interface. ``contact`` uses the points where maximal balls touch the rock as control
points, as the article proposes for large volumes; it keeps the volume. ``blend`` adds the potentials of the balls: with
e^-t the exponent n of the article and the decay are one parameter, and the sum is a soft minimum. For the fewest balls
see :mod:`geofit.medial`.

Coordinates are metres from the low corner of the sample, along the axes of the array.
"""

from __future__ import annotations

import itertools
import warnings
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cached_property
from os import PathLike
from typing import TYPE_CHECKING, ClassVar, Literal, Unpack

import numpy as np
from numpy.typing import ArrayLike, NDArray

from geofit.bodies.implicit_body import OwnField
from geofit.data.given import arguments_checked
from geofit.data.messages import Message, message
from geofit.data.progress import Progress, tell
from geofit.implicit.field import Box, Field, points_of
from geofit.implicit.mesh import TriangleMesh
from geofit.pores.balls import balls_of_distance, maximal_balls
from geofit.pores.box_mesh import mesh_in_box
from geofit.pores.contacts import contact_points
from geofit.pores.distance import Border, squared_distance
from geofit.pores.extraction import pore_network
from geofit.pores.network import PoreNetwork
from geofit.pores.threads import in_parts
from geofit.pores.volume import RockVolume, VolumeError

if TYPE_CHECKING:
    from geofit.cad.solid_read_back import SolidReadBack
    from geofit.cad.step_origin import StepFields
    from geofit.pores.sliced import SlicedVolume

__all__ = ["Construction", "ContactField", "PoreSurface", "pore_surface", "require_rock", "volume_note"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Construction = Literal["contact", "blend"]

#: Support of a contact, in voxels: two layers of contacts on either side.
_SUPPORT = 2.5
#: The volume is measured in at most so many boxes of so many voxels along each axis, and corrected so often, and then
#: as often again as it misses more than this share.
BOXES, BOX, ROUNDS, MORE_ROUNDS, ENOUGH = 16, 32, 2, 8, 0.005
#: Where cells as large as voxels miss more than this share of the volume, as in channels one voxel wide, they are
#: halved, down to this part of a voxel, and while the sample has no more of them than this.
MISSED, LEAST_CELL, MOST_CELLS = 0.05, 0.25, 1 << 24
#: Value of the field in a voxel that is held, and how often faults are looked for.
_HOLD, RESCUES = 0.5, 4
#: Fewest places that are worth a thread of their own.
LEAST = 2000


@dataclass(frozen=True, eq=False)
class ContactField:
    """Field through contact points; negative in pores, metres near the surface.

    Parameters
    ----------
    points, normals : ndarray, shape (n, 3)
        Contacts in units of the shortest voxel edge from the low corner, and unit vectors into the rock.
    pore : ndarray of bool
        The voxels that the body is to fill.
    rock_below : ndarray of int, one longer along each axis
        Count of rock voxels before each corner of voxels along all axes.
    edges : tuple of float
        Edges of a voxel in units of the shortest one.
    unit : float
        Length of the shortest edge in metres.
    shift : float
        Taken off the field, in units, so that the body has the volume of its voxels.
    cell : float
        Edge of the cells, in units, whose triangles have that volume.
    held : ndarray of int, shape (m, 3)
        Voxels in which the field keeps the sign that they have, because averaged planes would close a throat there or
        break a wall.
    """

    points: Floats
    normals: Floats
    pore: NDArray[np.bool_] = field(repr=False)
    rock_below: NDArray[np.int64] = field(repr=False)
    edges: tuple[float, float, float]
    unit: float
    shift: float = 0.0
    cell: float = 1.0
    held: NDArray[np.int64] = field(default_factory=lambda: np.zeros((0, 3), np.int64))

    @cached_property
    def _cells(self) -> tuple[Floats, Floats, Floats, NDArray[np.int64], Floats, NDArray[np.int64]]:
        from geofit.pores.contact_field import sort_into_cells

        lower = np.full(3, -1.0)
        counts = np.ceil((np.array(self.pore.shape) * self.edges + 2.0) / _SUPPORT).astype(np.int64)
        points = np.concatenate([self.points, (self.held + 0.5) * self.edges])
        normals = np.concatenate([self.normals, np.zeros(self.held.shape)])
        sign = np.where(self.pore[tuple(self.held.T)], -_HOLD, _HOLD)
        values = np.concatenate([np.zeros(len(self.points)), sign + self.shift])
        order, start = sort_into_cells(points, lower, _SUPPORT, counts)
        return points[order], normals[order], values[order], start, lower, counts

    def value(self, xyz: Floats) -> Floats:
        """Return the field at (n, 3) points."""
        return np.asarray((self.heights(xyz) - self.shift) * self.unit)

    def heights(self, xyz: Floats) -> Floats:
        """Return the field at (n, 3) points before the shift, in units of the shortest edge."""
        from geofit.pores.contact_field import contact_values

        out = np.empty(len(xyz))
        self._in_parts(contact_values, xyz, out)
        return out

    def gradient(self, xyz: Floats) -> Floats:
        """Return the gradient at (n, 3) points."""
        from geofit.pores.contact_field import contact_gradients

        out = np.empty((len(xyz), 3))
        self._in_parts(contact_gradients, xyz, out)
        return out

    def _in_parts(self, loop: Callable[..., None], xyz: Floats, out: Floats) -> None:
        places = np.ascontiguousarray(np.asarray(xyz, float) / self.unit)
        cells, edges = self._cells, np.array(self.edges)
        in_parts(
            lambda low, high: loop(places[low:high], *cells, _SUPPORT, self.pore, edges, out[low:high]),
            len(places),
            LEAST,
        )

    @property
    def bounds(self) -> Box:
        """Box of the sample."""
        return np.zeros(3), np.array(self.pore.shape) * self.edges * self.unit

    @property
    def lipschitz(self) -> float:
        """Infinite: averaged planes have no simple bound; :meth:`range_in` saves the work instead."""
        return float("inf")

    def range_in(self, lower: Floats, upper: Floats) -> tuple[Floats, Floats]:
        """Return bounds in boxes: one sign where all voxels within reach of a contact are of one kind, else none."""
        edge, size = np.array(self.edges), np.array(self.pore.shape)
        first = np.clip(np.floor((lower / self.unit - _SUPPORT - 1) / edge), 0, size - 1).astype(np.int64)
        last = np.clip(np.ceil((upper / self.unit + _SUPPORT + 1) / edge), first + 1, size).astype(np.int64)
        rock = np.zeros(len(lower), np.int64)
        for corner in range(8):
            high = np.array([corner >> axis & 1 for axis in range(3)], bool)
            at = np.where(high, last, first)
            rock += (-1) ** (3 - int(high.sum())) * self.rock_below[at[:, 0], at[:, 1], at[:, 2]]
        voxels = (last - first).prod(axis=1)
        low = np.where(rock == voxels, self.unit * (1 - self.shift), -np.inf)
        high_ = np.where(rock == 0, -self.unit * (1 + self.shift), np.inf)
        return np.where(rock == 0, high_, low), np.where(rock == voxels, low, high_)


@arguments_checked
@dataclass(frozen=True, eq=False)
class PoreSurface(OwnField):
    """The pore space as a body. It is a :class:`geofit.implicit.field.Field` itself.

    Attributes
    ----------
    field : Field
        Negative in pores.
    shape, voxel : tuple
        Voxels along each axis, and their edges in metres.
    construction : {"contact", "blend"}
    name : str
    messages : tuple of Message
        A warning where blended balls leave ducts of one or two voxels without triangles.
    """

    most_cells: ClassVar[int] = 1 << 14

    field: Field
    shape: tuple[int, int, int]
    voxel: tuple[float, float, float]
    construction: Construction
    name: str = "pores"
    messages: tuple[Message, ...] = ()

    def value(self, xyz: ArrayLike) -> Floats:
        """Return the field at (n, 3) points in metres from the low corner: negative in pores."""
        return self.field.value(points_of(xyz))

    def gradient(self, xyz: ArrayLike) -> Floats:
        """Return the gradient at (n, 3) points; it points into the rock."""
        return self.field.gradient(points_of(xyz))

    def __repr__(self) -> str:
        size = " x ".join(str(n) for n in self.shape)
        return f"<PoreSurface {self.name}: {size} voxels, {self.construction}>"

    @property
    def bounds(self) -> Box:
        """Box of the sample: outside it the body is not defined."""
        return np.zeros(3), np.array(self.shape) * np.array(self.voxel)

    @property
    def lipschitz(self) -> float:
        """Bound of the length of the gradient; infinite if there is none."""
        return self.field.lipschitz

    def range_in(self, lower: Floats, upper: Floats) -> tuple[Floats, Floats]:
        """Return bounds of the field in boxes."""
        from geofit.implicit.field import range_in

        return range_in(self.field, lower, upper)

    @property
    def spacing(self) -> float:
        """The shortest edge of a voxel, metres."""
        return min(self.voxel)

    @property
    def overview_spacing(self) -> float:
        """Edge of the overview's cells, metres: that of the voxels, or a part of it where channels are as narrow.

        The overview is capped at the faces of the sample.
        """
        return self.spacing * self.field.cell if isinstance(self.field, ContactField) else self.spacing

    def _mesh_of_cells(self, spacing: float) -> TriangleMesh:
        return mesh_in_box(self.field, *self.bounds, spacing)

    def write_step(self, path: str | PathLike[str], nurbs: bool = False, **stated: Unpack[StepFields]) -> SolidReadBack:
        """Write the pores as a STEP AP242 solid, of triangles by default: 500 patches do not follow a pore space."""
        return super().write_step(path, nurbs, **stated)

    @cached_property
    def porosity(self) -> float:
        """Share of the sample that lies in the body, by the volume of its triangles."""
        return float(self.overview.volume / np.prod(self.bounds[1]))

    @property
    def held_open(self) -> NDArray[np.int64]:
        """Pore voxels (n, 3) in which the field is held, or averaging would have closed a throat there."""
        return self._held(True)

    @property
    def held_closed(self) -> NDArray[np.int64]:
        """Rock voxels (n, 3) in which the field is held, or averaging would have broken a wall there."""
        return self._held(False)

    def _held(self, pore: bool) -> NDArray[np.int64]:
        if not isinstance(self.field, ContactField):
            return np.zeros((0, 3), np.int64)
        held = self.field.held
        return np.asarray(held[self.field.pore[tuple(held.T)] == pore])

    def voxels(self) -> NDArray[np.bool_]:
        """Return the voxels whose middle lies in the body."""
        edges = np.array(self.voxel)
        out = np.empty(self.shape, bool)
        rows = np.stack(np.meshgrid(*(np.arange(n) for n in self.shape[1:]), indexing="ij"), axis=-1).reshape(-1, 2)
        for slice_ in range(self.shape[0]):
            places = np.column_stack([np.full(len(rows), slice_), rows])
            out[slice_] = (self.field.value((places + 0.5) * edges) < 0).reshape(self.shape[1:])
        return out


@arguments_checked
def pore_surface(
    volume: RockVolume,
    network: PoreNetwork | None = None,
    *,
    construction: Construction = "contact",
    kappa: float = 16.0,
    progress: Progress | None = None,
) -> PoreSurface:
    """Return the pores of a network as one smooth implicit body.

    Parameters
    ----------
    volume : RockVolume
        The pore space.
    network : PoreNetwork, optional
        Its pores are rebuilt; what it dropped is left out. Computed with the defaults if absent.
    construction : {"contact", "blend"}
        From contact points (keeps the volume; default), or from the blended balls.
    kappa : float
        Sharpness of the blend (a weight in the exponent, without a unit): the surface lies outside the union of the
        balls by at most
        R (sqrt(1 + ln m / kappa) - 1) where m balls are in reach.
    progress : callable, optional
        ``progress(stage, fraction)``; False stops.

    Returns
    -------
    PoreSurface
        A field in metres, negative in the pores, with its triangles.

    Raises
    ------
    VolumeError
        If a parameter is out of its range, or the network is not of this volume.

    Warns
    -----
    UserWarning
        If a twentieth of the pores or more is so narrow that blended balls have no triangles there.

    Notes
    -----
    Implicit pores from balls and throats: Huang et al. (2007); contact points between pore and rock voxels:
    :mod:`geofit.pores.contacts`.
    """
    if construction not in ("contact", "blend"):
        raise VolumeError(
            message(
                "pores.construction-unknown",
                "construction={name} is unknown. Give 'contact' or 'blend'; geofit.metaballs covers the pores with few "
                "balls.",
                name=repr(construction),
            )
        )
    if not kappa > 0:
        raise VolumeError(message("pores.kappa-not-positive", "kappa={kappa} is not positive.", kappa=kappa))
    if construction == "contact":
        require_rock(volume)
    if network is None:
        network = pore_network(volume)
    if network.pore_of is None or network.pore_of.shape != volume.shape:
        raise VolumeError(
            message(
                "pores.network-without-voxels",
                "The network stores no voxels of a volume of shape {shape}. Compute it from this "
                "volume with pore_network.",
                shape=volume.shape,
            )
        )
    tell(progress, "contacts", 0.0)
    pore = network.pore_of > 0
    part = RockVolume(pore, pore=True, voxel=volume.voxel)
    if construction == "contact":
        return PoreSurface(_contact_field(part), volume.shape, volume.voxel, construction)
    body = _blended(part, kappa)
    if (share := _unseen(body, part)) <= MISSED:
        return PoreSurface(body, volume.shape, volume.voxel, construction)
    narrow = _narrow(share)
    # The frame above is that of the decorator.
    warnings.warn(str(narrow), UserWarning, stacklevel=3)
    return PoreSurface(body, volume.shape, volume.voxel, construction, messages=(narrow,))


def _narrow(share: float) -> Message:
    return message(
        "pores.ducts-without-triangles",
        "{share:.0%} of the pores are one or two voxels wide: blended balls have no triangles there, as no corner of a "
        "voxel lies inside. Finer voxels of a smaller sample resolve them; the construction 'contact' keeps their "
        "volume.",
        share=share,
    ).with_severity("warning")


def _unseen(body: Field, volume: RockVolume) -> float:
    """Return the share of the pores in cells, as large as voxels, of which no corner lies in the body."""
    from scipy import ndimage

    near = volume.pore
    if volume.cubic:
        # A cube without rock at its sides has a ball that contains its corners.
        near = near & ~ndimage.binary_erosion(near, border_value=1)
    # Cells are as large as the shortest edge.
    parts = np.maximum(np.rint(volume.edges), 1).astype(int)
    for axis in range(3):
        near = near.repeat(parts[axis], axis=axis)
    size = np.array(volume.voxel) / parts
    unseen, before = 0, np.zeros(np.add(near.shape[1:], 1), bool)
    for plane in range(near.shape[0] + 1):
        corners = np.argwhere(_at_corners(np.pad(near[max(plane - 1, 0) : plane + 1].any(axis=0), 1)))
        places = np.column_stack([np.full(len(corners), plane), corners]) * size
        inside = np.zeros_like(before)
        inside[tuple(corners.T)] = body.value(places) < 0
        if plane:
            unseen += int((near[plane - 1] & ~_at_corners(before | inside)).sum())
        before = inside
    return unseen / int(volume.pore.sum() * parts.prod())


def _at_corners(flags: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Return whether any of four neighbours that meet in a corner of an array is true, one shorter along each axis."""
    pairs = flags[1:] | flags[:-1]
    return np.asarray(pairs[:, 1:] | pairs[:, :-1])


def require_rock(volume: RockVolume | SlicedVolume | PoreNetwork) -> None:
    """Refuse a volume, or its network, in which all voxels are pore: nothing bounds its pores, throats or flow.

    Raises
    ------
    VolumeError
        If all voxels are pore.
    """
    if volume.porosity == 1:
        raise VolumeError(
            message(
                "pores.no-rock",
                "All voxels of the volume, shape {shape}, are pore: nothing bounds the pores. Give the label or the "
                "threshold of the pores only.",
                shape=volume.shape,
            )
        )


def volume_note(triangles: float, voxels: float) -> Message | None:
    """Return what the triangles have more or less than the voxels, given the porosity of both; None if it is little."""
    if not triangles:
        return message(
            "pores.no-surface",
            "No surface was written: it has no triangles, and the pores of the network are {share:.2%} of the sample. "
            "Figures of the rebuilt rock are those of its voxels.",
            share=voxels,
        ).with_severity("warning")
    if abs(triangles - voxels) <= MISSED * voxels:
        return None
    return message(
        "pores.surface-volume-off",
        "The volume within the triangles of the surface differs by {change:+.0%} from that of the voxels: channels or "
        "walls are as narrow as a voxel. Finer voxels of a smaller sample resolve them; figures of the rebuilt rock "
        "are those of its voxels.",
        change=triangles / voxels - 1,
    ).with_severity("warning")


def _contact_field(volume: RockVolume) -> ContactField:
    border: Border = "closed" if volume.pore.all() else "open"
    reach2 = squared_distance(volume.pore, border, volume.edges)
    balls = balls_of_distance(reach2, "exact" if volume.cubic else "cover", volume.edges)
    index, normals = contact_points(balls, volume.pore)
    below = np.zeros(np.array(volume.shape) + 1, np.int64)
    below[1:, 1:, 1:] = (~volume.pore).cumsum(0).cumsum(1).cumsum(2)
    raw = ContactField((index + 0.5) * volume.edges, normals, volume.pore, below, volume.edges, volume.unit)
    # The surface lies within a voxel of the voxels' own; there the share of a voxel inside is 1/2 - f.
    near = np.flatnonzero(_beside_wall(volume.pore))
    middles = (np.stack(np.unravel_index(near, volume.shape), axis=1) + 0.5) * np.array(volume.voxel)
    heights = raw.heights(middles)
    wanted = float(np.count_nonzero(volume.pore.ravel()[near]))
    low, high = -1.0, 1.0
    for _ in range(40):
        shift = 0.5 * (low + high)
        if np.clip(0.5 - (heights - shift), 0.0, 1.0).sum() < wanted:
            low = shift
        else:
            high = shift
    raw = replace(raw, shift=0.5 * (low + high))
    while True:
        body = raw
        # Voxels that are held change the volume a little, and another volume the faults.
        for _ in range(ROUNDS + 1 if raw.cell == 1 else 2 * ROUNDS + 2):
            body = _rescued(_of_equal_volume(body, volume), volume, near, heights)
        missed = abs(_measured(body, volume)[0])
        for _ in range(MORE_ROUNDS):
            if not ENOUGH < missed <= MISSED:
                break
            body = _rescued(_of_equal_volume(body, volume), volume, near, heights)
            missed = abs(_measured(body, volume)[0])
        cells = volume.pore.size * np.prod(volume.edges) / (raw.cell / 2) ** 3
        if raw.cell <= LEAST_CELL or cells > MOST_CELLS or missed <= MISSED:
            return body
        raw = replace(raw, cell=raw.cell / 2)


def _rescued(body: ContactField, volume: RockVolume, near: NDArray[np.int64], heights: Floats) -> ContactField:
    """Return the body with the parts, tunnels and cavities of its voxels, as far as the middles of voxels tell.

    Only voxels next to the wall can have the wrong sign: their flat indices and heights without held voxels are given.
    """
    from geofit.pores.topology import topology_faults

    for _ in range(RESCUES):
        rebuilt = volume.pore.copy()
        rebuilt.ravel()[near] = _with_held(body, volume, near, heights) < body.shift
        faults = topology_faults(rebuilt, volume.pore)
        if not len(faults):
            break
        body = replace(body, held=np.unique(np.concatenate([body.held, faults]), axis=0))
    return body


def _with_held(body: ContactField, volume: RockVolume, near: NDArray[np.int64], heights: Floats) -> Floats:
    """Return the heights with what held voxels change: they reach as far as the next voxels."""
    if not len(body.held):
        return heights
    around = np.zeros(volume.shape, bool)
    reach = np.ceil(1.0 / np.array(volume.edges)).astype(int)
    for i, j, k in body.held:
        low = np.maximum((i, j, k) - reach, 0)
        around[low[0] : i + reach[0] + 1, low[1] : j + reach[1] + 1, low[2] : k + reach[2] + 1] = True
    changed = np.flatnonzero(around.ravel()[near])
    places = np.stack(np.unravel_index(near[changed], volume.shape), axis=1)
    out = heights.copy()
    out[changed] = body.heights((places + 0.5) * np.array(volume.voxel))
    return out


def _of_equal_volume(body: ContactField, volume: RockVolume) -> ContactField:
    """Return the body grown or shrunk so that its triangles have the volume of the voxels, in boxes of the sample.

    Triangles see nothing thinner than a cell: where spheres touch, they lose rock.
    """
    _, missing, area = _measured(body, volume)
    return replace(body, shift=body.shift + missing / (area * volume.unit)) if area else body


def _measured(body: ContactField, volume: RockVolume) -> tuple[float, float, float]:
    """Return what the triangles miss of the voxels in boxes of the sample, as a share and in m3, and their area, m2."""
    wanted = missing = area = 0.0
    for first, last in _boxes(body, volume):
        voxels = volume.pore[_within(first, last)]
        low, high = np.multiply(first, volume.voxel), np.multiply(last, volume.voxel)
        mesh = mesh_in_box(body, low, high, body.cell * volume.unit, slivers=True)
        true = np.count_nonzero(voxels) * float(np.prod(volume.voxel))
        wanted += true
        missing += true - mesh.volume
        area += float(mesh.areas.sum())
    return missing / wanted if wanted else 0.0, missing, area


def _boxes(body: ContactField, volume: RockVolume) -> list[tuple[Ints, Ints]]:
    """Return the first and the end of the voxels of a few boxes of the sample, which all have about as many cells."""
    edge = int(BOX * body.cell)
    firsts = np.array(list(itertools.product(*(range(0, n, edge) for n in volume.shape))))
    lasts = np.minimum(firsts + edge, volume.shape)
    few = np.arange(len(firsts))
    if len(few) > BOXES:
        few = np.random.default_rng(len(few)).choice(len(few), BOXES, replace=False)
    if body.cell < 1 or not any(volume.pore[_within(firsts[k], lasts[k])].any() for k in few):
        # Narrow channels may be rare: chosen are boxes that have some, or a neighbour whose surface bulges into them.
        near = [volume.pore[_within(np.maximum(a - 1, 0), b + 1)].any() for a, b in zip(firsts, lasts, strict=True)]
        few = np.flatnonzero(near)
        few = np.random.default_rng(len(few)).permutation(few)[: BOXES // 2]
    return [(firsts[k], lasts[k]) for k in few]


def _within(first: Ints, last: Ints) -> tuple[slice, ...]:
    return tuple(slice(a, b) for a, b in zip(first.tolist(), last.tolist(), strict=True))


def _beside_wall(pore: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Return the voxels of both kinds with a voxel of the other kind among their 26 neighbours."""
    from scipy import ndimage

    cube = np.ones((3, 3, 3), bool)
    grown = ndimage.binary_dilation(pore, cube)
    shrunk = ndimage.binary_erosion(pore, cube, border_value=1)
    return np.asarray(grown & ~shrunk)


def _blended(volume: RockVolume, kappa: float) -> Field:
    """Return the sum of e^(-kappa t) over balls that cover the pore space, t = r^2 / R^2 - 1."""
    from geofit.implicit.blobs import Metaballs
    from geofit.implicit.kernels import potential

    balls = maximal_balls(volume, rule="cover", border="closed" if volume.pore.all() else "open")
    radius = np.maximum(balls.radius, 0.5) * volume.unit
    shapes = np.eye(3) * (np.sqrt(kappa) / radius)[:, None, None]
    middles = (balls.centre + 0.5) * np.array(volume.voxel)
    return Metaballs(middles, shapes, np.full(len(radius), np.exp(kappa)), potential("blinn"), 1.0)
