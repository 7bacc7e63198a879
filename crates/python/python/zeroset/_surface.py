"""What users call: surfaces, and the results of their methods."""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from numbers import Real
from typing import TYPE_CHECKING, Any, Literal, NamedTuple, TypeAlias

import numpy as np
import numpy.typing as npt

from . import _zeroset
from ._formula import from_sympy, is_of_sympy, parametric, traced
from ._zeroset import Error, Mesh, Picture

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ._explorer import Explorer

MISS, HIT, UNDECIDED = 0, 1, 2

Floats: TypeAlias = npt.NDArray[np.float64]
Domain: TypeAlias = "float | str | Sequence[Sequence[float]]"


class Interval(NamedTuple):
    """Two bounds between which a number is proven to lie."""

    lo: float
    hi: float

    @property
    def width(self) -> float:
        """The distance between the bounds."""
        return self.hi - self.lo

    @property
    def middle(self) -> float:
        """The number in the middle of the bounds."""
        return (self.lo + self.hi) / 2

    def __contains__(self, number: object) -> bool:
        return isinstance(number, (int, float)) and self.lo <= number <= self.hi


class Enclosure(NamedTuple):
    """Bounds of a function over boxes, and facts about it there. True is proven; False claims
    nothing.
    """

    lo: Floats
    """Lower bounds of all values in a box; infinite for an undefined function."""
    hi: Floats
    """Upper bounds."""
    undefined: npt.NDArray[np.bool_]
    """The function has a value nowhere in the box."""
    defined: npt.NDArray[np.bool_]
    """The function has a value everywhere in the box."""
    continuous: npt.NDArray[np.bool_]
    """The function is defined and continuous in the whole box."""

    @property
    def may_vanish(self) -> npt.NDArray[np.bool_]:
        """Whether a box may hold a zero. False is a proof that it holds none."""
        found = (self.lo <= 0) & (0 <= self.hi)
        return np.asarray(found)


class Trace(NamedTuple):
    """What is proven of rays. Distances count in lengths of a ray's direction."""

    t: Floats
    """Where a picture draws the surface; infinite where it draws none."""
    status: npt.NDArray[np.uint8]
    """`MISS` and `HIT` are proven; `UNDECIDED` is neither."""
    bracket: Floats
    """Bounds (…, 2) of the first zero of a hit. For an undecided ray, the first number is a
    distance up to which there is no zero. NaN elsewhere.
    """


@dataclass(frozen=True)
class Measures:
    """Measures of a surface. Intervals are proven to hold the exact number. A measure that was not
    asked for is None.
    """

    name: str
    """The formula as it was read."""
    volume: Interval | None
    """The volume of a solid."""
    mass: Interval | None
    """The mass of a solid, if there is a density. Where this has no value, it counts as 0."""
    centroid: tuple[Interval, Interval, Interval] | None
    moments: tuple[Interval, Interval, Interval] | None
    """Moments of inertia about the axes through the centroid along x, y and z. The density is 1
    unless it is given.
    """
    corners: tuple[tuple[Interval, ...], tuple[Interval, ...]] | None
    """The least and the greatest x, y and z."""
    area_bounds: Interval | None
    """The area, if `only` names it. Its end is infinite if nothing bounds the area from above. None
    also if the function has too many parts.
    """
    area: float | None
    """The area of a mesh: an estimate. None also if the mesh has no triangle, and the surface is
    not proven empty.
    """
    area_change: float | None
    """Difference from the area of a coarser mesh."""
    genus: tuple[int | None, ...] | None
    """The genus of each piece; None for one with a rim."""
    proven: bool | None
    """Whether the surface is proven to have the pieces of the mesh."""


