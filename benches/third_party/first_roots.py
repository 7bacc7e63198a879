"""Checks the claims that `zeroset-chart rays` wrote with flint, which isolates roots of polynomials, and with mpmath.

    zeroset-chart rays barth-sextic --methods affine -o rays/barth-sextic
    python3 first_roots.py ../../examples rays

Each directory of rays has the name of a function file. Python parses that function and substitutes each ray. If the
result is a polynomial, its roots are isolated exactly. There must be no root from the ray's entry into the domain to
the claimed interval, and at least one in that interval. Irrational constants are rounded to 40 digits. Any other
function is sampled with 40 digits: its sign must change in the interval, and not before.

Prints a line for each surface, and exits with status 1 if a claim is wrong.
"""

import ast
import math
import operator
import re
import sys
from fractions import Fraction
from pathlib import Path

import flint
import mpmath
import numpy

mpmath.mp.dps = 40
flint.ctx.prec = 200
SAMPLES = 120


class Polynomial:
    """A polynomial in t with rational coefficients, the lowest first."""

    def __init__(self, *coefficients):
        self.c = list(coefficients)

    def __add__(self, other):
        n = max(len(self.c), len(other.c))
        a, b = (p.c + [0] * (n - len(p.c)) for p in (self, other))
        return Polynomial(*map(operator.add, a, b))

    def __neg__(self):
        return Polynomial(*map(operator.neg, self.c))

    def __sub__(self, other):
        return self + -other

    def __mul__(self, other):
        c = [Fraction(0)] * (len(self.c) + len(other.c) - 1)
        for i, a in enumerate(self.c):
            for j, b in enumerate(other.c):
                c[i + j] += a * b
        return Polynomial(*c)

    def __truediv__(self, other):
        if len(other.c) > 1:
            raise NotPolynomial
        return Polynomial(*(a / other.c[0] for a in self.c))

    def __pow__(self, power):
        n = power.c[0]
        if len(power.c) > 1 or n.denominator != 1 or n < 0:
            raise NotPolynomial
        result = Polynomial(Fraction(1))
        for _ in range(int(n)):
            result = result * self
        return result


class NotPolynomial(Exception):
    pass


def rational(number):
    return Fraction(str(mpmath.nstr(number, 40)))


class Exact:
    """Evaluation on a ray to a polynomial in t."""

    names = {"phi": mpmath.phi, "pi": mpmath.pi, "e": mpmath.e}

    @staticmethod
    def number(text):
        return Polynomial(Fraction(text))

    @classmethod
    def constant(cls, name):
        return Polynomial(rational(+cls.names[name]))

    @staticmethod
    def call(name, arguments):
        if name == "sqrt" and len(arguments[0].c) == 1:
            value = arguments[0].c[0]
            return Polynomial(rational(mpmath.sqrt(mpmath.mpf(value.numerator) / value.denominator)))
        raise NotPolynomial


class Sampled:
    """Evaluation at a point to a number of 40 digits."""

    functions = {
        "sin": mpmath.sin, "cos": mpmath.cos, "tan": mpmath.tan, "exp": mpmath.exp, "log": mpmath.log,
        "sqrt": mpmath.sqrt, "abs": abs, "max": max, "min": min, "floor": mpmath.floor,
    }

    @staticmethod
    def number(text):
        return mpmath.mpf(text)

    @staticmethod
    def constant(name):
        return +Exact.names[name]

    @classmethod
    def call(cls, name, arguments):
        if name == "abs":
            return abs(arguments[0])
        result = cls.functions[name](*arguments)
        if isinstance(result, mpmath.mpc):
            raise ValueError("not real")
        return result


OPERATORS = {
    ast.Add: operator.add, ast.Sub: operator.sub, ast.Mult: operator.mul, ast.Div: operator.truediv,
    ast.Pow: operator.pow,
}


def evaluate(node, names, kind):
    match node:
        case ast.BinOp():
            return OPERATORS[type(node.op)](*(evaluate(n, names, kind) for n in (node.left, node.right)))
        case ast.UnaryOp(op=ast.USub()):
            return -evaluate(node.operand, names, kind)
        case ast.Constant():
            return kind.number(str(node.value))
        case ast.Name():
            return names[node.id] if node.id in names else kind.constant(node.id)
        case ast.Call():
            return kind.call(node.func.id, [evaluate(a, names, kind) for a in node.args])
    raise ValueError(ast.dump(node))


def statements(text):
    """Pairs of name and formula in order; the function itself comes last, without a name."""
    lines = [line.split("#")[0].strip() for line in text.splitlines()]
    words = ("domain", "view", "color", "look", "light", "axes")
    lines = [line for line in lines if line and line.split()[0] not in words]
    for line in lines:
        name, found, formula = line.partition("=")
        formula = re.sub(r"\bin\b.*", "", formula) if found else line
        yield name.strip() if found else None, ast.parse(formula.strip().replace("^", "**"), mode="eval").body


def function(parts, at, kind):
    names = dict(zip("xyz", at))
    for name, tree in parts:
        value = evaluate(tree, names, kind)
        if name is None:
            return value
        names[name] = value


