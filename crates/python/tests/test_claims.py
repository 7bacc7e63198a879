"""The claims of pictures, checked by a program that knows nothing of this one."""

import json
import pathlib
import re
import struct
import subprocess
import sys

import pytest
from conftest import cases

CHECK = pathlib.Path(__file__).parents[3] / "examples" / "python" / "check_claims.py"


def counts(path, status=0):
    """What the checker counts of a file of claims, and all that it prints."""
    run = subprocess.run([sys.executable, CHECK, path], capture_output=True, text=True, check=False)
    assert run.returncode == status, run.stdout + run.stderr
    last = run.stdout.splitlines()[-1]
    return {name: int(n) for n, name in re.findall(r"(\d+) ([a-z ]+)", last)}, run.stdout


def claimed(program, folder, text, size="16", *view):
    path = folder / "claims.jsonl"
    subprocess.run([program, "render", text, "--size", size, *view, "--claims", path], check=True)
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
        ("(cos u cos v, sin u cos v, sin v) for u in [0, 2pi], v in [-pi/2, pi/2]", 1),
        ("clip 1, 1, 0, 0.5; (u v, u, v^2) for u in [-2, 2], v in [-2, 2]; domain ball 1.5", 0.97),
        (
            "r = 0.7 in [0, 1]; x^2 + y^2 + z^2 = 2; "
            "((2 + r cos s) cos t, (2 + r cos s) sin t, r sin s) for s in [0, 2pi], t in [0, 2pi]",
            0.97,
        ),
        ("(u, v, sqrt(4 - u^2 - v^2)) for u in [-2, 2], v in [-2, 2]", 0.97),
        ("(u, v, |u| + max(v, 0)/2 + floor(u + v)/4) for u in [-2, 2], v in [-1, 1]", 0.97),
    ],
)
def test_claims_are_confirmed(program, tmp_path, text, share):
    found, said = counts(claimed(program, tmp_path, text))
    decided = found["confirmed"] + found["not decided"]
    print(found)
    assert decided > 200, said
    assert found["refuted"] == 0, said
    assert found["confirmed"] >= share * decided, said


# A text, and half the side of a cube in which it is seen.
PARAMETRIC = [
    ("(cos u cos v, sin u cos v, sin v) for u in [0, 2pi], v in [-pi/2, pi/2]", 1.5),
    ("((2 + cos v) cos u, (2 + cos v) sin u, sin v) for u in [0, 2pi], v in [0, 2pi]", 3.5),
    ("(v cos u, v sin u, u) for u in [-3, 3], v in [-3, 3]", 2),
    (
        "(sin u cos v sin v, cos u cos v sin v, sin u cos u cos(v)^2) for u in [0, 2pi], "
        "v in [-pi/2, pi/2]",
        0.6,
    ),
    ("(u v, u, v^2) for u in [-2, 2], v in [-2, 2]", 1),
    (
        "(u - u^3/3 + u v^2, -v - u^2 v + v^3/3, u^2 - v^2) for u in [-3, 3], v in [-3, 3]",
        1,
    ),
    ("(v cos u, v sin u, v) for u in [0, 2pi], v in [-2, 2]", 1),
    ("(cosh v cos u, cosh v sin u, sinh v) for u in [0, 2pi], v in [-2, 2]", 1.5),
    (
        "w(u, v) = 2 - cos u cos v; (((3/2) (1 - 2 cos u cos v) + 3 cos u)/w(u, v), "
        "sqrt(3) sin(u) (2 - 1.5 cos v)/w(u, v), sqrt(3) sin(v) (cos u - 1.5)/w(u, v)) "
        "for u in [0, 2pi], v in [0, 2pi]",
        4,
    ),
    ("(cosh v cos u, cosh v sin u, v) for u in [0, 2pi], v in [-2, 2]", 1.5),
]
EYES = [
    [0.3, -0.8, 0.5], [1.0, 0.1, 0.2], [-0.4, 0.7, -0.6], [0.0, 0.0, 1.0],
    [1.0, 0.0, 0.0], [-0.5, -0.5, 0.1], [0.2, 0.9, 0.9], [-0.8, 0.05, 0.3],
]  # fmt: skip


