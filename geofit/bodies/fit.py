"""Fit a body: contacts, samples and normals to the smoothest field that is right about all of them."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from geofit.bodies.active import ActiveFit, SidedSamples, fit_active
from geofit.bodies.between import between_samples
from geofit.bodies.data import BodyData, Prepared, prepare
from geofit.bodies.field import SIDES, BodyField
from geofit.bodies.fitted import BodyRaster, Fitted
from geofit.bodies.frame import BodyFrame
from geofit.bodies.kernels import KERNELS, LINEAR
from geofit.bodies.region import Region, hole_spacing, region_of
from geofit.bodies.settings import BodySettings
from geofit.data.errors import FitError
from geofit.data.given import arguments_checked
from geofit.data.messages import message
from geofit.implicit.lattice import Lattice, sample

if TYPE_CHECKING:
    from geofit.bodies.blend import BlendFit
    from geofit.bodies.body import BodyFit

__all__ = ["Fitted", "fit_body", "fit_field"]

Floats = NDArray[np.float64]

#: Parts of the body that no data support are closed, places between samples on which the field has the other side are
#: made samples, and the field is fitted again, this often at most.
ROUNDS = 5
#: Least distance of a place between samples from other data, as a share of the length that it represents.
APART = 0.1
#: Nodes of the raster on which such parts are looked for, along the longest side of the box, and those that the extent
#: of the body is larger than it.
NODES = 48
ROOM = 2


@arguments_checked
def fit_body(
    data: BodyData | Any,
    settings: BodySettings | None = None,
    *,
    codes: str | Sequence[str] | None = None,
    name: str = "",
) -> BodyFit:
    """Fit a closed body.

    Parameters
    ----------
    data : BodyData, or a source of intervals
        Arrays in metres and map coordinates; or boreholes with their logs (:class:`geofit.io.boreholes.Boreholes`, or
        a site that holds them), of which ``codes`` chooses what lies inside.
    settings : BodySettings, optional
        How it is fitted and judged.
    codes : str or sequence of str, optional
        Codes of the intervals inside the body; for a source of intervals only.
    name : str
        Name of the body; by default its codes, or "body".

    Returns
    -------
    BodyFit
        With its accuracy.

    Raises
    ------
    FitError
        If the data cannot bound a body, or contradict each other beyond remedy.
    SettingsError
        If codes are missing, or given for arrays.

    Notes
    -----
    Radial functions r^3, or r (Turk and O'Brien, ACM TOG 21(4), 2002), and a drift (:mod:`geofit.bodies.rbf`).
    Samples give inequalities; those that bind are found by an active set (:mod:`geofit.bodies.active`).

    Examples
    --------
    >>> import numpy as np
    >>> rng = np.random.default_rng(0)
    >>> unit = rng.normal(size=(60, 3))
    >>> unit /= np.linalg.norm(unit, axis=1)[:, None]
    >>> ball = fit_body(BodyData(contacts=10 * unit, inside=[[0, 0, 0]], outside=15 * unit), name="ball")
    >>> bool(ball.value([[1, 2, 3]])[0] < 0), ball.accuracy.verdict
    (True, 'PASS')
    """
    from geofit.bodies.accuracy import examine_body
    from geofit.bodies.body import BodyFit
    from geofit.bodies.intervals import as_body_data

    settings = BodySettings() if settings is None else settings
    given = as_body_data(data, codes, settings)
    fitted = fit_field(given, settings)
    if not name:
        name = "body" if codes is None else codes if isinstance(codes, str) else "+".join(codes)
    body = BodyFit(name, given, settings, fitted)
    return body.with_accuracy(examine_body(body))


def fit_field(data: BodyData, settings: BodySettings) -> Fitted:
    """Fit the field alone, without a verdict; parameters and errors as :func:`fit_body`."""
    start = time.perf_counter()
    prepared = prepare(data, settings)
    region = region_of(prepared.contacts, prepared.inside, prepared.outside, settings, hole_spacing(data))
    if settings.box is not None:
        own = np.concatenate([prepared.contacts, prepared.inside])
        if not ((own >= region.lower) & (own <= region.upper)).all(axis=1).any():
            raise FitError(
                message(
                    "bodies.box-without-data",
                    "No contact and no inside sample lies in the box {lower} to {upper}. Give a box around the body.",
                    lower=region.lower.tolist(),
                    upper=region.upper.tolist(),
                )
            )
    frame = BodyFrame.around(region.lower, region.upper, settings)
    samples = [(prepared.inside, -1.0), (prepared.outside, 1.0), (region.closing, 1.0)]
    lower, upper = region.lower - frame.origin, region.upper - frame.origin
    between = {side: _between_used(data, prepared, inside=side < 0) for side in (-1.0, 1.0)}
    fit: ActiveFit | BlendFit | None = None
    fresh = unsupported = 0
    for attempt in range(ROUNDS + 1):
        try:
            fit = _solve(prepared, samples, region, frame, settings, fit, fresh)
        except FitError:
            # The former field misses some places, which the checks count; no field at all would be worse.
            if fit is None:
                raise
            break
        field = BodyField(fit.rbf if isinstance(fit, ActiveFit) else fit.field, frame, lower, upper)
        survey, strays, buried = _survey(field, prepared, frame.origin)
        unsupported = len(strays)
        lacking = [(places[side * field.value(places - frame.origin) <= 0], side) for side, places in between.items()]
        if settings.closed:
            lacking.append((strays, 1.0))
        fresh = sum(len(places) for places, _ in lacking)
        if attempt == ROUNDS or not fresh:
            break
        samples += lacking
    assert fit is not None
    system, active = (fit.system, len(fit.active)) if isinstance(fit, ActiveFit) else (None, fit.active)
    given = len(prepared.contacts) + 3 * int(np.isfinite(prepared.normals).all(axis=1).sum())
    field = replace(field, cut=field.reaches())
    return Fitted(
        field,
        region,
        prepared,
        survey,
        system,
        active,
        given + active,
        fit.rounds,
        time.perf_counter() - start,
        unsupported,
        buried,
    )


def _between_used(data: BodyData, prepared: Prepared, *, inside: bool) -> Floats:
    """Return the places between two samples of one stretch that are both used; none at other data, none twice."""
    from scipy.spatial import cKDTree

    places, share, first = between_samples(data, inside=inside)
    used = prepared.inside_used if inside else prepared.outside_used
    known = np.concatenate([prepared.contacts, prepared.inside, prepared.outside])
    if not len(places):
        return places
    origin = known[0]
    apart = cKDTree(known - origin).query(places - origin)[0] > APART * share
    places, share = (each[used[first] & used[first + 1] & apart] for each in (places, share))
    if not len(places):
        return places
    twins = cKDTree(places - origin).query_pairs(APART * float(share.min()), output_type="ndarray")
    return np.delete(places, twins.max(axis=1), axis=0) if len(twins) else places


def _solve(
    prepared: Prepared,
    sides: Sequence[tuple[Floats, float]],
    region: Region,
    frame: BodyFrame,
    settings: BodySettings,
    former: ActiveFit | BlendFit | None,
    fresh: int,
) -> ActiveFit | BlendFit:
    """Fit a field, in parts where there are many contacts; ``former`` is the fit without the last ``fresh`` places."""
    from scipy.spatial import cKDTree

    contacts = frame.to_fit(prepared.contacts)
    oriented = np.asarray(np.isfinite(prepared.normals).all(axis=1))
    slopes = frame.gradient_to_fit(prepared.normals[oriented])
    kernel = KERNELS[settings.kernel]
    if kernel == LINEAR and len(slopes):
        raise FitError(
            message(
                "bodies.kernel-without-slope",
                "{count} contacts have a normal, and a field of the kernel r has no slope at its contacts. Choose the "
                "kernel r^3, or leave the normals out.",
                count=len(slopes),
            )
        )
    xyz = frame.to_fit(np.concatenate([places for places, _ in sides]))
    side = np.concatenate([np.full(len(places), side) for places, side in sides])
    near = cKDTree(contacts).query(xyz)[0] * frame.size if len(xyz) else np.zeros(0)
    # Quadratic near a contact: thin intervals would otherwise make a field of tents, with every sample active.
    samples = SidedSamples.of(xyz, side, np.minimum(near, region.bound) ** 2 / region.bound)
    if len(contacts) + 3 * int(oriented.sum()) > settings.dense:
        from geofit.bodies.blend import BlendFit, fit_blend, refit_blend

        if isinstance(former, BlendFit):
            return refit_blend(former, contacts, oriented, slopes, samples, fresh)
        corners = np.array(np.meshgrid(*zip(region.lower, region.upper, strict=True))).reshape(3, -1).T
        return fit_blend(contacts, oriented, slopes, samples, frame.to_fit(corners), kernel)
    return fit_active(contacts, np.zeros(len(contacts)), contacts[oriented], slopes, samples, kernel)


def _survey(field: BodyField, prepared: Prepared, origin: Floats) -> tuple[BodyRaster, Floats, float]:
    """Look at the body on a raster.

    Also return the deepest place (map coordinates) of each part without data, and the share of contacts on cavities.
    """
    from scipy.ndimage import label, minimum_position

    lattice = Lattice.around(field.lower, field.upper, cells=NODES)
    values = sample(field, lattice)
    inside = values < 0
    places = []
    for axis, step in enumerate(np.eye(3)):
        changes = np.argwhere(np.diff(inside, axis=axis))
        places.append(lattice.origin + lattice.spacing * (changes + step / 2))
    data = np.concatenate([prepared.contacts, prepared.inside]) - origin
    first = np.floor((data - lattice.origin) / lattice.spacing).astype(int)
    corners = [tuple(np.clip(first + corner, 0, np.array(lattice.shape) - 1).T) for corner in np.ndindex(2, 2, 2)]
    within = ((data >= field.lower) & (data <= field.upper)).all(axis=1)
    lower, upper = _extent(field, lattice, inside, np.stack([np.stack(at, axis=1)[within] for at in corners]))
    survey = BodyRaster(lattice.spacing, np.concatenate(places), lower, upper)
    parts, count = label(inside, np.ones((3, 3, 3)))
    supported = {0}.union(*(np.unique(parts[at]).tolist() for at in corners))
    buried = _buried(inside, [tuple(axis[: len(prepared.contacts)] for axis in at) for at in corners])
    alone = [k for k in range(1, count + 1) if k not in supported]
    if not alone:
        return survey, np.zeros((0, 3)), buried
    deepest = np.array(minimum_position(values, parts, alone))
    return survey, np.asarray(lattice.origin + lattice.spacing * deepest + origin), buried


def _extent(
    field: BodyField, lattice: Lattice, inside: NDArray[np.bool_], around: NDArray[np.int64]
) -> tuple[Floats, Floats]:
    """Return corners (3,) of a box around the body, from the nodes inside it and those around each datum, (8, n, 3).

    A body thinner than the raster has nodes inside in some places only, or none: then the box holds all data, and
    grows until the body does not reach its sides.
    """
    nodes = np.argwhere(inside)
    thin = not inside[tuple(around.T)].any(axis=1).all()
    low = np.concatenate([nodes - ROOM, *(around - 1 if thin else ())]).min(axis=0)
    high = np.concatenate([nodes + ROOM, *(around + 1 if thin else ())]).max(axis=0)
    while True:
        lower = np.maximum(lattice.origin + lattice.spacing * low, field.lower)
        upper = np.minimum(lattice.origin + lattice.spacing * high, field.upper)
        reached = replace(field, lower=lower, upper=upper).reaches() if thin else ()
        below, above = np.array([side in reached for side in SIDES]).reshape(3, 2).T
        below, above = below & (lower > field.lower), above & (upper < field.upper)
        if not (below | above).any():
            return lower, upper
        low, high = low - ROOM * below, high + ROOM * above


def _buried(inside: NDArray[np.bool_], corners: Sequence[tuple[NDArray[np.int64], ...]]) -> float:
    """Return the share of contacts next to a cavity, not next to the ground around the body, by the nodes about each.

    Ground around the body reaches the border of the raster. Contacts without a node of either do not count.
    """
    from scipy.ndimage import label

    parts, count = label(~inside, np.ones((3, 3, 3)))
    around = np.zeros(count + 1, bool)
    for axis in range(3):
        for end in (0, -1):
            around[np.unique(np.take(parts, end, axis))] = True
    around[0] = False
    outer = np.any([around[parts[at]] for at in corners], axis=0)
    cavity = np.any([(parts[at] > 0) & ~around[parts[at]] for at in corners], axis=0)
    shown = int((outer | cavity).sum())
    return float((cavity & ~outer).sum() / shown) if shown else 0.0
