"""Checks the claims of a mesh: its edges, whether it crosses itself, and its distance.

    zeroset mesh "x^2+y^2+z^2 = 1" -o sphere.ply --claims sphere.json
    pip install python-flint numpy
    python check_claims.py sphere.json

Nothing of zeroset is used but the two files. Edges are counted. Whether triangles meet is decided
in whole numbers: coordinates are floats, which are whole numbers times a power of two. For the
distance, each vertex is held against the formula by the ball arithmetic of `check_claims`.
"""

import heapq
import json
from collections import Counter
from itertools import product
from multiprocessing import Pool
from pathlib import Path

import numpy as np
from check_claims import Cell, Jet, Ray, Scene, whole
from flint import arb

TYPES = {"double": "<f8", "float": "<f4", "uchar": "u1"}


def read_ply(path):
    """Vertices and triangles of a binary PLY file."""
    header, data = path.read_bytes().split(b"end_header\n", 1)
    lines = [line.split() for line in header.decode().splitlines()]
    assert ["format", "binary_little_endian", "1.0"] in lines
    vertices, faces = (int(line[2]) for line in lines if line[0] == "element")
    fields = [
        (line[2], TYPES[line[1]]) for line in lines if line[0] == "property" and len(line) == 3
    ]
    found = np.frombuffer(data, fields, vertices)
    rest = np.frombuffer(data, [("count", "u1"), ("corners", "<i4", 3)], faces, found.nbytes)
    assert (rest["count"] == 3).all() and found.nbytes + rest.nbytes == len(data)
    return np.stack([found[axis] for axis in "xyz"], 1), rest["corners"].astype(np.int64)


def edges(vertices, triangles):
    """What edges tell: closed if each is in two triangles, oriented if these run opposite ways."""
    ways = np.concatenate([triangles[:, [k, (k + 1) % 3]] for k in range(3)])
    _, both = np.unique(np.sort(ways, 1), axis=0, return_counts=True)
    _, same = np.unique(ways, axis=0, return_counts=True)
    return {
        "vertices": len(vertices),
        "triangles": len(triangles),
        "closed": bool((both == 2).all()),
        "oriented": bool((same == 1).all() and (both <= 2).all()),
        "euler": len(np.unique(triangles)) - len(both) + len(triangles),
    }


def near_pairs(corners):
    """All pairs of triangles whose boxes meet, by a grid that has each box in all of its cells."""
    low, high = corners.min(1), corners.max(1)
    extent = (high.max(0) - low.min(0)).max()
    cell = max(2 * (high - low).max(1).mean(), extent / 64)
    first, last = (np.floor((end - low.min(0)) / cell).astype(np.int64) for end in (low, high))
    size = last - first + 1
    count = size.prod(1)
    owner = np.repeat(np.arange(len(corners)), count)
    rank = np.arange(count.sum()) - np.repeat(count.cumsum() - count, count)
    places = np.empty((len(owner), 3), np.int64)
    for axis in range(3):
        places[:, axis] = first[owner, axis] + rank % size[owner, axis]
        rank //= size[owner, axis]
    _, group = np.unique(places, axis=0, return_inverse=True)
    group = group.ravel()
    owner = owner[np.argsort(group, kind="stable")]
    pairs = set()
    for members in np.split(owner, np.bincount(group).cumsum()[:-1]):
        one, other = np.triu_indices(len(members), 1)
        one, other = members[one], members[other]
        meet = ((low[one] <= high[other]) & (low[other] <= high[one])).all(1)
        pairs.update(zip(one[meet].tolist(), other[meet].tolist()))
    return np.array(sorted(pairs), np.int64).reshape(-1, 2)


def sides(plane, points):
    """On which side of planes points are, by floats: 0 where these do not tell."""
    a, b, c = (plane[:, None, k] for k in range(3))
    u, v, w = b - a, c - a, points - a
    volume = (np.cross(u, v) * w).sum(2)
    bound = 1e-14 * np.abs(u).sum(2) * np.abs(v).sum(2) * np.abs(w).sum(2)
    return np.where(np.abs(volume) > bound, np.sign(volume), 0).astype(int)


def doubtful(vertices, triangles):
    """Pairs of triangles of which neither has the other on one side, as far as floats tell."""
    corners = vertices[triangles]
    pairs = near_pairs(corners)
    beside = np.zeros(len(pairs), bool)
    for own, other in (pairs.T, pairs.T[::-1]):
        side = sides(corners[own], corners[other])
        shared = (triangles[other][:, :, None] == triangles[own][:, None, :]).any(2)
        for way in (1, -1):
            beside |= ((side == way) | shared).all(1) & ~shared.all(1)
    return pairs[~beside]


def minus(a, b):
    return [p - q for p, q in zip(a, b)]


def dot(a, b):
    return sum(p * q for p, q in zip(a, b))


def cross(a, b):
    return [a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3] for k in range(3)]


def volume(a, b, c, d):
    """The sign of the volume of four points, exact."""
    found = dot(cross(minus(b, a), minus(c, a)), minus(d, a))
    return (found > 0) - (found < 0)


