"""Arguments that a function cannot take: refused at its door, not by an attribute that is missing inside.

:func:`arguments_checked` reads what a function takes from its signature, so a public function says it once.
"""

from __future__ import annotations

import ast
import os
import re
from collections.abc import Callable, Collection, Iterator, Mapping
from difflib import get_close_matches
from functools import cache, partial, wraps
from inspect import Parameter, Signature, isfunction, signature
from numbers import Integral, Real
from typing import Any, Literal, NamedTuple, NoReturn, TypeVar, cast, get_origin

import numpy as np

from geofit.data.errors import ArgumentError, GeofitError
from geofit.data.messages import Message, Untranslated, message
from geofit.data.numbers import shown

__all__ = ["FIT", "POINTS", "SETTINGS", "SITE", "SURFACES", "arguments_checked", "keywords_known", "require_kind"]

T = TypeVar("T", bound=Callable[..., Any])

#: Numbers from which on squares and products overflow.
HUGE = 1e100

POINTS = message("data.point-set-needed", "a PointSet is needed: PointSet(xyz).")
SETTINGS = message("data.fit-settings-needed", "settings are needed: FitSettings(epsilon=0.5).")
FIT = message(
    "data.fit-needed",
    "a fit is needed: fit_horizon(points) gives one, judge(surface, points) makes one of a surface that was read.",
)
SITE = message("data.site-needed", "a site is needed: read_site(path) gives one.")
SURFACES = message("data.surfaces-needed", "a surface is needed, or several by name: {names}.", names="{'T1': surface}")


def _given_by(kind: str, call: str) -> Message:
    return message(
        "data.object-needed", "a {kind} is needed: {call}.", kind=Untranslated(kind), call=Untranslated(call)
    )


#: What is needed where a class is, and how to get it.
_CLASSES = {
    "PointSet": POINTS,
    "FitSettings": SETTINGS,
    "HorizonFit": FIT,
    "Slices": _given_by("RockVolume", "read_volume(path)"),
    "Site": SITE,
    "HasElevation": SURFACES,
    **dict.fromkeys(("MeshSurface", "PatchSurface", "Surface"), SURFACES),
    "Uncertainty": message(
        "data.uncertainty-needed",
        "the uncertainty of an examination is needed: examine(surface).uncertainty; where that is None, its notes say "
        "why.",
    ),
    **{
        kind: _given_by(kind, call)
        for kind, call in (
            ("AdjustedSurvey", "geofit.caves.adjust_survey(survey)"),
            ("BodyData", "BodyData(contacts, normals=normals)"),
            ("BodySettings", "BodySettings(epsilon=0.5)"),
            ("Boreholes", "geofit.io.read_boreholes(collar, survey, intervals)"),
            ("Field", "geofit.implicit.Sphere(centre, radius)"),
            ("Ground", "geofit.io.read_ground(path)"),
            ("Lattice", "geofit.implicit.Lattice.around(lower, upper, cells=60)"),
            ("MaximalBalls", "maximal_balls(volume)"),
            ("Mesh", "surface.triangulate(0.05)"),
            ("MorphBody", "morph(a, b)(0.5)"),
            ("PassageBody", "centreline_body(survey)"),
            ("PoreNetwork", "pore_network(volume)"),
            ("PoreSurface", "pore_surface(volume)"),
            ("RockVolume", "RockVolume(array, pore=0, voxel=1e-6)"),
            ("Source", "geofit.io.Source(path=path)"),
            ("Survey", "geofit.io.read_survex(path)"),
            ("TriangleMesh", "geofit.implicit.isosurface(field, lattice)"),
        )
    },
}  # fmt: skip


_SURFACE = ("elevation", "project", "triangulate")
#: What tells an object whose class may have any name. A surface may take the place of a fit, and a fit of a surface:
#: a function that needs the points of a fit says so.
_MEMBERS = {
    "HasElevation": ("elevation",),
    **dict.fromkeys(("HorizonFit", "MeshSurface", "PatchSurface", "Surface"), _SURFACE),
    "Field": ("value", "gradient"),
    "Slices": ("slab",),
}


