"""Follows the operations of a program in a cell, as far as bits and comparisons decide."""

import math
from fractions import Fraction

from floats import ALL, SIGN, Unproven, exponent, last_bit, rounded_up, to_bits, to_float
from nodes import Low, Node, Shifted
from series import arb_of, constant


class Execution:
    """Executes a program in a cell. `value`, of a subclass, finds out what is known of a node."""

    def __init__(self, lines, inputs, decisions):
        self.lines, self.inputs = lines, inputs
        self.decisions, self.next, self.options = decisions, 0, []
        self.nodes, self.numbers, self.pairs, self.fields = {}, {}, {}, {}
        self.values = {}

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
        key = (op, *(a if isinstance(a, int) else id(a) for a in args))
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
        """The result of an operation on numbers. NaN stands for what is not known."""
        floats = [to_float(v) for v in values]
        if not all(map(math.isfinite, floats)):
            return to_bits(math.nan)
        exact = op(*map(Fraction, floats))
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
            if not math.isfinite(to_float(a)) or to_float(a) < 0:
                return to_bits(math.nan)
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
        return Shifted(a.node, (a.by + b) & ALL)

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
