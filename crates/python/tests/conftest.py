"""Helps for all tests: the program `zeroset`, and numbers from a seed that is printed."""

import os
import pathlib

import numpy as np
import pytest

SEED = 20070020


@pytest.fixture
def random():
    print(f"seed {SEED}; ZEROSET_CASES sets the number of cases")
    return np.random.default_rng(SEED)


def cases(usual):
    """How many random cases a test takes: `usual`, unless ZEROSET_CASES is set."""
    return int(os.environ.get("ZEROSET_CASES", usual))


@pytest.fixture(scope="session")
def program():
    """The program, as `cargo build` leaves it."""
    root = pathlib.Path(__file__).parents[3]
    path = pathlib.Path(os.environ.get("ZEROSET", root / "target" / "debug" / "zeroset"))
    assert path.is_file(), f"{path}: run `cargo build` first, or set ZEROSET"
    return path
