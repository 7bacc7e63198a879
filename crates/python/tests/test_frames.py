"""The recipe for frames in many processes."""

import pathlib
import subprocess
import sys

import pytest

SCRIPT = pathlib.Path(__file__).parents[3] / "examples" / "python" / "frames.py"


def frames(folder, kind, way):
    command = [sys.executable, SCRIPT, kind, folder, "--frames", "6", "--size", "48", "--by", way]
    done = subprocess.run(command, check=True, capture_output=True, text=True, timeout=120)
    files = {path.name: path.read_bytes() for path in sorted(folder.iterdir())}
    return done.stdout, files


@pytest.mark.parametrize("kind", ["turn", "study"])
def test_frames_do_not_depend_on_the_process(kind, tmp_path):
    pytest.importorskip("joblib")
    pytest.importorskip("dask.distributed")
    first, alone = frames(tmp_path / "alone", kind, "alone")
    count = len(alone)
    assert count == {"turn": 6, "study": 25}[kind]
    assert first.startswith(f"{count} of {count} frames drawn")
    for way in ["dask", "joblib"]:
        assert frames(tmp_path / way, kind, way)[1] == alone
    # Only frames that lack are drawn.
    (tmp_path / "joblib" / "frame-00003.png").unlink()
    again, files = frames(tmp_path / "joblib", kind, "joblib")
    assert again.startswith(f"1 of {count} ") and files == alone
