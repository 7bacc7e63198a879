"""Python functions and SymPy's expressions mean what they mean there."""

import importlib.metadata
import math

import numpy as np
import pytest
import scipy.special
import sympy as sp
from conftest import SEED

import zeroset as zs

CENTERS = np.array([[0, 0, 0], [1, 0, 0.5], [-0.5, 1, 0]])

FUNCTIONS = [
    lambda x, y, z: x + 2 * y - z / 3,
    lambda x, y, z: x**2 * y - z**3 + 1,
    lambda x, y, z: (x - 1) ** 4 / (2 + y**2) - z,
    lambda x, y, z: 2**x + 0.5 ** (y + z),
    lambda x, y, z: -x + +y - abs(z),
    lambda x, y, z: x % 0.7 + y // 0.3 - z,
    lambda x, y, z: 5 % (x + 3) + 7 // (y + 4) * z,
    lambda x, y, z: np.sin(x) * np.cos(y) - np.tan(z / 2),
    lambda x, y, z: np.arcsin(x / 4) + np.arccos(y / 4) + np.arctan(z),
    lambda x, y, z: np.sinh(x) + np.cosh(y) * np.tanh(z),
    lambda x, y, z: np.arcsinh(x) + np.arccosh(2 + y * y) + np.arctanh(z / 4),
    lambda x, y, z: np.exp(x) + np.exp2(y) - np.expm1(z),
    lambda x, y, z: np.log(4 + x) + np.log2(4 + y) * np.log10(4 + z) - np.log1p(x * x),
    lambda x, y, z: np.sqrt(x * x + y * y) - np.cbrt(z),
    lambda x, y, z: np.hypot(x, y) - np.arctan2(y, x + 3) + z,
    lambda x, y, z: np.minimum(x, y) + np.maximum(y, z) - np.fmin(x, z) * np.fmax(x, 0.1),
    lambda x, y, z: np.floor(x * 3) + np.ceil(y * 3) + np.trunc(z * 3) - np.rint(x * 2.3),
    lambda x, y, z: np.sign(x) * np.square(y) + np.absolute(z) - np.fabs(x),
    lambda x, y, z: np.reciprocal(x + 3) + np.negative(y) + np.positive(z),
    lambda x, y, z: np.power(x + 3, 1.5) + np.float_power(y, 2) - z,
    lambda x, y, z: np.deg2rad(x) + np.rad2deg(y) - np.radians(z) * np.degrees(x),
    lambda x, y, z: np.heaviside(x, 0.5) + np.remainder(y, 0.9) - np.mod(z, 0.4),
    lambda x, y, z: np.where(x > y, z, x * y) - 1,
    lambda x, y, z: np.where((x > 0) & (y <= 1), x, np.where((z < 0) | (x >= 1), y, z)),
    lambda x, y, z: np.where(~(x < y), 1.0, 2.0) * z,
    lambda x, y, z: np.clip(x, -0.5, y * y) - z,
    lambda x, y, z: np.float64(2.5) * x - np.int32(3) * y + np.array(1.5) * z,
    lambda x, y, z: math.pi * x - math.e * y + 1e-7 * z + 1e22 * x,
    lambda x, y, z: sum(np.sin(k * x) / k for k in range(1, 6)) - y * z,
    lambda x, y, z: np.max([x, y, z], axis=0) - np.min(np.stack([x * y, z]), axis=0),
    lambda x, y, z: np.maximum.reduce([x - 1, -x - 1, y]) + np.minimum.reduce([y, z]),
    lambda x, y, z: np.select([x < -1, x < 1], [-1, x**3], default=1) - z,
    lambda x, y, z: np.select([x < 0, True], [x**2, x], default=np.nan) - z,
    lambda x, y, z: np.piecewise(x, [x < 0, x >= 0], [lambda a: -a, lambda a: a**2]) - y * z,
    lambda x, y, z: np.round(2 * x) / 2 + np.around(y, 1) - np.fix(3 * z),
    lambda x, y, z: np.sinc(x) + np.sinc(y * z),
    lambda x, y, z: np.real((x + 1j * y) ** 3 - 1) + ((x + 1j * y) ** 2).imag - np.angle(z + 9j),
    lambda x, y, z: scipy.special.erf(x) - scipy.special.erfc(y) + scipy.special.jv(2, z),
    lambda x, y, z: sum(1 / (np.hypot(x - a, y - b) + (z - c) ** 2 + 1) for a, b, c in CENTERS),
    lambda x, y, z: np.linalg.norm(np.array([x, y, z]), axis=0) + np.prod([x, y], axis=0),
    lambda x, y, z: (
        np.dot([1, 2, 3], [x, y, z]) - np.cross([1, 2, 3], np.stack([x, y, z], -1)).T[0]
    ),
    lambda x, y, z: np.subtract(1, x) + np.divide(y, 3) - np.multiply(z, x) + np.add(x, y),
]