class Surface:
    """The zero set of a formula, or all drawings of a text of several lines.

    `formula` is a text in the language of the program `zeroset`, a SymPy expression or equation, or
    a Python function of x, y and z, or of x and y, that uses NumPy's functions. What a function
    computes is recorded. `values` are parameters: names in the formula that get these values.

    Raises `Error` if the formula cannot be read. Its message shows the place.

    >>> torus = Surface("(hypot(x, y) - 2)^2 + z^2 = r^2", r=0.5)
    >>> torus.parameters
    {'r': 0.5}
    >>> torus.set(r=1.0)
    >>> float(torus(2, 0, 0))
    -1.0
    >>> wave = Surface(lambda x, y, z: np.sin(x) * y + z**2)
    >>> wave.text
    '((sin(x) * y) + (z ^ (2)))'
    """

    def __init__(self, formula: str | Callable[..., Any] | Any, /, **values: float) -> None:
        text = _text(formula, values)
        scene, known = None, set()
        try:
            scene = _zeroset.Scene(text)
            known = {name for name, _, _ in scene.parameters}
        except Error:
            # A text that lacks a value cannot be read yet.
            if not values:
                raise
        lines = [f"{name} = {float(values[name])!r}" for name in values if name not in known]
        if scene is None or lines:
            scene = _zeroset.Scene("\n".join([text, *lines]))
        self._scene = scene
        self.set(**{name: value for name, value in values.items() if name in known})

    @property
    def text(self) -> str:
        """The text of the formula, with a line for each value that it was given."""
        return self._scene.text

    @property
    def surfaces(self) -> list[str]:
        """The surfaces as they were read, one line each."""
        return self._scene.surfaces

    @property
    def notes(self) -> list[str]:
        """Places where the text could have been meant otherwise."""
        return self._scene.notes

    @property
    def parameters(self) -> dict[str, float]:
        """The parameters and their values."""
        return {name: value for name, value, _ in self._scene.parameters}

    @property
    def ranges(self) -> dict[str, Interval]:
        """The ranges that the text gives to parameters."""
        rows = self._scene.parameters
        return {name: Interval(*ends) for name, _, ends in rows if ends is not None}

    @property
    def domain(self) -> tuple[Interval, Interval, Interval]:
        """The box in which zeros are looked for: that of the text, or else one that is found."""
        x, y, z = (Interval(*ends) for ends in self._scene.domain())
        return x, y, z

    def set(self, **values: float) -> None:
        """Sets parameters. Within the range that the text gives, nothing is compiled.

        Raises `Error` if the text has no such parameter.
        """
        for name, value in values.items():
            self._scene.set(name, float(value))

    def __call__(
        self,
        x: npt.ArrayLike,
        y: npt.ArrayLike | None = None,
        z: npt.ArrayLike | None = None,
    ) -> Floats:
        """Values of f, float64 without an error bound; NaN where f is undefined.

        The arguments are broadcast. A single argument is an array of points (…, 3). An equation
        a = b has the function a - b.
        """
        axes, shape = _axes(x, y, z)
        flat_x, flat_y, flat_z = (np.ascontiguousarray(axis).ravel() for axis in axes)
        values = np.empty(flat_x.shape)
        self._scene.values(flat_x, flat_y, flat_z, values)
        return values.reshape(shape)

    def gradient(
        self,
        x: npt.ArrayLike,
        y: npt.ArrayLike | None = None,
        z: npt.ArrayLike | None = None,
    ) -> Floats:
        """Gradients of f, float64 (…, 3) without an error bound; NaN where there is none."""
        axes, shape = _axes(x, y, z)
        points = np.stack(axes, axis=-1).reshape(-1, 3)
        return self._scene.gradients(points).reshape((*shape, 3))

    def enclose(self, lo: npt.ArrayLike, hi: npt.ArrayLike) -> Enclosure:
        """Proven bounds of f over boxes, given by their lower and upper corners (…, 3).

        >>> Surface("x^2+y^2+z^2 = 1").enclose([0, 0, 2], [0.5, 0.5, 3]).lo
        array(3.)
        """
        low, high = np.broadcast_arrays(_array(lo), _array(hi))
        shape = low.shape[:-1]
        bounds, facts = self._scene.enclosures(_rows(low, "lo"), _rows(high, "hi"))
        below, above = (bound.reshape(shape) for bound in bounds)
        undefined, defined, continuous = (
            (facts >> bit & 1).astype(bool).reshape(shape) for bit in range(3)
        )
        return Enclosure(below, above, undefined, defined, continuous)

    def trace(
        self,
        origins: npt.ArrayLike,
        directions: npt.ArrayLike,
        *,
        domain: Domain | None = None,
        method: str | None = None,
        precision: str | None = None,
        accuracy: float | None = None,
    ) -> Trace:
        """What is proven of the rays ``origin + t * direction``, t >= 0, within the domain.

        Both arrays are (…, 3) and are broadcast. Neighboring rays are best given in a row.
        `accuracy` is the largest distance of a drawn point from the zero, by default a millionth
        of the domain's largest extent.

        >>> Surface("x^2+y^2+z^2 = 1").trace([0, 0, 5], [[0, 0, -1], [0, 0, 1]]).status
        array([1, 0], dtype=uint8)
        """
        start, along = np.broadcast_arrays(_array(origins), _array(directions))
        shape = start.shape[:-1]
        (t, near, far), status = self._scene.rays(
            _rows(start, "origins"),
            _rows(along, "directions"),
            region=domain,
            method=method,
            precision=precision,
            accuracy=accuracy,
        )
        bracket = np.stack((near, far), axis=-1).reshape((*shape, 2))
        return Trace(t.reshape(shape), status.reshape(shape), bracket)

    def render(
        self,
        width: int = 640,
        height: int = 480,
        *,
        domain: Domain | None = None,
        view: str | None = None,
        eye: Sequence[float] | None = None,
        target: Sequence[float] | None = None,
        up: Sequence[float] | None = None,
        fov: float | None = None,
        orthographic: float | None = None,
        look: str | None = None,
        background: tuple[int, int, int] | Literal["transparent"] | None = None,
        light: Sequence[float] | None = None,
        occlusion: bool | None = None,
        antialias: int | None = None,
        bits: int | None = None,
        undecided: str | None = None,
        title: str | None = None,
        method: str | None = None,
        precision: str | None = None,
        max_depth: int | None = None,
        steps: int | None = None,
        tolerance: float | None = None,
        budget: float | None = None,
        progress: Callable[[str, int], object] | None = None,
        **choices: float | bool | None,
    ) -> Picture:
        """A picture, with what is proven of each pixel.

        `domain` is half the edge of a cube, ranges of x, y and z, or ``"auto"``. `view` is one of
        `views()`; `fov` is in degrees; `orthographic` is the height of a parallel projection, in
        units of the surface. `look` is one of `looks()`, `method` one of `methods()`.
        `background` has bytes of red, green and blue, or is ``"transparent"``. `undecided`
        is the appearance of undecided pixels: ``"shade"``, ``"hatch"``, ``"tint"`` or ``"miss"``.
        With 16 `bits` per channel, the picture also has ``light``. `choices` are named by
        `choices()`, such as ``haze=0.5`` and ``ground=True``.
        `precision` is ``"auto"``, ``"f32"`` or ``"f64"``; `budget` is in seconds. An interrupt
        from the keyboard ends the work. `progress` is called with the stage, such as ``"tracing"``
        or ``"smoothing"``, and the percent of its pixels that are done, whenever these have
        changed. Its exception ends the work.
        """
        own = {"self", "width", "height", "choices", "progress"}
        named = {k: v for k, v in locals().items() if k not in own | {"own"}}
        options = {k: v for k, v in (named | choices).items() if v is not None}
        return self._scene.render(width, height, options, progress=progress)

    def mesh(
        self,
        tolerance: float | None = None,
        *,
        domain: Domain | None = None,
        estimate: bool = False,
        full: bool = False,
        budget: float | None = None,
    ) -> Mesh:
        """Triangles no farther than `tolerance` from the surface, by default a thousandth of the
        domain's diagonal. With `estimate`, nothing is proven, and many are done several times as
        fast. With `full`, all triangles of the first mesh stay.
        """
        return self._scene.mesh(
            region=domain, tolerance=tolerance, estimate=estimate, full=full, budget=budget
        )

    def measure(
        self,
        *,
        domain: Domain | None = None,
        only: Iterable[str] | None = None,
        relative: float | None = None,
        density: str | None = None,
        budget: float | None = None,
    ) -> list[Measures]:
        """Measures of each surface. `only` names those to compute, of `"volume"`, `"mass"`,
        `"centroid"`, `"inertia"`, `"ends"`, `"area"` and `"shape"`: all by default. `relative` is
        the width of the bounds of a volume, as a share of it: 0.001 by default. `density` is a
        formula that weights mass, centroid and moments.

        >>> ball = Surface("x^2+y^2+z^2 <= 1")
        >>> 4.18879 in ball.measure(relative=0.01)[0].volume
        True
        >>> 2.51327 in ball.measure(only="mass", relative=0.01, density="x^2+y^2+z^2")[0].mass
        True
        """
        if isinstance(only, str):
            only = [only]
        names = None if only is None else list(only)
        rows = self._scene.measure(
            region=domain, only=names, relative=relative, density=density, budget=budget
        )
        return [Measures(**{key: _intervals(value) for key, value in row.items()}) for row in rows]

    def explore(self, width: int = 512, height: int = 512, **options: Any) -> Explorer:
        """A widget in which the surface is turned, typed anew, and moved by sliders. `options` are
        those of `render`. Needs anywidget.
        """
        try:
            from ._explorer import Explorer
        except ImportError as error:
            raise ImportError("explore needs anywidget: pip install anywidget") from error
        return Explorer(self, width, height, **options)

    def _repr_png_(self) -> bytes:
        return self.render().png()

    def __reduce__(self) -> tuple[Any, ...]:
        # Other processes compile it anew.
        return _again, (type(self), self.text, self.parameters)

    def __repr__(self) -> str:
        return f"<{type(self).__name__} {'; '.join(self.surfaces)}>"


