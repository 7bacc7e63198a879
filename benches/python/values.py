"""Times values at many points beside numexpr and numba, on one thread.

    pip install numexpr numba
    RAYON_NUM_THREADS=1 python benches/python/values.py

The three take turns; figures are medians in milliseconds. Before, their values are compared.
"""

import argparse
import statistics
import time

import numba
import numexpr
import numpy as np

import zeroset as zs

# Written so that each library reads it. Products stand for powers: they favor numexpr and numba.
FORMULAS = {
    "sphere": "x*x + y*y + z*z - 1",
    "torus": "(x*x + y*y + z*z + 0.75)**2 - 4*(x*x + y*y)",
    "steiner": "x*x*y*y + y*y*z*z + z*z*x*x - 2*x*y*z",
    "mitchell": "4*((x*x)**2 + (y*y + z*z)**2) + 17*x*x*(y*y + z*z) - 20*(x*x + y*y + z*z) + 17",
    "tangle": "(x*x)**2 - 5*x*x + (y*y)**2 - 5*y*y + (z*z)**2 - 5*z*z + 11.8",
    "teardrop": "(x*x*x*x*x + x*x*x*x)/2 - y*y - z*z",
    "klein": "(x*x + y*y + z*z + 2*y - 1)*((x*x + y*y + z*z - 2*y - 1)**2 - 8*z*z)"
    " + 16*x*z*(x*x + y*y + z*z - 2*y - 1)",
    "barth": "4*(2.618033988749895*x*x - y*y)*(2.618033988749895*y*y - z*z)"
    "*(2.618033988749895*z*z - x*x) - 4.23606797749979*(x*x + y*y + z*z - 1)**2",
    "linked-tori": "((x*x + y*y + z*z + 0.21)**2 - (x*x + y*y))"
    "*(((x - 0.5)**2 + y*y + z*z + 0.21)**2 - ((x - 0.5)**2 + z*z)) - 0.001",
    "gyroid": "sin(x)*cos(y) + sin(y)*cos(z) + sin(z)*cos(x)",
}
NAMES = {"sin": np.sin, "cos": np.cos}


def by_numba(formula):
    """The formula as a loop that numba compiles, which reads and writes memory once."""
    source = f"def f(x, y, z):\n    return {formula}"
    space = dict(NAMES)
    exec(source, space)
    return numba.vectorize([numba.float64(*[numba.float64] * 3)])(space["f"])


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("names", nargs="*", default=list(FORMULAS))
    parser.add_argument("--points", type=int, default=10**7)
    parser.add_argument("--rounds", type=int, default=7)
    arguments = parser.parse_args()
    numexpr.set_num_threads(1)
    random = np.random.default_rng(1)
    x, y, z = random.uniform(-1.5, 1.5, (3, arguments.points))
    ratios = []
    for name in arguments.names or FORMULAS:
        formula = FORMULAS[name]
        surface, loop = (
            zs.Surface(formula.replace("**", "^") + " = 0"),
            by_numba(formula),
        )
        ways = {
            "zeroset": lambda surface=surface: surface(x, y, z),
            "numexpr": lambda formula=formula: numexpr.evaluate(formula, {"x": x, "y": y, "z": z}),
            "numba": lambda loop=loop: loop(x, y, z),
        }
        first, *others = [way() for way in ways.values()]
        for other in others:
            np.testing.assert_allclose(first, other, rtol=1e-9, atol=1e-9)
        del first, others, other
        times = {way: [] for way in ways}
        for _ in range(arguments.rounds):
            for way, run in ways.items():
                begun = time.perf_counter()
                run()
                times[way].append(1e3 * (time.perf_counter() - begun))
        median = {way: statistics.median(found) for way, found in times.items()}
        ratios.append(median["zeroset"] / min(median["numexpr"], median["numba"]))
        shown = "  ".join(f"{way} {took:5.0f}" for way, took in median.items())
        print(f"{name:12} {shown}   {ratios[-1]:.2f} of the better", flush=True)
    print(f"geometric mean {statistics.geometric_mean(ratios):.2f}")


if __name__ == "__main__":
    main()
