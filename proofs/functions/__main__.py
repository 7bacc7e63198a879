"""Proves the bounds of elementary functions in f64, at every float of their domains.

    ZEROSET_PROOFS=DIR cargo test -p zeroset-interval --lib proofs_
    python proofs/functions DIR/functions

Each file lists the operations that a routine executes, as a test recorded them, and names the
bounds that it returns. This script divides the domain into cells. In a cell it knows of each value:

- what it is without rounding, as a Taylor polynomial of the input with a bound of the rest, by
  FLINT's ball arithmetic;
- how far rounding can have moved it, upward and downward;
- the place of its last bit, and how many bits it has. They show which operations are exact.

A pair of head and tail is closer to the exact value than either. `Machine` knows the sums,
products, quotients and roots that make such pairs, from the operations alone. Its rule for the
rounding error of a product is an argument by hand, `exact_product`.

A comparison that both outcomes are possible for is followed twice. A cell is proven if the bounds,
less all rounding, hold the function's Taylor polynomial. Exits with status 1 if a cell is not.
"""

import argparse
import math
import sys
import time
from multiprocessing import Pool
from pathlib import Path

from cells import CELLS, floats, floats_between, tasks
from claims import BEYOND, Program, follow_samples, prove_beyond, prove_cell
from exact import Cell
from floats import Unproven
from waves import prove_near, prove_rest, prove_small

PROGRAM = {}
# A cell that is not proven is halved this often.
HALVINGS = 8
# A cell of so few floats is divided into them.
FEW = 8


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
            if depth < HALVINGS and lo < middle < hi:
                cells += [(lo, middle, depth + 1), (middle, hi, depth + 1)]
            elif depth == HALVINGS and lo < hi:
                # At an end, comparisons may find equality.
                inner = math.nextafter(lo, math.inf), math.nextafter(hi, -math.inf)
                cells += [(*inner, depth + 1), (lo, lo, depth + 1), (hi, hi, depth + 1)]
            else:
                return (lo, hi), count, None, str(reason)
    return (lo, hi), count, least, None


def prove_program(pool, path, every, moved=False):
    """Returns whether all cells are proven. Prints how many there are."""
    started, count, least, bad = time.monotonic(), 0, 1.0, []
    cells = [(path, moved, *task) for task in tasks(path)][::every]
    if moved:
        # Of the largest rests, for which the coefficient matters most.
        cells = [cell for cell in cells if cell[2] == "near" and abs(cell[3] + cell[4]) > 1.5]
    for cell, tried, left, reason in pool.imap_unordered(prove, cells, 4):
        count += tried
        if left is None:
            bad.append(f"  {cell[0]!r} to {cell[1]!r}: {reason}")
        else:
            least = min(least, left)
    if not moved:
        try:
            follow_samples(Program(path))
            for at, limit in BEYOND.get(path.stem, []):
                count += 1
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
