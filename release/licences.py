"""Writes the licences of all crates that the program or the wheel is made of.

python licences.py MANIFEST TARGET FILE

Texts come from the crates' own files. A crate without one is listed with the name of its licence,
which its manifest gives. The same text is written once, below the names of all crates that have it.
"""

import json
import pathlib
import subprocess
import sys

NAMES = ("licen", "copying", "notice", "unlicense")


def main(manifest: str, target: str, file: str) -> None:
    command = ["cargo", "metadata", "--locked", "--format-version", "1"]
    command += ["--manifest-path", manifest, "--filter-platform", target]
    metadata = json.loads(subprocess.run(command, check=True, capture_output=True).stdout)
    packages = {package["id"]: package for package in metadata["packages"]}
    nodes = {node["id"]: node for node in metadata["resolve"]["nodes"]}
    reached, waiting = set(), [metadata["resolve"]["root"]]
    while waiting:
        package = waiting.pop()
        if package in reached:
            continue
        reached.add(package)
        for dependency in nodes[package]["deps"]:
            if any(kind["kind"] is None for kind in dependency["dep_kinds"]):
                waiting.append(dependency["pkg"])
    texts: dict[str, list[str]] = {}
    bare: list[str] = []
    # Crates without a source are those of this project.
    for package in sorted(
        (packages[id] for id in reached if packages[id]["source"]),
        key=lambda package: (package["name"], package["version"]),
    ):
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


def texts_of(package: dict[str, str]) -> list[str]:
    directory = pathlib.Path(package["manifest_path"]).parent
    files = sorted(path for path in directory.iterdir() if path.name.lower().startswith(NAMES))
    read = (path.read_text(encoding="utf-8", errors="replace") for path in files if path.is_file())
    return [text.strip().replace("\r\n", "\n") for text in read]


if __name__ == "__main__":
    main(*sys.argv[1:])
