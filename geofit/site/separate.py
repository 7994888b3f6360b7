"""Push horizons apart where they cross: exact points stay exact, and nothing moves outside the supports there.

The changes of the control points of all horizons are one problem: the smallest sum of squares that leaves every exact
point where it is and gives the thickness its least value at the places of a lattice. It is convex; the inequalities
are taken in by a penalty whose multipliers are estimated anew (augmented Lagrangian, Nocedal and Wright 2006,
sec. 17.4), its kinks by Newton steps on the violated places. Points that are approximated hold their place softly.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import block_array, block_diag, csc_array, csr_array, diags_array, eye_array, hstack, vstack
from scipy.sparse.linalg import SuperLU, splu

from geofit.data.columns import LARGEST
from geofit.data.errors import SettingsError
from geofit.data.given import FIT, arguments_checked, require_kind
from geofit.data.messages import EMPTY, Message, message
from geofit.data.progress import Progress, tell, within
from geofit.data.threads import one_thread
from geofit.fitting.horizon_fit import HorizonFit
from geofit.fitting.model import Model
from geofit.site.height_field import HeightField
from geofit.site.order import require_sequence
from geofit.site.overlap import Overlap

__all__ = ["Contradiction", "Separation", "separate_horizons"]

Floats = NDArray[np.float64]

#: Added to the least thickness, metres: what the surfaces may bend towards each other between the places looked at.
#: It starts at the first and grows with what a round leaves there, up to the second.
MARGIN, WIDEST = 1e-3, 0.05
#: Rounds of looking for what is still too thin, of multipliers, and of Newton steps.
ROUNDS, MULTIPLIERS, STEPS = 8, 12, 60
#: With the widest margin, a round that leaves as many places and more than this share of what is missing is the last.
STALLED = 0.9
#: Weight of a place that is too thin, and of an approximated point, against the square of a change of control point.
PENALTY, HOLD = 1e4, 1e2
#: A place is pinned by exact points where they leave less than this share of its freedom to move.
FREEDOM = 0.2
#: Changes below this (metres) are none, and the softness of exact points that depend on each other.
STILL, SOFT = 1e-9, 1e-10


@dataclass(frozen=True)
class Contradiction:
    """A place that cannot be resolved: the exact points around it ask for what cannot be.

    ``lack`` is by how many metres the thickness at (x, y) stays below the least one; ``above`` and ``below`` name the
    nearest exact point of the upper and of the lower horizon by file and row, empty where there is none.
    """

    upper: str
    lower: str
    x: float
    y: float
    lack: float
    above: Message
    below: Message

    @property
    def text(self) -> Message:
        """What contradicts what, in words."""
        none = message("site.no-exact-point", "no exact point")
        return message(
            "site.horizons-not-separable",
            "{upper} and {lower} cannot be separated at ({x:.1f}, {y:.1f}), {lack:.3f} m are "
            "missing: {above} of {upper} contradicts {below} of {lower}",
            upper=self.upper,
            lower=self.lower,
            x=self.x,
            y=self.y,
            lack=self.lack,
            above=self.above or none,
            below=self.below or none,
        ).with_severity("warning")


@dataclass(frozen=True, eq=False)
class Separation:
    """Surfaces after the separation, by name; ``moved`` gives by how many metres each was moved at most."""

    surfaces: Mapping[str, HorizonFit]
    moved: Mapping[str, float]
    contradictions: tuple[Contradiction, ...]


@arguments_checked
def separate_horizons(
    surfaces: Mapping[str, HorizonFit],
    sequence: Sequence[str],
    minimum: float = 0.0,
    progress: Progress | None = None,
) -> Separation:
    """Push horizons of a sequence apart until each is at least ``minimum`` metres above the next.

    Parameters
    ----------
    surfaces : mapping of str to HorizonFit
        Fitted surfaces by name; those that the sequence does not name are handed on as they are.
    sequence : sequence of str
        Names from the top to the bottom.
    minimum : float
        Least thickness, metres.
    progress : callable, optional
        Called as ``progress(stage, fraction)``; returning False stops the separation.

    Returns
    -------
    Separation
        Surfaces that had to move are new and checked, with their control net in ``model``; the others are the same
        objects. What exact points forbid is listed.

    Raises
    ------
    Cancelled
        If ``progress`` returned False.
    ArgumentError
        If a surface is not a fit.
    SettingsError
        If the sequence does not fit the surfaces, or one was not fitted here over the map.

    Notes
    -----
    Exact points keep their residual to 1e-8 m. The whole net is changed, not its patches: seams stay closed and
    tangent. A core that is ruled between its sections moves at its periphery only.
    """
    for name, surface in surfaces.items():
        require_kind(f"surfaces[{name!r}]", surface, HorizonFit, FIT)
    sequence = list(sequence)
    require_sequence(surfaces, sequence)
    if len(sequence) < 2:
        return Separation(dict(surfaces), {}, ())
    if not 0 <= minimum <= LARGEST:
        raise SettingsError(
            message(
                "site.least-thickness-negative",
                "The least thickness is {value}; give metres, from 0 to {most:.0e}.",
                value=minimum,
                most=LARGEST,
            )
        )
    stack = _Stack([_Layer(surfaces[name]) for name in sequence], minimum)
    with one_thread():
        stack.separate(within(progress, 0.0, 0.9))
        tell(progress, "separate horizons", 0.9)
        result, moved = dict(surfaces), {}
        for layer in stack.layers:
            if layer.change.any():
                moved[layer.surface.name] = float(np.abs(layer.change).max())
                result[layer.surface.name] = layer.moved_surface()
        return Separation(result, moved, stack.contradictions())


class _Layer:
    """One horizon of the stack: its control net, its exact points, and the change so far."""

    def __init__(self, surface: HorizonFit) -> None:
        model = surface.model
        if model is None or model.problem.parametrization.frame.kind != "map" or model.aside is not None:
            text = message(
                "site.no-control-net",
                "'{name}' has no control net over the map: it was read from a file, or is not a height "
                "field. Fit it again, or take it out of the order.",
                name=surface.name,
            )
            raise SettingsError(text)
        self.surface, self.model = surface, model
        problem, net = self.model.problem, self.model.net
        held = problem.kept & problem.parametrization.parametrized
        self.plane = problem.parametrization.plane / net.unit
        self.exact = np.flatnonzero(held & surface.core)
        self.loose = np.flatnonzero(held & ~surface.core)
        self.movable = ~net.frozen if net.lines is not None else np.ones(net.space.size, bool)
        self.change = np.zeros(net.space.size)

    def matrix(self, xy: Floats) -> csr_array:
        """Return the (n, size) matrix from coefficients to heights at map coordinates."""
        return self.model.net.space.matrix(self.model.problem.parametrization.frame.plan(xy) / self.model.net.unit)

    def at_points(self, which: NDArray[np.intp]) -> csr_array:
        """Return the matrix from coefficients to heights at some of its points."""
        return self.model.net.space.matrix(self.plane[which])

    def nearest_exact(self, x: float, y: float) -> Message:
        """Name the exact point nearest to a place, empty without one."""
        if not len(self.exact):
            return EMPTY
        points = self.model.problem.points
        away = np.linalg.norm(points.xyz[self.exact, :2] - (x, y), axis=1)
        return points.describe(int(self.exact[away.argmin()]))

    def as_moved(self, lift: float) -> HorizonFit:
        """Return the surface as moved so far and lifted, unchecked."""
        return self.surface.with_(patches=self.moved().patches(), origin=self.surface.origin + np.array([0, 0, lift]))

    def moved(self) -> Model:
        """Return the model with its control points moved; those that stay keep their bits."""
        net = self.model.net
        coefficients = np.where(self.change == 0, net.coefficients, net.coefficients + self.change)
        return self.model.with_net(replace(net, coefficients=coefficients))

    def moved_surface(self) -> HorizonFit:
        """Return the checked surface of the control points moved; it states that it was."""
        new = self.surface.refitted(self.moved())
        assert new.accuracy is not None
        note = message(
            "site.moved-to-keep-order",
            "moved by up to {most:.3f} m to keep the order of strata",
            most=float(np.abs(self.change).max()),
        )
        accuracy = replace(new.accuracy, notes=(*new.accuracy.notes, note))
        return new.with_(accuracy=accuracy)


class _Stack:
    """Horizons from the top to the bottom, separated together."""

    def __init__(self, layers: list[_Layer], minimum: float) -> None:
        self.layers, self.minimum = layers, minimum
        self.start = np.cumsum([0, *(layer.change.size for layer in layers)])
        self.pairs = list(combinations(range(len(layers)), 2))
        self.given = self.overlaps()

    def overlaps(self) -> dict[tuple[int, int], Overlap]:
        """Return what is too thin as overlaps: the upper surface of each pair is lowered by the least thickness."""
        lowered = [HeightField(layer.as_moved(-self.minimum)) for layer in self.layers]
        reliefs = [HeightField(layer.as_moved(0.0)) for layer in self.layers]
        found = {(i, j): Overlap.between(lowered[i], reliefs[j]) for i, j in self.pairs}
        return {pair: overlap for pair, overlap in found.items() if overlap is not None}

    def separate(self, progress: Progress | None) -> None:
        """Move control points until nothing that can move is too thin."""
        rows: list[csr_array] = []
        thickness: list[Floats] = []
        for pair, overlap in self.given.items():
            self._hold(pair, overlap.nodes(), rows, thickness)
        thin = [given < 0 for given in thickness]
        overlaps, margin, former = self.given, MARGIN, (0, np.inf)
        for number in range(ROUNDS):
            for pair, overlap in overlaps.items():
                self._hold(pair, overlap.below(), rows, thickness)
            if len(rows) == len(thin) and overlaps is not self.given:
                return
            thin += [np.ones(len(given), bool) for given in thickness[len(thin) :]]
            if not np.concatenate(thin).any():
                return
            lack = margin - np.concatenate(thickness)
            part = within(progress, number / ROUNDS, (number + 1) / ROUNDS)
            if not self._solve(csr_array(vstack(rows)), lack, np.concatenate(thin), part):
                return
            overlaps = self.overlaps()
            worst = max((-overlap.thinnest[2] for overlap in overlaps.values()), default=0.0)
            left = sum(len(overlap.below()) for overlap in overlaps.values()), worst
            if margin == WIDEST and left[0] >= former[0] > 0 and worst > STALLED * former[1]:
                return
            former = left
            margin = min(margin + 2 * max(worst, 0.0), WIDEST)

    def _hold(self, pair: tuple[int, int], places: Floats, rows: list[csr_array], thickness: list[Floats]) -> None:
        """Add places to those whose thickness is held, with what it is there before anything moves."""
        if len(places):
            rows.append(self._rows(pair, places))
            thickness.append(self.given[pair](*places.T))

    def contradictions(self) -> tuple[Contradiction, ...]:
        """Return where the surfaces as moved are still too thin."""
        return tuple(
            Contradiction(
                upper=self.layers[i].surface.name,
                lower=self.layers[j].surface.name,
                x=crossing.x,
                y=crossing.y,
                lack=crossing.depth,
                above=self.layers[i].nearest_exact(crossing.x, crossing.y),
                below=self.layers[j].nearest_exact(crossing.x, crossing.y),
            )
            for (i, j), overlap in self.overlaps().items()
            for crossing in overlap.crossings()
        )

    def _rows(self, pair: tuple[int, int], places: Floats) -> csr_array:
        """Return the (n, size) matrix from the changes of all control points to those of the thickness."""
        parts = [csr_array((len(places), layer.change.size)) for layer in self.layers]
        parts[pair[0]] = self.layers[pair[0]].matrix(places)
        parts[pair[1]] = -self.layers[pair[1]].matrix(places)
        return csr_array(hstack(parts))

    def _solve(self, rows: csr_array, lack: Floats, thin: NDArray[np.bool_], progress: Progress | None) -> bool:
        """Find the smallest change of what acts at thin places; return whether it differs from the one before."""
        movable = np.concatenate([layer.movable for layer in self.layers])
        acting = np.zeros(movable.size, bool)
        active = csr_array(rows[thin])
        acting[active.indices[active.data != 0]] = True
        free = np.flatnonzero(acting & movable)
        rows = csr_array(rows[:, free])
        held = rows.power(2).sum(axis=1) > 0
        exact, loose = (
            csr_array(block_diag(parts, format="csr")[:, free])
            for parts in (
                [layer.at_points(layer.exact) for layer in self.layers],
                [layer.at_points(layer.loose) for layer in self.layers],
            )
        )
        exact = csr_array(exact[np.unique(exact.nonzero()[0])])
        before = np.concatenate([layer.change for layer in self.layers])
        change = np.zeros(movable.size)
        change[free] = _minimum_norm_correction(csr_array(rows[held]), lack[held], exact, loose, before[free], progress)
        for layer, first in zip(self.layers, self.start, strict=False):
            layer.change = change[first : first + layer.change.size]
        return bool(np.abs(change - before).max() > STILL)


def _minimum_norm_correction(
    rows: csr_array,
    lack: Floats,
    exact: csr_array,
    loose: csr_array,
    start: Floats,
    progress: Progress | None,
) -> Floats:
    """Return the smallest x with rows @ x >= lack where that is free to be, exact @ x = 0, and loose @ x small.

    Parameters
    ----------
    rows, exact, loose : (n, size), (m, size), (k, size) sparse arrays
        Thickness at places, heights at exact and at approximated points.
    lack : (n,) array
        What the thickness must gain, metres.
    start : (size,) array
        A change to begin with.
    progress : callable or None
        Called before each Newton step.
    """
    size, count = rows.shape[1], exact.shape[0]
    exact = csr_array(diags_array(1 / np.sqrt(exact.power(2).sum(axis=1))) @ exact)
    gram = splu(csc_array(exact @ exact.T + SOFT * eye_array(count))) if count else None
    free = _freedom(rows, exact, gram) >= FREEDOM
    rows, lack = csr_array(rows[free]), lack[free]
    base = eye_array(size) + HOLD * (loose.T @ loose)
    change, force = start, np.zeros(len(lack))
    for number in range(MULTIPLIERS):
        wanted = lack + force / PENALTY
        for k in range(STEPS):
            tell(progress, "separate horizons", (number + k / STEPS) / MULTIPLIERS)
            active = wanted > rows @ change
            part = csr_array(rows[active])
            system, right = base + PENALTY * (part.T @ part), PENALTY * (part.T @ wanted[active])
            if count:
                system = block_array([[system, exact.T], [exact, -SOFT * eye_array(count)]])
                right = np.append(right, np.zeros(count))
            step = splu(csc_array(system)).solve(right)[:size] - change
            share = _share(step, change, base, rows @ step, wanted - rows @ change)
            if not share:
                # Rounding alone is left: every further step would be this one again.
                break
            change = change + share * step
            if np.abs(step).max() <= STILL or (share == 1 and np.array_equal(active, wanted > rows @ change)):
                break
        left = lack - rows @ change
        force = np.maximum(force + PENALTY * left, 0.0)
        if left.max(initial=0.0) <= 0.1 * MARGIN:
            break
    if gram is not None:
        for _ in range(2):
            change = change - exact.T @ gram.solve(exact @ change)
    return change


def _share(step: Floats, change: Floats, base: csr_array, gain: Floats, left: Floats) -> float:
    """Return how much of a Newton step to take, up to all of it: where the penalised sum is least on the way."""
    along, slope = base @ step, float(change @ (base @ step))
    curve = float(step @ along)

    def rising(share: float) -> bool:
        return slope + share * curve > PENALTY * float(gain @ np.maximum(left - share * gain, 0.0))

    if not rising(1.0 + 1e-9):
        return 1.0
    low, high = 0.0, 1.0
    for _ in range(40):
        middle = (low + high) / 2
        low, high = (low, middle) if rising(middle) else (middle, high)
    return low if high < 1.0 else 1.0


def _freedom(rows: csr_array, exact: csr_array, gram: SuperLU | None) -> Floats:
    """Return (n,) the share of each row's square that is left when the exact points are held."""
    if gram is None:
        return np.ones(rows.shape[0])
    common = (exact @ rows.T).toarray()
    taken = (common * gram.solve(common)).sum(axis=0)
    return np.asarray(1 - taken / np.maximum(rows.power(2).sum(axis=1), 1e-300))
