"""Formulas of other kinds as texts: Python functions of NumPy's ufuncs, and SymPy's expressions.

A function is called once, with an `Expression` for each argument. What it computes is recorded and
written as a text.
"""

from __future__ import annotations

import inspect
import math
import numbers
from collections.abc import Callable
from typing import Any

import numpy as np

from ._zeroset import Error

# NumPy's ufuncs by the language's functions of the same arguments.
_CALLS = {
    "absolute": "abs", "fabs": "abs", "sign": "sign", "floor": "floor", "ceil": "ceil",
    "rint": "round", "trunc": "trunc", "square": "sqr", "sqrt": "sqrt", "cbrt": "cbrt",
    "exp": "exp", "exp2": "exp2", "expm1": "expm1", "log": "ln", "log2": "log2",
    "log10": "log10", "log1p": "log1p", "sin": "sin", "cos": "cos", "tan": "tan",
    "arcsin": "asin", "arccos": "acos", "arctan": "atan", "sinh": "sinh", "cosh": "cosh",
    "tanh": "tanh", "arcsinh": "asinh", "arccosh": "acosh", "arctanh": "atanh",
    "arctan2": "atan2", "hypot": "hypot", "minimum": "min", "maximum": "max", "fmin": "min",
    "fmax": "max", "remainder": "mod", "reciprocal": "recip", "heaviside": "heaviside",
    "deg2rad": "radians", "radians": "radians", "rad2deg": "degrees", "degrees": "degrees",
}  # fmt: skip
_SIGNS = {
    "add": "+", "subtract": "-", "multiply": "*", "divide": "/", "true_divide": "/",
    "power": "^", "float_power": "^",
}  # fmt: skip
_RELATIONS = {
    "less": "<", "less_equal": "<=", "greater": ">", "greater_equal": ">=", "equal": "=",
    "not_equal": "!=",
}  # fmt: skip
_LOGIC = {"logical_and": "and", "logical_or": "or", "bitwise_and": "and", "bitwise_or": "or"}

# SymPy's functions by the language's, where the names differ.
_SYMPY = {
    "Abs": "abs", "ceiling": "ceil", "Max": "max", "Min": "min", "Mod": "mod", "log": "ln",
    "Heaviside": "heaviside", "sinc": "sinc", "besselj": "besselj",
}  # fmt: skip
_SYMPY_SAME = {
    "sign", "floor", "exp", "sin", "cos", "tan", "sec", "csc", "cot", "asin", "acos", "atan",
    "asec", "acsc", "acot", "sinh", "cosh", "tanh", "sech", "csch", "coth", "asinh", "acosh",
    "atanh", "asech", "acsch", "acoth", "atan2", "erf", "erfc", "re", "im", "legendre",
    "hermite", "laguerre", "gegenbauer", "chebyshevt", "chebyshevu",
}  # fmt: skip

# Deeper formulas are written as several lines: the language bounds how deep brackets go.
_DEEPEST = 20


class Expression(np.lib.mixins.NDArrayOperatorsMixin):
    """A value that a traced function computes. It takes part in arithmetic, comparisons, NumPy's
    ufuncs, ``numpy.where`` and ``numpy.clip``. It has no number yet, so ``if`` cannot test it.
    """

    # The mixin makes a ufunc of every operator.

    __slots__ = ("_form", "_parts")
    __hash__ = object.__hash__

    def __init__(self, form: str, *parts: Expression) -> None:
        # The text of a leaf; else a text with a place `{}` for each part.
        self._form = form
        self._parts = parts

    def __array_ufunc__(self, ufunc: np.ufunc, method: str, *inputs: Any, **options: Any) -> Any:
        name = ufunc.__name__
        if method != "__call__" or options:
            raise Error(f"numpy.{name} with {method} or options has no meaning in a formula")
        if any(isinstance(value, np.ndarray) and value.ndim for value in inputs):
            return NotImplemented
        parts = [expression(value) for value in inputs]
        if name == "negative":
            return Expression("(-{})", *parts)
        if name == "positive":
            return parts[0]
        if name in ("logical_not", "invert"):
            return Expression("(not {})", *parts)
        if name == "floor_divide":
            return call("floor", _infix("/", *parts))
        for table in (_SIGNS, _RELATIONS, _LOGIC):
            if name in table:
                return _infix(table[name], *parts)
        if name in _CALLS:
            return call(_CALLS[name], *parts)
        raise Error(f"numpy.{name} has no meaning in a formula")

    def __array_function__(self, function: Any, types: Any, args: Any, kwargs: Any) -> Any:
        if function is np.where and len(args) == 3:
            return _choice(*map(expression, args))
        if function is np.clip and len(args) == 3:
            return call("clamp", *map(expression, args))
        raise Error(f"numpy.{function.__name__} has no meaning in a formula")

    def __bool__(self) -> bool:
        raise Error("a formula has no truth value: write numpy.where(condition, a, b) for `if`")

    def __float__(self) -> float:
        raise Error("a formula has no number: use functions of numpy in place of those of math")

    def __iter__(self) -> Any:
        raise Error("a formula has no elements")

    def __repr__(self) -> str:
        return f"<Expression {text_of(self)}>"


def call(name: str, *arguments: Any) -> Expression:
    """The value of a function of the language."""
    places = ", ".join(["{}"] * len(arguments))
    return Expression(f"{name}({places})", *map(expression, arguments))


