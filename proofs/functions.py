"""Proves the bounds of elementary functions in f64, at every float of their domains.

    ZEROSET_PROOFS=DIR cargo test -p zeroset-interval --lib proofs_
    python proofs/functions.py DIR/functions

Each file lists the operations that a routine executes, as a test recorded them, and names the
bounds that it returns. This script divides the domain into cells. In a cell it knows of each value:

- what it is without rounding, as a Taylor polynomial of the input with a bound of the rest, by
  FLINT's ball arithmetic;
- how far rounding can have moved it, upward and downward;
- the place of its last bit, and how many bits it has. They show which operations are exact.

A pair of head and tail is closer to the exact value than either. `Machine.pair_of` knows the sums,
products, quotients and roots that make such pairs, from the operations alone. Its rule for the
rounding error of a product is an argument by hand, `exact_product`.

A comparison that both outcomes are possible for is followed twice. A cell is proven if the bounds,
less all rounding, hold the function's Taylor polynomial. Exits with status 1 if a cell is not.
"""

import argparse
import math
import struct
import sys
import time
from fractions import Fraction
from itertools import chain, pairwise, permutations
from multiprocessing import Pool
from pathlib import Path

from flint import arb, arb_poly, arb_series, ctx, fmpq

ORDER = 16
ctx.prec = 200
ctx.cap = ORDER + 1
U = 2.0**-52
LEAST = 2.0**-1074
SIGN = 1 << 63
UPPER_HALF = (1 << 64) - (1 << 27)
ALL = (1 << 64) - 1
MOST_BITS = 53
# Errors are sums and products of numbers that are not negative, computed with rounding to nearest.
# This factor covers it.
MORE = 1 + 2.0**-40
BALL = arb(0, 1)
# A cell that is not proven is halved this often.
HALVINGS = 8
# A cell of so few floats is divided into them.
FEW = 8
# Any |error| that is not bounded.
NONE = math.inf


def to_float(bits):
    return struct.unpack("<d", struct.pack("<Q", bits))[0]


def to_bits(number):
    return struct.unpack("<Q", struct.pack("<d", number))[0]


def rounded_up(exact):
    """The least float that is not below a fraction."""
    try:
        near = float(exact)
    except OverflowError:
        return math.inf if exact > 0 else -sys.float_info.max
    return near if Fraction(near) >= exact else math.nextafter(near, math.inf)


def arb_of(number):
    number = Fraction(number)
    return arb(fmpq(number.numerator, number.denominator))


def last_bit(number):
    """The largest k such that a float is a multiple of 2^k."""
    number = Fraction(number)
    twos = (number.numerator & -number.numerator).bit_length() - 1
    return twos - (number.denominator.bit_length() - 1)


def exponent(number):
    """The k with 2^k ≤ number < 2^(k + 1)."""
    return math.frexp(number)[1] - 1


def sum_below(a, b):
    """A bound of a + b from below."""
    big, small = (a, b) if abs(a) >= abs(b) else (b, a)
    near = big + small
    return near if small - (near - big) >= 0 else math.nextafter(near, -math.inf)


def lost(most, lsb=None):
    """What rounding a number up can add, if it is at most `most` and a multiple of 2^lsb."""
    if most < 2.0**-1021:
        return LEAST
    places = exponent(math.nextafter(most, 0.0)) - 52
    unit = 2.0**places
    return unit - 2.0**lsb if lsb is not None and -1074 <= lsb < places else unit


def below(ball):
    return math.nextafter(float(ball.lower()), -math.inf)


def above(ball):
    return math.nextafter(float(ball.upper()), math.inf)


def product(a, b):
    """The product of two intervals, rounded outward."""
    ends = [x * y if x and y else 0.0 for x in a for y in b]
    lo, hi = min(ends), max(ends)
    return lo - abs(lo) * 2.0**-50 - LEAST, hi + abs(hi) * 2.0**-50 + LEAST


def times_power(a, power):
    """An interval times a power of two, rounded outward if it underflows."""
    try:
        ends = [math.ldexp(end, power) for end in a]
    except OverflowError:
        raise Unproven("overflow") from None
    for i, away in enumerate((-math.inf, math.inf)):
        if abs(ends[i]) < 2.0**-1022 and a[i]:
            ends[i] = math.nextafter(ends[i], away)
    return tuple(ends)


def total(*parts):
    lo, hi = sum(p[0] for p in parts), sum(p[1] for p in parts)
    more = 2.0**-50 * sum(max(abs(p[0]), abs(p[1])) for p in parts)
    return lo - more, hi + more


def minus(a):
    return -a[1], -a[0]


def size(a):
    return max(abs(a[0]), abs(a[1]))


def hull(a, b):
    return min(a[0], b[0]), max(a[1], b[1])


class Series:
    """A function on a cell, as a Taylor polynomial about its middle, and one about all of its
    points at once. The last coefficient of that bounds the rest."""

    __slots__ = ("thin", "fat", "_range")

    def __init__(self, thin, fat):
        self.thin, self.fat, self._range = thin, fat, None

    def ball(self):
        """All values in the cell."""
        parts = list(self.thin)[:ORDER]
        ball = arb_poly(parts)(BALL) if parts else arb(0)
        return ball + self.fat[ORDER] * BALL

    def range(self):
        if self._range is None:
            ball = self.ball()
            self._range = below(ball), above(ball)
        return self._range

    def __add__(self, other):
        return Series(self.thin + other.thin, self.fat + other.fat)

    def __sub__(self, other):
        return Series(self.thin - other.thin, self.fat - other.fat)

    def __mul__(self, other):
        return Series(self.thin * other.thin, self.fat * other.fat)

    def __truediv__(self, other):
        if other.fat[0].contains(0):
            raise Unproven("a quotient by 0")
        return Series(self.thin / other.thin, self.fat / other.fat)

    def __neg__(self):
        return Series(-self.thin, -self.fat)

    def times(self, factor):
        return Series(self.thin * factor, self.fat * factor)

    def sqrt(self):
        return Series(self.thin.sqrt(), self.fat.sqrt())


def constant(number):
    series = arb_series([number])
    return Series(series, series)


ZERO = constant(arb(0))
ONE = constant(arb(1))


class Unproven(Exception):
    pass


class Node:
    """A float that an operation computes. `value()` of a machine fills in what is known of it."""

    __slots__ = ("op", "args", "exact", "error", "range", "lsb", "bits", "known", "heads",
                 "spread", "under", "rounded")

    def __init__(self, op, args):
        self.op, self.args, self.known = op, args, False
        self.exact = self.error = self.range = self.lsb = None
        self.bits = MOST_BITS
        self.heads = []
        # The error is also within 0 and `spread`. The error misses what is between −`under` and 0.
        self.spread = self.under = None
        self.rounded = True


class Low:
    """An integer of which only the last bits are known."""

    def __init__(self, value, count):
        self.value, self.count = value % (1 << count), count


class Shifted:
    """The bits of a float plus an integer."""

    def __init__(self, node, by):
        self.node, self.by = node, by


class Pair:
    """The sum of head and tail: `exact` without rounding, and the error of the sum."""

    def __init__(self, exact, error, sums, rounding):
        self.exact, self.error, self.sums, self.rounding = exact, error, sums, rounding

    def range(self):
        return total(self.exact.range(), self.error)