@pytest.mark.parametrize("number", range(len(FUNCTIONS)))
def test_functions_mean_what_they_mean_in_numpy(number, random):
    function = FUNCTIONS[number]
    points = random.uniform(-2, 2, (200, 3))
    expected = function(*points.T)
    np.testing.assert_allclose(zs.Surface(function)(points), expected, rtol=1e-12, atol=1e-12)


def changed_in_place(x, y, z):
    v = x**2 + y**2
    v -= 1
    v *= v
    return v + z**2 - 0.1


def box(x, y, z):
    q = np.abs(np.array([x, y, z])) - np.array([1, 0.5, 0.7])
    return np.linalg.norm(np.maximum(q, 0.0)) + min(max(q[0], max(q[1], q[2])), 0.0)


def escape(x, y, z):
    a, b = x, y
    for count in range(5):
        if a * a + b * b > 4:
            return z - count
        a, b = a * a - b * b + x, 2 * a * b + y
    return z


def blobs(x, y, z):
    distances = (x - CENTERS[:, 0]) ** 2 + (y - CENTERS[:, 1]) ** 2 + (z - CENTERS[:, 2]) ** 2
    return np.sum(np.exp(-4 * distances)) - 0.5


# Functions that compute with the numbers of one point.
OF_A_POINT = [
    lambda x, y, z: max(x, y, z) - 1,
    lambda x, y, z: min(x, y * z) + max(abs(x), abs(z), 1),
    lambda x, y, z: x if x > 0 else y * z,
    lambda x, y, z: (x if x > y and y > z else y) - (z or 1),
    lambda x, y, z: sorted([x, y, z])[1],
    lambda x, y, z: round(x, 1) - round(y) + z,
    changed_in_place,
    box,
    escape,
    blobs,
]


@pytest.mark.parametrize("number", range(len(OF_A_POINT)))
def test_tests_of_formulas_become_choices(number, random):
    function = OF_A_POINT[number]
    points = random.uniform(-2, 2, (200, 3))
    expected = [function(*point) for point in points]
    np.testing.assert_allclose(zs.Surface(function)(points), expected, rtol=1e-12, atol=1e-12)


def test_the_greatest_of_several_stays_one_maximum():
    text = zs.Surface(lambda x, y, z: np.max([x, y, z, x * y], axis=0) - max(abs(x), abs(y))).text
    assert text.count("max(") == 2
    assert "if(" not in text


def test_conditions_joined_by_words_of_python_are_solids():
    s = zs.Surface(lambda x, y, z: x**2 + y**2 < 1 and -1 < z < 1)
    assert 2 * math.pi in s.measure(relative=0.02)[0].volume


def test_a_function_of_x_and_y_is_a_graph():
    s = zs.Surface(lambda x, y: x * y)
    assert s(2, 3, 10) == 4
    s = zs.Surface(lambda u, v, a: a * u * v, a=2)
    assert s(2, 3, 10) == -2


def test_an_equation_with_a_name_on_its_left_is_no_definition(random):
    r = sp.sqrt(X**2 + Y**2 + Z**2)
    points = random.uniform(-2, 2, (50, 3))
    x, y, z = points.T
    distance = np.sqrt(x**2 + y**2 + z**2)
    found = zs.Surface(sp.Eq(r, sp.Abs(Z / r)))(points)
    np.testing.assert_allclose(found, distance - np.abs(z) / distance, rtol=1e-12, atol=1e-12)
    assert zs.Surface(sp.Eq(sp.Symbol("a"), X + Y), a=2)(1, 3, 0) == -2


def test_the_version_is_that_of_the_package():
    assert zs.__version__ == importlib.metadata.version("zeroset")


# Functions that are defined for all numbers, under NumPy's names and SymPy's.
UNARY = [("sin", "sin"), ("cos", "cos"), ("tanh", "tanh"), ("arctan", "atan"), ("abs", "Abs")]
UNARY += [("sinh", "sinh"), ("arcsinh", "asinh"), ("exp", "exp"), ("sign", "sign")]