class _Kind(NamedTuple):
    """Values that an argument takes; ``inner``: what each of several must be."""

    fits: Callable[[Any], bool]
    needed: Message
    inner: tuple[_Kind, ...] = ()
    number: bool = False


class _Fault(NamedTuple):
    argument: str
    value: Any
    needed: Message


def _is_numeric(value: Any) -> bool:
    try:
        array = np.asarray(value)
    except (TypeError, ValueError):  # rows of several lengths, an object without numbers
        return False
    return not array.size or array.dtype.kind in "biuf" or (array.dtype.kind == "O" and all(map(_is_real, array.flat)))


def _is_real(value: Any) -> bool:
    if isinstance(value, np.ndarray) and value.ndim == 0:
        value = value.item()
    try:
        return isinstance(value, Real) and float(value) == value
    except OverflowError:  # a whole number that a double does not hold
        return False


def _is_several(value: Any) -> bool:
    single = isinstance(value, str | bytes | Mapping) or getattr(value, "ndim", 1) == 0
    return isinstance(value, Collection) and not single


_ANY = _Kind(lambda _: True, message("data.anything-needed", "anything"))
_NONE = _Kind(lambda value: value is None, message("data.none-needed", "no value (None)"))
_TEXT = _Kind(lambda value: isinstance(value, str), message("data.text-needed", "a text (str)"))
_NUMBERS = _Kind(
    _is_numeric, message("data.numbers-needed", "numbers, such as a list or an array of them"), number=True
)
_GIVEN = _NUMBERS._replace(fits=lambda value: value is not None, number=False)
_WHOLE = _Kind(
    lambda value: not isinstance(value, bool) and isinstance(value, Integral) and _is_real(value),
    message("data.whole-number-needed", "a whole number (int)"),
    number=True,
)
_CALL = _Kind(callable, message("data.function-needed", "a function"))
_SEVERAL = _Kind(_is_several, message("data.several-needed", "several values, such as a list of them"))
_BY_NAME = _Kind(lambda value: isinstance(value, Mapping), message("data.by-name-needed", "values by name (a dict)"))
_PATH = _Kind(lambda value: isinstance(value, os.PathLike), message("data.path-needed", "a path (pathlib.Path)"))
_WRITTEN = {
    "Any": _ANY,
    "None": _NONE,
    "str": _TEXT,
    "bool": _Kind(
        lambda value: isinstance(value, bool | np.bool_), message("data.truth-needed", "true or false (bool)")
    ),
    "int": _WHOLE,
    "float": _Kind(_is_real, message("data.number-needed", "a number (float)"), number=True),
    "ArrayLike": _NUMBERS,
    "NDArray": _NUMBERS,
    "Floats": _NUMBERS,
    "Ints": _NUMBERS,
    "Progress": _CALL,
    "Callable": _CALL,
    "Path": _PATH,
    "PathLike": _PATH,
    "Literal": _TEXT,
    "Sequence": _SEVERAL,
    "Collection": _SEVERAL,
    "tuple": _SEVERAL,
    "Mapping": _BY_NAME,
}