class Machine:
    """Executes a program in a cell."""

    def __init__(self, lines, inputs, decisions):
        self.lines, self.inputs = lines, inputs
        self.decisions, self.next, self.options = decisions, 0, []
        self.nodes, self.numbers, self.pairs, self.fields = {}, {}, {}, {}
        self.values = {}

    # Execution.

    def line(self, number):
        """The value of a line: bits as an integer, or a node."""
        if number not in self.values:
            stack = [number]
            while stack:
                top = stack[-1]
                name, *args = self.lines[top]
                if top in self.inputs:
                    self.values[top] = self.inputs[top]
                elif name == "bits":
                    self.values[top] = int(args[0], 16)
                else:
                    shift = name.startswith("shift")
                    operands = [int(a) for a in (args[:1] if shift else args)]
                    missing = [a for a in operands if a not in self.values]
                    if missing:
                        stack += missing
                        continue
                    values = [self.values[a] for a in operands]
                    if shift:
                        values.append(int(args[1]))
                    found = getattr(self, "do_" + name)(*values)
                    if isinstance(found, Node) and found.op == "number":
                        found = to_bits(found.args[0])
                    self.values[top] = found
                stack.pop()
        return self.values[number]

    def decide(self, count):
        """The number of an outcome, where several are possible."""
        if self.next == len(self.decisions):
            self.decisions.append(0)
        self.options.append(count)
        self.next += 1
        return self.decisions[self.next - 1]

    def node(self, op, *args):
        key = (op, *map(id, args)) if op != "scale" else (op, id(args[0]), args[1])
        if key not in self.nodes:
            self.nodes[key] = Node(op, args)
        return self.nodes[key]

    def real(self, value):
        """A value as a node."""
        if isinstance(value, Node):
            return value
        if isinstance(value, Shifted):
            if value.by % (1 << 52) == 0:
                power = value.by >> 52
                power -= 4096 if power >= 2048 else 0
                lo, _ = self.value(value.node).range
                if lo >= 2.0**-1022:
                    return self.scaled(value.node, power)
            raise Unproven("bits as a float")
        if value not in self.numbers:
            number = to_float(value)
            node = Node("number", (number,))
            if not math.isfinite(number):
                raise Unproven("an infinite number")
            node.exact, node.error, node.range = constant(arb_of(number)), (0.0, 0.0), (number,) * 2
            node.known = True
            if number:
                node.lsb = last_bit(number)
                node.bits = exponent(abs(number)) + 1 - node.lsb
            else:
                node.lsb, node.bits = 10**6, 0
            self.numbers[value] = node
        return self.numbers[value]

    def scaled(self, node, power):
        return node if power == 0 else self.node("scale", node, power)

    def is_number(self, *values):
        return all(isinstance(v, int) for v in values)

    def fold(self, op, *values):
        """The result of an operation on numbers."""
        numbers = [Fraction(to_float(v)) for v in values]
        exact = op(*numbers)
        if exact == 0:
            return 0
        return to_bits(rounded_up(exact))

    def do_add(self, a, b):
        if self.is_number(a, b):
            return self.fold(lambda a, b: a + b, a, b)
        a, b = self.real(a), self.real(b)
        if a.op == "number" and a.args[0] == 0:
            return b
        if b.op == "number" and b.args[0] == 0:
            return a
        if a is b:
            return self.scaled(a, 1)
        return self.node("add", a, b)

    def do_sub(self, a, b):
        if self.is_number(a, b):
            return self.fold(lambda a, b: a - b, a, b)
        a, b = self.real(a), self.real(b)
        if a is b:
            return 0
        if b.op == "number" and b.args[0] == 0:
            return a
        if a.op == "number" and a.args[0] == 0:
            return self.do_neg(b)
        return self.node("sub", a, b)

    def do_mul(self, a, b):
        if self.is_number(a, b):
            return self.fold(lambda a, b: a * b, a, b)
        for one, other in [(a, b), (b, a)]:
            if isinstance(other, int):
                number = to_float(other)
                if number == 0:
                    return 0
                mantissa, power = math.frexp(number)
                if mantissa in (0.5, -0.5):
                    node = self.scaled(self.real(one), power - 1)
                    return node if mantissa > 0 else self.do_neg(node)
        return self.node("mul", self.real(a), self.real(b))

    def do_mul_add(self, a, b, c):
        """One rounding gives at most what two give, and not less than the exact result."""
        inexact = self.do_mul(a, b)
        return self.do_add(inexact, c)

    def do_div(self, a, b):
        if self.is_number(a, b):
            return self.fold(lambda a, b: a / b, a, b) if to_float(b) else to_bits(math.nan)
        if self.is_number(a) and to_float(a) == 0:
            return 0
        if isinstance(b, int) and math.frexp(to_float(b))[0] == 0.5:
            return self.scaled(self.real(a), 1 - math.frexp(to_float(b))[1])
        return self.node("div", self.real(a), self.real(b))

    def do_sqrt(self, a):
        if self.is_number(a):
            number = Fraction(to_float(a))
            root = Fraction(math.isqrt(int(number * 4**600)), 2**600)
            if root * root == number:
                return to_bits(float(root))
            near = math.sqrt(to_float(a))
            near = near if Fraction(near) ** 2 >= number else math.nextafter(near, math.inf)
            return to_bits(near)
        return self.node("sqrt", self.real(a))

    def do_neg(self, a):
        if isinstance(a, int):
            return a ^ SIGN
        a = self.real(a)
        return a.args[0] if a.op == "neg" else self.node("neg", a)

    def do_abs(self, a):
        if isinstance(a, int):
            return a & ~SIGN
        return self.do_neg(a) if self.is_negative(self.real(a)) else a

    def is_negative(self, node):
        key = ("sign", id(node))
        if key not in self.fields:
            lo, hi = self.value(node).range
            if lo >= 0:
                self.fields[key] = False
            elif hi < 0:
                self.fields[key] = True
            else:
                self.fields[key] = bool(self.decide(2))
        return self.fields[key]

    def order(self, a, b):
        """Whether a < b, a = b or a > b, as −1, 0 and 1."""
        a, b = self.real(a), self.real(b)
        if a is b:
            return 0
        key = ("order", id(a), id(b))
        if key not in self.fields:
            (a_lo, a_hi), (b_lo, b_hi) = self.value(a).range, self.value(b).range
            outcomes = []
            if a_lo < b_hi:
                outcomes.append(-1)
            if a_hi > b_lo:
                outcomes.append(1)
            if a_lo <= b_hi and b_lo <= a_hi:
                outcomes.append(0)
            chosen = outcomes[self.decide(len(outcomes))] if len(outcomes) > 1 else outcomes[0]
            self.fields[key] = chosen
            self.fields[("order", id(b), id(a))] = -chosen
        return self.fields[key]

    def do_min(self, a, b):
        return b if self.is_greatest(a, b) else a

    def do_max(self, a, b):
        return a if self.is_greatest(a, b) else b

    def is_greatest(self, a, b):
        """Whether a ≥ b. Equal numbers are both the greatest."""
        one, other = self.value(a), self.value(b)
        if one.range[1] <= other.range[0]:
            return False
        return one.range[0] >= other.range[1] or self.order(a, b) >= 0

    def do_lt(self, a, b):
        return ALL if self.order(a, b) < 0 else 0

    def do_le(self, a, b):
        return ALL if self.order(a, b) <= 0 else 0

    def do_eq(self, a, b):
        return ALL if self.order(a, b) == 0 else 0

    def do_nearest(self, a):
        if isinstance(a, int):
            return to_bits(float(round(Fraction(to_float(a)))))
        lo, hi = self.value(a).range
        first, last = round(lo), round(hi)
        if last - first > 3:
            raise Unproven("many integers")
        chosen = first + (self.decide(last - first + 1) if last > first else 0)
        return to_bits(float(chosen))

    def do_select(self, mask, a, b):
        assert mask in (0, ALL), "a mask"
        return a if mask else b

    def do_select_signed(self, sign, a, b):
        negative = bool(sign & SIGN) if isinstance(sign, int) else self.is_negative(self.real(sign))
        return a if negative else b

    def field(self, shifted):
        """The bits of a float plus an integer, without the last 52. The float is not negative."""
        key = ("field", id(shifted.node), shifted.by)
        if key not in self.fields:
            lo, hi = self.value(shifted.node).range
            if lo < 0:
                raise Unproven("bits of a negative number")
            first, last = ((to_bits(end) + shifted.by) >> 52 for end in (lo, hi))
            if last - first > 2:
                raise Unproven("many exponents")
            self.fields[key] = first + (self.decide(last - first + 1) if last > first else 0)
        return self.fields[key]

    def shifted(self, a):
        return a if isinstance(a, Shifted) else Shifted(self.real(a), 0)

    def do_and(self, a, b):
        if self.is_number(a, b):
            return a & b
        if isinstance(a, int):
            a, b = b, a
        if isinstance(a, Low):
            assert isinstance(b, int) and b < 1 << a.count, "known bits"
            return a.value & b
        if b in (0, ALL):
            return a if b else 0
        if b == SIGN:
            return SIGN if self.is_negative(self.real(a)) else 0
        if b == 0xFFF << 52:
            return self.field(self.shifted(a)) << 52
        clear = b ^ ALL
        assert clear & (clear + 1) == 0 and clear < 1 << 52, "a mask of low bits"
        return self.node("mask", self.real(a), clear.bit_length())

    def do_or(self, a, b):
        assert self.is_number(a, b), "known bits"
        return a | b

    def do_xor(self, a, b):
        if self.is_number(a, b):
            return a ^ b
        if isinstance(a, int):
            a, b = b, a
        assert b in (0, SIGN), "a sign"
        return self.do_neg(a) if b else a

    def do_int_add(self, a, b):
        if self.is_number(a, b):
            return (a + b) & ALL
        if isinstance(a, Low):
            return Low(a.value + (b if isinstance(b, int) else b.value), a.count)
        assert isinstance(b, int), "a known integer"
        a = self.shifted(a)
        return Shifted(a.node, (a.by + b) & ALL if a.by + b > ALL else a.by + b)

    def do_int_sub(self, a, b):
        if self.is_number(a, b):
            return (a - b) & ALL
        assert isinstance(b, int), "a known integer"
        a = self.shifted(a)
        return Shifted(a.node, (a.by - b) & ALL)

    def do_shift_left(self, a, by):
        if isinstance(a, Low):
            assert by + a.count >= 64, "known bits"
            return (a.value << by) & ALL
        return (a << by) & ALL

    def do_shift_right(self, a, by):
        if isinstance(a, int):
            return a >> by
        assert by == 52, "an exponent"
        return self.field(self.shifted(a)) & 0xFFF

    # What is known of values.

    def value(self, node):
        """Finds out what is known of a node."""
        node = self.real(node)
        if node.known:
            return node
        # Without recursion, since sums of many terms are deep.
        stack = [node]
        while stack:
            top = stack[-1]
            if top.known:
                stack.pop()
                continue
            if any(a.known and a.under for a in self.needed(top)):
                raise Unproven("an operand without all of its error")
            needed = [a for a in self.needed(top) if not a.known]
            if needed:
                stack += needed
                continue
            self.find(top)
            top.known = True
            stack.pop()
        return node

    def needed(self, node):
        core = self.exact_product(node)
        if core:
            return core[:3]
        tail = sum_tail(node)
        if tail:
            return tail[:3]
        return [a for a in node.args if isinstance(a, Node)]

    def find(self, node):
        getattr(self, "find_" + node.op)(node)
        lo, hi = node.range
        # A float of at least 2^k is a multiple of 2^(k − 52).
        if lo > 0 or hi < 0:
            least = max(exponent(min(abs(lo), abs(hi))) + 1 - max(node.bits, 1), -1074)
            node.lsb = least if node.lsb is None else max(node.lsb, least)
        if node.lsb is not None:
            most = size(node.range)
            places = exponent(most) + 1 - node.lsb if most else 0
            node.bits = min(node.bits, max(places, 0))

    def is_below_one(self, node):
        """Whether the node is 1 − z/2 for a float z from 0 to 1. Its rounding is then at most
        2^-53·(1 − z/2): z/2 is a multiple of 2^(e − 53), where 2^e is at most z and above z/2, so
        rounding up to a multiple of 2^-53 adds at most 2^-53 − 2^(e − 53)."""
        if node.op != "add":
            return False
        for one, other in [node.args, node.args[::-1]]:
            if one.op == "number" and one.args[0] == 1 and other.op == "neg":
                half = other.args[0]
                if half.op == "scale" and half.args[1] == -1:
                    lo, hi = half.args[0].range
                    return lo >= 0 and hi <= 1
        return False

    def set(self, node, exact, error, rounds, lsb=None):
        """`rounds`: whether the result is rounded; the error is that of the operands."""
        node.exact, node.lsb, node.rounded = exact, lsb, rounds
        at = exact.range()
        if rounds:
            error = error[0], (error[1] + lost(size(total(at, error)), lsb)) * MORE
        node.error, node.range = error, total(at, error)

    def rounding(self, node):
        """The rounding error of an operation, at most."""
        return 0.0, lost(size(node.range))

    def is_exact(self, lsb, most):
        return lsb is not None and lsb >= -1074 and most <= 2.0 ** min(MOST_BITS + lsb, 1023)

    def find_scale(self, node):
        a, power = node.args
        exact = a.exact.times(arb(2) ** power)
        lsb = None if a.lsb is None else a.lsb + power
        tiny = lsb is None or lsb < -1074
        error = times_power(a.error, power)
        self.set(node, exact, error, False, lsb)
        if tiny:
            node.error = node.error[0], node.error[1] + LEAST
            node.range = total(exact.range(), node.error)
        else:
            node.range = times_power(a.range, power)
        node.bits = a.bits
        for head, _ in list(a.heads):
            pair = self.pairs[id(head), id(a)]
            scaled = self.scaled(head, power)
            self.value(scaled)
            both = times_power(pair.error, power)
            both = both[0], both[1] + (2 * LEAST if tiny else 0)
            self.register(scaled, node, Pair(pair.exact.times(arb(2) ** power), both, None, None))

    def find_neg(self, node):
        a = node.args[0]
        self.set(node, -a.exact, minus(a.error), False, a.lsb)
        node.range = minus(a.range)
        node.bits = a.bits
        for head, _ in list(a.heads):
            pair = self.pairs[id(head), id(a)]
            self.value(self.do_neg(head))
            negated = Pair(-pair.exact, minus(pair.error), None, None)
            self.register(self.do_neg(head), node, negated)

    def find_mask(self, node):
        """The low bits are cleared: the number moves toward 0."""
        a, count = node.args
        lo, hi = a.range
        off = size(a.range) * 2.0 ** (count - 52)
        moved = (-off if hi > 0 else 0.0, off if lo < 0 else 0.0)
        lsb = None if a.lsb is None else a.lsb
        self.set(node, a.exact, total(a.error, moved), False, lsb)
        node.bits = MOST_BITS - count

    def find_sqrt(self, node):
        a = node.args[0]
        root = a.exact.sqrt()
        lo = root.range()[0] + math.sqrt(max(a.range[0], 0.0))
        if not lo > 0:
            raise Unproven("a root of 0")
        error = tuple(e / lo * MORE for e in a.error) if size(a.error) else (0.0, 0.0)
        self.set(node, root, error, True)
        if a.range[0] >= 1:
            node.range = max(node.range[0], 1.0), node.range[1]

    def find_mul(self, node):
        a, b = node.args
        ends = [Fraction(x) * Fraction(y) for x in a.range for y in b.range]
        if max(map(abs, ends)) <= LEAST:
            # Rounded up, it is 0 or the least number.
            least, most = (LEAST if end > 0 else 0.0 for end in (min(ends), max(ends)))
            node.exact = constant(arb_of(least))
            node.error, node.range, node.lsb = (0.0, most - least), (least, most), -1074
            return
        exact = a.exact * b.exact
        error = total(product(a.error, hull(b.range, b.exact.range())),
                      product(hull(a.range, a.exact.range()), b.error))
        if a.error == b.error == (0.0, 0.0):
            error = 0.0, 0.0
        lsb = None if a.lsb is None or b.lsb is None else a.lsb + b.lsb
        most = size(total(exact.range(), error))
        fits = lsb is not None and lsb >= -1074 and a.bits + b.bits <= MOST_BITS
        self.set(node, exact, error, not (fits or self.is_exact(lsb, most)), lsb)
        if a is b:
            node.range = max(node.range[0], 0.0), node.range[1]

    def find_div(self, node):
        a, b = node.args
        if self.quotient_tail(node, a, b) or self.root_tail(node, a, b):
            return
        if b.range[0] <= 0 <= b.range[1]:
            raise Unproven("a quotient by 0")
        exact = a.exact / b.exact
        inverse = hull((1 / b.range[0],) * 2, (1 / b.range[1],) * 2)
        error = product(total(a.error, minus(product(exact.range(), b.error))), inverse)
        if a.error == b.error == (0.0, 0.0):
            error = 0.0, 0.0
        self.set(node, exact, error, True)

    def find_sub(self, node):
        self.find_sum(node, -1)

    def find_add(self, node):
        self.find_sum(node, 1)

    def find_sum(self, node, sign):
        core = self.exact_product(node)
        if core:
            return self.product_tail(node, *core)
        tail = sum_tail(node)
        if tail:
            return self.sum_tail(node, *tail)
        a, b = node.args
        # A head and its tail.
        for head, other, s in [(a, b, sign), (b, a, 1)]:
            pair = self.pairs.get((id(head), id(other))) if s == 1 else None
            if pair and sign == 1:
                return self.set(node, pair.exact, pair.error, True)
        negated = self.real(self.do_neg(b)) if sign == -1 else None
        if negated and (id(negated), id(a)) in self.pairs:
            pair = self.pairs[id(negated), id(a)]
            return self.set(node, pair.exact, pair.error, True)
        exact = a.exact + b.exact if sign == 1 else a.exact - b.exact
        error = total(a.error, b.error if sign == 1 else minus(b.error))
        if a.error == b.error == (0.0, 0.0):
            error = 0.0, 0.0
        lsb = None if a.lsb is None or b.lsb is None else min(a.lsb, b.lsb)
        if sign == -1 and b.spread:
            node.under = b.spread
            error = total(a.error, minus((b.error[0], 0.0)))
        most = size(total(exact.range(), error))
        self.set(node, exact, error, not self.is_exact(lsb, most), lsb)
        if sign == 1:
            node.range = max(node.range[0], sum_below(a.range[0], b.range[0])), node.range[1]
        if self.is_below_one(node):
            z = other_than_one(node).args[0].args[0]
            if z.error[0] == 0:
                # z may have been rounded up, which makes 1 − z/2 smaller.
                node.spread = exact.times(arb(2) ** -53)
                if z.range[1] < 2.0**-54:
                    # The sum is rounded to 1, so by z/2.
                    node.spread = (ONE - exact).times(1 + arb(2) ** -40)
                node.error = node.error[0], min(node.error[1], 2.0**-53)
                node.range = node.range[0], 1.0
        # A tail, and what is added to it.
        for tail, other, s, t in [(a, b, 1, sign), (b, a, sign, 1)]:
            for head, _ in list(tail.heads):
                self.extend(node, head, tail, other, s, t)

    # Pairs.

    def register(self, head, tail, pair):
        key = id(head), id(tail)
        if key not in self.pairs:
            self.pairs[key] = pair
            tail.heads.append((head, pair))

    def pair_error(self, leaves):
        """The sum of nodes, pairs among them taken together: its exact value and its error."""
        exact, error, left = ZERO, (0.0, 0.0), []
        for leaf in leaves:
            # An exact difference of a head and a number counts as both.
            if leaf.op == "sub" and not leaf.rounded and leaf.args[1].op == "number" and any(
                    head is leaf.args[0] for tail in leaves for head, _ in tail.heads):
                left += [leaf.args[0], self.value(self.do_neg(to_bits(leaf.args[1].args[0])))]
            else:
                left.append(leaf)
        leaves = list(left)
        for tail in leaves:
            for head, pair in tail.heads:
                if tail in left and head in left and head is not tail:
                    left.remove(tail)
                    left.remove(head)
                    exact, error = exact + pair.exact, total(error, pair.error)
        for leaf in left:
            exact, error = exact + leaf.exact, total(error, leaf.error)
        return exact, error

    def make_pair(self, head, tail, sums, rounding):
        """Registers a pair: the sum of nodes, or the product of two sums."""
        parts = [self.pair_error(leaves) for leaves in sums]
        exact, error = parts[0]
        if len(parts) == 2:
            other, off = parts[1]
            error = total(product(error, total(other.range(), off)), product(exact.range(), off))
            exact = exact * other
        self.register(head, tail, Pair(exact, total(error, rounding), sums, rounding))

    def set_tail(self, node, head, more):
        """A tail is what its head lacks: the opposite of its rounding error, up to `more`."""
        node.exact = ZERO
        node.error = total((-lost(size(head.range)), 0.0), more)
        node.range = node.error

    def sum_tail(self, node, head, a, b, kind):
        """The tail of a sum. All differences but the last must be exact."""
        lacks = lost(size(head.range))
        held = size(b.range) + lacks
        grid = head.lsb
        if None not in (a.lsb, b.lsb):
            # Either the sum is exact, and so are the differences. Or it is too large for the
            # operands' last place: then it is a multiple of twice that.
            least = min(a.lsb, b.lsb)
            grid = max(head.lsb, least + (0 if self.is_exact(least, size(head.range)) else 1))
            fine = self.is_exact(least, size(head.range))
        else:
            fine = False
        if not fine and None not in (grid, a.lsb):
            # If the first difference is exact, the second is a.
            fine = self.is_exact(min(grid, a.lsb), held)
        more = 2 * U * lacks * MORE + LEAST
        if not fine and kind == "any" and (b.range[0] > 0 or b.range[1] < 0):
            # What is held of b may be rounded. The next two differences are exact.
            near = min(map(abs, b.range)) - 2 * lost(size(b.range)) - lacks
            off = lost(size(b.range) + lacks) * MORE
            places = [n for n in (head.lsb, near > 0 and exponent(near) - 52) if n is not None]
            if near > 0 and len(places) == 2 and a.lsb is not None:
                fine = self.is_exact(min(places), size(a.range) + off)
                fine = fine and self.is_exact(min(*places, a.lsb), off)
                more = 3 * U * (lacks + off) * MORE + LEAST
        if not fine and kind == "ordered":
            # If a is 0 or a multiple of the last place of b, the difference is exact by Dekker's
            # theorem, for any rounding. It is if |b| ≤ |a|.
            fine = (
                self.ratio(b, a) <= 0.5
                or a.lsb is not None and a.lsb >= exponent(size(b.range)) - 52
                or self.is_larger(a, b)
            )
        if not fine:
            raise Unproven(f"a sum's tail {kind} {head.range} {head.lsb} {a.range} {a.lsb} {b.range} {b.lsb}")
        self.set_tail(node, head, (-more, more))
        self.make_pair(head, node, [[a, b]], (-more, more))

    def is_larger(self, a, b):
        """Whether |b| ≤ |a|."""
        if min(a.range[0], b.range[0]) >= 0 and self.fields.get(("order", id(a), id(b)), -1) >= 0:
            return True
        if a.range[0] <= 0 <= a.range[1] or b.range[0] <= 0 <= b.range[1]:
            return False
        parts = []
        for node in (a, b):
            parts.append((node.exact, node.error) if node.range[0] > 0
                         else (-node.exact, minus(node.error)))
        (one, one_error), (other, other_error) = parts
        return (one - other).range()[0] + one_error[0] - other_error[1] > 0

    def ratio(self, b, a):
        """A bound of |b/a| for a product that has a factor a."""
        if b is a:
            return 1.0
        if a.op == "scale":
            return self.ratio(b, a.args[0]) * 2.0 ** -a.args[1]
        if b.op in ("neg", "scale"):
            factor = 2.0 ** b.args[1] if b.op == "scale" else 1.0
            return self.ratio(b.args[0], a) * factor
        if b.op != "mul":
            return math.inf
        one, other = b.args
        return MORE * min(self.ratio(u, a) * size(v.range) * MORE if u is a or u.op == "mul" else math.inf
                   for u, v in [(one, other), (other, one)])

    def product_tail(self, node, head, a, b):
        """The tail of a product, as `exact_product` states."""
        most = size(a.range) * size(b.range) * MORE
        off = 2.0**-76 * most + 32 * LEAST
        if head.op == "mul":
            self.set_tail(node, head, (-off, off))
        else:
            # A product by a power of two has no tail.
            node.exact, node.error, node.range = ZERO, (0.0, 0.0), (0.0, 0.0)
            return self.make_pair(head, node, [[head]], (0.0, 0.0))
        self.make_pair(head, node, [[a], [b]], (-off, off))

    def extend(self, node, head, tail, other, sign, other_sign):
        """Registers the pair whose tail is ±tail ± other."""
        pair = self.pairs[id(head), id(tail)]
        if sign == -1:
            negative = self.value(self.do_neg(tail))
            head = self.value(self.do_neg(head))
            pair = self.pairs[id(head), id(negative)]
        if other_sign == -1:
            other = self.value(self.do_neg(other))
        off = self.rounding(node)
        if pair.sums and len(pair.sums) == 2:
            one, two = pair.sums
            found = [
                (second, mine, yours)
                for first, second in permutations(self.factors(other) or (), 2)
                for mine, yours in [(two, one), (one, two)]
                # first is the head of `yours`.
                if yours[0] is first and len(mine) == 1
            ]
            # Best, second is a tail of `mine`.
            found.sort(key=lambda f: not any(h is f[1][0] for h, _ in f[0].heads))
            if found:
                second, mine, yours = found[0]
                rest = total(*(n.range for n in yours[1:])) if len(yours) > 1 else (0.0, 0.0)
                missing = product(second.range, rest)
                rounding = total(pair.rounding, off, self.rounding(other), minus(missing))
                sums = [mine + [second], yours]
                if mine is two:
                    sums.reverse()
                return self.make_pair(head, node, sums, rounding)
        sums = pair.sums if pair.sums and len(pair.sums) == 1 else None
        if sums is None:
            # The pair so far counts as one number.
            parts, error = [other], total(pair.error, other.error, off)
            opaque = Pair(pair.exact + other.exact, error, None, None)
            return self.register(head, node, opaque)
        leaves, rounding = list(sums[0]), total(pair.rounding, off)
        parts = [other]
        if other.op == "add":
            u, v = other.args
            heads = [[h for h, _ in part.heads if h in leaves] for part in (u, v)]
            if all(heads):
                parts, rounding = [u, v], total(rounding, self.rounding(other))
        self.make_pair(head, node, [leaves + parts], rounding)

    def factors(self, node):
        """The operands of a product, or nothing."""
        if node.op == "mul":
            return node.args
        if node.op == "scale" and -1000 < node.args[1] < 1000:
            return self.real(to_bits(2.0 ** node.args[1])), node.args[0]
        return None

    def exact_product(self, node):
        """Head and operands of a product, if the node is the product's tail.

        Let u be 2^-52 and a, b scaled so that |a·b| = 1. The operands' upper halves a' and b' have
        26 bits, the lower ones a" and b" 27, so all products but a"·b" are exact, and |a"| is at
        most 2^-25·|a|. The product of the upper halves and the head are multiples of the head's
        last place, and differ by less than 2^-23. So their difference is exact. The sums after it
        are about −a"·b, then −a"·b", then minus the head's error. They are at most 2^-25, 2^-50 and
        2^-52 with what was lost before, and lose u times that, as a"·b" loses u·2^-50. Together
        less than 2^-76. Operations that underflow lose less than 32 times the least positive number
        more.
        """
        if node.op != "add":
            return None
        key = ("product", id(node))
        if key not in self.fields:
            self.fields[key] = None
            first = node
            while first.op == "add":
                first = first.args[0]
            if first.op != "sub":
                return None
            one, known = self.real(to_bits(1.0)), self.factors(first.args[1])
            for a, b in ([known, known[::-1]] if known else []) + [(first.args[1], one)]:
                if self.tail_of_product(first.args[1], a, b) is node:
                    self.fields[key] = first.args[1], a, b
        return self.fields[key]

    def tail_of_product(self, head, a, b):
        """The tail as `times` of the code computes it."""
        a, b = (n if n.op != "number" else to_bits(n.args[0]) for n in (a, b))
        upper = [self.do_and(n, UPPER_HALF) for n in (a, b)]
        lower = [self.do_sub(n, u) for n, u in zip((a, b), upper, strict=True)]
        tail = self.do_sub(self.do_mul(*upper), head)
        for one, other in [(upper[0], lower[1]), (lower[0], upper[1]), (lower[0], lower[1])]:
            tail = self.do_add(tail, self.do_mul(one, other))
        return tail

    def remainder(self, node):
        """a − ph − pt + at from the code of `difference`: the parts, the first operation first."""
        chain = []
        while node.op in ("add", "sub"):
            chain.append(node)
            if node.op == "sub" and node.args[1].op == "mul":
                return list(reversed(chain))
            node = node.args[0]
        return None

    def quotient_tail(self, node, rest, divisor):
        """The tail of a quotient: (a − h·b)/b for its head h."""
        chain = self.remainder(rest)
        if not chain:
            return False
        a, top = chain[0].args
        heads = [h for h in top.args if h.op == "div" and h.args[0] is a and h.args[1] is divisor]
        if not heads:
            return False
        head = heads[0]
        tails, off = self.remainder_parts(chain, top)
        above, below = [a], [divisor]
        for part, sign in tails:
            if sign == 1:
                above.append(part)
            else:
                # Head and tail of the product h·b.
                pair = self.pairs[id(top), id(part)]
                factors = pair.sums
                below = next(f for f in factors if f[0] is divisor)
                off = total(off, minus(pair.rounding))
        (a_exact, a_error), (b_exact, b_error) = self.pair_error(above), self.pair_error(below)
        exact = a_exact / b_exact
        b_at = total(b_exact.range(), b_error)
        inverse = hull((1 / b_at[0],) * 2, (1 / b_at[1],) * 2)
        if b_at[0] <= 0 <= b_at[1]:
            raise Unproven("a quotient by 0")
        error = product(total(a_error, minus(product(exact.range(), b_error))), inverse)
        h = head.range
        least = size(h) * size(divisor.range) * U * MORE
        true = total((-least, least), *(p.range for p in above[1:]),
                     *(minus(product(h, p.range)) for p in below[1:]))
        tail = product(total(true, off), inverse)
        crossed = size(true) * sum(size(p.range) for p in below[1:]) * size(inverse) ** 2 * MORE
        rounding = total(product(off, inverse), (-crossed, crossed),
                         (0.0, size(tail) * U * MORE + LEAST))
        node.exact, node.error, node.range, node.lsb = ZERO, tail, tail, None
        self.register(head, node, Pair(exact, total(error, rounding), None, None))
        return True

    def remainder_parts(self, chain, top):
        """Tails in a remainder with their signs, and its rounding error.

        The first difference is exact, by Sterbenz: two roundings move (a/b)·b or (√a)² from a by a
        few units, and where they underflow, all numbers are multiples of the least.
        """
        tails, off = [], (0.0, 0.0)
        most = size(top.range) * 3 * U * MORE + 4 * LEAST
        for link in chain[1:]:
            tails.append((link.args[1], 1 if link.op == "add" else -1))
            most = (most + size(link.args[1].range)) * MORE
            off = total(off, (0.0, most * U * MORE + LEAST))
        return tails, off

    def root_tail(self, node, rest, twice):
        """The tail of a root: (a − h²)/2h for its head h."""
        chain = self.remainder(rest)
        if not chain or twice.op != "scale" or twice.args[1] != 1:
            return False
        head = twice.args[0]
        a, top = chain[0].args
        if head.op != "sqrt" or head.args[0] is not a or top.args != (head, head):
            return False
        tails, off = self.remainder_parts(chain, top)
        under = [a]
        for part, sign in tails:
            if sign == 1:
                under.append(part)
            else:
                off = total(off, minus(self.pairs[id(top), id(part)].rounding))
        exact, error = self.pair_error(under)
        root = exact.sqrt()
        least = min(head.range[0], root.range()[0])
        if not least > 0:
            raise Unproven("a root of 0")
        inverse = 0.5 / head.range[1] / MORE, 0.5 / least * MORE
        # √S − √E = (S − E)/(√S + √E).
        error = product(error, (inverse[0] / MORE, inverse[1] * MORE))
        near = size(head.range) ** 2 * 2 * U * MORE
        true = total((-near, near), *(p.range for p in under[1:]))
        tail = product(total(true, off), inverse)
        bent = size(true) ** 2 / least**3 * MORE
        rounding = total(product(off, inverse), (-bent, bent),
                         (0.0, size(tail) * U * MORE + LEAST))
        node.exact, node.error, node.range, node.lsb = ZERO, tail, tail, None
        self.register(head, node, Pair(root, total(error, rounding), None, None))
        return True


