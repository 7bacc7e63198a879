"""Cells, and the functions in them."""

from fractions import Fraction

from flint import arb, arb_series

from floats import MOST_BITS, exponent, size, to_bits
from nodes import Node
from series import BALL, ONE, Series, arb_of, constant


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


def shifted_constant(derivative, at, cell):
    """The series of a function, from its derivative and its value."""
    if cell.lo == cell.hi:
        return constant(at(cell.middle))
    derivative = derivative(cell.x)
    thin = (derivative.thin * cell.width).integral() + at(cell.middle)
    fat = (derivative.fat * cell.width).integral() + at(cell.ball)
    return Series(thin, fat)


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