def arguments_checked(what: T) -> T:
    """Refuse arguments that the signature of a function, or of the public methods of a class, does not allow.

    Annotations are read as they are written: nothing is imported for them. Objects, texts and names are looked at
    before the function starts; numbers and the shapes that the docstring states (``xyz : (n, 3) array``) only where it
    ends in an error that is not one of geofit's, because its own checks of numbers say more. What a class is made of
    has these shapes in any case: it is used later.

    Raises
    ------
    ArgumentError
        By the returned function, if an argument is unknown, missing, or of another type or shape.
    """
    function: Callable[..., Any] = what.__init__ if isinstance(what, type) else what  # type: ignore[misc]
    known = signature(function)

    @cache
    def kinds() -> tuple[dict[str, tuple[_Kind, ...]], ...]:
        every = {one.name: tuple(_kinds(one.annotation, function)) for one in known.parameters.values()}
        before = {name: (_GIVEN,) if found == (_NUMBERS,) else found for name, found in every.items()}
        return {name: found for name, found in before.items() if not any(map(_of_numbers, found))}, every

    @wraps(function)
    def call(*args: Any, **kwargs: Any) -> Any:
        before, every = kinds()
        if before:
            _compare(known, _bound(function, known, args, kwargs), before)
        try:
            result = function(*args, **kwargs)
        except GeofitError:
            raise
        except Exception:
            given = _bound(function, known, args, kwargs)
            _compare(known, given, every)
            _compare_shapes(what.__doc__, given)
            _compare_values(known, given)
            raise
        if isinstance(what, type):
            given = _bound(function, known, args, kwargs)
            _compare(known, given, every)
            _compare_shapes(what.__doc__, given, empty=True)
        return result

    if isinstance(what, type):
        for name, member in list(vars(what).items()):
            if isfunction(member) and not name.startswith("_"):
                setattr(what, name, arguments_checked(member))
        what.__init__ = call  # type: ignore[misc]
        return what
    return cast(T, call)


#: A line of a docstring that states shapes: ``lower, upper : (k, 3) array``.
_SHAPES = re.compile(
    r"^ *(\w[\w, ]*) : (pair of )?((?:\([^()]*\)(?:, )?)+) array\S*(?: of \w+)?(?:, optional| or (\w+))?$", re.M
)


@cache
def _shapes(doc: str) -> dict[str, tuple[tuple[str, ...], ...]]:
    """Return the shapes that each argument may have, as its docstring states them."""
    found = {}
    for names, pair, shapes, other in _SHAPES.findall(doc):
        several = [tuple(re.findall(r"[^, ][^,]*", shape)) for shape in re.findall(r"\(([^()]*)\)", shapes)]
        for name in names.split(", "):
            found[name] = (*((("2",) if pair else ()) + shape for shape in several), *([()] if other else []))
    return found


def _compare_shapes(doc: str | None, given: Mapping[str, Any], *, empty: bool = False) -> None:
    """Refuse an array of another shape, unless it may be empty; a letter is the same number for all arguments."""
    letters: dict[str, int] = {}
    for name, shapes in _shapes(doc or "").items():
        value = given.get(name)
        if value is None:
            continue
        _refuse_ragged(name, value)
        if empty and not np.size(value):
            continue
        shape = np.shape(value)
        if not any(len(shape) == len(one) and all(map(partial(_is_side, letters), one, shape)) for one in shapes):
            needed = tuple(str(letters.get(side, side)) for side in shapes[0])
            text = message(
                "data.argument-shape-unfit",
                "{argument} has shape {given}; an array of shape {needed} is needed.",
                argument=name,
                given=shape,
                needed=Untranslated(f"({', '.join(needed)}{',' * (len(needed) == 1)})"),
            )
            raise ArgumentError(text)


def _is_side(letters: dict[str, int], stated: str, length: int) -> bool:
    """Whether an axis has the length that is stated: a number, a letter, or a sum that is not looked at."""
    return length == (int(stated) if stated.isdigit() else letters.setdefault(stated, length))


def _compare_values(known: Signature, given: Mapping[str, Any]) -> None:
    """Refuse values that no function can work with: the last resort after an error that is not one of geofit's.

    A value that is the argument's default, infinite or empty, is not to blame.
    """
    for name, value in given.items():
        if isinstance(value, float | str) and value == known.parameters[name].default:
            continue
        _refuse_ragged(name, value)
        if isinstance(value, str | os.PathLike):
            if not os.fspath(value) or "\0" in str(value):
                _refuse_value(name, message("data.text-unusable", "it is empty or holds a NUL character."))
        elif isinstance(value, Real | list | tuple | np.ndarray):
            array = np.asarray(value)
            if array.dtype.kind == "f" and not (np.abs(array) < HUGE).all():
                needed = message("data.finite-needed", "finite numbers below {most:.0e} are needed.", most=HUGE)
                _refuse_value(name, needed)


