"""Checks that what two processors prove about the same rays does not contradict.

python consistent.py DIRECTORY DIRECTORY compares NAME.status.npy and NAME.bracket.npy of both. A
ray that is a proven hit in one is no proven miss in the other, and the two brackets meet.
"""

import array
import pathlib
import sys

MISS, HIT, UNDECIDED = 0, 1, 2


def read(file: pathlib.Path, code: str) -> array.array:
    """The elements of an array file of version 1."""
    content = file.read_bytes()
    length = int.from_bytes(content[8:10], "little")
    values = array.array(code)
    values.frombytes(content[10 + length :])
    return values


def main(one: str, other: str) -> None:
    rays = differ = 0
    names = sorted(path.name for path in pathlib.Path(one).glob("*.status.npy"))
    if not names:
        sys.exit("there is nothing to compare")
    for name in names:
        bracket = name.replace("status", "bracket")
        statuses = [read(pathlib.Path(place, name), "B") for place in (one, other)]
        brackets = [read(pathlib.Path(place, bracket), "d") for place in (one, other)]
        for ray, (here, there) in enumerate(zip(*statuses, strict=True)):
            rays += 1
            differ += here != there
            if {here, there} == {MISS, HIT}:
                sys.exit(f"{name}: ray {ray} is a miss in one, and a hit in the other")
            if here == there == HIT:
                (low, high), (least, most) = (b[2 * ray : 2 * ray + 2] for b in brackets)
                if low > most or least > high:
                    sys.exit(f"{bracket}: the brackets of ray {ray} do not meet")
    print(f"{rays} rays of {len(names)} surfaces: no contradiction; {differ} statuses differ")


main(*sys.argv[1:])
