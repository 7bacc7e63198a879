"""Implicit surfaces: type any ``f(x, y, z) = 0`` and see it, with a proof for every pixel.

>>> import zeroset as zs
>>> sphere = zs.Surface("x^2 + y^2 + z^2 = 1")
>>> float(sphere(0, 0, 2))
3.0
>>> sphere.render(64, 64)
<Picture 64x64: ... hits, ... misses, 0 undecided>
"""

from ._formula import Expression
from ._surface import (
    HIT,
    MISS,
    UNDECIDED,
    Enclosure,
    Interval,
    Measures,
    Parametric,
    Surface,
    Trace,
    choices,
    example,
    examples,
    explore,
    looks,
    methods,
    plot,
    views,
)
from ._zeroset import Error, Mesh, Picture, SurfaceMesh, __version__

__all__ = [
    "HIT",
    "MISS",
    "UNDECIDED",
    "Enclosure",
    "Error",
    "Expression",
    "Interval",
    "Measures",
    "Mesh",
    "Parametric",
    "Picture",
    "Surface",
    "SurfaceMesh",
    "Trace",
    "__version__",
    "choices",
    "example",
    "examples",
    "explore",
    "looks",
    "methods",
    "plot",
    "views",
]