class Parametric(Surface):
    """A surface that is given by its points, for all values of two parameters between their ends.

    `formula` is a Python function of the parameters that returns x, y and z and uses NumPy's
    functions; or three coordinates, as texts, numbers and SymPy expressions; or a text. A pair with
    the name of a parameter is its range. A number is a value, as for `Surface`. A text may have its
    ranges itself: ``(cos u, sin u, v) for u in [0, 2pi], v in [-1, 1]``.

    Ends are numbers, SymPy expressions or texts such as ``"2pi"``. Numbers are exact, but for
    multiples of pi/12: `math.tau` is 2π. So what closes at 2π has no gap.

    All that draws or meshes a surface does so with this one. It has no values at points, rays and
    measures.

    >>> tube = Parametric(lambda u, v: (np.cos(u), np.sin(u), v), u=(0, 2 * np.pi), v=(-1, 1))
    >>> tube.text
    '(cos(u), sin(u), v) for u in [0, 2*pi], v in [-1, 1]'
    >>> tube.render(64, 64)
    <Picture 64x64: ... hits, ... misses, 0 undecided>
    """

    def __init__(self, formula: Any, /, **names: Any) -> None:
        values = {name: float(value) for name, value in names.items() if isinstance(value, Real)}
        ranges = {name: value for name, value in names.items() if name not in values}
        super().__init__(parametric(formula, ranges, values), **values)
        if not any(re.search(_RANGES, line) for line in self.surfaces):
            raise Error(
                "the text has no parametric surface: write (x, y, z) for u in [0, 1], v in [0, 1], "
                "or give u=(0, 1) and v=(0, 1) beside the coordinates"
            )


