"""What is known of a float in a cell: its exact value, its error, and its last bit."""

import math
from fractions import Fraction

from flint import arb

from execution import Execution
from floats import (
    LEAST,
    MORE,
    MOST_BITS,
    Unproven,
    exponent,
    hull,
    lost,
    minus,
    product,
    size,
    sum_below,
    times_power,
    total,
)
from nodes import Node, Pair, other_than_one, sum_tail
from series import ONE, arb_of, constant


class Values(Execution):
    """What is known of values."""

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
            error = error[0], total(error, (0.0, lost(size(total(at, error)), lsb)))[1]
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
        lo, hi = (root.range()[i] + math.sqrt(max(a.range[i], 0.0)) for i in (0, 1))
        if not lo > 0:
            raise Unproven("a root of 0")
        # The difference of two roots is that of the numbers over the sum of the roots.
        error = product(a.error, (1 / hi / MORE, 1 / lo * MORE)) if size(a.error) else (0.0, 0.0)
        self.set(node, root, error, True)
        if a.range[0] >= 1:
            node.range = max(node.range[0], 1.0), node.range[1]

    def all_of(self, node):
        """Bounds of a node with and without its error."""
        return node.range if node.error == (0.0, 0.0) else hull(node.range, node.exact.range())

    def find_mul(self, node):
        a, b = node.args
        tiny = size(a.range) * size(b.range) < 2.0**-1000
        ends = [Fraction(x) * Fraction(y) for x in a.range for y in b.range] if tiny else []
        if ends and max(map(abs, ends)) <= LEAST:
            # Rounded up, it is 0 or the least number.
            least, most = (LEAST if end > 0 else 0.0 for end in (min(ends), max(ends)))
            node.exact = constant(arb_of(least))
            node.error, node.range, node.lsb = (0.0, most - least), (least, most), -1074
            return
        exact = a.exact * b.exact
        error = total(
            product(a.error, self.all_of(b)),
            product(self.all_of(a), b.error),
        )
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