def _infix(sign: str, left: Any, right: Any) -> Expression:
    return Expression(f"({{}} {sign} {{}})", expression(left), expression(right))


def _choice(condition: Expression, yes: Expression, no: Expression) -> Expression:
    return call("if", condition, yes, no)


def expression(value: Any) -> Expression:
    """A number or an expression as an expression."""
    if isinstance(value, Expression):
        return value
    if isinstance(value, np.ndarray) and value.ndim == 0:
        value = value.item()
    if isinstance(value, (bool, np.bool_)):
        value = int(value)
    if isinstance(value, numbers.Integral):
        return Expression(f"({int(value)})")
    if isinstance(value, numbers.Real):
        if not math.isfinite(value):
            raise Error(f"{value!r} is no number of a formula")
        return Expression(f"({float(value)!r})")
    raise Error(f"a {type(value).__name__} has no meaning in a formula: {value!r}")


def text_of(root: Expression) -> str:
    """The text of an expression. Parts that are used again become lines of their own."""
    uses: dict[int, int] = {}
    order: list[Expression] = []
    stack = [(root, False)]
    while stack:
        node, done = stack.pop()
        if done:
            order.append(node)
            continue
        uses[id(node)] = uses.get(id(node), 0) + 1
        if uses[id(node)] == 1:
            stack.append((node, True))
            stack.extend((part, False) for part in reversed(node._parts))
    lines: list[str] = []
    texts: dict[int, str] = {}
    depths: dict[int, int] = {}
    for node in order:
        text = node._form.format(*(texts[id(part)] for part in node._parts))
        depth = 1 + max((depths[id(part)] for part in node._parts), default=0)
        is_number = not text.startswith("(") or not _is_condition(node)
        again = uses[id(node)] > 1 and node._parts
        if node is not root and is_number and (again or depth > _DEEPEST):
            name = f"part_{len(lines) + 1}"
            lines.append(f"{name} = {text}")
            text, depth = name, 1
        texts[id(node)], depths[id(node)] = text, depth
    final = texts[id(root)]
    # A drawing is no pair of brackets around an equation.
    if _is_condition(root):
        final = final[1:-1]
    return "\n".join([*lines, final])


def _is_condition(node: Expression) -> bool:
    words = [*_RELATIONS.values(), "and", "or"]
    return node._form == "(not {})" or node._form in [f"({{}} {word} {{}})" for word in words]


def traced(function: Callable[..., Any], values: dict[str, float]) -> str:
    """The text of a Python function of x, y, z and of the parameters in `values`."""
    try:
        names = list(inspect.signature(function).parameters)
    except (TypeError, ValueError):
        names = ["x", "y", "z"]
    unknown = [name for name in names[3:] if name not in values]
    if len(names) < 3 or unknown:
        wanted = f"a value for {unknown[0]}" if unknown else "three arguments: x, y and z"
        raise Error(f"the function {getattr(function, '__name__', '')} needs {wanted}")
    arguments = [Expression(name) for name in ["x", "y", "z", *names[3:]]]
    result = function(*arguments)
    if isinstance(result, (bool, np.bool_)):
        raise Error("the function is a constant")
    return text_of(expression(result))


def from_sympy(value: Any) -> str:
    """The text of an expression, an equation or an inequality of SymPy."""
    import sympy

    relations = {
        sympy.Equality: "=", sympy.StrictLessThan: "<", sympy.LessThan: "<=",
        sympy.StrictGreaterThan: ">", sympy.GreaterThan: ">=", sympy.Unequality: "!=",
    }  # fmt: skip
    known: dict[Any, Expression] = {}

    def convert(node: Any) -> Expression:
        if node not in known:
            known[node] = build(node)
        return known[node]

    def build(node: Any) -> Expression:
        if node.is_Symbol:
            return Expression(str(node.name))
        if node.is_Integer:
            return expression(int(node))
        if node.is_Rational:
            return _infix("/", int(node.p), int(node.q))
        if node.is_Float:
            return expression(float(node))
        constants = {sympy.pi: "pi", sympy.E: "e", sympy.GoldenRatio: "phi", sympy.I: "i"}
        if node in constants:
            return Expression(constants[node])
        for kind, sign in relations.items():
            if isinstance(node, kind):
                return _infix(sign, convert(node.lhs), convert(node.rhs))
        if isinstance(node, sympy.Piecewise):
            *pieces, (last, condition) = node.args
            if condition != sympy.true:
                raise Error("a Piecewise needs a last value for all other places")
            found = convert(last)
            for piece, where in reversed(pieces):
                found = _choice(convert(where), convert(piece), found)
            return found
        words = {sympy.And: "and", sympy.Or: "or", sympy.Add: "+", sympy.Mul: "*"}
        for kind, sign in words.items():
            if isinstance(node, kind):
                first, *rest = map(convert, node.args)
                for part in rest:
                    first = _infix(sign, first, part)
                return first
        if isinstance(node, sympy.Not):
            return Expression("(not {})", convert(node.args[0]))
        if isinstance(node, sympy.Pow):
            if node.exp == sympy.Rational(1, 2):
                return call("sqrt", convert(node.base))
            return _infix("^", convert(node.base), convert(node.exp))
        name = type(node).__name__
        if name in _SYMPY or name in _SYMPY_SAME:
            return call(_SYMPY.get(name, name), *map(convert, node.args))
        raise Error(f"SymPy's {name} has no meaning in a formula: {node}")

    return text_of(convert(sympy.sympify(value)))