def _refuse_ragged(name: str, value: Any) -> None:
    if isinstance(value, list | tuple):
        try:
            np.asarray(value)
        except ValueError:
            needed = message("data.rows-unequal", "its rows have unequal lengths; an array is needed.")
            _refuse_value(name, needed)


def _refuse_value(name: str, fault: Message) -> NoReturn:
    text = message("data.argument-unusable", "{argument} cannot be used: {fault}", argument=name, fault=fault)
    raise ArgumentError(text)


def _of_numbers(kind: _Kind) -> bool:
    return kind.number or any(map(_of_numbers, kind.inner))


def keywords_known(cls: T) -> T:
    """Refuse arguments that a class does not have, or lacks; it checks their values itself.

    Where it ends in another error all the same, they are looked at as :func:`arguments_checked` does.
    """
    made: Callable[..., None] = cls.__init__
    known = signature(made)

    @wraps(made)
    def call(*args: Any, **kwargs: Any) -> None:
        given = _bound(made, known, args, kwargs)
        try:
            made(*args, **kwargs)
        except GeofitError:
            raise
        except Exception:
            _compare(known, given, {one.name: tuple(_kinds(one.annotation, made)) for one in known.parameters.values()})
            _compare_values(known, given)
            raise

    cls.__init__ = call  # type: ignore[method-assign]
    return cls


def require_kind(argument: str, value: object, kinds: type | tuple[type, ...], needed: Message) -> None:
    """Refuse an argument that is none of the kinds.

    Parameters
    ----------
    argument : str
        Its name in the call.
    value : object
        What was given.
    kinds : type or tuple of type
        What the function takes.
    needed : Message
        What is needed and how to get it: the end of the sentence.

    Raises
    ------
    ArgumentError
        If ``value`` is of another type.
    """
    _refuse(None if isinstance(value, kinds) else _Fault(argument, value, needed))


def _refuse(fault: _Fault | None) -> None:
    if fault is None:
        return
    argument, value, needed = fault
    if isinstance(value, Real):
        text = message(
            "data.argument-unfit",
            "{argument} is {value}; {needed}",
            argument=argument,
            value=shown(value),
            needed=needed,
        )
    else:
        text = message(
            "data.argument-type-unfit",
            "{argument} is of type {given}; {needed}",
            argument=argument,
            given="None" if value is None else type(value).__name__,
            needed=needed,
        )
    raise ArgumentError(text)


def _compare(known: Signature, given: Mapping[str, Any], kinds: Mapping[str, tuple[_Kind, ...]]) -> None:
    for name in kinds.keys() & given.keys():
        many = known.parameters[name].kind is Parameter.VAR_POSITIONAL
        for one in given[name] if many else (given[name],):
            _refuse(_fault(name, one, kinds[name]))


def _bound(function: Callable[..., Any], known: Signature, args: Any, kwargs: Mapping[str, Any]) -> Mapping[str, Any]:
    """Return arguments by their names."""
    try:
        return known.bind(*args, **kwargs).arguments
    except TypeError as error:
        names = [one.name for one in known.parameters.values() if one.name != "self" and one.kind != one.VAR_KEYWORD]
        own = function.__qualname__.removesuffix(".__init__")
        call = {"function": Untranslated(own), "names": Untranslated(", ".join(names))}
        wrong = next((name for name in kwargs if name not in known.parameters), "")
        near = get_close_matches(wrong, names, 1) if wrong else []
        if near:
            text = message(
                "data.argument-mistyped",
                "{function} has no argument '{name}'. Did you mean '{near}'? Its arguments are: {names}.",
                name=Untranslated(wrong),
                near=Untranslated(near[0]),
                **call,
            )
        elif wrong:
            text = message(
                "data.argument-unknown",
                "{function} has no argument '{name}'. Its arguments are: {names}.",
                name=Untranslated(wrong),
                **call,
            )
        else:
            text = message(
                "data.arguments-unfit",
                "{function} cannot be called like this: {error}. Its arguments are: {names}.",
                error=str(error),
                **call,
            )
        raise ArgumentError(text) from None


