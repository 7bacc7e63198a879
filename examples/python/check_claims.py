"""Checks the claims of a picture with the ball arithmetic of FLINT. Nothing of zeroset is used.

    zeroset render "x^2+y^2+z^2 = 1" --size 64 --claims sphere.jsonl
    pip install python-flint
    python check_claims.py sphere.jsonl

A miss claims: no visible surface has a zero on the ray within the domain. A hit claims: the first
zero lies between the two distances of its bracket. A solid's first point counts as its zero. Each
claim is confirmed, refuted, or not decided with the allowed number of evaluations. Exits with
status 1 if a claim is refuted.

Balls hold all values that a function takes on a part of a ray. Where a ball holds no 0, there is no
zero. Where a function has both signs and is continuous in between, there is one.

A parametric surface is divided into cells of its parameters. Its points on the ray are those on two
planes that meet there. So they are zeros of two functions of the parameters: a cell has none where
a ball holds no 0, and it has one if Krawczyk's test proves it.
"""

import argparse
import json
import math
import sys
from collections import Counter
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise
from multiprocessing import Pool

from flint import arb, ctx, fmpq

ctx.prec = 100
NONE = arb.nan()


@dataclass(slots=True)
class Jet:
    """A function on a part of a ray: a ball of its values, and one of its slopes (NaN if unknown).

    With a `pole`, the function is v/pole. So it has no zero where `v` has none. `total`: it is
    defined and continuous on the whole part. `void`: it is defined nowhere on it.
    """

    v: arb
    d: arb = NONE
    total: bool = True
    pole: "Jet | None" = None
    void: bool = False


UNKNOWN = Jet(NONE, NONE, False)
VOID = Jet(NONE, NONE, False, None, True)


def number(value):
    return Jet(value, arb(0))


def hull(a, b):
    return a.union(b) if a.is_finite() and b.is_finite() else NONE


def whole(a):
    """The function without a separate pole."""
    if a.pole is None:
        return a
    b = a.pole
    if b.v.contains(0):
        return UNKNOWN
    return Jet(a.v / b.v, (a.d - a.v / b.v * b.d) / b.v, a.total and b.total)


def neg(a):
    return Jet(-a.v, -a.d, a.total, a.pole)


def add(a, b):
    if a.pole or b.pole:
        p, q = a.pole or number(arb(1)), b.pole or number(arb(1))
        above = add(mul(Jet(a.v, a.d, a.total), q), mul(Jet(b.v, b.d, b.total), p))
        return Jet(above.v, above.d, above.total, mul(p, q))
    return Jet(a.v + b.v, a.d + b.d, a.total and b.total)


def sub(a, b):
    return add(a, neg(b))


def mul(a, b):
    pole = None
    if a.pole or b.pole:
        pole = mul(a.pole, b.pole) if a.pole and b.pole else a.pole or b.pole
    return Jet(a.v * b.v, a.d * b.v + a.v * b.d, a.total and b.total, pole)


def div(a, b):
    b = whole(b)
    return mul(a, Jet(arb(1), arb(0), True, b)) if b.v.is_finite() else UNKNOWN


def sqr(a):
    pole = sqr(a.pole) if a.pole else None
    return Jet(a.v**2, 2 * a.v * a.d, a.total, pole)


def power(a, b):
    b = whole(b)
    exponent = b.v.unique_fmpz() if b.v.is_exact() else None
    if exponent is not None:
        n = abs(int(exponent))
        pole = power(a.pole, number(arb(n))) if a.pole else None
        result = Jet(a.v**n, n * a.v ** (n - 1) * a.d if n else arb(0), a.total, pole)
        return result if exponent >= 0 else div(number(arb(1)), result)
    a = whole(a)
    if a.v > 0:
        return function(arb.exp, arb.exp)(mul(b, function(arb.log, lambda v: 1 / v)(a)))
    if a.v >= 0 and b.v.is_exact() and b.v > 0:
        return Jet(arb(0).union(a.v.upper() ** b.v), NONE, a.total)
    return VOID if a.v < 0 else UNKNOWN