def other_than_one(node):
    return next(part for part in node.args if part.op == "neg")


def sum_tail(node):
    """Head and operands of a sum, if the node is the sum's tail."""
    if node.op == "sub":
        b, held = node.args
        if held.op == "sub":
            head, a = held.args
            if head.op == "add" and set(head.args) == {a, b}:
                return head, a, b, "ordered"
    if node.op == "add":
        a_rest, b_rest = node.args
        if a_rest.op == b_rest.op == "sub":
            (a, a_held), (b, b_held) = a_rest.args, b_rest.args
            if a_held.op == b_held.op == "sub" and a_held.args[1] is b_held:
                head = b_held.args[0]
                if b_held.args[1] is a and a_held.args[0] is head and head.op == "add" \
                        and set(head.args) == {a, b}:
                    return head, a, b, "any"
    return None


# Functions.


def shifted_constant(derivative, at, cell):
    """The series of a function, from its derivative and its value."""
    if cell.lo == cell.hi:
        return constant(at(cell.middle))
    derivative = derivative(cell.x)
    thin = (derivative.thin * cell.width).integral() + at(cell.middle)
    fat = (derivative.fat * cell.width).integral() + at(cell.ball)
    return Series(thin, fat)


class Cell:
    """The floats between two numbers."""

    def __init__(self, lo, hi, lsb=None):
        self.lo, self.hi = lo, hi
        lo, hi = Fraction(lo), Fraction(hi)
        self.middle, self.width = arb_of((lo + hi) / 2), arb_of((hi - lo) / 2)
        self.ball = self.middle + self.width * BALL
        self.x = Series(arb_series([self.middle, self.width]), arb_series([self.ball, self.width]))
        self.lsb = lsb

    def input(self):
        if self.lo == self.hi:
            return to_bits(self.lo)
        node = Node("input", ())
        node.exact, node.error, node.range = self.x, (0.0, 0.0), (self.lo, self.hi)
        node.known = True
        node.lsb = self.lsb if self.lsb is not None else -1074
        if self.lo > 0 or self.hi < 0:
            node.lsb = max(node.lsb, exponent(min(abs(self.lo), abs(self.hi))) - 52)
        node.bits = min(MOST_BITS, exponent(size(node.range)) + 1 - node.lsb)
        return node