# How the line of a parametric surface ends.
_RANGES = r"\) for \w+ in \[.*\], \w+ in \[.*\]$"


def _again(kind: type[Surface], text: str, values: dict[str, float]) -> Surface:
    surface = kind(text)
    surface.set(**values)
    return surface


def explore(
    formula: str | Callable[..., Any] | Any,
    /,
    width: int = 512,
    height: int = 512,
    *,
    options: Mapping[str, Any] | None = None,
    **values: float,
) -> Explorer:
    """A widget for a formula; see `Surface` and `Surface.explore`. `values` are parameters, which
    have sliders; `options` are those of `Surface.render`.
    """
    return Surface(formula, **values).explore(width, height, **(options or {}))


def plot(
    *formulas: str | Callable[..., Any] | Any, width: int = 640, height: int = 480, **options: Any
) -> Picture:
    """A picture of several surfaces. `options` are those of `Surface.render`.

    >>> plot("x^2+y^2+z^2 = 1", "z = x*y {x^2+y^2 < 4}", width=64, height=64)
    <Picture 64x64: ...>
    """
    if not formulas:
        raise Error("plot needs a formula")
    texts = [
        formula.text if isinstance(formula, Surface) else _text(formula, {}) for formula in formulas
    ]
    return Surface("\n".join(texts)).render(width, height, **options)