def function(f, slope):
    """A function that is smooth wherever it is defined, and NaN elsewhere."""

    def apply(a):
        a = whole(a)
        v = f(a.v)
        return Jet(v, slope(a.v) * a.d, a.total and v.is_finite())

    return apply


def sqrt(a):
    a = whole(a)
    if a.v > 0:
        return Jet(a.v.sqrt(), a.d / (2 * a.v.sqrt()), a.total)
    upper = a.v.upper()
    if not upper.is_finite():
        return UNKNOWN
    return Jet(arb(0).union(upper.max(arb(0)).sqrt()), NONE, a.total and a.v >= 0)


def cbrt(a):
    a = whole(a)
    if a.v < 0:
        return neg(cbrt(neg(a)))
    if a.v > 0:
        root = a.v.root(3)
        return Jet(root, a.d / (3 * root**2), a.total)
    end = a.v.abs_upper().root(3)
    return Jet((-end).union(end), NONE, a.total)


def magnitude(a):
    a = whole(a)
    if a.v > 0 or a.v < 0:
        return a if a.v > 0 else neg(a)
    return Jet(abs(a.v), hull(a.d, -a.d), a.total)


def extremum(name):
    def apply(a, b):
        a, b = whole(a), whole(b)
        total = a.total and b.total
        if a.v < b.v or b.v < a.v:
            least, most = (a, b) if a.v < b.v else (b, a)
            chosen = least if name == "min" else most
            return Jet(chosen.v, chosen.d, total)
        return Jet(getattr(a.v, name)(b.v), hull(a.d, b.d), total)

    return apply


def floor(a):
    a = whole(a)
    v = a.v.floor()
    return Jet(v, arb(0), a.total) if v.is_exact() else Jet(v, NONE, False)


def trunc(a):
    a = whole(a)
    if abs(a.v) < 1:
        return Jet(arb(0), arb(0), a.total)
    if a.v >= 0 or a.v <= 0:
        return floor(a) if a.v >= 0 else neg(floor(neg(a)))
    return Jet(hull(a.v.floor(), -(-a.v).floor()), NONE, False)


def nearest(a):
    found = floor(add(a, number(arb(0.5))))
    # Halves go to even numbers.
    return found if found.v.is_exact() else Jet(hull(found.v, found.v - 1), NONE, False)


def sign(a):
    a = whole(a)
    one = arb(1) if a.v > 0 else arb(-1) if a.v < 0 else None
    return Jet(arb(0, 1), NONE, False) if one is None else Jet(one, arb(0), a.total)


def atan2(y, x):
    y, x = whole(y), whole(x)
    slope = (x.v * y.d - y.v * x.d) / (x.v**2 + y.v**2)
    if x.v > 0:
        v = (y.v / x.v).atan()
    elif y.v > 0 or y.v < 0:
        v = (arb.pi() / 2 if y.v > 0 else -arb.pi() / 2) - (x.v / y.v).atan()
    else:
        return Jet(arb(0, 4), NONE, False)
    return Jet(v, slope, y.total and x.total)


def choose(a, b, c):
    a = whole(a)
    if a.total and (a.v < 0 or a.v >= 0):
        return b if a.v < 0 else c
    return either(b, c)


def either(a, b):
    """One of two functions at each place, but only one that is defined there."""
    a, b = whole(b if a.void else a), whole(a if b.void else b)
    return a if a.void else Jet(hull(a.v, b.v), NONE, False)


def otherwise(a, b):
    return a if whole(a).total else b if a.void else either(a, b)


def where(holds):
    def apply(a, b):
        b = whole(b)
        return Jet(a.v, a.d, a.total and b.total and holds(b.v), a.pole)

    return apply


def bessel(n):
    def slope(v):
        return (v.bessel_j(n - 1) - v.bessel_j(n + 1)) / 2

    return function(lambda v: v.bessel_j(n), slope)


