"""Draws surfaces of the gallery beside scikit-image's marching cubes and isoray.

    pip install isoray scikit-image trimesh embreex
    python benches/python/peers.py --size 512 > table.md

All three follow the same rays, in the same box. Peers sample the function as zeroset compiles it,
which favors them: it is many times as fast as NumPy. A mesh is followed by Embree. Times are from
the text to distances for all pixels, medians of --rounds runs. A pixel counts as missed if a peer
has no surface where zeroset proves one, and as invented if it has one where zeroset proves none.
The error is the largest difference from the proven bracket among the pixels that both draw.
"""

import argparse
import contextlib
import signal
import statistics
import sys
import time

import isoray
import numpy as np
import trimesh
from skimage.measure import marching_cubes
from trimesh.ray.ray_pyembree import RayMeshIntersector

import zeroset as zs


class Scene:
    """A surface with the box, the rays and the claims of a picture."""

    def __init__(self, text, size):
        self.text = text
        picture = zs.Surface(text).render(size, size, antialias=1)
        self.domain = np.array(picture.domain)
        self.view = {**picture.camera, "domain": picture.domain}
        self.status = picture.status.ravel()
        self.brackets = picture.brackets.reshape(-1, 2)
        self.rays = [array.reshape(-1, 3) for array in picture.rays]
        self.size = size

    def judge(self, t):
        """Missed pixels, invented pixels and the largest error of distances."""
        drawn = np.isfinite(t)
        hit, miss = self.status == zs.HIT, self.status == zs.MISS
        both = hit & drawn
        lo, hi = self.brackets[both].T
        error = np.maximum(np.maximum(lo - t[both], t[both] - hi), 0).max(initial=0)
        return np.count_nonzero(hit & ~drawn), np.count_nonzero(miss & drawn), error


def ours(scene):
    picture = zs.Surface(scene.text).render(scene.size, scene.size, antialias=1, **scene.view)
    return picture.depth.ravel()


def by_isoray(scene):
    surface = zs.Surface(scene.text)

    def sampled(points):
        return surface(points), surface.gradient(points)

    origins, directions = scene.rays
    low, high = scene.domain.T
    inside = isoray.ray_aabb_intersect(origins, directions, low, high)
    lipschitz = isoray.estimate_lipschitz(sampled, (low, high))
    bounds = isoray.GradientInclusion(sampled, lipschitz=lipschitz)
    found = isoray.bisect_trace(origins, directions, *inside, bounds, sampled)
    between = {"t_lo": found.t_lo, "t_hi": found.t_hi}
    t = isoray.newton_refine(found.t, origins, directions, found.hit, sampled, **between)
    return np.where(found.hit, t, np.inf)


def by_cubes(cells):
    def draw(scene):
        surface = zs.Surface(scene.text)
        axes = [np.linspace(low, high, cells + 1) for low, high in scene.domain]
        values = surface(*np.meshgrid(*axes, indexing="ij", sparse=True))
        t = np.full(len(scene.status), np.inf)
        if not np.nanmin(values) < 0 < np.nanmax(values):
            return t
        steps = (scene.domain[:, 1] - scene.domain[:, 0]) / cells
        vertices, faces, _, _ = marching_cubes(values, 0, spacing=tuple(steps))
        mesh = trimesh.Trimesh(vertices + scene.domain[:, 0], faces, process=False)
        points, rays, _ = RayMeshIntersector(mesh).intersects_location(
            *scene.rays, multiple_hits=False
        )
        t[rays] = np.linalg.norm(points - scene.rays[0][rays], axis=1)
        return t

    return draw


WAYS = {
    "zeroset": ours,
    "isoray": by_isoray,
    "cubes 128³": by_cubes(128),
    "cubes 256³": by_cubes(256),
}


@contextlib.contextmanager
def within(seconds):
    """Raises TimeoutError in the block after this time."""

    def end(*_):
        raise TimeoutError

    signal.signal(signal.SIGALRM, end)
    signal.alarm(seconds)
    try:
        yield
    finally:
        signal.alarm(0)


def row(name, scene, rounds, limit):
    """A row of the table for each way."""
    for way, draw in WAYS.items():
        times = []
        try:
            for _ in range(rounds):
                begun = time.perf_counter()
                with within(limit):
                    t = draw(scene)
                times.append(time.perf_counter() - begun)
                if times[-1] > 20:
                    break
        except TimeoutError:
            print(f"| {name} | {way} | over {limit} s | | | |", flush=True)
            continue
        except (ValueError, MemoryError, RuntimeError, FloatingPointError) as error:
            print(f"| {name} | {way} | cannot: {type(error).__name__} | | | |", flush=True)
            continue
        missed, invented, error = scene.judge(t)
        took = 1e3 * statistics.median(times)
        print(
            f"| {name} | {way} | {took:.0f} | {missed} | {invented} | {error:.1e} |",
            flush=True,
        )


def is_plain(text):
    """Whether a text draws one whole zero set in a box. Peers know nothing else."""
    lines = [line for line in text.splitlines() if not line.startswith("#")]
    words = ["ball", "clip", "<", ">", "{"]
    others = any(word in line for word in words for line in lines)
    return len(zs.Surface(text).surfaces) == 1 and not others


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("names", nargs="*", help="surfaces of the gallery; all by default")
    parser.add_argument("--size", type=int, default=512)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--limit", type=int, default=60, help="seconds for a picture")
    arguments = parser.parse_args()
    print("| surface | by | ms | missed | invented | largest error |")
    print("|---|---|---:|---:|---:|---:|")
    texts = zs.examples()
    for name in arguments.names or texts:
        if not is_plain(texts[name]):
            print(
                f"{name}: left out, since peers know no solids, cuts or lists",
                file=sys.stderr,
            )
            continue
        scene = Scene(texts[name], arguments.size)
        row(name, scene, arguments.rounds, arguments.limit)


if __name__ == "__main__":
    main()
