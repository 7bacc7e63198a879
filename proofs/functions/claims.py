"""Programs that a test recorded, and the proof of their bounds in a cell."""

import math
import sys

from flint import arb

from exact import FUNCTIONS, Cell
from floats import LEAST, Unproven, exponent, to_bits, to_float
from machine import Machine
from reduction import reduce
from series import ZERO, arb_of

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
        notes = notes.splitlines()
        self.samples = [line.split()[1:] for line in notes if line.startswith("sample ")]
        self.notes = dict(line.rsplit(" ", 1) for line in notes if not line.startswith("sample "))
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


def follow_samples(program):
    """Whether the operations give what the code computed, at some floats."""
    ends = [end for _, low, high in program.bounds for end in (low, high)]
    if not program.samples:
        raise Unproven("no samples")
    for x, *expected in program.samples:
        machine = Machine(program.lines, {0: int(x, 16)}, [])
        found = [machine.line(end) for end in ends]
        if not machine.is_number(*found) or machine.options:
            raise Unproven(f"no numbers at {to_float(int(x, 16))!r}")
        if [to_float(end) for end in found] != [to_float(int(end, 16)) for end in expected]:
            raise Unproven(f"other bounds at {to_float(int(x, 16))!r}")


def prove_beyond(program, name, at, limit):
    """The bounds of a function that is monotone beyond a number, at all floats there."""
    far = math.copysign(sys.float_info.max, at)
    cell = Cell(*sorted((at, far)))
    machine = Machine(program.lines, {0: cell.input()}, [])
    ((_, low, high),) = program.bounds
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


def prove_bounds(program, machine, name, low, high, function, offs=(0.0, 0.0), others=()):
    """How much is left of the bounds' distance from the function, relative to what was added.
    Errors count that are possible on any machine."""
    left = []
    function_here = function
    if "exponent" in program.notes:
        power = to_float(machine.line(program.line("exponent")))
        function_here = function.times(arb(2) ** -int(power))
    for number, sign, off in [(high, 1, offs[0]), (low, -1, offs[1])]:
        node = machine.value(machine.line(number))
        target = function_here if sign == 1 else -function_here
        far = (node.exact - target - (node.under or ZERO)).ball()
        error = min(m.value(m.line(number)).error[0] for m in (machine, *others))
        if not math.isfinite(error):
            raise Unproven(f"{name}: no bound")
        slack = far.lower() + arb_of(error) - arb_of(off)
        if not slack >= 0:
            side = "upper" if sign == 1 else "lower"
            raise Unproven(f"{name}: {side} bound, {far.lower()} {node.error}")
        left.append(float(slack / far.upper()) if far.upper() > 0 else 1.0)
    return min(left)


def prove_cell(program, cell):
    ((name, low, high),) = program.bounds
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
