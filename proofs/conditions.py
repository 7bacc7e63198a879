"""Tries mutants of a crate's conditions, which one build compiles all at once.

    python proofs/conditions.py ir                      # the unit tests of crates/ir
    python proofs/conditions.py ir --tried 150 --seed 7 --also simpl shorten seams

In a copy of the sources, each condition of an `if` and of a match asks a function whether it holds.
A variable of the environment names one condition, which is then always true, or always false: a
rewriting without its condition, or without the rewriting. The program itself has no such function.
A mutant is found if a test fails, or does not end. With --also, survivors are tried by those tests
of zeroset-testkit whose names contain one of the words.
"""

import argparse
import json
import os
import random
import re
import shutil
import subprocess
import sys
import threading
from collections.abc import Iterable
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
TREE = ROOT / "target/switched/tree"
SECONDS = 300
SWITCH = """//! Decides conditions.

use std::sync::LazyLock;

static MUTANT: LazyLock<Option<usize>> =
    LazyLock::new(|| std::env::var("ZEROSET_CONDITION").ok()?.parse().ok());

pub(crate) fn holds(number: usize, condition: bool) -> bool {
    match *MUTANT {
        Some(mutant) if mutant / 2 == number => mutant % 2 == 0,
        _ => condition,
    }
}
"""
# A condition on one line, without patterns and blocks.
CONDITIONS = [
    re.compile(r"\bif ((?!let\b)[^{}\n]+?) \{(?=$| )"),
    re.compile(r" if ((?!let\b)[^{}\n]+?) =>"),
]


def copy_sources() -> None:
    """Copies the tracked files."""
    shutil.rmtree(TREE, ignore_errors=True)
    listed = subprocess.run(
        ["git", "ls-files", "-z"], cwd=ROOT, check=True, capture_output=True, text=True
    )
    for name in listed.stdout.split("\0"):
        if name and (ROOT / name).is_file():
            (TREE / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(ROOT / name, TREE / name)


def switch(crate: str, skipped: set[tuple[str, int]]) -> list[str]:
    """Switches the conditions of a crate but for `skipped` lines. Returns a text for each."""
    sites: list[str] = []
    sources = TREE / "crates" / crate / "src"
    for path in sorted((ROOT / "crates" / crate / "src").rglob("*.rs")):
        name = str(path.relative_to(ROOT))
        lines = path.read_text().split("\n")
        is_test = path.name in ("tests.rs", "testing.rs")
        for number, line in enumerate(lines):
            if line.startswith("#[cfg(test)]"):
                is_test = True
            if is_test or line.lstrip().startswith("//") or (name, number + 1) in skipped:
                continue
            for pattern in CONDITIONS:
                found = pattern.search(line)
                if found and " let " not in line:
                    start, end = found.span(1)
                    call = f"crate::switch::holds({len(sites)}, {found[1]})"
                    lines[number] = line[:start] + call + line[end:]
                    sites.append(f"{name}:{number + 1} {line.strip()}")
                    break
        (TREE / name).write_text("\n".join(lines))
    (sources / "switch.rs").write_text(SWITCH)
    root = sources / "lib.rs"
    root.write_text(root.read_text().replace("\nmod ", "\nmod switch;\nmod ", 1))
    return sites


def build(arguments: list[str]) -> tuple[Path | None, set[tuple[str, int]]]:
    """Compiles tests. Returns the program, or the lines with errors."""
    environment = os.environ | {"CARGO_TARGET_DIR": str(TREE.parent / "target")}
    command = ["cargo", "test", "--locked", "--no-run", "--message-format=json", *arguments]
    done = subprocess.run(command, cwd=TREE, env=environment, capture_output=True, text=True)
    program, errors = None, set()
    for line in done.stdout.splitlines():
        message = json.loads(line)
        if message.get("executable"):
            program = Path(message["executable"])
        shown = message.get("message", {})
        if isinstance(shown, dict) and shown.get("level") == "error":
            errors |= {(span["file_name"], span["line_start"]) for span in shown["spans"]}
    if program is None and not errors:
        sys.exit(done.stderr)
    return (program if done.returncode == 0 else None), errors


def is_found(program: Path, crate: str, words: Iterable[str], mutant: int) -> bool:
    """Returns whether a test fails, or takes too long. Further tests do not run then."""
    environment = os.environ | {"ZEROSET_CONDITION": str(mutant), "RUST_BACKTRACE": "0"}
    tests = subprocess.Popen(
        [program, *words],
        cwd=TREE / "crates" / crate,
        env=environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
    )
    timer = threading.Timer(SECONDS, tests.kill)
    timer.start()
    assert tests.stdout
    for line in tests.stdout:
        if line.endswith("... FAILED\n"):
            tests.kill()
    timer.cancel()
    return tests.wait() != 0


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("crate")
    parser.add_argument("--tried", type=int, help="mutants, drawn at random; otherwise all")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--also", nargs="*", default=[], metavar="WORD")
    parser.add_argument("--skip", nargs="*", default=[], metavar="TEST", help="slow unit tests")
    arguments = parser.parse_args()
    copy_sources()
    skipped: set[tuple[str, int]] = set()
    while True:
        sites = switch(arguments.crate, skipped)
        program, errors = build(["-p", f"zeroset-{arguments.crate}", "--lib"])
        if program:
            break
        # Such as conditions of constant functions.
        if errors <= skipped:
            sys.exit(f"errors in other lines: {errors}")
        skipped |= errors
    mutants = list(range(2 * len(sites)))
    random.Random(arguments.seed).shuffle(mutants)
    mutants = mutants[: arguments.tried]
    print(f"seed {arguments.seed}: {len(sites)} conditions, {len(mutants)} mutants are tried")
    skips = [f"--skip={name}" for name in arguments.skip]
    stages: list[tuple[str, Path, str, list[str]]] = [
        ("unit tests", program, arguments.crate, skips)
    ]
    if arguments.also:
        properties, _ = build(["-p", "zeroset-testkit", "--test", "all"])
        if properties is None:
            sys.exit("zeroset-testkit does not compile")
        stages.append(("testkit", properties, "testkit", arguments.also))
    total, found = len(mutants), 0
    for name, tests, crate, words in stages:
        if is_found(tests, crate, words, 2 * len(sites)):
            sys.exit(f"{name}: a test fails without a mutant")
        with ThreadPoolExecutor(os.cpu_count()) as pool:
            results = list(pool.map(partial(is_found, tests, crate, words), mutants))
        mutants = [mutant for mutant, is_red in zip(mutants, results, strict=True) if not is_red]
        found = total - len(mutants)
        print(f"{name}: {found} of {total} mutants found", flush=True)
    for mutant in sorted(mutants):
        print(f"always {'false' if mutant % 2 else 'true'}: {sites[mutant // 2]}")


if __name__ == "__main__":
    main()