def of_pieces(derivative, at):
    return lambda cell: shifted_constant(derivative, at, cell)


def exp_of(x):
    return Series(x.thin.exp(), x.fat.exp())


def log_of(x):
    return Series(x.thin.log(), x.fat.log())


def cosh_of(x):
    return (exp_of(x) + exp_of(-x)).times(arb(1) / 2)


def sinh_of(x):
    return (exp_of(x) - exp_of(-x)).times(arb(1) / 2)


def sin_of(x):
    return Series(x.thin.sin(), x.fat.sin())


def cos_of(x):
    return Series(x.thin.cos(), x.fat.cos())


def one_minus_square(x):
    return (ONE - x) * (ONE + x)


TWO_OVER_ROOT_PI = 2 / arb.pi().sqrt()
FUNCTIONS = {
    "exp": lambda cell: exp_of(cell.x),
    "ln": lambda cell: log_of(cell.x),
    "log2": lambda cell: log_of(cell.x).times(1 / arb(2).log()),
    "log10": lambda cell: log_of(cell.x).times(1 / arb(10).log()),
    "sinh": of_pieces(cosh_of, arb.sinh),
    "cosh": of_pieces(sinh_of, arb.cosh),
    "tanh": of_pieces(lambda x: ONE / (cosh_of(x) * cosh_of(x)), arb.tanh),
    "asinh": of_pieces(lambda x: ONE / (ONE + x * x).sqrt(), arb.asinh),
    "acosh": of_pieces(lambda x: ONE / ((x - ONE) * (x + ONE)).sqrt(), arb.acosh),
    "atanh": of_pieces(lambda x: ONE / one_minus_square(x), arb.atanh),
    "atan": of_pieces(lambda x: ONE / (ONE + x * x), arb.atan),
    "asin": of_pieces(lambda x: ONE / one_minus_square(x).sqrt(), arb.asin),
    "acos": of_pieces(lambda x: -(ONE / one_minus_square(x).sqrt()), arb.acos),
    "erf": of_pieces(lambda x: exp_of(-(x * x)).times(TWO_OVER_ROOT_PI), arb.erf),
}


