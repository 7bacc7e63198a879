"""Counts which rules and constants are checked by machine, by enumeration, and only at random.

    ZEROSET_PROOFS=DIR cargo test -p zeroset-interval --lib proofs_
    python proofs/table.py DIR            # writes the table in docs/correctness.md
    python proofs/table.py DIR --check    # exits with status 1 if it is another

It reads the table of operations, the statements that tests wrote to DIR, those in this folder, and
the list of functions of the example `exhaustive`.
"""

import argparse
import re
import sys
from pathlib import Path

ROOT = Path(__file__).parent.parent
PAGE = ROOT / "docs/correctness.md"
SWEEP = ROOT / "crates/testkit/examples/exhaustive/sweep.rs"
UNITS = ROOT / "crates/interval/src/rules/affine/rounding/relative.rs"
BEGIN, END = "<!-- proofs/table.py writes what follows. -->\n", "<!-- end -->\n"


def table(written):
    lines = (written / "operations.txt").read_text().split("\n")
    arity = {name: int(count) for name, count in map(str.split, lines)}
    by_small = {name.lower(): name for name in arity}

    def stems(folder, kind):
        return {path.stem for path in folder.glob(f"*.{kind}")}

    solved = {by_small[name] for name in stems(written / "intervals", "smt2")}
    cases = sum(path.read_text().count("; case") for path in (written / "intervals").glob("*.smt2"))
    programs = stems(written / "functions", "txt")
    waves = {"sin", "cos", "tan"} if any(name.startswith("waves") for name in programs) else set()
    names = {name for name in programs if not name.startswith("waves")} | waves
    functions = {by_small[name] for name in names}
    swept = set(re.findall(r"(?:all|wave)\(Op::(\w+)", SWEEP.read_text()))
    rest = sorted(set(arity) - solved - functions)
    only_random = [name for name in rest if name not in swept]
    rounding = stems(written / "rounding", "smt2")
    outward = {"range", "contraction", "crossing"}
    forms = {re.sub("(-[0-9]+)?(-fused)?$", "", name) for name in rounding} - outward
    slopes = re.findall(r'\("(\w+)", \|rule, at\| rule\.shape_of', UNITS.read_text())
    thresholds = stems(ROOT / "proofs", "smt2") - {"prelude"}

    def listed(names):
        return ", ".join(f"`{name}`" for name in sorted(names))

    rows = [
        ("interval rules of all operations", len(arity), "at random", "all"),
        ("· bounds and definedness", len(solved), "solver", f"{cases} cases: {listed(solved)}"),
        ("· bounds at every float, in `f64`", len(functions), "balls", listed(functions)),
        ("· bounds at every float, in `f32`", len(swept), "enumeration", listed(swept)),
        ("· neither", len(only_random), "only at random", listed(only_random)),
        (
            "· in `f64` neither",
            len(rest) - len(only_random),
            "only at random",
            listed(set(rest) - set(only_random)),
        ),
        ("rounding of affine forms", len(forms), "solver", listed(forms)),
        ("rounding of slopes", len(slopes), "intervals of factors", listed(slopes)),
        (
            "ranges and contraction of segments",
            len(outward & rounding),
            "solver",
            listed(outward & rounding),
        ),
        (
            "rewritings of the simplifier",
            len(stems(written / "rewritings", "smt2")),
            "solver",
            "texts of its tests, for all coordinates and parameters",
        ),
        ("thresholds of steps left out", len(thresholds), "solver", "[parts](parts.md)"),
    ]
    text = ["| rules and constants | number | checked by | which |", "|---|---|---|---|"]
    text += [f"| {' | '.join(map(str, row))} |" for row in rows]
    return "\n".join(text) + "\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("written", type=Path)
    parser.add_argument("--check", action="store_true")
    arguments = parser.parse_args()
    page = PAGE.read_text()
    before, found = page.split(BEGIN)
    old, after = found.split(END, 1)
    new = "\n" + table(arguments.written) + "\n"
    if arguments.check:
        if old != new:
            print(new)
            sys.exit(f"the table in {PAGE.relative_to(ROOT)} is stale: proofs/table.py writes it")
    else:
        PAGE.write_text(before + BEGIN + new + END + after)


if __name__ == "__main__":
    main()