@pytest.mark.parametrize("number", range(len(PARAMETRIC)))
def test_claims_of_parametric_surfaces_are_confirmed(program, tmp_path, number):
    """ZEROSET_CASES is the number of rays in a row. With 60, all views are checked."""
    text, half = PARAMETRIC[number]
    side = cases(10)
    for eye in EYES if side > 10 else [EYES[number % len(EYES)]]:
        size = sum(one * one for one in eye) ** 0.5
        at = ",".join(repr(4 * half * one / size) for one in eye)
        up = "0,1,0" if eye[2] == 1.0 else "0,0,1"
        view = [f"--domain={half}", f"--eye={at}", f"--up={up}", "--target=0,0,0", "--fov=40"]
        found, said = counts(claimed(program, tmp_path, text, str(side), *view))
        print(found)
        assert found["refuted"] == found["not decided"] == 0, said
        # Along two sides, the rays of the diagonals touch the umbrella or the cone exactly.
        assert found["confirmed"] >= 0.96 * side**2, said


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


def test_false_claims_of_parametric_surfaces_are_refuted(program, tmp_path):
    text = "(cos u cos v, sin u cos v, sin v) for u in [0, 2pi], v in [-pi/2, pi/2]"
    path = claimed(program, tmp_path, text, "24")
    header, *lines = path.read_text().splitlines()
    claims = [json.loads(line) for line in lines]
    hits = [claim for claim in claims if claim["status"] == "hit"][::4]
    misses = [claim for claim in claims if claim["status"] == "miss"][::4]
    assert len(hits) > 25 and len(misses) > 25

    def checked(claims, status):
        path.write_text("\n".join([header, *map(json.dumps, claims)]) + "\n")
        return counts(path, status)

    def refuted(claims, why):
        found, said = checked(claims, 1)
        assert found["refuted"] == len(claims) == said.count(why), said

    refuted([{**hit, "status": "miss"} for hit in hits], "there is a zero")
    # Zeros of the equation, as floats.
    near = [zero(hit, -1) for hit in hits]
    assert all(a <= t <= b for t, (a, b) in zip(near, (hit["bracket"] for hit in hits)))
    for moved in [-1e-9, 1e-9]:
        brackets = [[t + moved - 1e-10, t + moved + 1e-10] for t in near]
        pairs = zip(hits, brackets)
        refuted([{**hit, "bracket": both} for hit, both in pairs], "no zero in the bracket")
    refuted(
        [
            {**miss, "status": "hit", "bracket": [1.0, 9.0]}
            for miss in misses
            if within(header, miss)
        ],
        "no zero in the bracket",
    )
    far = [{**hit, "bracket": [zero(hit, 1) - 1e-9, zero(hit, 1) + 1e-9]} for hit in hits]
    refuted(far, "a zero before the bracket")
    # Narrower brackets than those claimed are confirmed.
    exact = [{**hit, "bracket": [t - 1e-12, t + 1e-12]} for hit, t in zip(hits, near)]
    assert checked(exact, 0)[0]["confirmed"] == len(exact)
    # A part of the sphere only: each ray through the rest is a miss.
    half = json.loads(header)
    ranges = half["surfaces"][0]["ranges"]
    assert half["steps"][ranges[1][0]] == ["neg", ranges[1][1]]
    half["steps"].append(["number", "0"])
    ranges[1] = [len(half["steps"]) - 1, ranges[1][1]]
    header = json.dumps(half)
    below = [hit for hit in hits if all(place(hit, sign)[2] < -0.01 for sign in (-1, 1))]
    above = [hit for hit in hits if place(hit, -1)[2] > 0.01]
    assert len(below) > 3 and len(above) > 10
    refuted(below, "no zero in the bracket")
    found, said = checked(above, 0)
    assert found["confirmed"] == len(above), said


def zero(claim, sign):
    """The distance of the first (-1) or the last zero of the unit sphere on a ray."""
    size = sum(d * d for d in claim["direction"]) ** 0.5
    pairs = list(zip(claim["origin"], (d / size for d in claim["direction"])))
    half = sum(o * d for o, d in pairs)
    return -half + sign * (half * half - sum(o * o for o, _ in pairs) + 1) ** 0.5


def place(claim, sign):
    size = sum(d * d for d in claim["direction"]) ** 0.5
    distance = zero(claim, sign)
    return [o + distance * d / size for o, d in zip(claim["origin"], claim["direction"])]


def within(header, claim):
    """Whether the middle of a ray is in the domain."""
    size = sum(d * d for d in claim["direction"]) ** 0.5
    half = -sum(o * d for o, d in zip(claim["origin"], claim["direction"])) / size
    middle = [o + half * d / size for o, d in zip(claim["origin"], claim["direction"])]
    box = json.loads(header)["domain"]
    return all(a < m < b for a, m, b in zip(box["low"], middle, box["high"]))


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