# Beyond some numbers, routines compute the same as there: the number, the limit of the function.
BEYOND = {
    "exp": [(720.0, math.inf), (-760.0, 0.0)],
    "sinh": [(720.0, math.inf), (-720.0, -math.inf)],
    "cosh": [(720.0, math.inf), (-720.0, math.inf)],
    "tanh": [(720.0, 1.0), (-720.0, -1.0)],
    "erf": [(6.0, 1.0), (-6.0, -1.0)],
}


class Program:
    """What a test recorded. If it is `moved`, a coefficient of the sine is off by twice the error
    that the code allows for it."""

    def __init__(self, path, moved=False):
        text = path.read_text()
        lines, notes = text.split("\n\n")
        self.lines = [line.split() for line in lines.splitlines()]
        self.notes = dict(line.rsplit(" ", 1) for line in notes.splitlines())
        if moved:
            name = self.notes["coefficient"]
            off = 2 * self.number("slack") / (math.pi / 4) ** 2
            bits = to_bits(self.number("coefficient") + off)
            self.lines[self.lines.index(["bits", name])] = ["bits", f"{bits:016x}"]
        self.bounds, self.reductions = [], {}
        for note, high in self.notes.items():
            if note.startswith("bounds "):
                _, name, low = note.split()
                self.bounds.append((name, int(low), int(high)))

    def number(self, name):
        return to_float(int(self.notes[name], 16))

    def line(self, name):
        return int(self.notes[name])

    def reduced(self, cell):
        """Bounds for the reduced angles in a cell."""
        sign = 1 if cell.lo > 0 else -1
        power = exponent(min(abs(cell.lo), abs(cell.hi)))
        if (power, sign) not in self.reductions:
            self.reductions[power, sign] = reduce(self, power, sign)
        return self.reductions[power, sign]