sine, cosine = function(arb.sin, arb.cos), function(arb.cos, lambda v: -v.sin())
OPERATIONS = {
    "neg": neg,
    "add": add,
    "sub": sub,
    "mul": mul,
    "div": div,
    "sqr": sqr,
    "pow": power,
    "sqrt": sqrt,
    "cbrt": cbrt,
    "abs": magnitude,
    "min": extremum("min"),
    "max": extremum("max"),
    "floor": floor,
    "ceil": lambda a: neg(floor(neg(a))),
    "round": nearest,
    "trunc": trunc,
    "fract": lambda a: sub(a, floor(a)),
    "mod": lambda a, b: sub(a, mul(b, floor(div(a, b)))),
    "sign": sign,
    "exp": function(arb.exp, arb.exp),
    "ln": function(arb.log, lambda v: 1 / v),
    "log2": function(lambda v: v.log() / arb(2).log(), lambda v: 1 / (v * arb(2).log())),
    "log10": function(lambda v: v.log() / arb(10).log(), lambda v: 1 / (v * arb(10).log())),
    "sin": sine,
    "cos": cosine,
    "tan": lambda a: div(sine(a), cosine(a)),
    "asin": function(arb.asin, lambda v: 1 / (1 - v**2).sqrt()),
    "acos": function(arb.acos, lambda v: -1 / (1 - v**2).sqrt()),
    "atan": function(arb.atan, lambda v: 1 / (1 + v**2)),
    "sinh": function(arb.sinh, arb.cosh),
    "cosh": function(arb.cosh, arb.sinh),
    "tanh": function(arb.tanh, lambda v: 1 / v.cosh() ** 2),
    "asinh": function(arb.asinh, lambda v: 1 / (1 + v**2).sqrt()),
    "acosh": function(arb.acosh, lambda v: 1 / (v**2 - 1).sqrt()),
    "atanh": function(arb.atanh, lambda v: 1 / (1 - v**2)),
    "erf": function(arb.erf, lambda v: 2 / arb.pi().sqrt() * (-(v**2)).exp()),
    "besselj0": bessel(0),
    "besselj1": bessel(1),
    "besselj2": bessel(2),
    "besselj3": bessel(3),
    "atan2": atan2,
    "select_negative": choose,
    "otherwise": otherwise,
    "where_nonneg": where(lambda v: v >= 0),
    "where_positive": where(lambda v: v > 0),
    "where_nonzero": where(lambda v: not v.contains(0)),
    "where_defined": where(lambda _: True),
}
# Where the last operand is so, the operation is defined nowhere.
EMPTY = {
    "sqrt": lambda v: v < 0,
    "ln": lambda v: v <= 0,
    "log2": lambda v: v <= 0,
    "log10": lambda v: v <= 0,
    "asin": lambda v: abs(v) > 1,
    "acos": lambda v: abs(v) > 1,
    "acosh": lambda v: v < 1,
    "atanh": lambda v: abs(v) >= 1,
    "div": lambda v: v == 0,
    "mod": lambda v: v == 0,
    "where_nonneg": lambda v: v < 0,
    "where_positive": lambda v: v <= 0,
    "where_nonzero": lambda v: v == 0,
}
NAMES = {
    "pi": arb.pi(),
    "tau": 2 * arb.pi(),
    "e": arb(1).exp(),
    "phi": (1 + arb(5).sqrt()) / 2,
}


def constant(step):
    match step:
        case ["number", text]:
            return number(arb(fmpq(*map(int, text.split("/")))))
        case ["between", low, high]:
            return number(arb(low).union(arb(high)))
        case [name] if name in NAMES:
            return number(NAMES[name])
    return None


def needed(steps, roots):
    """The places of all steps that these use, in order."""
    found = set(roots)
    for k in reversed(range(len(steps))):
        if k in found and steps[k][0] in OPERATIONS:
            found.update(steps[k][1:])
    return sorted(found)


def apply(name, operands):
    needed = {"select_negative": operands[:1], "otherwise": []}.get(name, operands)
    if any(operand.void for operand in needed):
        return VOID
    if name in EMPTY and EMPTY[name](whole(operands[-1]).v):
        return VOID
    return OPERATIONS[name](*operands)