def mesh_claimed(program, folder, text, *options):
    """Files of a mesh and of its claims."""
    paths = folder / "mesh.ply", folder / "mesh.json"
    command = [program, "mesh", text, *options, "-o", paths[0], "--claims", paths[1]]
    subprocess.run(command, check=True)
    return paths


SPHERE = "(cos u cos v, sin u cos v, sin v) for u in [0, 2pi], v in [-pi/2, pi/2]"
ENNEPER = "(u - u^3/3 + u v^2, v - v^3/3 + u^2 v, u^2 - v^2) for u in [-2, 2.1], v in [-2, 2]"


@pytest.mark.parametrize(
    ("text", "claims", "options"),
    [
        (SPHERE, 8, ["--tolerance", "0.02"]),
        (SPHERE, 8, ["--domain", "0.8"]),
        (ENNEPER, 7, []),
        ("klein-bottle-of-figure-8", 7, []),
        # Some triangles have no area, so pairs are not counted.
        ("boy-surface", 6, ["--tolerance", "0.03"]),
        ("(sqrt(x^2+y^2) - 1)^2 + z^2 = 0.16", 8, ["--tolerance", "0.02"]),
        ("domain 2; subtract(box(1.2), cylinder(0.5, 3)) <= 0", 8, ["--tolerance", "0.02"]),
        ("domain 2; z = x*y {x^2 + y^2 < 2}", 8, ["--tolerance", "0.02"]),
        ("domain ball 1; clip 0, 0, 1, 0; x^2 + y^2 <= 0.5", 8, ["--tolerance", "0.02"]),
    ],
)
def test_claims_of_meshes_are_confirmed(program, tmp_path, text, claims, options):
    _, path = mesh_claimed(program, tmp_path, text, *options)
    found, said = counts(path)
    assert found == {"confirmed": claims, "refuted": 0, "not decided": 0}, said


@pytest.mark.parametrize("text", [SPHERE, "x^2 + y^2 + z^2 = 1"])
def test_false_claims_of_meshes_are_refuted(program, tmp_path, text):
    ply, path = mesh_claimed(program, tmp_path, text, "--tolerance", "0.01")
    mesh, claims = ply.read_bytes(), json.loads(path.read_text())
    start, count = mesh.index(b"end_header\n") + 11, claims["vertices"]
    # Coordinates, a normal and a color; a count and three numbers.
    vertex, face = 3 * 8 + 3 * 4 + 4, 1 + 3 * 4
    faces = start + vertex * count
    assert len(mesh) == faces + face * claims["triangles"]
    assert claims["crossing"] == 0 and claims["embedded"]

    def refuted(names, mesh, claims):
        ply.write_bytes(mesh)
        path.write_text(json.dumps(claims))
        _, said = counts(path, 1)
        lines = [line for line in said.splitlines() if ": refuted:" in line]
        assert [line.split()[0] for line in lines] == names, said

    for name in ["vertices", "triangles", "euler", "crossing"]:
        refuted([name], mesh, {**claims, name: claims[name] + 1})
    for name in ["closed", "oriented"]:
        refuted([name], mesh, {**claims, name: False})
    if text != SPHERE:  # It takes minutes there.
        refuted(["distance"], mesh, {**claims, "distance": 1e-12})
    # A triangle that is turned over, and one that is not there.
    corners = mesh[faces + 1 : faces + face]
    turned = mesh[: faces + 1] + corners[4:8] + corners[:4] + mesh[faces + 9 :]
    refuted(["oriented"], turned, claims)
    fewer = {**claims, "triangles": claims["triangles"] - 1}
    header = mesh[:start].replace(b"face %d" % claims["triangles"], b"face %d" % fewer["triangles"])
    refuted(["closed", "euler"], header + mesh[start:faces] + mesh[faces + face :], fewer)

    def moved(factor):
        """The mesh, of which a vertex is so many times as far from the center."""
        at = struct.unpack_from("<3d", mesh, start)
        return mesh[:start] + struct.pack("<3d", *(factor * x for x in at)) + mesh[start + 24 :]

    refuted(["distance"], moved(1.02), claims)
    # Through the other side, past the vertex there.
    refuted(["crossing", "embedded", "distance"], moved(-1.3), claims)