def prove_beyond(program, name, at, limit):
    """The bounds of a function that is monotone beyond a number, at all floats there."""
    far = math.copysign(sys.float_info.max, at)
    cell = Cell(*sorted((at, far)))
    machine = Machine(program.lines, {0: cell.input()}, [])
    (_, low, high), = program.bounds
    low, high = (machine.line(number) for number in (low, high))
    if not machine.is_number(low, high) or machine.options:
        raise Unproven("no number beyond")
    power = to_float(machine.line(program.line("exponent"))) if "exponent" in program.notes else 0
    low, high = (arb_of(to_float(end)) * arb(2) ** int(power) for end in (low, high))
    here = FUNCTIONS[name](Cell(at, at)).ball()
    most = arb_of(sys.float_info.max)
    holds = -low <= here <= high
    if math.isinf(limit):
        # Rounded up, the bound is infinite.
        holds = holds and (high if limit > 0 else low) > most
    elif limit == 0:
        # Rounded up, the negated lower bound is 0.
        holds = holds and low > -arb_of(LEAST)
    else:
        holds = holds and -low <= arb_of(limit) <= high
    if not holds:
        raise Unproven(f"beyond {at}")


def paths(execute):
    """Executes with every combination of decisions."""
    decisions = []
    while True:
        machine = execute(decisions)
        yield machine
        options = machine.options
        decisions = decisions[: len(options)]
        while decisions and decisions[-1] + 1 >= options[len(decisions) - 1]:
            decisions.pop()
        if not decisions:
            return
        decisions[-1] += 1


def prove_bounds(program, machine, name, low, high, function, offs=(0.0, 0.0)):
    """How much is left of the bounds' distance from the function, relative to what was added."""
    left = []
    function_here = function
    if "exponent" in program.notes:
        power = to_float(machine.line(program.line("exponent")))
        function_here = function.times(arb(2) ** -int(power))
    for number, sign, off in [(high, 1, offs[0]), (low, -1, offs[1])]:
        node = machine.value(machine.line(number))
        target = function_here if sign == 1 else -function_here
        far = (node.exact - target - (node.under or ZERO)).ball()
        slack = far.lower() + arb_of(node.error[0]) - arb_of(off)
        if not slack >= 0:
            side = "upper" if sign == 1 else "lower"
            raise Unproven(f"{name}: {side} bound, {far.lower()} {node.error}")
        left.append(float(slack / far.upper()) if far.upper() > 0 else 1.0)
    return min(left)


def prove_cell(program, cell):
    (name, low, high), = program.bounds
    function = FUNCTIONS[name](cell)
    x = cell.input()

    def execute(decisions):
        nonlocal least
        machine = Machine(program.lines, {0: x}, decisions)
        least = min(least, prove_bounds(program, machine, name, low, high, function))
        return machine

    least = 1.0
    for _ in paths(execute):
        pass
    return least


# Sine, cosine and tangent: first the reduction of the angle, then functions of the rest.

DIGITS = 400
HALF_PI = None


def half_pi():
    """π/2 to 2^-DIGITS, as a fraction."""
    global HALF_PI
    if HALF_PI is None:
        with_more = ctx.prec
        ctx.prec = 2 * DIGITS
        number = (arb.pi() / 2 * arb(2) ** DIGITS).floor().unique_fmpz()
        ctx.prec = with_more
        HALF_PI = Fraction(int(number), 2**DIGITS)
    return HALF_PI


def closest(limit):
    """A bound from below of the distance of any float up to `limit` from a multiple k·π/2, k ≠ 0.

    Let floats of an octave be m·2^e. No fraction with a denominator below that of the next
    convergent is closer to 2^e/(π/2) than a convergent p/q: |m·2^e/(π/2) − k| is at least that of
    the last convergent with q ≤ 2^53.
    """
    least = math.inf
    for power in range(-1, exponent(limit) + 1):
        unit = Fraction(2) ** (power - 52)
        low, high = unit / (half_pi() + Fraction(1, 2**DIGITS)), unit / half_pi()
        p, q, older_p, older_q = 1, 0, 0, 1
        x, y, best = low, high, None
        while True:
            digit = x.numerator // x.denominator
            if digit != y.numerator // y.denominator:
                raise Unproven("digits of π")
            p, older_p = digit * p + older_p, p
            q, older_q = digit * q + older_q, q
            if q > 2**53:
                break
            best = abs(q * low - p)
            x, y = 1 / (x - digit), 1 / (y - digit)
        least = min(least, float(best * half_pi()))
    return least * (1 - 2.0**-40)


class Linear:
    """A value x·a + k·b plus rounding errors."""

    def __init__(self, a, b, errors, lsb, parts=()):
        self.a, self.b, self.errors, self.lsb, self.parts = a, b, errors, lsb, parts
        # The last place that the exact sum has.
        self.least = lsb


