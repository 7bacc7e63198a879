"""The claims of pictures, checked by a program that knows nothing of this one."""

import json
import pathlib
import re
import subprocess
import sys

import pytest

CHECK = pathlib.Path(__file__).parents[3] / "examples" / "python" / "check_claims.py"


def counts(path, status=0):
    """What the checker counts of a file of claims, and all that it prints."""
    run = subprocess.run([sys.executable, CHECK, path], capture_output=True, text=True, check=False)
    assert run.returncode == status, run.stdout + run.stderr
    last = run.stdout.splitlines()[-1]
    return {name: int(n) for n, name in re.findall(r"(\d+) ([a-z ]+)", last)}, run.stdout


def claimed(program, folder, text, size="16"):
    path = folder / "claims.jsonl"
    subprocess.run([program, "render", text, "--size", size, "--claims", path], check=True)
    return path


# At jumps and edges of domains, balls hold values of both sides.
@pytest.mark.parametrize(
    ("text", "share"),
    [
        ("barth-sextic", 0.97),
        ("gyroid", 0.97),
        ("domain 3; z = 1/x + tan(y)/4", 0.97),
        ("max(abs(x), sqrt(y^2+z^2)) - 1 <= 0; z = sin(3x)/2", 0.97),
        ("domain ball 2; subtract(box(1.2), cylinder(0.5, 3)) <= 0", 0.97),
        ("if(x < 0, x^2 + y^2, |y| + floor(2x)/4) + z = 1/2", 0.97),
        ("z = atan2(y, x)/2 + sqrt(2 - x^2 - y^2); domain 2", 0.85),
        ("domain 4; besselj0(2*sqrt(x^2+y^2)) + erf(x)/9 = z", 0.97),
        ("(x^2+y^2)^(3/4) + mod(z, 1) = 1; domain 2", 0.85),
    ],
)
def test_claims_are_confirmed(program, tmp_path, text, share):
    found, said = counts(claimed(program, tmp_path, text))
    decided = found["confirmed"] + found["not decided"]
    print(found)
    assert decided > 200, said
    assert found["refuted"] == 0, said
    assert found["confirmed"] >= share * decided, said


def test_false_claims_are_refuted(program, tmp_path):
    path = claimed(program, tmp_path, "(sqrt(x^2+y^2) - 1)^2 + z^2 = 0.16", "24")
    header, *lines = path.read_text().splitlines()
    claims = [json.loads(line) for line in lines]
    hits = [claim for claim in claims if claim["status"] == "hit"]
    misses = [claim for claim in claims if claim["status"] == "miss"]
    assert len(hits) > 100 and len(misses) > 100
    depths = sorted(hits, key=lambda claim: claim["bracket"][1] - claim["bracket"][0])

    def refuted(claim, why):
        path.write_text("\n".join([header, json.dumps(claim)]) + "\n")
        found, said = counts(path, 1)
        assert found["refuted"] == 1 and why in said, said

    refuted({**hits[50], "status": "miss"}, "there is a zero")
    near = depths[0]["bracket"][0]
    for moved in [-0.2, 0.2]:
        bracket = [near + moved, near + moved + 0.01]
        refuted({**depths[0], "bracket": bracket}, "no zero in the bracket")
    middle = misses[len(misses) // 2]
    refuted({**middle, "status": "hit", "bracket": [1.0, 9.0]}, "no zero in the bracket")
    # A ray through the ring's near and far side: the bracket is the second zero's.
    passing = next(claim for claim in hits if second(claim))
    refuted({**passing, "bracket": second(passing)}, "a zero before the bracket")


def second(claim):
    """A bracket of a later zero of the torus on a hit's ray, if there is one."""
    length = sum(d * d for d in claim["direction"]) ** 0.5
    directions = [d / length for d in claim["direction"]]

    def value(distance):
        x, y, z = (o + distance * d for o, d in zip(claim["origin"], directions, strict=True))
        return ((x * x + y * y) ** 0.5 - 1) ** 2 + z * z - 0.16

    step = claim["bracket"][1] + 0.05
    if value(step) > -0.01:
        return None
    while value(step) < 0:
        step += 0.01
    return [step - 0.02, step + 0.01]