def tree(random, depth):
    """A random formula, as nested tuples."""
    kind = random.integers(0, 8) if depth > 0 else 8
    if kind < 3:
        return (int(random.integers(0, len(UNARY))), tree(random, depth - 1))
    if kind < 7:
        return ("+-*/"[kind - 3], tree(random, depth - 1), tree(random, depth - 1))
    if kind == 7:
        return ("**", tree(random, depth - 1), int(random.integers(2, 4)))
    return (
        "xyz"[random.integers(0, 3)] if random.random() < 0.7 else round(random.uniform(-2, 2), 2)
    )


def value(of, names, module, column):
    """The value of a tree, by the functions of a module: `column` tells where UNARY has them."""
    if not isinstance(of, tuple):
        return names.get(of, of)
    head, *rest = of
    parts = [value(part, names, module, column) for part in rest]
    if isinstance(head, int):
        # Large arguments would make large numbers, of which few digits are equal.
        return getattr(module, UNARY[head][column])(parts[0] / 4)
    a, b = parts
    return {
        "+": lambda: a + b,
        "-": lambda: a - b,
        "*": lambda: a * b,
        "/": lambda: a / (b * b + 1),
        "**": lambda: a**b,
    }[head]()


@pytest.mark.parametrize("number", range(25))
def test_random_formulas_mean_the_same(number):
    random = np.random.default_rng([SEED, number])
    formula = ("+", tree(random, 5), ("*", "x", tree(random, 4)))
    points = random.uniform(-2, 2, (100, 3))
    expected = value(formula, dict(zip("xyz", points.T)), np, 0) + 0 * points[:, 0]
    limits = {"rtol": 1e-11, "atol": 1e-11 * max(1, np.abs(expected).max())}
    traced = zs.Surface(lambda x, y, z: value(formula, {"x": x, "y": y, "z": z}, np, 0))
    np.testing.assert_allclose(traced(points), expected, **limits)
    symbols = dict(zip("xyz", sp.symbols("x y z", real=True)))
    expression = sp.sympify(value(formula, symbols, sp, 1))
    np.testing.assert_allclose(zs.Surface(expression)(points), expected, **limits)


def test_a_function_may_have_parameters():
    def lens(x, y, z, r, d=0):
        return (x - d) ** 2 + y**2 + z**2 - r**2

    s = zs.Surface(lens, r=2, d=1)
    assert s.parameters == {"r": 2.0, "d": 1.0}
    assert s(1, 0, 0) == -4
    with pytest.raises(zs.Error, match="a value for r"):
        zs.Surface(lens, d=1)


def test_shared_parts_stay_shared():
    def squared(x, y, z):
        for _ in range(60):
            x = x * x - y
        return x + z

    text = zs.Surface(squared).text
    assert len(text) < 5000
    assert text.count("\n") >= 58


def test_deep_formulas_are_read():
    def nested(x, y, z):
        for n in range(300):
            x = np.sin(x) + n * y
        return x - z

    s = zs.Surface(nested)
    assert s(0.3, 0.01, 0) == pytest.approx(nested(0.3, 0.01, 0), rel=1e-9)


def test_an_inequality_is_a_solid():
    s = zs.Surface(lambda x, y, z: x**2 + y**2 + z**2 <= 1)
    assert 4.18879 in s.measure(relative=0.01)[0].volume
    s = zs.Surface(lambda x, y, z: (x**2 + y**2 < 1) & (np.abs(z) < 1))
    assert 2 * math.pi in s.measure(relative=0.02)[0].volume


def without_end(x, y, z):
    while x < 100:
        x = x * 2
    return x


@pytest.mark.parametrize(
    ("function", "message"),
    [
        (lambda x, y, z: math.sin(x), "functions of numpy"),
        (lambda x, y, z: np.gcd(x, y), "numpy.gcd"),
        (lambda x, y, z: np.add.accumulate(x), "accumulate"),
        (lambda x, y, z: x + float("inf"), "no number"),
        (lambda x, y, z: x + "y", "str"),
        (lambda x, y, z: None, "NoneType"),
        (lambda x, y, z: True, "constant"),
        (lambda x: x, "the arguments x, y and z"),
        (without_end, "tests formulas too often"),
        (lambda x, y, z, a: x, "a value for a"),
        (lambda x, y, z: list(x), "no elements"),
        (lambda x, y, z: x + 1j, "complex"),
        (lambda x, y, z: np.interp(x, [0, 1], [2, 3]), "numpy.interp"),
        (lambda x, y, z: np.sin(x, where=False), "options"),
    ],
)
def test_functions_that_no_formula_can_say_are_refused(function, message):
    with pytest.raises((zs.Error, TypeError), match=message):
        zs.Surface(function)


