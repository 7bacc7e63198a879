"""Floats, and intervals of them that are rounded outward."""

import math
import struct
import sys
from fractions import Fraction

U = 2.0**-52
LEAST = 2.0**-1074
SIGN = 1 << 63
UPPER_HALF = (1 << 64) - (1 << 27)
ALL = (1 << 64) - 1
MOST_BITS = 53
# Errors are sums and products of numbers that are not negative, computed with rounding to nearest.
# This factor covers it.
MORE = 1 + 2.0**-40


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
    lo_more, hi_more = (2.0**-50 * sum(abs(p[i]) for p in parts) for i in (0, 1))
    return lo - lo_more, hi + hi_more


def minus(a):
    return -a[1], -a[0]


def size(a):
    return max(abs(a[0]), abs(a[1]))


def hull(a, b):
    return min(a[0], b[0]), max(a[1], b[1])


class Unproven(Exception):
    pass