class Reduction:
    """The operations that reduce an angle x = r + k·π/2, for r and k in intervals."""

    def __init__(self, program, r, k):
        self.program, self.r, self.k = program, r, k
        self.bounds, self.values = [], {}
        turn = float(half_pi())
        x = total(r, product(k, (turn, turn)))
        self.x_lsb = exponent(min(abs(x[0]), abs(x[1])) * (1 - 2.0**-40)) - 52

    def range(self, value):
        if value.a:
            here = Fraction(value.a) * half_pi() + value.b
            at = total(product(self.r, (value.a,) * 2), self.times_k(here))
        else:
            at = self.times_k(value.b)
        return total(at, self.error(value))

    def times_k(self, factor):
        """k times a number that may be wrong by 2^-DIGITS."""
        near = float(factor)
        off = abs(near) * U + 2.0**-350
        return product(self.k, (near - off, near + off))

    def error(self, value):
        parts = [product((float(c),) * 2, self.bounds[n]) for n, c in value.errors.items()]
        return total(*parts) if parts else (0.0, 0.0)

    def at(self, number):
        if number not in self.values:
            name, *args = self.program.lines[number]
            if name == "input":
                self.values[number] = Linear(1, Fraction(0), {}, self.x_lsb)
            elif name == "nearest":
                self.values[number] = Linear(0, Fraction(1), {}, 0)
            elif name == "bits":
                self.values[number] = Fraction(to_float(int(args[0], 16)))
            else:
                operands = [self.at(int(a)) for a in args]
                self.values[number] = getattr(self, "do_" + name)(*operands)
        return self.values[number]

    def rounded(self, value):
        size_of = size(self.range(value))
        errors = {**value.errors, len(self.bounds): Fraction(1)}
        self.bounds.append((0.0, size_of * U * MORE))
        return Linear(value.a, value.b, errors, value.lsb, value.parts)

    def with_place(self, value):
        lo, hi = self.range(value)
        if lo > 0 or hi < 0:
            value.lsb = max(value.lsb, exponent(min(abs(lo), abs(hi))) - 52)
        return value

    def do_neg(self, value):
        if isinstance(value, Fraction):
            return -value
        errors = {n: -c for n, c in value.errors.items()}
        return Linear(-value.a, -value.b, errors, value.lsb)

    def do_mul(self, one, other):
        k, factor = (one, other) if isinstance(other, Fraction) else (other, one)
        assert k.a == 0 and k.b == 1, "a multiple of k"
        lsb = last_bit(factor)
        product_of = Linear(0, factor, {}, lsb)
        bits = exponent(float(abs(factor))) + 1 - lsb
        if exponent(size(self.k)) + 1 + bits > MOST_BITS:
            product_of = self.rounded(product_of)
        return self.with_place(product_of)

    def do_mul_add(self, one, other, more):
        return self.do_add(self.do_mul(one, other), more)

    def do_sub(self, one, other):
        return self.do_add(one, self.do_neg(other), other)

    def do_add(self, one, other, subtracted=None):
        errors = dict(one.errors)
        for number, factor in other.errors.items():
            errors[number] = errors.get(number, 0) + factor
        errors = {n: c for n, c in errors.items() if c}
        least = min(one.lsb, other.lsb)
        if subtracted is not None and any(subtracted is part for part in one.parts):
            # Either the first sum was exact, and so is this. Or its last place is not its
            # operands'.
            places = [one.lsb if one.exact else max(one.lsb, one.least + 1), other.lsb]
            least = min(places)
        value = Linear(one.a + other.a, one.b + other.b, errors, least)
        value.parts = one, subtracted if subtracted is not None else other
        value.least = least
        value.exact = size(self.range(value)) <= 2.0 ** (MOST_BITS + least)
        if not value.exact:
            exact, rounded = value, self.rounded(value)
            rounded.least, rounded.exact = least, False
            rounded.parts = exact.parts
            value = rounded
        return self.with_place(value)


def reduce(program, power, sign):
    """Bounds of the tail and of the error of the rest, for a rest from 2^power to 2^(power + 1)."""
    rest = sorted((sign * 2.0**power, sign * 2.0 ** (power + 1)))
    most = program.number("most") / 1.5
    tails, errors = 0.0, 0.0
    for k_sign in (1, -1):
        first = 1
        while first <= most:
            k = sorted((float(k_sign * first), float(k_sign * (2 * first - 1))))
            reduction = Reduction(program, tuple(rest), tuple(k))
            head = reduction.at(program.line("rest"))
            if "rest tail" in program.notes:
                tail = reduction.at(program.line("rest tail"))
            else:
                tail = reduction.do_neg(reduction.at(program.line("correction")))
            both = reduction.do_neg(reduction.do_neg(head))
            both = Linear(head.a + tail.a, head.b + tail.b, dict(head.errors), 0)
            for number, factor in tail.errors.items():
                both.errors[number] = both.errors.get(number, 0) + factor
            assert both.a == 1 and tail.a == 0, "the whole angle"
            off = total(reduction.times_k(both.b + half_pi()), reduction.error(both))
            errors = max(errors, size(off))
            tails = max(tails, size(reduction.range(tail)))
            first *= 2
    return tails * MORE, errors * MORE


WAVES = {
    "sin": [lambda r: sin_of(r), lambda r: cos_of(r), lambda r: -sin_of(r), lambda r: -cos_of(r)],
    "cos": [lambda r: cos_of(r), lambda r: -sin_of(r), lambda r: -cos_of(r), lambda r: sin_of(r)],
    "tan": [lambda r: sin_of(r) / cos_of(r), lambda r: -(cos_of(r) / sin_of(r))] * 2,
}


def known(exact, error, at, lsb=-1074):
    node = Node("input", ())
    node.exact, node.error, node.range, node.lsb, node.known = exact, error, at, lsb, True
    return node


def prove_rest(program, cell, reduced):
    """Sine, cosine and tangent of a rest in a cell, for each k modulo 4."""
    tails, off = reduced
    x = program.lines.index(["input", "x"])
    least = 1.0
    for turns in range(4):
        rest = cell.input()
        rest.error = -tails - off, tails + off
        rest.range = total(cell.x.range(), rest.error)
        tail = known(ZERO, (-tails, tails), (-tails, tails))
        tail.heads.append((rest, Pair(cell.x, (-off, off), None, None)))
        far = known(ZERO, (1.0, 1e10), (0.75, 1e10))
        inputs = {x: far, program.line("rest"): rest, program.line("rest tail"): tail,
                  program.line("turns"): Low(turns, 2)}
        for name, low, high in program.bounds:
            target = WAVES[name][turns](cell.x)

            def execute(decisions, name=name, low=low, high=high, target=target, inputs=inputs,
                        rest=rest, tail=tail):
                nonlocal least
                machine = Machine(program.lines, inputs, decisions)
                machine.pairs[id(rest), id(tail)] = tail.heads[0][1]
                left = prove_bounds(program, machine, name, low, high, target)
                least = min(least, left)
                return machine

            for _ in paths(execute):
                del tail.heads[1:]
    return least


def prove_small(program, cell):
    """Sine, cosine and tangent of an angle of no turns: it is its own rest."""
    least = 1.0
    none = next(n for n, line in enumerate(program.lines) if line[0] == "nearest")
    inputs = {0: cell.input(), none: 0}
    for name, low, high in program.bounds:
        target = WAVES[name][0](cell.x)

        def execute(decisions, name=name, low=low, high=high, target=target):
            nonlocal least
            machine = Machine(program.lines, inputs, decisions)
            left = prove_bounds(program, machine, name, low, high, target)
            least = min(least, left)
            if f"value {name}" in program.notes:
                prove_value(program, machine, name, target, 0.0)
            return machine

        for _ in paths(execute):
            pass
    return least


def prove_value(program, machine, name, target, off):
    """A value's error relative to the function."""
    value = machine.value(machine.line(program.line(f"value {name}")))
    magnitude = target if target.range()[0] >= 0 else -target
    allowed = magnitude.times(arb_of(program.number("units") * U))
    parts = [(value.exact - target, value.error), (target - value.exact, minus(value.error))]
    for difference, error in parts:
        left = (allowed - difference).ball().lower() - arb_of(error[1] + off)
        if not left >= 0:
            raise Unproven(f"{name}: {left} for a value")


