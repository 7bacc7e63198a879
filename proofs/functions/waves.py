"""Sine, cosine and tangent: of small angles, and of the rests of others."""

from claims import paths, prove_bounds
from exact import cos_of, sin_of
from floats import MORE, U, Unproven, hull, minus, size, total
from machine import Machine
from nodes import Low, Node, Pair
from series import ZERO, arb_of, constant

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
        inputs = {
            x: far,
            program.line("rest"): rest,
            program.line("rest tail"): tail,
            program.line("turns"): Low(turns, 2),
        }
        for name, low, high in program.bounds:
            target = WAVES[name][turns](cell.x)

            def execute(
                decisions,
                name=name,
                low=low,
                high=high,
                target=target,
                inputs=inputs,
                rest=rest,
                tail=tail,
            ):
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


def prove_value(program, machine, name, target, off, others=()):
    """A value's error relative to the function."""
    value = machine.value(machine.line(program.line(f"value {name}")))
    magnitude = target if target.range()[0] >= 0 else -target
    allowed = magnitude.times(arb_of(program.number("units") * U))
    error = value.error
    for other in others:
        error = hull(error, other.value(other.line(program.line(f"value {name}"))).error)
    parts = [(value.exact - target, error), (target - value.exact, minus(error))]
    for difference, error in parts:
        left = (allowed - difference).ball().lower() - arb_of(error[1] + off)
        if not left >= 0:
            raise Unproven(f"{name}: {left} for a value")


def prove_near(program, cell, reduced):
    """Sine and cosine near 0. The angle is s − n, up to the error of the reduction.

    Bounds are affine in n, apart from rounding, and the function's second derivative is at most 1.
    Bounds of roundings grow with |n|. So the two extreme n suffice, less n²/2. Where the cosine
    is subtracted from a bound of its opposite, nothing is lost: it is concave.
    """
    most, off = reduced
    bent = most * most / 2 * MORE
    least = 1.0
    for turns in range(4):
        machines = []
        for correction in (most, -most):
            n = known(constant(arb_of(correction)), (0.0, 0.0), (correction,) * 2)
            inputs = {
                0: None,
                program.line("rest"): cell.input(),
                program.line("correction"): n,
                program.line("turns"): Low(turns, 2),
            }
            machines.append((n, Machine(program.lines, inputs, [])))
        others = [machine for _, machine in machines]
        for n, machine in machines:
            angle = cell.x - n.exact
            for name, low, high in program.bounds:
                target = WAVES[name][turns](angle)
                is_cosine = (turns % 2 == 0) == (name == "cos")
                sign = 0 if not is_cosine else 1 if target.range()[0] > 0 else -1
                slope = size(sin_of(angle).range()) if is_cosine else 1.0
                # What the upper and the lower bound lose.
                moved = [off * slope * MORE + (0.0 if sign == s else bent) for s in (-1, 1)]
                left = prove_bounds(program, machine, name, low, high, target, moved, others)
                least = min(least, left)
                prove_value(program, machine, name, target, max(moved), others)
            if machine.options:
                raise Unproven("a decision")
    return least
