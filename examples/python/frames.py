"""Draws the frames of a sequence, or of a parameter study, in many processes.

    python frames.py turn out --frames 90 --by dask
    python frames.py study out --by joblib

Each frame follows from its number alone. So any process can draw any frame, and frames that are
there already are left as they are: a run that was stopped goes on where it ended. The domain and
the camera are set, so that the view is the same in all frames.
"""

import argparse
import itertools
import math
import pathlib

import zeroset as zs

TURN = zs.Surface("sin(x + t)*cos(y) + sin(y)*cos(z) + sin(z)*cos(x + t) = 0\ndomain ball 6")
STUDY = zs.Surface("x^2 + b*y^2 + c*z^2 = 1\nb = 1 in [-1, 2]\nc = 1 in [-1, 2]\ndomain 2")
VALUES = list(itertools.product([-1, 0, 0.5, 1, 2], repeat=2))


def turn(number, frames):
    """Values of the parameters in a frame of a sequence that repeats."""
    return TURN, {"t": 2 * math.pi * number / frames}, {"eye": [17, 13, 11]}


def study(number, _frames):
    """Values of the parameters in a frame of a parameter study."""
    b, c = VALUES[number]
    return STUDY, {"b": b, "c": c}, {"eye": [6, 4.5, 4]}


KINDS = {"turn": turn, "study": study}


def draw(kind, number, frames, folder, size):
    """Draws one frame, unless it is there. Returns its number and what is proven of its pixels."""
    path = pathlib.Path(folder) / f"frame-{number:05}.png"
    if path.exists():
        return number, None
    surface, values, camera = KINDS[kind](number, frames)
    surface.set(**values)
    picture = surface.render(size, size, target=[0, 0, 0], **camera)
    # A frame appears whole or not at all, also if its process is ended.
    picture.save(path)
    return number, picture.counts


def by_dask(jobs):
    """Local processes here; the address of a scheduler as `Client(address)` uses a cluster."""
    from dask.distributed import Client, as_completed

    with Client(n_workers=2, threads_per_worker=1, dashboard_address=None) as client:
        futures = [client.submit(draw, *job, pure=False) for job in jobs]
        for future in as_completed(futures):
            yield future.result()


def by_joblib(jobs):
    """All processors of this machine."""
    from joblib import Parallel, delayed

    yield from Parallel(n_jobs=2, return_as="generator")(delayed(draw)(*job) for job in jobs)


def alone(jobs):
    """This process, whose kernels use all processors."""
    for job in jobs:
        yield draw(*job)


WAYS = {"dask": by_dask, "joblib": by_joblib, "alone": alone}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("kind", choices=KINDS)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--frames", type=int, default=60, help="frames of a turn")
    parser.add_argument("--size", type=int, default=256)
    parser.add_argument("--by", choices=WAYS, default="alone")
    arguments = parser.parse_args()
    frames = len(VALUES) if arguments.kind == "study" else arguments.frames
    arguments.folder.mkdir(parents=True, exist_ok=True)
    folder = str(arguments.folder.resolve())
    jobs = [(arguments.kind, number, frames, folder, arguments.size) for number in range(frames)]
    drawn = undecided = 0
    for _, counts in WAYS[arguments.by](jobs):
        drawn += counts is not None
        undecided += counts["undecided"] if counts else 0
    print(f"{drawn} of {frames} frames drawn, {undecided} pixels undecided")


if __name__ == "__main__":
    main()