def test_a_function_that_raises_raises():
    with pytest.raises(ZeroDivisionError):
        zs.Surface(lambda x, y, z: 1 / 0)


X, Y, Z = sp.symbols("x y z", real=True)
SYMBOLIC = [
    X + 2 * Y - Z / 3,
    X**2 * Y - Z**3 + sp.Rational(1, 7),
    (X - 1) ** 4 / (2 + Y**2) - Z,
    2**X + sp.Rational(1, 2) ** (Y + Z),
    sp.Abs(X) - sp.sign(Y) * Z,
    sp.sin(X) * sp.cos(Y) - sp.tan(Z / 2),
    sp.sec(X / 2) + sp.csc(Y + 4) - sp.cot(Z + 5),
    sp.asin(X / 4) + sp.acos(Y / 4) + sp.atan(Z),
    sp.sinh(X) + sp.cosh(Y) * sp.tanh(Z),
    sp.asinh(X) + sp.acosh(2 + Y * Y) + sp.atanh(Z / 4),
    sp.exp(X) + sp.log(4 + Y) - sp.sqrt(Z + 3),
    sp.log(X + 4, 2) - sp.log(Y + 5, 10) * Z,
    sp.cbrt(X + 3) + (Y + 3) ** sp.Rational(5, 2) - Z,
    sp.atan2(Y, X + 3) + sp.Max(X, Y, Z) - sp.Min(X, 1),
    sp.floor(3 * X) + sp.ceiling(3 * Y) - Z,
    sp.Mod(X, 2) - Y * Z,
    sp.Piecewise((X, Y > 0), (Z, X + Z < 1), (X * Y, True)),
    sp.Piecewise((1, sp.And(X > 0, Y <= 1)), (2, sp.Or(Z < 0, X >= 1)), (3, True)) * Z,
    sp.pi * X - sp.E * Y + sp.GoldenRatio * Z,
    sp.erf(X) + sp.erfc(Y) - Z,
    sp.besselj(0, X) + sp.besselj(1, Y) - sp.besselj(3, Z),
    sp.legendre(4, X) + sp.chebyshevt(3, Y) - sp.hermite(3, Z),
    sp.Float("0.1") * X + sp.Float("1e-9") * Y - Z,
    sp.diff(sp.sin(X * Y) * sp.exp(Z), X),
    sp.Derivative(X**3 * Y, X) - Z,
    sp.expand((X + Y) ** 5 - Z),
    sp.sec(X) ** 2 - 1 + Y / (Z + 4),
    sp.Heaviside(X + 0.123) * Y - Z,
    sp.sech(X) + sp.csch(Y + 3) - sp.coth(Z + 3),
    sp.acot(X + 3) + sp.asec(Y + 4) - sp.acsc(Z + 4),
    sp.Sum(sp.cos(sp.Symbol("k") * X) / sp.Symbol("k"), (sp.Symbol("k"), 1, 4)) - Y * Z,
    sp.factor(X**4 - Y**4) + sp.besselj(2, Z),
]


@pytest.mark.parametrize("number", range(len(SYMBOLIC)))
def test_expressions_mean_what_they_mean_in_sympy(number, random):
    value = SYMBOLIC[number]
    points = random.uniform(-2, 2, (25, 3))
    # A derivative with a number in place of its variable has no meaning.
    known = value.doit()
    exact = [
        complex(known.subs(dict(zip((X, Y, Z), point))).evalf(20)) for point in points.tolist()
    ]
    assert all(abs(one.imag) < 1e-12 for one in exact)
    found = zs.Surface(value)(points)
    np.testing.assert_allclose(found, [one.real for one in exact], rtol=1e-11, atol=1e-11)


def test_equations_of_sympy():
    a = sp.Symbol("a")
    s = zs.Surface(sp.Eq(X**2 + Y**2, 1 + a * Z**2), a=2)
    assert s(1, 0, 3) == -18
    assert s.parameters == {"a": 2.0}
    ball = zs.Surface(X**2 + Y**2 + Z**2 <= 4)
    assert ball.render(16, 16).counts["hit"] > 20


@pytest.mark.parametrize("value", [sp.gamma(X), sp.Function("f")(X), sp.zeta(X), sp.Integral(X, X)])
def test_expressions_that_no_formula_can_say_are_refused(value):
    with pytest.raises(zs.Error, match="has no meaning in a formula"):
        zs.Surface(value)


def test_parameters_without_a_value_are_named():
    with pytest.raises(zs.Error, match="`k`"):
        zs.Surface(sp.Symbol("k") * X - Y)