class Patch:
    """A parametric surface. Each parameter is low + (high - low)·share for a share from 0 to 1."""

    MOST_CELLS = 100_000

    def __init__(self, scene, surface):
        self.scene, self.steps = scene, surface["steps"]
        self.needed = needed(scene.steps, self.steps)
        ends = [end for pair in surface["ranges"] for end in pair]
        values = scene.values(needed(scene.steps, ends), {})
        self.ranges = [[whole(values[k]).v for k in pair] for pair in surface["ranges"]]
        self.begin()

    def begin(self):
        """Forgets all cells but the first."""
        self.count = 0
        self.root = Cell(self, [arb(0).union(arb(1))] * 2, [(0.0, 1.0)] * 2)

    def at(self, shares, slopes):
        """The coordinates, for these shares and their slopes."""
        places = {}
        for k, (low, high) in enumerate(self.ranges):
            places["parameter", k] = Jet(low + (high - low) * shares[k], (high - low) * slopes[k])
        values = self.scene.values(self.needed, places)
        return [whole(values[k]) for k in self.steps]


class Cell:
    """A part of a parametric surface, for shares in two balls.

    Each coordinate is in a ball of `values`, and in middle + a·U + b·V for U and V in [-1, 1].
    """

    UNIT = arb(0, 1)
    # Cells overlap by this share of their size. So points at edges are not missed.
    OVERLAP = 1 / 8

    def __init__(self, patch, shares, square=None):
        self.patch, self.shares, self.square = patch, shares, square
        self.parts = None
        sizes = [share.rad() for share in shares]
        along_u = patch.at(shares, [sizes[0], arb(0)])
        along_v = patch.at(shares, [arb(0), sizes[1]])
        middle = patch.at([share.mid() for share in shares], [arb(0)] * 2)
        self.void = any(jet.void for jet in along_u)
        self.total = all(jet.total for jet in along_u)
        self.middle = [jet.v for jet in middle]
        self.a, self.b = [jet.d for jet in along_u], [jet.d for jet in along_v]
        self.is_smooth = all(one.is_finite() for one in self.middle + self.a + self.b)
        linear = [
            m + a * self.UNIT + b * self.UNIT
            for m, a, b in zip(self.middle, self.a, self.b, strict=True)
        ]
        self.values = [
            min(jet.v, one, key=arb.rad) for jet, one in zip(along_u, linear, strict=True)
        ]

    def part(self, places):
        """The part of the cell for these balls of U and V."""
        shares = zip(self.shares, places, strict=True)
        return Cell(self.patch, [share.mid() + share.rad() * place for share, place in shares])

    def halves(self):
        """Two cells that cover this one."""
        if self.parts is None:
            sizes = [high - low for low, high in self.square]
            if self.is_smooth:
                sizes = [sum(abs(one).upper() for one in slopes) for slopes in (self.a, self.b)]
            cut = 0 if sizes[0] > sizes[1] else 1
            low, high = self.square[cut]
            middle = (low + high) / 2
            self.parts = [self.half(cut, low, middle), self.half(cut, middle, high)]
            self.patch.count += 2
        return self.parts

    def half(self, cut, low, high):
        shares, square = list(self.shares), list(self.square)
        square[cut] = low, high
        margin = (high - low) * self.OVERLAP
        shares[cut] = arb(low - margin).union(arb(high + margin))
        return Cell(self.patch, shares, square)


