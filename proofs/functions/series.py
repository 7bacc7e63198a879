"""Taylor polynomials with bounds of their rest, by ball arithmetic."""

import math
from fractions import Fraction

from flint import arb, arb_poly, arb_series, ctx, fmpq

from floats import Unproven

# Degree of the coefficient that bounds the rest.
ORDER = 16
ctx.prec = 200
ctx.cap = ORDER + 1
BALL = arb(0, 1)


def arb_of(number):
    number = Fraction(number)
    return arb(fmpq(number.numerator, number.denominator))


def below(ball):
    return math.nextafter(float(ball.lower()), -math.inf)


def above(ball):
    return math.nextafter(float(ball.upper()), math.inf)


class Series:
    """A function on a cell, as a Taylor polynomial about its middle, and one about all of its
    points at once. The last coefficient of that bounds the rest."""

    __slots__ = ("_range", "fat", "thin")

    def __init__(self, thin, fat):
        self.thin, self.fat, self._range = thin, fat, None

    def ball(self):
        """All values in the cell."""
        parts = list(self.thin)[:ORDER]
        ball = arb_poly(parts)(BALL) if parts else arb(0)
        return ball + self.fat[ORDER] * BALL

    def range(self):
        if self._range is None:
            if self.fat.prec <= ORDER:
                raise Unproven("a series without a rest")
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