def prove_near(program, cell, reduced):
    """Sine and cosine near 0. The angle is s − n, up to the error of the reduction.

    Bounds are affine in n, apart from rounding, and the function's second derivative is at most 1.
    Bounds of roundings are convex in n. So the two extreme n suffice, less n²/2. Where the cosine
    is subtracted from a bound of its opposite, nothing is lost: it is concave.
    """
    most, off = reduced
    bent = most * most / 2 * MORE
    least = 1.0
    for turns in range(4):
        for correction in (most, -most):
            s = cell.input()
            n = known(constant(arb_of(correction)), (0.0, 0.0), (correction,) * 2)
            inputs = {0: None, program.line("rest"): s, program.line("correction"): n,
                      program.line("turns"): Low(turns, 2)}
            angle = cell.x - n.exact
            machine = Machine(program.lines, inputs, [])
            for name, low, high in program.bounds:
                target = WAVES[name][turns](angle)
                is_cosine = (turns % 2 == 0) == (name == "cos")
                sign = 0 if not is_cosine else 1 if target.range()[0] > 0 else -1
                slope = size(sin_of(angle).range()) if is_cosine else 1.0
                # What the upper and the lower bound lose.
                moved = [off * slope * MORE + (0.0 if sign == s else bent) for s in (-1, 1)]
                left = prove_bounds(program, machine, name, low, high, target, moved)
                least = min(least, left)
                prove_value(program, machine, name, target, max(moved))
            if machine.options:
                raise Unproven("a decision")
    return least


# Cells.


def floats(lo, hi):
    while lo <= hi:
        yield lo
        lo = math.nextafter(lo, math.inf)


def floats_between(lo, hi):
    return abs(to_bits(hi) - to_bits(lo)) if lo * hi > 0 else math.inf


def octaves(first, last, pieces):
    """The numbers from 2^first to 2^last. Each octave is divided into pieces."""
    for power in range(first, last):
        ends = [math.ldexp(1 + i / pieces, power) for i in range(pieces)]
        ends.append(math.ldexp(1.0, power + 1) if power < 1023 else sys.float_info.max)
        yield from pairwise(ends)


def steps(lo, hi, width):
    """The numbers from lo to hi."""
    count = round((hi - lo) / width)
    yield from pairwise(lo + (hi - lo) * i / count for i in range(count + 1))


def beside_one(first, last, pieces, sign):
    """Numbers beside 1, at distances from 2^first to 2^last."""
    for near, far in octaves(first, last, pieces):
        yield tuple(sorted((1 + sign * near, 1 + sign * far)))
    yield 1.0, 1.0


def tiny(first):
    """Numbers from 0 to 2^first, of which an octave is a cell."""
    yield 0.0, 0.0
    yield from octaves(-1074, first, 1)


def mirrored(cells):
    for lo, hi in cells:
        yield lo, hi
        yield -hi, -lo


def positive_numbers():
    """For logarithms."""
    yield from octaves(-1074, -1, 8)
    yield from beside_one(-53, -1, 8, -1)
    yield from beside_one(-52, 0, 8, 1)
    yield from octaves(1, 1024, 8)


def atan_cells():
    yield from tiny(-3)
    yield from steps(0.125, 4.0, 1 / 32)
    yield from octaves(2, 20, 8)
    yield from octaves(20, 60, 4)
    yield from octaves(60, 1024, 1)


def asinh_cells():
    yield from tiny(-3)
    yield from octaves(-3, 30, 12)
    yield from octaves(30, 1024, 8)


def acosh_cells():
    yield from beside_one(-52, 0, 16, 1)
    yield from octaves(1, 30, 12)
    yield from octaves(30, 1024, 8)


def arc_cells():
    yield from tiny(-4)
    yield from steps(0.0625, 0.875, 1 / 64)
    yield from beside_one(-53, -3, 16, -1)


def rests(program, part):
    """Rests of angles, none of which is 0, and small angles, which are their own rests."""
    # The rest may have been rounded.
    first = exponent(closest(program.number("most")) * (1 - 2.0**-10))
    # The number of turns is that of an angle times 2/π, with two roundings.
    last = math.pi / 4 + program.number("most") * 2.0**-50
    for lo, hi in mirrored(chain(octaves(first, -1, 1), steps(0.5, last, 1 / 32))):
        yield part, lo, hi
    # Angles whose turns may be rounded to 0.
    for lo, hi in mirrored(chain(tiny(-1), steps(0.5, last, 1 / 32))):
        yield "small", lo, hi


CELLS = {
    "exp": lambda: chain([(-(2.0**-30), 2.0**-30)], mirrored(octaves(-30, -1, 1)),
                         mirrored(steps(0.5, 720.0, 0.5)), steps(-760.0, -720.0, 0.5)),
    "ln": positive_numbers,
    "log2": positive_numbers,
    "log10": positive_numbers,
    "sinh": lambda: mirrored(chain(tiny(-1), steps(0.5, 720.0, 0.5))),
    "cosh": lambda: chain([(-(2.0**-30), 2.0**-30)], mirrored(octaves(-30, -1, 1)),
                          mirrored(steps(0.5, 720.0, 0.5))),
    "tanh": lambda: mirrored(chain(tiny(-3), steps(0.125, 40.0, 0.125), steps(40.0, 720.0, 0.5))),
    "asinh": lambda: mirrored(asinh_cells()),
    "acosh": acosh_cells,
    "atanh": lambda: mirrored(arc_cells()),
    "atan": lambda: mirrored(atan_cells()),
    "asin": lambda: mirrored(arc_cells()),
    "acos": lambda: mirrored(chain([(0.0, 0.0), (0.0, 2.0**-60)], octaves(-60, -4, 1),
                                   steps(0.0625, 0.875, 1 / 64), beside_one(-53, -3, 16, -1))),
    "erf": lambda: mirrored(chain(tiny(-3), steps(0.125, 6.0, 1 / 16))),
}


def tasks(path):
    """The cells of a program."""
    name = path.stem
    if name not in CELLS:
        part = "near" if name == "waves-near" else "rest"
        return list(rests(Program(path), part))
    return [("whole", *cell) for cell in CELLS[name]()]


PROGRAM = {}


def prove_part(program, part, cell):
    """A cell of a program. Sine, cosine and tangent have parts of their own."""
    if part == "whole":
        return prove_cell(program, cell)
    if part == "small":
        return prove_small(program, cell)
    if part == "rest":
        return prove_rest(program, cell, program.reduced(cell))
    return prove_near(program, cell, program.reduced(cell))


def prove(task):
    """The cell of a task, and the number of cells that it was divided into. Then how much of its
    slack is left, or why it is not proven."""
    path, moved, part, lo, hi = task
    if (path, moved) not in PROGRAM:
        PROGRAM[path, moved] = Program(path, moved)
    program = PROGRAM[path, moved]
    cells, count, least = [(lo, hi, 0)], 0, 1.0
    while cells:
        lo, hi, depth = cells.pop()
        count += 1
        try:
            least = min(least, prove_part(program, part, Cell(lo, hi)))
        except Unproven as reason:
            if lo < hi and floats_between(lo, hi) <= FEW:
                cells += [(x, x, depth) for x in floats(lo, hi)]
                continue
            middle = (lo + hi) / 2 if abs(lo + hi) < math.inf else lo / 2 + hi / 2
            if depth == HALVINGS or not lo < middle < hi:
                return (lo, hi), count, None, str(reason)
            cells += [(lo, middle, depth + 1), (middle, hi, depth + 1)]
    return (lo, hi), count, least, None


def prove_program(pool, path, every, moved=False):
    """Returns whether all cells are proven. Prints how many there are."""
    started, count, least, bad = time.monotonic(), 0, 1.0, []
    cells = [(path, moved, *task) for task in tasks(path)][::every]
    for cell, tried, left, reason in pool.imap_unordered(prove, cells, 4):
        count += tried
        if left is None:
            bad.append(f"  {cell[0]!r} to {cell[1]!r}: {reason}")
        else:
            least = min(least, left)
    for at, limit in [] if moved else BEYOND.get(path.stem, []):
        count += 1
        try:
            prove_beyond(Program(path), path.stem, at, limit)
        except Unproven as reason:
            bad.append(f"  {reason}")
    seconds = time.monotonic() - started
    name = f"functions/{path.stem}" + ", moved" * moved
    print(f"{name}: {count} cells, {len(bad)} not proven, {seconds:.0f} s", flush=True)
    if not moved:
        print("\n".join(sorted(bad)[:10]), end="\n" * bool(bad))
    return not bad


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("names", nargs="*", help="programs; all, if none is named")
    parser.add_argument("--every", type=int, default=1, help="leave out all but every nth cell")
    arguments = parser.parse_args()
    paths_of = sorted(arguments.folder.glob("*.txt"))
    found = {path.stem for path in paths_of}
    if not found or not set(arguments.names) <= found or not set(CELLS) <= found:
        sys.exit(f"programs are missing in {arguments.folder}")
    holds = True
    with Pool() as pool:
        for path in paths_of:
            if not arguments.names or path.stem in arguments.names:
                holds &= prove_program(pool, path, arguments.every)
        if not arguments.names:
            near = arguments.folder / "waves-near.txt"
            holds &= not prove_program(pool, near, 1, moved=True)
    sys.exit(not holds)


if __name__ == "__main__":
    main()