class Ray:
    """The surfaces on a ray. Cells are parts of it, as pairs of floats of its parameter t."""

    def __init__(self, scene, claim):
        self.scene = scene
        self.origin, self.direction = claim["origin"], claim["direction"]
        self.left = scene.effort
        self.start, self.along = (list(map(arb, claim[name])) for name in ("origin", "direction"))
        *others, main = sorted(range(3), key=lambda k: abs(self.direction[k]))
        self.axes = main, others

    def values(self, low, high):
        """All steps on a cell."""
        self.left -= 1
        t = arb(low) if low == high else arb(low).union(arb(high))
        axes = zip("xyz", self.origin, self.direction, strict=True)
        places = {(name,): Jet(arb(o) + arb(d) * t, arb(d)) for name, o, d in axes}
        return self.scene.values(self.scene.needed, places)

    def side(self, surface, low, high=None):
        """1 or -1 if the function, or v above its pole, has only this sign on a cell.

        1 if the function is defined nowhere on the cell, and else 0.
        """
        found = self.values(low, low if high is None else high)[surface["step"]]
        if found.void:
            return 1
        v = found.v
        if not (v > 0 or v < 0) and high is not None and found.d.is_finite():
            middle = low + (high - low) / 2
            at = self.values(middle, middle)[surface["step"]]
            if (at.pole is None) == (found.pole is None):
                v = at.v + found.d * (arb(low).union(arb(high)) - arb(middle))
        if surface["kind"] == "solid" and self.scene.outside and found.pole:
            v = whole(found).v
        return 1 if v > 0 else -1 if v < 0 else 0

    def is_free(self, surface, low, high):
        """Whether a surface has no zero on a cell: True, False if there is one, None if unknown."""
        if surface["kind"] == "parametric":
            return self.is_free_of(surface["patch"], low, high)
        is_solid = surface["kind"] == "solid" and self.scene.outside
        cells = [(low, high)] if low <= high else []
        while cells:
            low, high = cells.pop()
            side = self.side(surface, low, high)
            if is_solid and side < 0:
                return False
            if side:
                continue
            middle = low + (high - low) / 2
            if self.left <= 0 or not low < middle < high:
                return None
            cells += [(middle, high), (low, middle)]
        return True

    def has_zero(self, surface, low, high, parts=8):
        """Whether a surface is proven to have a zero on a cell."""
        if surface["kind"] == "parametric":
            return self.is_free(surface, low, high) is False
        places = [low + (high - low) * k / parts for k in range(parts)] + [high]
        sides = [self.side(surface, place) for place in places]
        if surface["kind"] == "solid" and self.scene.outside:
            return -1 in sides
        known = [(place, side) for place, side in zip(places, sides, strict=True) if side]
        pairs = pairwise(known)
        return any(a[1] != b[1] and self.is_continuous(surface, a[0], b[0]) for a, b in pairs)

    def is_continuous(self, surface, low, high):
        cells = [(low, high)]
        for _ in range(64):
            if not cells:
                return True
            low, high = cells.pop()
            if not whole(self.values(low, high)[surface["step"]]).total:
                middle = low + (high - low) / 2
                cells += [(low, middle), (middle, high)]
        return False

    def is_free_of(self, patch, low, high):
        """As `is_free`, for a parametric surface."""
        if patch.count > patch.MOST_CELLS:
            patch.begin()
        cells, is_known = [patch.root] if low <= high else [], True
        while cells:
            cell = cells.pop()
            self.left -= 1
            if cell.void or self.has_point(cell, low, high) is False:
                continue
            places = self.krawczyk(cell)
            if any(abs(place) > 1 for place in places):
                continue
            if cell.total and places and all(abs(place) < 1 for place in places):
                found = self.has_point_where(cell, places, low, high)
                if found:
                    return False
                is_known = is_known and found is False
                continue
            if self.left <= 0 or min(high - low for low, high in cell.square) < 2**-40:
                is_known = False
            else:
                cells += cell.halves()
        return True if is_known else None

    def has_point(self, cell, low, high):
        """False if no point of a surface's cell is on a cell of the ray, None if one may be.

        If one is on the line of the ray: True if it is proven to be on the cell of the ray.
        """
        main, others = self.axes
        t = (cell.values[main] - self.start[main]) / self.along[main]
        if t < low or t > high or any(share < 0 or share > 1 for share in cell.shares):
            return False
        if any(not self.plane(k, cell.values, self.start).contains(0) for k in others):
            return False
        is_inside = (
            t >= low and t <= high and all(share >= 0 and share <= 1 for share in cell.shares)
        )
        return is_inside or None

    def has_point_where(self, cell, places, low, high):
        """As `has_point`, if a point of the cell is on the line, and all are in these `places`."""
        for _ in range(8):
            cell = cell.part(places)
            found = self.has_point(cell, low, high)
            places = self.krawczyk(cell)
            if found is not None or not all(abs(place) < 1 for place in places):
                return found
        return None

    def plane(self, k, point, origin=(0, 0, 0)):
        """A function of points that is 0 on a plane through the ray, if `origin` is its own."""
        main = self.axes[0]
        ahead = (point[main] - origin[main]) * self.along[k]
        return (point[k] - origin[k]) * self.along[main] - ahead

    def krawczyk(self, cell):
        """Balls of U and V for all points of a cell on the ray: empty if they are not known.

        If both balls are within (-1, 1), there is such a point where the surface is continuous.
        """
        if not cell.is_smooth:
            return []
        _, (i, j) = self.axes
        f = [self.plane(k, cell.middle, self.start) for k in (i, j)]
        a, b = ([self.plane(k, slopes) for k in (i, j)] for slopes in (cell.a, cell.b))
        (a0, a1), (b0, b1) = ([one.mid() for one in slopes] for slopes in (a, b))
        size = a0 * b1 - a1 * b0
        if size.contains(0):
            return []
        # With the inverse Y of the matrix in the middle, U = U - Y·(f + a·U + b·V) at a zero.
        u, v = ((y0 / size, y1 / size) for y0, y1 in [(b1, -b0), (-a1, a0)])
        return [
            (is_u - y0 * a[0] - y1 * a[1]) * cell.UNIT
            + (1 - is_u - y0 * b[0] - y1 * b[1]) * cell.UNIT
            - (y0 * f[0] + y1 * f[1])
            for (y0, y1), is_u in ((u, 1), (v, 0))
        ]

    def within(self):
        """A part of the ray that holds all of its points in the domain. None if there are none."""
        domain = self.scene.domain
        low, high = Fraction(0), None
        bounds = []  # pairs a, b with a·t <= b in the domain
        for o, d, a, b in zip(
            self.origin, self.direction, domain["low"], domain["high"], strict=True
        ):
            o, d = Fraction(o), Fraction(d)
            bounds += [(d, Fraction(b) - o), (-d, o - Fraction(a))]
        if clip := domain.get("clip"):
            normal = [Fraction(n) for n in clip["normal"]]
            along = sum(n * Fraction(d) for n, d in zip(normal, self.direction, strict=True))
            off = sum(n * Fraction(o) for n, o in zip(normal, self.origin, strict=True))
            bounds.append((along, Fraction(clip["offset"]) - off))
        for a, b in bounds:
            if a == 0 and b < 0:
                return None
            if a < 0:
                low = max(low, b / a)
            elif a > 0:
                high = b / a if high is None else min(high, b / a)
        if low > high:
            return None
        low, high = below(low), above(high)
        if ball := domain.get("ball"):
            # With p = origin - center: (p·d)/d² ± the root of ((p·d)/d²)² - (p² - radius²)/d².
            p = [
                Fraction(o) - Fraction(c) for o, c in zip(self.origin, ball["center"], strict=True)
            ]
            d = [Fraction(d) for d in self.direction]
            square = sum(d * d for d in d)
            half = -sum(p * d for p, d in zip(p, d, strict=True)) / square
            under = half**2 - (sum(p * p for p in p) - Fraction(ball["radius"]) ** 2) / square
            if under < 0:
                return None
            root = Fraction(math.isqrt(math.ceil(under * 4**80)) + 1, 2**80)
            low, high = max(low, below(half - root)), min(high, above(half + root))
        return (low, high) if low <= high else None


