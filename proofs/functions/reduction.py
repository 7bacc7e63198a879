"""The reduction of angles by multiples of π/2."""

import math
from fractions import Fraction

from flint import arb, ctx

from floats import (
    MORE,
    MOST_BITS,
    U,
    Unproven,
    exponent,
    last_bit,
    lost,
    product,
    size,
    to_float,
    total,
)

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
        errors = {**value.errors, len(self.bounds): Fraction(1)}
        self.bounds.append((0.0, lost(size(self.range(value)))))
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
    # The head may be in another octave than the rest.
    near, far = (1 - 2.0**-10) * 2.0**power, (1 + 2.0**-10) * 2.0 ** (power + 1)
    # No rest is larger.
    far = min(far, 0.8)
    rest = sorted((sign * near, sign * far))
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
