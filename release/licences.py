"""Writes the licences of all crates that the program or the wheel is made of.

python licences.py MANIFEST TARGET FILE

Texts come from the crates' own files. A crate without one is listed with the name of its licence,
which its manifest gives. The same text is written once, below the names of all crates that have it.
Fails if a licence is not among those below, or if a crate is not the registry's. Crates of which
two versions are used are listed, since their users choose them.
"""

import collections
import json
import pathlib
import re
import subprocess
import sys

# Each of them lets a program of another licence be made of the code, if its text goes with it.
ALLOWED = {
    "0BSD",
    "Apache-2.0",
    "Apache-2.0 WITH LLVM-exception",
    "BSD-2-Clause",
    "BSD-3-Clause",
    "BSL-1.0",
    "CC0-1.0",
    "ISC",
    "MIT",
    "Unicode-3.0",
    "Zlib",
}
NAMES = ("licen", "copying", "notice", "unlicense")


def main(manifest: str, target: str, file: str) -> None:
    where = ["--locked", "--manifest-path", manifest]
    metadata = json.loads(run("cargo", "metadata", "--format-version", "1", *where))
    tree = run("cargo", "tree", "--target", target, "--edges", "normal", "--prefix", "none", *where)
    # Lines are "name vVERSION", and more where something is to say of the crate.
    used = {tuple(line.split()[:2]) for line in tree.splitlines()}
    # Crates without a source are those of this project.
    crates = sorted(
        (
            package
            for package in metadata["packages"]
            if package["source"] and (package["name"], f"v{package['version']}") in used
        ),
        key=lambda package: (package["name"], package["version"]),
    )
    check(crates)
    texts: dict[str, list[str]] = {}
    bare: list[str] = []
    for package in crates:
        title = f"{package['name']} {package['version']}: {package['license']}"
        found = texts_of(package)
        for text in found:
            texts.setdefault(text, []).append(title)
        if not found:
            bare.append(title)
    rule = "=" * 80
    parts = [
        f"{rule}\n{chr(10).join(titles)}\n{rule}\n\n{text}\n" for text, titles in texts.items()
    ]
    if bare:
        parts.append(
            f"{rule}\nCrates that hold no text of their licence\n{rule}\n\n"
            + "\n".join(bare)
            + "\n"
        )
    pathlib.Path(file).write_text("\n".join(parts), encoding="utf-8")
    print(f"{file}: {len(texts)} texts, {len(bare)} crates without one")


def run(*command: str) -> str:
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def check(crates: list[dict[str, str]]) -> None:
    refused = [
        f"{crate['name']} {crate['version']}: {crate['license']}, {crate['source']}"
        for crate in crates
        if not is_allowed(crate["license"] or "") or not crate["source"].startswith("registry+")
    ]
    if refused:
        sys.exit("these crates cannot be part of a release:\n" + "\n".join(refused))
    counts = collections.Counter(crate["name"] for crate in crates)
    twice = [name for name, count in counts.items() if count > 1]
    print(f"{len(crates)} crates, of these in two versions: {', '.join(twice) or 'none'}")


def is_allowed(licence: str) -> bool:
    """Whether a choice of licences, such as `MIT OR (Apache-2.0 AND ISC)`, has one that is allowed.

    `AND` comes before `OR`, as in Python.
    """
    words = re.sub(
        r"[\w.+-]+( WITH [\w.+-]+)?",
        lambda word: word[0].lower() if word[0] in ("AND", "OR") else str(word[0] in ALLOWED),
        # An old way of writing `OR`.
        licence.replace("/", " OR "),
    )
    return bool(eval(words or "False"))


def texts_of(package: dict[str, str]) -> list[str]:
    directory = pathlib.Path(package["manifest_path"]).parent
    files = sorted(path for path in directory.iterdir() if path.name.lower().startswith(NAMES))
    read = (path.read_text(encoding="utf-8", errors="replace") for path in files if path.is_file())
    return [text.strip().replace("\r\n", "\n") for text in read]


if __name__ == "__main__":
    main(*sys.argv[1:])