def goes_through(one, other):
    """Whether an edge of a triangle goes through the inside of the other."""
    sides = [volume(*other, corner) for corner in one]
    for k in range(3):
        if sides[k] * sides[k - 1] < 0:
            around = [volume(one[k], one[k - 1], other[j], other[j - 1]) for j in range(3)]
            if abs(sum(around)) == 3:
                return True
    return False


def are_apart(one, other, shared):
    """Whether a plane has two triangles on its sides, and both on it only in shared corners."""
    ways = [[minus(t[k], t[k - 1]) for k in range(3)] for t in (one, other)]
    normals = [cross(way[0], way[1]) for way in ways]
    axes = normals + [cross(u, v) for u, v in product(*ways)]
    axes += [cross(u, normal) for way, normal in zip(ways, normals) for u in way]
    total = [0, 0, 0]

    def touching(axis):
        """The corners of both that lie on a plane between: None if there is no such plane."""
        below, above = ([dot(axis, corner) for corner in t] for t in (one, other))
        if max(below) > min(above):
            return None
        if max(below) < min(above):
            return [[], []]
        end = max(below)
        return [
            [c for c, at in zip(t, all) if at == end]
            for t, all in zip((one, other), (below, above))
        ]

    for axis in axes + [[-a for a in axis] for axis in axes]:
        found = touching(axis) if any(axis) else None
        if found is not None:
            # A sum of such axes has fewer corners on the plane: those that all of them have.
            total = [p + q for p, q in zip(total, axis)]
    found = touching(total) if any(total) else None
    return found is not None and any(all(c in shared for c in corners) for corners in found)