def examples() -> dict[str, str]:
    """Names and texts of the gallery's surfaces."""
    return dict(_zeroset.gallery())


def example(name: str) -> Surface:
    """A surface of the gallery."""
    texts = examples()
    if name not in texts:
        raise Error(f"the gallery has no surface {name!r}: {', '.join(texts)}")
    return Surface(texts[name])


def methods() -> dict[str, str]:
    """Names of the methods that find surfaces, each with a line of help."""
    return dict(_zeroset.methods())


def looks() -> dict[str, str]:
    """Names of the looks, each with a line of help."""
    return dict(_zeroset.looks())


def choices() -> dict[str, str]:
    """Names of the choices for a picture, each with its values and its default."""
    return dict(_zeroset.choices())


def _name_choices(function: Any) -> None:
    """Names the choices in a function's signature, for help and completion."""
    signature = inspect.signature(function)
    *own, _ = signature.parameters.values()
    kind = inspect.Parameter.KEYWORD_ONLY
    named = [inspect.Parameter(name, kind, default=None) for name in choices()]
    function.__signature__ = signature.replace(parameters=[*own, *named])


_name_choices(Surface.render)


def views() -> list[str]:
    """Names of the sides from which to look."""
    return _zeroset.views()


def _text(formula: Any, values: Mapping[str, float]) -> str:
    if isinstance(formula, str):
        return formula
    if is_of_sympy(formula):
        return from_sympy(formula)
    if callable(formula):
        return traced(formula, dict(values))
    kind = type(formula).__name__
    raise Error(f"a formula is a text, a SymPy expression or a function, not a {kind}")


def _array(values: npt.ArrayLike) -> Floats:
    return np.asarray(values, dtype=np.float64)


def _rows(points: Floats, name: str) -> Floats:
    if points.ndim == 0 or points.shape[-1] != 3:
        raise Error(f"{name} has the shape {points.shape}, not (…, 3)")
    return np.ascontiguousarray(points).reshape(-1, 3)


def _axes(
    x: npt.ArrayLike, y: npt.ArrayLike | None, z: npt.ArrayLike | None
) -> tuple[tuple[Floats, ...], tuple[int, ...]]:
    """Coordinates as arrays of one shape, and that shape."""
    if y is None and z is None:
        points = _array(x)
        if points.ndim == 0 or points.shape[-1] != 3:
            raise Error(f"points has the shape {points.shape}, not (…, 3)")
        return (points[..., 0], points[..., 1], points[..., 2]), points.shape[:-1]
    if y is None or z is None:
        raise Error("give x, y and z, or one array of points (…, 3)")
    axes = np.broadcast_arrays(_array(x), _array(y), _array(z))
    return tuple(axes), axes[0].shape


def _intervals(value: Any) -> Any:
    """Pairs of floats, however deep in lists, as intervals."""
    if isinstance(value, (list, tuple)):
        if len(value) == 2 and all(isinstance(end, float) for end in value):
            return Interval(*value)
        return tuple(map(_intervals, value))
    return value
