"""What a machine computes with."""

from floats import MOST_BITS, total


class Node:
    """A float that an operation computes. `value()` of a machine fills in what is known of it."""

    __slots__ = (
        "args",
        "bits",
        "error",
        "exact",
        "heads",
        "known",
        "lsb",
        "op",
        "range",
        "rounded",
        "spread",
        "under",
    )

    def __init__(self, op, args):
        self.op, self.args, self.known = op, args, False
        self.exact = self.error = self.range = self.lsb = None
        self.bits = MOST_BITS
        self.heads = []
        # The error is also within 0 and `spread`. The error misses what is between −`under` and 0.
        self.spread = self.under = None
        self.rounded = True


class Low:
    """An integer of which only the last bits are known."""

    def __init__(self, value, count):
        self.value, self.count = value % (1 << count), count


class Shifted:
    """The bits of a float plus an integer."""

    def __init__(self, node, by):
        self.node, self.by = node, by


class Pair:
    """The sum of head and tail: `exact` without rounding, and the error of the sum."""

    def __init__(self, exact, error, sums, rounding):
        self.exact, self.error, self.sums, self.rounding = exact, error, sums, rounding

    def range(self):
        return total(self.exact.range(), self.error)


def other_than_one(node):
    return next(part for part in node.args if part.op == "neg")


def sum_tail(node):
    """Head and operands of a sum, if the node is the sum's tail."""
    if node.op == "sub":
        b, held = node.args
        if held.op == "sub":
            head, a = held.args
            if head.op == "add" and set(head.args) == {a, b}:
                return head, a, b, "ordered"
    if node.op == "add":
        a_rest, b_rest = node.args
        if a_rest.op == b_rest.op == "sub":
            (a, a_held), (b, b_held) = a_rest.args, b_rest.args
            if a_held.op == b_held.op == "sub" and a_held.args[1] is b_held:
                head = b_held.args[0]
                if (
                    b_held.args[1] is a
                    and a_held.args[0] is head
                    and head.op == "add"
                    and set(head.args) == {a, b}
                ):
                    return head, a, b, "any"
    return None