def span(origin, way, domain):
    """The exact parameters where the ray enters and leaves the box; None if it misses the box."""
    near, far = Fraction(0), None
    for o, d, low, high in zip(origin, way, domain[::2], domain[1::2]):
        if d == 0:
            if not low <= o <= high:
                return None
            continue
        first, last = sorted(((low - o) / d, (high - o) / d))
        near, far = max(near, first), last if far is None else min(far, last)
    return (near, far) if near <= far else None


def real_roots(p):
    """All real roots, each as a ball that holds it."""
    scale = math.lcm(*(Fraction(c).denominator for c in p.c))
    roots = flint.fmpz_poly([int(c * scale) for c in p.c]).complex_roots()
    return [root.real for root, _ in roots if root.imag == 0]


def polynomial_verdict(roots, inside, claim):
    ball = lambda number: flint.arb(flint.fmpq(number.numerator, number.denominator))
    within = lambda root, ends: root >= ball(ends[0]) and root <= ball(ends[1])
    end = inside[1] if claim is None else claim[0]
    if any(within(root, (inside[0], end)) for root in roots):
        return False
    return claim is None or any(within(root, claim) for root in roots)


def sampled_verdict(value, inside, claim):
    def sign(t):
        try:
            return mpmath.sign(value(t))
        except (ValueError, ZeroDivisionError, TypeError):
            return None

    def is_crossing(a, b):
        """Whether the sign changes at a zero, not at a pole, a jump or the end of the domain of definition."""
        start, ends = sign(a), (a, b)
        for _ in range(140):
            middle = (a + b) / 2
            if sign(middle) == start:
                a = middle
            else:
                b = middle
        try:
            small = max(abs(value(a)), abs(value(b)))
        except (ValueError, ZeroDivisionError, TypeError):
            return False
        return small < 1e-20 * (1 + 1 / abs(ends[1] - ends[0]))

    end = inside[1] if claim is None else claim[0]
    steps = [inside[0] + (end - inside[0]) * k / SAMPLES for k in range(SAMPLES + 1)]
    signs = [sign(t) for t in steps]
    for a, b, s, r in zip(steps, steps[1:], signs, signs[1:]):
        if s and r and s != r and is_crossing(a, b):
            return False
    if claim is None:
        return True
    s, r = (sign(t) for t in claim)
    # Signs prove nothing if the interval ends outside the domain, or where f is undefined.
    if s is None or r is None or s != r:
        return True
    # The function may have jumped back behind a zero.
    inner = (claim[0] + (claim[1] - claim[0]) * k / SAMPLES for k in range(SAMPLES))
    return any(sign(t) not in (s, None) for t in inner)


def main():
    examples, directory = map(Path, sys.argv[1:3])
    wrong = total = 0
    for rays in sorted(directory.glob("*/rays.npy")):
        name = rays.parent.name
        parts = list(statements((examples / f"{name}.zset").read_text()))
        domain = [Fraction(float(e)) for e in numpy.load(rays.parent / "domain.npy").flatten()]
        certified, affine = (numpy.load(rays.parent / f"{f}.npy") for f in ("certified", "affine"))
        counts = {"agree": 0, "open": 0, "wrong": 0}
        is_exact = True
        roots = None
        for row, c, a in zip(numpy.load(rays), certified, affine):
            origin, way = ([Fraction(float(v)) for v in row[i : i + 3]] for i in (0, 3))
            inside = span(origin, way, domain)
            length = float(numpy.linalg.norm(row[3:]))
            if is_exact:
                try:
                    at = [Polynomial(o, d) for o, d in zip(origin, way)]
                    roots = real_roots(function(parts, at, Exact))
                except NotPolynomial:
                    is_exact = False
            for status, near, far in ((c[0], c[1], c[2]), (a[0], a[1], a[2])):
                if status == 2 or inside is None:
                    counts["open" if status == 2 else "agree" if status == 0 else "wrong"] += 1
                    continue
                claim = None
                if status == 1:
                    slack = 1e-14 * (1 + abs(far))
                    claim = [Fraction(e) for e in ((near - slack) / length, (far + slack) / length)]
                if is_exact:
                    verdict = polynomial_verdict(roots, inside, claim)
                else:
                    mp = lambda f: mpmath.mpf(f.numerator) / f.denominator
                    o, d = ([mp(v) for v in part] for part in (origin, way))
                    value = lambda t: function(parts, [a + t * b for a, b in zip(o, d)], Sampled)
                    with mpmath.workdps(40):
                        ends = [None if e is None else [mp(v) for v in e] for e in (inside, claim)]
                        verdict = sampled_verdict(value, *ends)
                counts["agree" if verdict else "wrong"] += 1
                if not verdict:
                    print(f"  {name}: {row.tolist()} is said to be {status, near, far}")
        kind = "isolated" if is_exact else "sampled"
        print(f"{name:34}{kind}  {counts}", flush=True)
        wrong += counts["wrong"]
        total += counts["agree"]
    print(f"{total} claims agree, {wrong} are wrong")
    sys.exit(wrong > 0)


main()
