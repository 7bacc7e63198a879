"""The manual's lines run as they stand."""

import pathlib
import re

import pytest

import zeroset as zs

MANUAL = pathlib.Path(__file__).parents[3] / "docs" / "python.md"


def test_lines_of_the_manual_run(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    blocks = re.findall(r"```python\n(.*?)```", MANUAL.read_text(), re.DOTALL)
    assert len(blocks) >= 4
    exec("\n".join(blocks), {})
    assert {path.name for path in tmp_path.iterdir()} == {"hyperboloid.png", "part.stl"}


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
