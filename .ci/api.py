"""Compares the library's public items with those of the last release, as semantic versioning asks.

python api.py DOCUMENTATION           fails if an item is gone, and the version does not allow it
python api.py DOCUMENTATION record    writes the items of a release to tests/data/api.txt

DOCUMENTATION is what `cargo doc` makes of the crate `zeroset`. Each line is an item, after the path
of the item that has it. New items never break a program. Members of a type that programs may not
list (`non_exhaustive`) are lines of their own, so a new one is a new item.
"""

import html.parser
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).parent.parent
RECORD = ROOT / "tests/data/api.txt"
KINDS = ("struct", "enum", "trait", "fn", "constant", "type", "macro")
# Elements that have no end.
EMPTY = {"br", "hr", "img", "input", "link", "meta", "wbr"}
BLANKET = "blanket-implementations-list"
# The line of a trait says enough of its functions. Some traits are the compiler's own.
IMPLIED = re.compile(r"fn |impl ((!\w+|Freeze|StructuralPartialEq|UnsafeUnpin) for )?\w+$")


class Page(html.parser.HTMLParser):
    """The declarations on one page, but for those that hold for all types."""

    def __init__(self) -> None:
        super().__init__()
        self.depth = 0
        self.declaration = self.skipped = 0
        self.found: list[str] = []

    def handle_starttag(self, tag: str, attributes: list[tuple[str, str | None]]) -> None:
        if tag in EMPTY:
            return
        self.depth += 1
        names = dict(attributes)
        if names.get("id") == BLANKET:
            self.skipped = self.depth
        declares = {"code-header", "item-decl"} & set((names.get("class") or "").split())
        if declares and not self.skipped and not self.declaration:
            self.declaration = self.depth
            self.found.append("")

    def handle_endtag(self, tag: str) -> None:
        if tag in EMPTY:
            return
        if self.depth == self.declaration:
            self.declaration = 0
        if self.depth == self.skipped:
            self.skipped = 0
        self.depth -= 1

    def handle_data(self, data: str) -> None:
        if self.declaration:
            # The sign leads to notes on a type.
            self.found[-1] += data.replace("ⓘ", "")


def lines(text: str) -> list[str]:
    """A declaration as one line, or one line for each member that others may be added to."""
    body = re.sub(r"//.*", "", text)
    if not text.startswith("#[non_exhaustive]"):
        return [" ".join(body.split())]
    # Members begin at the first level of indentation, and deeper lines belong to them.
    members = re.split(r"\n(?! {5}| {4}[)}\]])", body)
    joined = (" ".join(member.split()).rstrip(",") for member in members)
    return [member for member in joined if member not in ("", "}")]


def items(documentation: pathlib.Path) -> set[str]:
    found = set()
    for page in documentation.glob("*.html"):
        kind, _, name = page.stem.partition(".")
        if kind not in KINDS:
            continue
        reader = Page()
        reader.feed(page.read_text(encoding="utf-8"))
        declared = {line for text in reader.found for line in lines(text)}
        found |= {f"{name}: {line}" for line in declared if not IMPLIED.match(line)}
    return found


def version() -> str:
    manifest = (ROOT / "Cargo.toml").read_text(encoding="utf-8")
    return manifest.split("[workspace.package]")[1].split('version = "')[1].split('"')[0]


def allows_changes(before: str, now: str) -> bool:
    """Whether a version may break programs that were written for an earlier one."""
    old, new = ([int(part) for part in version.split(".")] for version in (before, now))
    return new[0] > old[0] or (old[0] == new[0] == 0 and new[1] > old[1])


def main(documentation: str, task: str = "check") -> int:
    now = items(pathlib.Path(documentation))
    if task == "record":
        RECORD.write_text("\n".join([version(), *sorted(now)]) + "\n", encoding="utf-8")
        print(f"{RECORD.name}: {len(now)} items of {version()}")
        return 0
    released, *recorded = RECORD.read_text(encoding="utf-8").splitlines()
    gone, new = sorted(set(recorded) - now), sorted(now - set(recorded))
    print(f"api: {len(now)} items, {len(new)} new since {released}, {len(gone)} gone or changed")
    if not gone or allows_changes(released, version()):
        return 0
    print("\n".join(gone))
    print(f"Programs for {released} may need these. Keep them, or raise the version, and record.")
    return 1


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
