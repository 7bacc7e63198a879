"""The manual's lines run as they stand."""

import pathlib
import re

import pytest

import zeroset as zs

ROOT = pathlib.Path(__file__).parents[3]


@pytest.mark.parametrize(
    ("name", "files"),
    [
        ("docs/python.md", {"hyperboloid.png", "part.stl"}),
        ("README.md", {"hyperboloid.png", "hyperboloid.stl"}),
    ],
)
def test_lines_of_the_manual_run(name, files, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    blocks = re.findall(r"```python\n(.*?)```", (ROOT / name).read_text(), re.DOTALL)
    exec("\n".join(blocks), {})
    assert {path.name for path in tmp_path.iterdir()} == files


def public():
    for name in zs.__all__:
        thing = getattr(zs, name)
        if isinstance(thing, type):
            for key, value in vars(thing).items():
                if not key.startswith("_"):
                    yield f"{name}.{key}", value
        elif callable(thing):
            yield name, thing


@pytest.mark.parametrize("name", [name for name, _ in public()])
def test_public_names_have_a_docstring(name):
    assert dict(public())[name].__doc__, name