def meetings(vertices, triangles):
    """The numbers of pairs that cross, and that meet in more than the corners they share."""
    ratios = [[along.as_integer_ratio() for along in place] for place in vertices.tolist()]
    scale = max(low for place in ratios for _, low in place)
    places = [[high * (scale // low) for high, low in place] for place in ratios]
    crossing = meeting = 0
    for pair in doubtful(vertices, triangles).tolist():
        one, other = ([places[vertex] for vertex in triangles[k]] for k in pair)
        if goes_through(one, other) or goes_through(other, one):
            crossing += 1
            meeting += 1
            continue
        shared = [places[vertex] for vertex in set(triangles[pair[0]]) & set(triangles[pair[1]])]
        meeting += not are_apart(one, other, shared)
    flat = sum(
        not any(cross(minus(b, a), minus(c, a)))
        for a, b, c in ([places[vertex] for vertex in triangle] for triangle in triangles)
    )
    return crossing, meeting + flat


def distance(cell_values, place):
    """A ball of the distances of points in a box from a place."""
    return sum((value - arb(at)) ** 2 for value, at in zip(cell_values, place)).sqrt()


class Samples:
    """Points of a parametric surface at which a search begins."""

    SIDE = 48

    def __init__(self, patch):
        self.patch = patch
        side = [k / self.SIDE for k in range(self.SIDE + 1)]
        self.shares = list(product(side, side))
        places = [patch.at([arb(share) for share in both], [arb(0)] * 2) for both in self.shares]
        self.places = np.array([[float(jet.v.mid()) for jet in place] for place in places])

    def is_near(self, place, tolerance):
        """Whether a point is proven to be near, that Newton's method finds."""
        off = np.nan_to_num(((self.places - place) ** 2).sum(1), nan=np.inf)
        for start in np.argsort(off)[:3].tolist():
            shares = self.shares[start]
            for _ in range(4):
                found = self.patch.at([arb(share) for share in shares], [arb(0)] * 2)
                if distance([jet.v for jet in found], place) < tolerance:
                    return True
                cell = Cell(self.patch, [arb(share, 0.5 / self.SIDE) for share in shares])
                if not cell.is_smooth:
                    break
                slopes = [[float(one.mid()) for one in slope] for slope in (cell.a, cell.b)]
                way = [at - float(one.mid()) for at, one in zip(place, cell.middle)]
                moves = np.linalg.lstsq(np.array(slopes).T, way, rcond=None)[0] / (2 * self.SIDE)
                shares = [min(max(s + m, 0.0), 1.0) for s, m in zip(shares, moves.tolist())]
        return False


def is_near_patch(patch, place, tolerance, effort):
    """Whether a point of a parametric surface is near: None if that is not decided."""
    if patch.samples.is_near(place, tolerance):
        return True
    if patch.count > patch.MOST_CELLS:
        patch.begin()
    cells = [(0.0, 0, patch.root)]
    for number in range(1, effort):
        if not cells:
            return False
        cell = heapq.heappop(cells)[2]
        if distance(cell.middle, place) < tolerance:
            return True
        for k, part in enumerate(cell.halves()):
            least = distance(part.values, place)
            if not part.void and not least > tolerance:
                nearest = float(least.lower()) if least.is_finite() else 0.0
                heapq.heappush(cells, (max(nearest, 0.0), 2 * number + k, part))
    return None


def has_zero_on(scene, surface, place, way, reach):
    """Whether a zero of a function, or a solid's end, is proven to be on a segment."""
    ray = Ray(scene, {"origin": place, "direction": way})
    if surface["kind"] != "solid":
        return ray.has_zero(surface, -reach, reach)
    found = {ray.side(surface, float(t)) for t in np.linspace(-reach, reach, 9)}
    return -1 in found and (1 in found or is_at_end(scene.domain, place, 0.999 * reach))


def is_at_end(domain, place, reach):
    """Whether a place is near the boundary of a domain."""
    ends = [abs(at - end) for key in ("low", "high") for at, end in zip(place, domain[key])]
    if clip := domain.get("clip"):
        normal = np.array(clip["normal"])
        ends.append(abs(normal @ place - clip["offset"]) / np.linalg.norm(normal))
    if ball := domain.get("ball"):
        ends.append(abs(np.linalg.norm(np.subtract(place, ball["center"])) - ball["radius"]))
    return bool(min(ends) < reach)


def is_near_zeros(scene, surface, place, ways, tolerance, effort):
    """Whether a zero of a function is near, or a solid's end: None if that is not decided."""
    across, inward = ways
    # At a rim, the function may end before the vertex: 0.5² + 0.85² < 1.
    beside = [at + tolerance / 2 * along for at, along in zip(place, inward)]
    for start, share in (place, 1.0), (beside, 0.85):
        if has_zero_on(scene, surface, start, across, share * tolerance):
            return True
    boxes, signs = [[arb(at, tolerance) for at in place]], set()
    for _ in range(effort):
        if not boxes:
            # A solid's sign may jump.
            return None if surface["kind"] == "solid" and len(signs) > 1 else False
        box = boxes.pop()
        values = scene.values(scene.needed, {(n,): Jet(b) for n, b in zip("xyz", box)})
        found = values[surface["step"]]
        value = whole(found).v if surface["kind"] == "solid" else found.v
        if found.void or value > 0 or value < 0:
            signs.add(bool(found.void or value > 0))
            continue
        parts = [[b.mid() + sign * b.rad() / 2 for sign in (-1, 1)] for b in box]
        boxes += [[arb(m, b.rad() / 2) for m, b in zip(m, box)] for m in product(*parts)]
    return None


def begin(header, effort):
    global scene, tolerance
    scene, tolerance = Scene(header, effort), header["distance"]
    for surface in scene.surfaces:
        if surface["kind"] == "parametric":
            surface["patch"].samples = Samples(surface["patch"])


def near(task):
    place, *ways = task
    verdicts = []
    for surface in scene.surfaces:
        if surface["kind"] == "parametric":
            found = is_near_patch(surface["patch"], place, tolerance, scene.effort)
        else:
            found = is_near_zeros(scene, surface, place, ways, tolerance, scene.effort)
        verdicts.append(found)
    return True if True in verdicts else None if None in verdicts else False


def units(vectors):
    """Directions, not longer than 1, so that distances are at most parameters."""
    size = np.linalg.norm(vectors, axis=1, keepdims=True) * (1 + 1e-9)
    return np.where(size > 0, vectors / np.where(size > 0, size, 1), [0.0, 0.0, 1 - 1e-9])


def distances(claims, vertices, triangles, effort):
    """How many vertices are near the surface, are far from it, and are not decided."""
    corners = vertices[triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    across, inward = np.zeros_like(vertices), np.zeros_like(vertices)
    for k in range(3):
        np.add.at(across, triangles[:, k], normals)
        np.add.at(inward, triangles[:, k], corners.mean(1) - corners[:, k])
    tasks = list(zip(vertices.tolist(), units(across).tolist(), units(inward).tolist()))
    with Pool(initializer=begin, initargs=(claims, effort)) as pool:
        count = Counter(pool.imap(near, tasks, chunksize=64))
    return count[True], count[False], count[None]


def check(path, effort):
    """Prints what is found of each claim. Returns whether none is refuted."""
    claims = json.loads(Path(path).read_text(encoding="utf-8"))
    vertices, triangles = read_ply(Path(path).parent / claims["file"])
    print(claims["text"])
    found = edges(vertices, triangles)
    verdicts = {name: claims[name] == value for name, value in found.items()}
    if claims["crossing"] is not None:
        crossing, meeting = meetings(vertices, triangles)
        found |= {"crossing": crossing, "embedded": meeting == 0}
        verdicts["crossing"] = crossing == claims["crossing"]
        if claims["embedded"]:
            verdicts["embedded"] = meeting == 0
    if claims["distance"] is not None:
        near, far, open_count = distances(claims, vertices, triangles, effort)
        found["distance"] = f"{near} vertices near, {far} far, {open_count} not decided"
        verdicts["distance"] = far == 0 and (open_count == 0 or None)
    words = {True: "confirmed", False: "refuted", None: "not decided"}
    for name, verdict in verdicts.items():
        print(f"{name} {claims[name]}: {words[verdict]}: {found[name]}")
    count = Counter(verdicts.values())
    print(f"{count[True]} confirmed, {count[False]} refuted, {count[None]} not decided")
    return count[False] == 0