def below(value):
    near = float(value)
    return near if Fraction(near) <= value else math.nextafter(near, -math.inf)


def above(value):
    return -below(-value)


@dataclass
class Scene:
    """The first line of a file of claims."""

    header: dict
    effort: int

    def __post_init__(self):
        self.steps, self.domain = self.header["steps"], self.header["domain"]
        self.constants = [constant(step) for step in self.steps]
        self.surfaces = [one for one in self.header["surfaces"] if not one["hidden"]]
        for surface in self.surfaces:
            if surface["kind"] == "parametric":
                surface["patch"] = Patch(self, surface)
        self.needed = needed(self.steps, [one["step"] for one in self.surfaces if "step" in one])
        self.outside = True

    def values(self, places, known):
        """These steps, each after those that it uses. Variables or parameters are known."""
        values = {}
        for k in places:
            value = self.constants[k] or known.get(tuple(self.steps[k]))
            if value is None:
                name, *operands = self.steps[k]
                value = apply(name, [values[operand] for operand in operands])
            values[k] = value
        return values

    def judge(self, claim):
        """What is found of a claim, in words."""
        if claim["status"] == "undecided":
            return "claims nothing"
        ray = Ray(self, claim)
        within = ray.within()
        # From within the domain, a solid's surface is what is seen, and not its points.
        sides = zip(claim["origin"], self.domain["low"], self.domain["high"], strict=True)
        self.outside = not all(a <= o <= b for o, a, b in sides)
        if claim["status"] == "miss":
            if within is None:
                return "confirmed"
            found = [ray.is_free(surface, *within) for surface in self.surfaces]
            if all(found):
                return "confirmed"
            ray.left = self.effort
            wrong = any(ray.has_zero(surface, *within, parts=64) for surface in self.surfaces)
            return "refuted: there is a zero" if wrong else "not decided"
        if within is None:
            return "refuted: the ray does not meet the domain"
        length = sum(Fraction(d) ** 2 for d in claim["direction"])
        near, far = (Fraction(end) for end in claim["bracket"])
        # The parameter t of a distance is the distance over the root of `length`.
        size = Fraction(math.isqrt(math.floor(length * 4**200)), 2**200)
        near, far = max(below(near / size), within[0]), min(above(far / size), within[1])
        if near > far:
            return "refuted: the bracket is outside of the domain"
        if all(ray.is_free(surface, near, far) for surface in self.surfaces):
            return "refuted: there is no zero in the bracket"
        ray.left = self.effort
        before = [ray.is_free(surface, within[0], near) for surface in self.surfaces]
        ray.left = self.effort
        if any(ray.has_zero(surface, near, far) for surface in self.surfaces):
            if all(before):
                return "confirmed"
            ends = within[0], math.nextafter(near, -math.inf)
            if ends[0] < ends[1] and any(
                ray.has_zero(one, *ends, parts=64) for one in self.surfaces
            ):
                return "refuted: there is a zero before the bracket"
        return "not decided"


