"""Packs a directory so that the same files give the same bytes.

python archive.py DIRECTORY FILE.tar.gz|FILE.zip SECONDS

Every file has the given time, in seconds since 1970, and belongs to nobody.
"""

import gzip
import io
import os
import pathlib
import sys
import tarfile
import time
import zipfile


def main(directory: str, file: str, seconds: str) -> None:
    root = pathlib.Path(directory)
    files = sorted(path for path in root.rglob("*") if path.is_file())
    names = [(path, str(path.relative_to(root.parent)).replace(os.sep, "/")) for path in files]
    pack = zipped if file.endswith(".zip") else packed
    pathlib.Path(file).write_bytes(pack(names, int(seconds)))


def mode(path: pathlib.Path) -> int:
    return 0o755 if os.access(path, os.X_OK) else 0o644


def packed(names: list[tuple[pathlib.Path, str]], seconds: int) -> bytes:
    tar = io.BytesIO()
    with tarfile.open(fileobj=tar, mode="w", format=tarfile.USTAR_FORMAT) as archive:
        for path, name in names:
            entry = tarfile.TarInfo(name)
            entry.size, entry.mtime, entry.mode = path.stat().st_size, seconds, mode(path)
            archive.addfile(entry, io.BytesIO(path.read_bytes()))
    return gzip.compress(tar.getvalue(), mtime=seconds)


def zipped(names: list[tuple[pathlib.Path, str]], seconds: int) -> bytes:
    content = io.BytesIO()
    with zipfile.ZipFile(content, "w", zipfile.ZIP_DEFLATED) as archive:
        for path, name in names:
            entry = zipfile.ZipInfo(name, time.gmtime(seconds)[:6])
            entry.compress_type = zipfile.ZIP_DEFLATED
            entry.external_attr = mode(path) << 16
            archive.writestr(entry, path.read_bytes())
    return content.getvalue()


if __name__ == "__main__":
    main(*sys.argv[1:])