def _kinds(annotation: object, function: Callable[..., Any]) -> Iterator[_Kind]:
    """Return what an annotation, as it is written, allows."""
    if not isinstance(annotation, str):
        yield _ANY
        return
    yield from _parsed(ast.parse(annotation, mode="eval").body, function.__globals__)


def _parsed(node: ast.expr, names: Mapping[str, Any]) -> Iterator[_Kind]:
    match node:
        case ast.BinOp(left=left, right=right):
            yield from _parsed(left, names)
            yield from _parsed(right, names)
        case ast.Constant(value=None):
            yield _NONE
        case ast.Subscript(value=ast.Name(id=("Sequence" | "Collection" | "Mapping") as name), slice=inner):
            last = inner.elts[-1] if isinstance(inner, ast.Tuple) else inner
            yield _WRITTEN[name]._replace(inner=tuple(_parsed(last, names)))
        case ast.Subscript(value=ast.Name(id="tuple"), slice=ast.Tuple(elts=parts)):
            yield _of_length(len(parts), parts, names)
        case ast.Subscript(value=ast.Name(id=name)) | ast.Name(id=name):
            yield _named(name, names.get(name))
        case _:
            yield _ANY


def _of_length(n: int, parts: list[ast.expr], names: Mapping[str, Any]) -> _Kind:
    """Return what ``tuple[float, float, float]`` or ``tuple[Hole, ...]`` allows; mixed parts are not looked at."""
    if isinstance(parts[-1], ast.Constant) and parts[-1].value is ...:
        return _SEVERAL._replace(inner=tuple(_parsed(parts[0], names)))
    alike = len({ast.dump(part) for part in parts}) == 1
    needed = message("data.several-needed-of-number", "{count} values, such as a tuple of them", count=n)
    inner = tuple(_parsed(parts[0], names)) if alike else ()
    return _Kind(lambda value: _is_several(value) and len(value) == n, needed, inner)


def _named(name: str, value: Any) -> _Kind:
    """Return the kind of a name in an annotation: its value, if the module has it at run time."""
    if name in _WRITTEN:
        return _WRITTEN[name]
    if get_origin(value) is Literal:
        return _TEXT
    # Another name for several types, or one that is imported for type checkers only and may be that.
    if not isinstance(value, type) and (value is not None or name not in _CLASSES):
        return _ANY
    needed = _CLASSES.get(
        name, message("data.class-needed", "an object of the class {kind} is needed.", kind=Untranslated(name))
    )
    if name in _MEMBERS:
        return _Kind(lambda given: all(hasattr(type(given), one) for one in _MEMBERS[name]), needed)
    return _Kind(lambda given: name in [one.__name__ for one in type(given).__mro__], needed)


def _fault(argument: str, value: Any, kinds: tuple[_Kind, ...]) -> _Fault | None:
    """Return what is wrong with a value that must be of one of some kinds."""
    inner: _Fault | None = None
    for kind in kinds:
        if not kind.fits(value):
            continue
        faults = (_fault(name, one, kind.inner) for name, one in _parts(argument, value)) if kind.inner else ()
        inner = next((fault for fault in faults if fault is not None), None)
        if inner is None:
            return None
    if inner is not None:
        return inner
    classes = [kind.needed for kind in kinds if kind.needed.is_sentence]
    some = message("data.kinds-needed", "needed: {kinds}.", kinds=tuple(kind.needed for kind in kinds))
    return _Fault(argument, value, classes[0] if classes else some)


def _parts(argument: str, value: Any) -> Iterator[tuple[str, Any]]:
    keyed = value.items() if isinstance(value, Mapping) else enumerate(value)
    return ((f"{argument}[{key!r}]", one) for key, one in keyed)