def begin(header, effort):
    """Gives the process a scene."""
    global scene
    scene = Scene(header, effort)


def check_pixels(lines):
    return [(claim["pixel"], scene.judge(claim)) for claim in map(json.loads, lines)]


def main():
    about, usage = __doc__.split("\n\n")[:2]
    parser = argparse.ArgumentParser(description=about, epilog=usage)
    parser.add_argument(
        "file", help="the file of `zeroset render --claims`, or of `zeroset mesh --claims`"
    )
    parser.add_argument("--effort", type=int, default=2000, help="evaluations for a claim [2000]")
    arguments = parser.parse_args()
    with open(arguments.file, encoding="utf-8") as file:
        header = json.loads(next(file))
        if header["format"] == "zeroset mesh claims 1":
            from check_mesh import check

            sys.exit(0 if check(arguments.file, arguments.effort) else 1)
        if header["format"] not in ("zeroset claims 1", "zeroset claims 2"):
            sys.exit(f"{arguments.file}: no file of claims that this program reads")
        for surface in header["surfaces"]:
            print(surface["read"])
        lines = file.readlines()
    tasks = [lines[k : k + 64] for k in range(0, len(lines), 64)]
    count: Counter[str] = Counter()
    with Pool(initializer=begin, initargs=(header, arguments.effort)) as pool:
        for found in pool.imap(check_pixels, tasks):
            for pixel, verdict in found:
                word, _, why = verdict.partition(":")
                count[word] += 1
                if why:
                    print(f"pixel {pixel}: refuted:{why}")
    words = ["confirmed", "refuted", "not decided", "claims nothing"]
    print(", ".join(f"{count[word]} {word}" for word in words))
    sys.exit(1 if count["refuted"] else 0)


if __name__ == "__main__":
    main()
