"""The cells of all domains."""

import math
import sys
from itertools import chain, pairwise

from claims import Program
from floats import exponent, to_bits
from reduction import closest


def floats(lo, hi):
    while lo <= hi:
        yield lo
        lo = math.nextafter(lo, math.inf)


def floats_between(lo, hi):
    return abs(to_bits(hi) - to_bits(lo)) if lo > 0 or hi < 0 else math.inf


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
    assert last < 0.8
    for lo, hi in mirrored(chain(octaves(first, -1, 1), steps(0.5, last, 1 / 32))):
        yield part, lo, hi
    # Angles whose turns may be rounded to 0.
    for lo, hi in mirrored(chain(tiny(-1), steps(0.5, last, 1 / 32))):
        yield "small", lo, hi


CELLS = {
    "exp": lambda: chain(
        [(-(2.0**-30), 2.0**-30)],
        mirrored(octaves(-30, -1, 1)),
        mirrored(steps(0.5, 720.0, 0.5)),
        steps(-760.0, -720.0, 0.5),
    ),
    "ln": positive_numbers,
    "log2": positive_numbers,
    "log10": positive_numbers,
    "sinh": lambda: mirrored(chain(tiny(-1), steps(0.5, 720.0, 0.5))),
    "cosh": lambda: chain(
        [(-(2.0**-30), 2.0**-30)], mirrored(octaves(-30, -1, 1)), mirrored(steps(0.5, 720.0, 0.5))
    ),
    "tanh": lambda: mirrored(chain(tiny(-3), steps(0.125, 40.0, 0.125), steps(40.0, 720.0, 0.5))),
    "asinh": lambda: mirrored(asinh_cells()),
    "acosh": acosh_cells,
    "atanh": lambda: (ends for ends in mirrored(arc_cells()) if abs(ends[0]) < 1),
    "atan": lambda: mirrored(atan_cells()),
    "asin": lambda: mirrored(arc_cells()),
    "acos": lambda: mirrored(
        chain(
            [(0.0, 0.0), (0.0, 2.0**-60)],
            octaves(-60, -4, 1),
            steps(0.0625, 0.875, 1 / 64),
            beside_one(-53, -3, 16, -1),
        )
    ),
    "erf": lambda: mirrored(chain(tiny(-3), steps(0.125, 6.0, 1 / 16))),
}


def tasks(path):
    """The cells of a program."""
    name = path.stem
    if name not in CELLS:
        part = "near" if name == "waves-near" else "rest"
        return list(rests(Program(path), part))
    return [("whole", *cell) for cell in CELLS[name]()]
