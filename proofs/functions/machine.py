"""Pairs of head and tail, whose sum is known better than either."""

import math
from itertools import permutations

from floats import (
    LEAST,
    MORE,
    UPPER_HALF,
    U,
    Unproven,
    exponent,
    hull,
    lost,
    minus,
    product,
    size,
    to_bits,
    total,
)
from nodes import Pair
from series import ZERO
from values import Values


class Machine(Values):
    """Pairs of head and tail."""

    def register(self, head, tail, pair):
        key = id(head), id(tail)
        if key not in self.pairs:
            self.pairs[key] = pair
            tail.heads.append((head, pair))

    def pair_error(self, leaves):
        """The sum of nodes, pairs among them taken together: its exact value and its error."""
        exact, error, left = ZERO, (0.0, 0.0), []
        for leaf in leaves:
            # An exact difference of a head and a number counts as both.
            if (
                leaf.op == "sub"
                and not leaf.rounded
                and leaf.args[1].op == "number"
                and any(head is leaf.args[0] for tail in leaves for head, _ in tail.heads)
            ):
                left += [leaf.args[0], self.value(self.do_neg(to_bits(leaf.args[1].args[0])))]
            else:
                left.append(leaf)
        leaves = list(left)
        for tail in leaves:
            for head, pair in tail.heads:
                if tail in left and head in left and head is not tail:
                    left.remove(tail)
                    left.remove(head)
                    exact, error = exact + pair.exact, total(error, pair.error)
        for leaf in left:
            exact, error = exact + leaf.exact, total(error, leaf.error)
        return exact, error

    def make_pair(self, head, tail, sums, rounding):
        """Registers a pair: the sum of nodes, or the product of two sums."""
        parts = [self.pair_error(leaves) for leaves in sums]
        exact, error = parts[0]
        if len(parts) == 2:
            other, off = parts[1]
            error = total(product(error, total(other.range(), off)), product(exact.range(), off))
            exact = exact * other
        self.register(head, tail, Pair(exact, total(error, rounding), sums, rounding))

    def set_tail(self, node, head, more):
        """A tail is what its head lacks: the opposite of its rounding error, up to `more`."""
        node.exact = ZERO
        node.error = total((-lost(size(head.range)), 0.0), more)
        node.range = node.error

    def sum_tail(self, node, head, a, b, kind):
        """The tail of a sum. All differences but the last must be exact."""
        lacks = lost(size(head.range))
        held = size(b.range) + lacks
        grid = head.lsb
        if None not in (a.lsb, b.lsb):
            # Either the sum is exact, and so are the differences. Or it is too large for the
            # operands' last place: then it is a multiple of twice that.
            least = min(a.lsb, b.lsb)
            grid = max(head.lsb, least + (0 if self.is_exact(least, size(head.range)) else 1))
            fine = self.is_exact(least, size(head.range))
        else:
            fine = False
        if not fine and None not in (grid, a.lsb):
            # If the first difference is exact, the second is a.
            fine = self.is_exact(min(grid, a.lsb), held)
        more = 2 * U * lacks * MORE + LEAST
        if not fine and kind == "any" and (b.range[0] > 0 or b.range[1] < 0):
            # What is held of b may be rounded. The next two differences are exact.
            near = min(map(abs, b.range)) - 2 * lost(size(b.range)) - lacks
            off = lost(size(b.range) + lacks) * MORE
            places = [n for n in (head.lsb, near > 0 and exponent(near) - 52) if n is not None]
            if near > 0 and len(places) == 2 and a.lsb is not None:
                fine = self.is_exact(min(places), size(a.range) + off)
                fine = fine and self.is_exact(min(*places, a.lsb), off)
                more = 3 * U * (lacks + off) * MORE + LEAST
        if not fine and kind == "ordered":
            # If a is 0 or a multiple of the last place of b, the difference is exact by Dekker's
            # theorem, for any rounding. It is if |b| ≤ |a|.
            fine = (
                self.ratio(b, a) <= 0.5
                or (a.lsb is not None and a.lsb >= exponent(size(b.range)) - 52)
                or self.is_larger(a, b)
            )
        if not fine:
            raise Unproven(
                f"a sum's tail {kind} {head.range} {head.lsb} {a.range} {a.lsb} {b.range} {b.lsb}"
            )
        self.set_tail(node, head, (-more, more))
        self.make_pair(head, node, [[a, b]], (-more, more))

    def is_larger(self, a, b):
        """Whether |b| ≤ |a|."""
        if min(a.range[0], b.range[0]) >= 0 and self.fields.get(("order", id(a), id(b)), -1) >= 0:
            return True
        if a.range[0] <= 0 <= a.range[1] or b.range[0] <= 0 <= b.range[1]:
            return False
        parts = []
        for node in (a, b):
            parts.append(
                (node.exact, node.error) if node.range[0] > 0 else (-node.exact, minus(node.error))
            )
        (one, one_error), (other, other_error) = parts
        return (one - other).range()[0] + one_error[0] - other_error[1] > 0

    def ratio(self, b, a):
        """A bound of |b/a| for a product that has a factor a."""
        if b is a:
            return 1.0
        if a.op == "scale":
            return self.ratio(b, a.args[0]) * 2.0 ** -a.args[1]
        if b.op in ("neg", "scale"):
            factor = 2.0 ** b.args[1] if b.op == "scale" else 1.0
            return self.ratio(b.args[0], a) * factor
        if b.op != "mul":
            return math.inf
        one, other = b.args
        ratios = [
            self.ratio(u, a) * size(v.range) * MORE
            for u, v in [(one, other), (other, one)]
            if u is a or u.op == "mul"
        ]
        return MORE * min(ratios, default=math.inf)

    def product_tail(self, node, head, a, b):
        """The tail of a product, as `exact_product` states."""
        most = size(a.range) * size(b.range) * MORE
        off = 2.0**-76 * most + 32 * LEAST
        if head.op == "mul":
            self.set_tail(node, head, (-off, off))
        else:
            # A product by a power of two has no tail.
            node.exact, node.error, node.range = ZERO, (0.0, 0.0), (0.0, 0.0)
            return self.make_pair(head, node, [[head]], (0.0, 0.0))
        self.make_pair(head, node, [[a], [b]], (-off, off))

    def extend(self, node, head, tail, other, sign, other_sign):
        """Registers the pair whose tail is ±tail ± other."""
        pair = self.pairs[id(head), id(tail)]
        if sign == -1:
            negative = self.value(self.do_neg(tail))
            head = self.value(self.do_neg(head))
            pair = self.pairs[id(head), id(negative)]
        if other_sign == -1:
            other = self.value(self.do_neg(other))
        off = self.rounding(node)
        if pair.sums and len(pair.sums) == 2:
            one, two = pair.sums
            found = [
                (second, mine, yours)
                for first, second in permutations(self.factors(other) or (), 2)
                for mine, yours in [(two, one), (one, two)]
                # first is the head of `yours`.
                if yours[0] is first and len(mine) == 1
            ]
            # Best, second is a tail of `mine`.
            found.sort(key=lambda f: not any(h is f[1][0] for h, _ in f[0].heads))
            if found:
                second, mine, yours = found[0]
                rest = total(*(n.range for n in yours[1:])) if len(yours) > 1 else (0.0, 0.0)
                missing = product(second.range, rest)
                rounding = total(pair.rounding, off, self.rounding(other), minus(missing))
                sums = [[*mine, second], yours]
                if mine is two:
                    sums.reverse()
                return self.make_pair(head, node, sums, rounding)
        sums = pair.sums if pair.sums and len(pair.sums) == 1 else None
        if sums is None:
            # The pair so far counts as one number.
            parts, error = [other], total(pair.error, other.error, off)
            opaque = Pair(pair.exact + other.exact, error, None, None)
            return self.register(head, node, opaque)
        leaves, rounding = list(sums[0]), total(pair.rounding, off)
        parts = [other]
        if other.op == "add":
            u, v = other.args
            heads = [[h for h, _ in part.heads if h in leaves] for part in (u, v)]
            if all(heads):
                parts, rounding = [u, v], total(rounding, self.rounding(other))
        self.make_pair(head, node, [[*leaves, *parts]], rounding)

    def factors(self, node):
        """The operands of a product, or nothing."""
        if node.op == "mul":
            return node.args
        if node.op == "scale" and -1000 < node.args[1] < 1000:
            return self.real(to_bits(2.0 ** node.args[1])), node.args[0]
        return None

    def exact_product(self, node):
        """Head and operands of a product, if the node is the product's tail.

        Let u be 2^-52 and a, b scaled so that |a·b| = 1. The operands' upper halves a' and b' have
        26 bits, the lower ones a" and b" 27, so all products but a"·b" are exact, and |a"| is at
        most 2^-25·|a|. The product of the upper halves and the head are multiples of the head's
        last place, and differ by less than 2^-23. So their difference is exact. The sums after it
        are about −a"·b, then −a"·b", then minus the head's error. They are at most 2^-25, 2^-50 and
        2^-52 with what was lost before, and lose u times that, as a"·b" loses u·2^-50. Together
        less than 2^-76. Operations that underflow lose less than 32 times the least positive number
        more.
        """
        if node.op != "add":
            return None
        key = ("product", id(node))
        if key not in self.fields:
            self.fields[key] = None
            first = node
            while first.op == "add":
                first = first.args[0]
            if first.op != "sub":
                return None
            one, known = self.real(to_bits(1.0)), self.factors(first.args[1])
            for a, b in ([known, known[::-1]] if known else []) + [(first.args[1], one)]:
                if self.tail_of_product(first.args[1], a, b) is node:
                    self.fields[key] = first.args[1], a, b
        return self.fields[key]

    def tail_of_product(self, head, a, b):
        """The tail as `times` of the code computes it."""
        a, b = (n if n.op != "number" else to_bits(n.args[0]) for n in (a, b))
        upper = [self.do_and(n, UPPER_HALF) for n in (a, b)]
        lower = [self.do_sub(n, u) for n, u in zip((a, b), upper, strict=True)]
        tail = self.do_sub(self.do_mul(*upper), head)
        for one, other in [(upper[0], lower[1]), (lower[0], upper[1]), (lower[0], lower[1])]:
            tail = self.do_add(tail, self.do_mul(one, other))
        return tail

    def remainder(self, node):
        """a − ph − pt + at from the code of `difference`: the parts, the first operation first."""
        chain = []
        while node.op in ("add", "sub"):
            chain.append(node)
            if node.op == "sub" and node.args[1].op == "mul":
                return list(reversed(chain))
            node = node.args[0]
        return None

    def quotient_tail(self, node, rest, divisor):
        """The tail of a quotient: (a − h·b)/b for its head h."""
        chain = self.remainder(rest)
        if not chain:
            return False
        a, top = chain[0].args
        heads = [h for h in top.args if h.op == "div" and h.args[0] is a and h.args[1] is divisor]
        if not heads:
            return False
        head = heads[0]
        tails, off = self.remainder_parts(chain, top)
        above, below = [a], [divisor]
        above += [part for part, sign in tails if sign == 1]
        # Head and tail of the product h·b.
        parts = [self.pairs.get((id(top), id(part))) for part, sign in tails if sign == -1]
        if len(parts) != 1 or not parts[0] or len(parts[0].sums or ()) != 2:
            raise Unproven("a remainder")
        below = next((f for f in parts[0].sums if f[0] is divisor), None)
        if below is None or [head] not in parts[0].sums:
            raise Unproven("a remainder")
        off = total(off, minus(parts[0].rounding))
        (a_exact, a_error), (b_exact, b_error) = self.pair_error(above), self.pair_error(below)
        exact = a_exact / b_exact
        b_at = total(b_exact.range(), b_error)
        if b_at[0] <= 0 <= b_at[1]:
            raise Unproven("a quotient by 0")
        # Also of the head of b, which is as good as b here.
        inverse = hull((1 / b_at[0],) * 2, (1 / b_at[1],) * 2)
        inverse = product(inverse, (1 / MORE, MORE))
        error = product(total(a_error, minus(product(exact.range(), b_error))), inverse)
        h = head.range
        least = size(h) * size(divisor.range) * U * MORE
        true = total(
            (-least, least),
            *(p.range for p in above[1:]),
            *(minus(product(h, p.range)) for p in below[1:]),
        )
        tail = product(total(true, off), inverse)
        crossed = size(true) * sum(size(p.range) for p in below[1:]) * size(inverse) ** 2 * MORE
        rounding = total(
            product(off, inverse), (-crossed, crossed), (0.0, size(tail) * U * MORE + LEAST)
        )
        node.exact, node.error, node.range, node.lsb = ZERO, tail, tail, None
        self.register(head, node, Pair(exact, total(error, rounding), None, None))
        return True

    def remainder_parts(self, chain, top):
        """Tails in a remainder with their signs, and its rounding error.

        The first difference is exact, by Sterbenz: two roundings move (a/b)·b or (√a)² from a by a
        few units, and where they underflow, all numbers are multiples of the least.
        """
        tails, off = [], (0.0, 0.0)
        most = size(top.range) * 3 * U * MORE + 4 * LEAST
        for link in chain[1:]:
            tails.append((link.args[1], 1 if link.op == "add" else -1))
            most = (most + size(link.args[1].range)) * MORE
            off = total(off, (0.0, most * U * MORE + LEAST))
        return tails, off

    def root_tail(self, node, rest, twice):
        """The tail of a root: (a − h²)/2h for its head h."""
        chain = self.remainder(rest)
        if not chain or twice.op != "scale" or twice.args[1] != 1:
            return False
        head = twice.args[0]
        a, top = chain[0].args
        if head.op != "sqrt" or head.args[0] is not a or top.args != (head, head):
            return False
        tails, off = self.remainder_parts(chain, top)
        under = [a] + [part for part, sign in tails if sign == 1]
        parts = [self.pairs.get((id(top), id(part))) for part, sign in tails if sign == -1]
        if len(parts) != 1 or not parts[0] or parts[0].sums != [[head], [head]]:
            raise Unproven("a remainder")
        off = total(off, minus(parts[0].rounding))
        exact, error = self.pair_error(under)
        root = exact.sqrt()
        least = min(head.range[0], root.range()[0])
        if not least > 0:
            raise Unproven("a root of 0")
        inverse = 0.5 / head.range[1] / MORE, 0.5 / least * MORE
        # √S − √E = (S − E)/(√S + √E).
        error = product(error, (inverse[0] / MORE, inverse[1] * MORE))
        near = size(head.range) ** 2 * 2 * U * MORE
        true = total((-near, near), *(p.range for p in under[1:]))
        tail = product(total(true, off), inverse)
        bent = size(true) ** 2 / least**3 * MORE
        rounding = total(product(off, inverse), (-bent, bent), (0.0, size(tail) * U * MORE + LEAST))
        node.exact, node.error, node.range, node.lsb = ZERO, tail, tail, None
        self.register(head, node, Pair(root, total(error, rounding), None, None))
        return True
