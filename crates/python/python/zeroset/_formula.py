"""Formulas of other kinds as texts: Python functions of NumPy's ufuncs, and SymPy's expressions.

A function is called with an `Expression` for each argument. What it computes is recorded and
written as a text. An `if` on a formula, as in Python's `max`, calls it once for each way through.
"""

from __future__ import annotations

import contextlib
import inspect
import math
import numbers
import re
import zlib
from collections.abc import Callable, Mapping, Sequence
from contextvars import ContextVar
from fractions import Fraction
from functools import partial
from typing import Any

import numpy as np

from ._zeroset import Error

# Ufuncs of NumPy and SciPy by the language's functions of the same arguments.
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
    "erf": "erf", "erfc": "erfc", "jv": "besselj", "conjugate": "conj",
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

# Largest number of ways through a function whose `if` tests formulas.
_MOST_WAYS = 256
_TOO_MANY = (
    "the function tests formulas too often: write numpy.where(condition, a, b) for `if`, and "
    "numpy.maximum(a, b) for `max`"
)
# The tests on one way through a function, and the answers to them.
_WAY: ContextVar[_Way | None] = ContextVar("way", default=None)

# Deeper formulas are written as several lines: the language bounds how deep brackets go.
_DEEPEST = 20


class Expression(np.lib.mixins.NDArrayOperatorsMixin):
    """A value that a traced function computes. It takes part in arithmetic, comparisons, and the
    functions of NumPy that work on arrays of objects.
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
        # `v -= 1` gives `v` another value.
        (target,) = options.pop("out", (None,))
        if method != "__call__" or options or (target is not None and target is not inputs[0]):
            raise Error(f"numpy.{name} with {method} or options has no meaning in a formula")
        if any(isinstance(value, np.ndarray) and value.ndim for value in inputs):
            arrays = np.broadcast(*map(_as_array, inputs))
            values = np.array([_as_array(ufunc(*parts)) for parts in arrays], dtype=object)
            return values.reshape(arrays.shape)
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
        if function in _FUNCTIONS:
            return _FUNCTIONS[function](*args, **kwargs)
        try:
            value = function(*map(_without_expressions, args), **kwargs)
        except (TypeError, AttributeError, ValueError, IndexError) as error:
            raise Error(f"numpy.{function.__name__} has no meaning in a formula") from error
        return value.item() if isinstance(value, np.ndarray) and not value.ndim else value

    def __bool__(self) -> bool:
        way = _WAY.get()
        if way is None:
            raise Error("a formula has no truth value: write numpy.where(condition, a, b) for `if`")
        return way.answer(self)

    def __round__(self, digits: int = 0) -> Expression:
        return _rounded(self, digits)

    @property
    def real(self) -> Expression:
        """The real part."""
        return call("re", self)

    @property
    def imag(self) -> Expression:
        """The imaginary part."""
        return call("im", self)

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


def _as_array(value: Any) -> np.ndarray:
    """An array of objects that holds a value."""
    array = np.empty((), dtype=object)
    array[()] = value
    return array if isinstance(value, Expression) else np.asarray(value, dtype=object)


def _without_expressions(value: Any) -> Any:
    """An argument of NumPy with arrays in place of expressions, so that NumPy computes it."""
    if isinstance(value, (list, tuple)):
        return [_without_expressions(one) for one in value]
    return _as_array(value) if isinstance(value, Expression) else value


def _rounded(value: Any, decimals: int = 0) -> Expression:
    if decimals == 0:
        return call("round", value)
    scale = 10.0**decimals
    return _infix("/", call("round", _infix("*", value, scale)), scale)


def _selected(conditions: Any, values: Any, default: Any = 0) -> Expression:
    """The first of the values whose condition holds."""
    pairs = list(zip(conditions, values))
    always = [at for at, (one, _) in enumerate(pairs) if isinstance(one, (bool, np.bool_)) and one]
    if always:
        default, pairs = pairs[always[0]][1], pairs[: always[0]]
    if isinstance(default, float) and math.isnan(default):
        # Nowhere else is there a value.
        condition, value = pairs.pop()
        found = Expression("({{{}: {}}})", expression(condition), expression(value))
    else:
        found = expression(default)
    for condition, value in reversed(pairs):
        found = _choice(expression(condition), expression(value), found)
    return found


def _piecewise(value: Any, conditions: Any, functions: Any) -> Expression:
    values = [one(value) if callable(one) else one for one in functions]
    default = values[len(conditions)] if len(values) > len(conditions) else 0
    return _selected(conditions, values[: len(conditions)], default)


# Functions of NumPy that are no ufuncs.
_FUNCTIONS: dict[Any, Callable[..., Expression]] = {
    np.where: lambda condition, yes, no: _choice(*map(expression, (condition, yes, no))),
    np.clip: lambda value, low, high: call("clamp", value, low, high),
    np.select: _selected,
    np.piecewise: _piecewise,
    np.round: _rounded,
    np.around: _rounded,
    np.fix: lambda value: call("trunc", value),
    np.sinc: lambda value: call("sinc", math.pi * expression(value)),
    np.real: lambda value: call("re", value),
    np.imag: lambda value: call("im", value),
    np.angle: lambda value: call("arg", value),
}


def _method(here: str) -> Callable[..., Expression]:
    def method(*values: Any) -> Expression:
        return call(here, *values)

    method.__doc__ = f"The function `{here}` of this formula and of further arguments."
    return method


# NumPy calls these methods for the elements of an array of objects.
for _ufunc, _here in _CALLS.items():
    setattr(Expression, _ufunc, _method(_here))


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
    if isinstance(value, numbers.Complex):
        return _infix("+", value.real, _infix("*", value.imag, Expression("i")))
    raise Error(f"a {type(value).__name__} has no meaning in a formula: {value!r}")


def text_of(root: Expression, parameters: Sequence[str] = (), prefix: str = "part") -> str:
    """The text of an expression. Parts that are used again become lines of their own. With
    parameters, which other lines do not know, these lines are functions of them.
    """
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
            name = f"{prefix}_{len(lines) + 1}"
            if parameters:
                name += f"({', '.join(parameters)})"
            lines.append(f"{name} = {text}")
            text, depth = name, 1
        texts[id(node)], depths[id(node)] = text, depth
    final = texts[id(root)]
    # A drawing is no pair of brackets around an equation.
    if _is_condition(root):
        final = final[1:-1]
    # An equation with a name on its left would define the name.
    if root._form == "({} = {})" and texts[id(root._parts[0])].isidentifier():
        left, right = (texts[id(part)] for part in root._parts)
        final = final if left in ("x", "y", "z") else f"{left} - {right} = 0"
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
    # A function of x and y is the graph over them.
    count = 2 if len(names) == 2 or (len(names) > 2 and names[2] in values) else 3
    unknown = [name for name in names[count:] if name not in values]
    if len(names) < 2 or unknown:
        wanted = f"a value for {unknown[0]}" if unknown else "the arguments x, y and z"
        raise Error(f"the function {getattr(function, '__name__', '')} needs {wanted}")
    arguments = [Expression(name) for name in ["x", "y", "z"][:count] + names[count:]]
    result = _explored(lambda: function(*arguments))
    if isinstance(result, (bool, np.bool_)):
        raise Error("the function is a constant")
    if count == 2 and not _is_condition(expression(result)):
        result = _infix("=", Expression("z"), result)
    return text_of(expression(result))


class _Way:
    """One way through a function: the conditions that it tests, and the answers."""

    def __init__(self, answers: list[bool], known: dict[Any, Expression]) -> None:
        self.answers = answers
        self.known = known
        self.tests: list[Expression] = []

    def answer(self, test: Expression) -> bool:
        """The answer to a test. Those after the given answers are true."""
        test = _shared(test if _is_condition(test) else _infix("!=", test, 0), self.known)
        answers = [*self.answers, *[True] * (len(self.tests) + 1 - len(self.answers))]
        for earlier, answer in zip(self.tests, answers):
            if earlier is test:
                return answer
        self.tests.append(test)
        if len(self.tests) > _MOST_WAYS:
            raise Error(_TOO_MANY)
        return answers[len(self.tests) - 1]


def _explored(function: Callable[[], Any]) -> Any:
    """The value of a function whose `if` may test formulas: choices between its values on all ways
    through it.
    """
    known: dict[Any, Expression] = {}
    ways = 0

    def value_after(answers: list[bool]) -> Any:
        nonlocal ways
        ways += 1
        if ways > _MOST_WAYS:
            raise Error(_TOO_MANY)
        way = _Way(answers, known)
        token = _WAY.set(way)
        try:
            value = function()
        finally:
            _WAY.reset(token)
        if len(way.tests) == len(answers) == 0:
            return value
        is_fixed = isinstance(value, (bool, np.bool_))
        value = bool(value) if is_fixed else _shared(expression(value), known)
        for at in reversed(range(len(answers), len(way.tests))):
            other = value_after([*answers, *[True] * (at - len(answers)), False])
            value = _merged(way.tests[at], value, other, known)
        return value

    return value_after([])


def _shared(root: Expression, known: dict[Any, Expression]) -> Expression:
    """An expression in which equal parts are one object."""
    done: dict[int, Expression] = {}
    stack = [root]
    while stack:
        node = stack[-1]
        left = [part for part in node._parts if id(part) not in done]
        stack.extend(left)
        if not left:
            stack.pop()
            parts = [done[id(part)] for part in node._parts]
            key = (node._form, *map(id, parts))
            done[id(node)] = known.setdefault(key, Expression(node._form, *parts))
    return done[id(root)]


def _merged(test: Expression, yes: Any, no: Any, known: dict[Any, Expression]) -> Any:
    """`yes` where the condition `test` holds, else `no`."""
    if yes is no:
        return yes
    values = (yes, no)
    if all(isinstance(one, (bool, np.bool_)) or _is_condition(one) for one in values):
        return _merged_conditions(test, yes, no)
    yes, no = (_shared(expression(one), known) for one in values)
    # Where both values differ in one part only, that part is the choice.
    chosen: dict[_Pair, Expression] = {}
    others = _differences(test, yes, no, chosen)
    if len(others) + len(chosen) == 1:
        chosen.update((key, _choice(test, *pair)) for key, pair in others.items())
        others.clear()
    value = _choice(test, yes, no) if others else _replaced(yes, no, chosen)
    return _shared(value, known)


def _merged_conditions(test: Expression, yes: Any, no: Any) -> Any:
    if yes is True or yes is test:
        return test if no is False else _infix("or", test, no)
    if no is False or no is test:
        return Expression("(not {})", test) if yes is True else _infix("and", test, yes)
    otherwise = Expression("(not {})", test)
    if yes is False:
        return otherwise if no is True else _infix("and", otherwise, no)
    if no is True:
        return _infix("or", otherwise, yes)
    return _infix("or", _infix("and", test, yes), _infix("and", otherwise, no))


_Pair = tuple[int, int]


def _differences(
    test: Expression, yes: Expression, no: Expression, chosen: dict[_Pair, Expression]
) -> dict[_Pair, tuple[Expression, Expression]]:
    """The parts in which two expressions differ. Those whose choice is a maximum or a minimum are
    added to `chosen` instead.
    """
    others = {}
    seen = set()
    stack = [(yes, no)]
    while stack:
        one, other = stack.pop()
        key = id(one), id(other)
        if one is other or key in seen:
            continue
        seen.add(key)
        extreme = _extreme(test, one, other)
        if extreme is not None:
            chosen[key] = extreme
        elif one._form == other._form and len(one._parts) == len(other._parts) > 0:
            stack.extend(zip(one._parts, other._parts))
        else:
            others[key] = one, other
    return others


def _replaced(yes: Expression, no: Expression, chosen: dict[_Pair, Any]) -> Expression:
    """`yes` with choices in place of the parts in which it differs from `no`."""
    done: dict[_Pair, Expression] = dict(chosen)
    stack = [(yes, no)]
    while stack:
        one, other = stack[-1]
        pairs = [(a, b) for a, b in zip(one._parts, other._parts) if a is not b]
        left = [(a, b) for a, b in pairs if (id(a), id(b)) not in done]
        if left and (id(one), id(other)) not in done:
            stack.extend(left)
            continue
        stack.pop()
        if (id(one), id(other)) not in done:
            parts = [a if a is b else done[id(a), id(b)] for a, b in zip(one._parts, other._parts)]
            done[id(one), id(other)] = Expression(one._form, *parts)
    return done[id(yes), id(no)]


def _extreme(test: Expression, yes: Expression, no: Expression) -> Expression | None:
    """The choice as a maximum or minimum, if it is one."""
    sides = {"({} > {})": 1, "({} >= {})": 1, "({} < {})": -1, "({} <= {})": -1}.get(test._form)
    if sides is None:
        return None
    greater, less = test._parts[::sides]
    for name, own, other in (("max", greater, less), ("min", less, greater)):
        parts = [
            node._parts if node._form.startswith(name + "(") else (node,) for node in (yes, no)
        ]
        of_yes, of_no = ({id(part) for part in some} for some in parts)
        if of_yes - of_no == {id(own)} and of_no - of_yes == {id(other)}:
            return call(name, *parts[0], other)
    return None


def from_sympy(value: Any) -> str:
    """The text of an expression, an equation or an inequality of SymPy."""
    return text_of(_of_sympy(value))


def is_of_sympy(value: Any) -> bool:
    """Whether a value is of a class of SymPy."""
    return any(str(kind.__module__).startswith("sympy.") for kind in type(value).__mro__)


def _of_sympy(value: Any) -> Expression:
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
        if isinstance(node, (sympy.Sum, sympy.Product)):
            value = node.doit()
            if value.has(sympy.Sum, sympy.Product):
                raise Error(
                    f"this sum or product has no meaning in a formula, write its terms: {node}"
                )
            return convert(value)
        if isinstance(node, sympy.Not):
            return Expression("(not {})", convert(node.args[0]))
        if isinstance(node, sympy.Pow):
            if node.exp == sympy.Rational(1, 2):
                return call("sqrt", convert(node.base))
            return _infix("^", convert(node.base), convert(node.exp))
        if isinstance(node, sympy.Derivative):
            done = node.doit()
            if not done.has(sympy.Derivative):
                return convert(done)
        if isinstance(node, sympy.Integral):
            raise Error(
                f"SymPy's Integral has no meaning in a formula, give its `.doit()` if it has one: "
                f"{node}"
            )
        name = type(node).__name__
        if name in _SYMPY or name in _SYMPY_SAME:
            return call(_SYMPY.get(name, name), *map(convert, node.args))
        raise Error(f"SymPy's {name} has no meaning in a formula: {node}")

    return convert(sympy.sympify(value))


# Ends of ranges that are the floats nearest to multiples of this part of pi are those multiples.
_PART_OF_PI = 12


def parametric(formula: Any, ranges: Mapping[str, Any], values: Mapping[str, float]) -> str:
    """The text of a parametric surface: three coordinates, and the ranges of two parameters. A text
    without ranges has its own.
    """
    if isinstance(formula, str):
        if not ranges:
            return formula
        if re.search(r"\)\s*for\s+\w+\s+in\b", formula.strip().splitlines()[-1]):
            raise Error(f"the text has ranges: leave out {_listed(list(ranges))}")
        names, text = list(ranges), formula
    elif callable(formula) and not is_of_sympy(formula):
        names, arguments = _arguments_of_surface(formula, ranges, values)

        def computed(axis: int) -> Any:
            return _coordinates(formula(*map(Expression, arguments)))[axis]

        coordinates = [expression(_explored(partial(computed, axis))) for axis in range(3)]
        text = _text_of_triple(coordinates, names)
    else:
        names = list(ranges)
        text = _text_of_triple([_coordinate(value) for value in _coordinates(formula)], names)
    if len(names) > 2:
        raise Error(f"a surface has two parameters, and these are {_listed(names)}")
    missing = [name for name in names if name not in ranges]
    if missing or len(names) < 2:
        wanted = _listed([f"{name}=(low, high)" for name in missing] or ["v=(low, high)"])
        raise Error(f"a parametric surface has the ranges of two parameters: give {wanted}, too")
    rows = [f"{name} in [{', '.join(_ends(name, ranges[name]))}]" for name in names]
    return f"{text} for {', '.join(rows)}"


def _arguments_of_surface(
    function: Callable[..., Any], ranges: Mapping[str, Any], values: Mapping[str, float]
) -> tuple[list[str], list[str]]:
    """The names of the parameters of a surface, and those of all arguments of its function."""
    try:
        arguments = list(inspect.signature(function).parameters)
    except (TypeError, ValueError):
        arguments = list(ranges)
    names = arguments[:2]
    if len(names) < 2:
        raise Error("the function of a parametric surface has two arguments, such as u and v")
    other = [name for name in ranges if name not in names]
    other += [name for name in values if name not in arguments]
    if other:
        raise Error(f"{other[0]} is no parameter of the surface: it has {_listed(arguments)}")
    unknown = [name for name in arguments[2:] if name not in values]
    if unknown:
        name = getattr(function, "__name__", "")
        raise Error(f"the function {name} needs a value for {unknown[0]}")
    return names, arguments


def _coordinates(values: Any) -> list[Any]:
    """Three coordinates."""
    found = None
    if not isinstance(values, (Expression, str)):
        with contextlib.suppress(TypeError):
            found = list(values)
    if found is None or len(found) != 3:
        many = "1" if found is None else str(len(found))
        raise Error(f"a parametric surface has three coordinates x, y and z, and not {many}")
    return found


def _text_of_triple(coordinates: list[Expression], parameters: Sequence[str]) -> str:
    """The text of three coordinates. A text has one function of a name, and may have several
    surfaces. So the names of functions follow from all of the text.
    """
    triple = _shared(Expression("({}, {}, {})", *coordinates), {})
    text = text_of(triple, parameters)
    number = zlib.crc32(text.encode())
    letters = "".join(chr(ord("a") + number // 26**place % 26) for place in range(5))
    return text_of(triple, parameters, f"part_{letters}")


def _coordinate(value: Any) -> Expression:
    """A coordinate that is a text, an expression or a number."""
    if isinstance(value, str):
        return Expression(f"({value})")
    return _of_sympy(value) if is_of_sympy(value) else expression(value)


def _ends(name: str, ends: Any) -> tuple[str, str]:
    """The texts of both ends of a range."""
    try:
        low, high = [ends] if isinstance(ends, str) else ends
    except (TypeError, ValueError):
        raise Error(f"{name}={ends!r} is no range: give {name}=(low, high)") from None
    texts = _end(name, low), _end(name, high)
    try:
        is_reversed = float(low) >= float(high)
    except (TypeError, ValueError):
        # The language tells, once other values are known.
        is_reversed = False
    if is_reversed:
        raise Error(f"the range of {name} ends where it begins, or before: {name}=({low}, {high})")
    return texts


def _end(name: str, end: Any) -> str:
    """The text of an end of a range."""
    if isinstance(end, str):
        return end
    if is_of_sympy(end):
        return from_sympy(end)
    if isinstance(end, numbers.Rational):
        return str(Fraction(end))
    if not isinstance(end, numbers.Real) or not math.isfinite(end):
        raise Error(f"the range of {name} has an end {end!r}, which is no finite number")
    number = float(end)
    count = round(number * _PART_OF_PI / math.pi)
    exact = count * math.pi / _PART_OF_PI
    if count != 0 and abs(number - exact) <= 2 * math.ulp(exact):
        share = Fraction(count, _PART_OF_PI)
        times = {1: "pi", -1: "-pi"}.get(share.numerator, f"{share.numerator}*pi")
        return f"{times}/{share.denominator}" if share.denominator != 1 else times
    return repr(number)


def _listed(names: Sequence[str]) -> str:
    """Names as a list in a sentence."""
    *most, last = names
    return f"{', '.join(most)} and {last}" if most else last
