"""The widget in a real browser: Chromium, in JupyterLab and in Notebook.

Both tests are skipped where there is no Chromium; `.ci/python` installs it. Otherwise the widget is
driven as its user would: by mouse and keyboard.
"""

import json
import os
import pathlib
import secrets
import shutil
import socket
import subprocess
import sys
import time
import urllib.request

import pytest

import zeroset as zs

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser")
PACKAGE = pathlib.Path(zs.__file__).parents[1]
CELLS = [
    "import zeroset as zs\nw = zs.explore('x^2+y^2+z^2 = 1 + a*x', a=0.5)\nw",
    "print('surface', w.surface, w.camera['eye'])",
]

if CHROMIUM is None:
    pytest.skip("there is no Chromium", allow_module_level=True)
psutil = pytest.importorskip("psutil")
sync_api = pytest.importorskip("playwright.sync_api")


def until(holds, seconds=60):
    """Waits until a condition holds."""
    end = time.monotonic() + seconds
    while not holds():
        assert time.monotonic() < end, "it took too long"
        time.sleep(0.1)


def listeners(process):
    """Addresses on which a process and its children listen."""
    family = [psutil.Process(process), *psutil.Process(process).children(recursive=True)]
    every = [one for member in family for one in member.net_connections(kind="inet")]
    return sorted(one.laddr for one in every if one.status == psutil.CONN_LISTEN)


def asked(address, token, what):
    """An answer of the server's interface, or None if there is none."""
    try:
        with urllib.request.urlopen(f"{address}/api/{what}?token={token}", timeout=5) as answer:
            return json.load(answer)
    except OSError:
        return None


@pytest.fixture(scope="module")
def server(tmp_path_factory):
    """A Jupyter server on the loopback: its address, token, folder and process."""
    folder = tmp_path_factory.mktemp("notebooks")
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    token = secrets.token_hex(16)
    environment = {
        **os.environ,
        "PYTHONPATH": str(PACKAGE),
        # Nothing of the user's own settings.
        "JUPYTER_CONFIG_DIR": str(folder / "config"),
        "JUPYTER_DATA_DIR": str(folder / "data"),
        "JUPYTER_RUNTIME_DIR": str(folder / "runtime"),
        "IPYTHONDIR": str(folder / "ipython"),
    }
    options = [
        "--no-browser",
        "--ip=127.0.0.1",
        f"--port={port}",
        f"--IdentityProvider.token={token}",
    ]
    with (folder / "log").open("w") as log:
        command = [sys.executable, "-m", "jupyterlab", "--allow-root", *options]
        process = subprocess.Popen(
            command, cwd=folder, env=environment, stdout=log, stderr=subprocess.STDOUT
        )
        address = f"http://127.0.0.1:{port}"
        try:
            until(lambda: process.poll() is not None or asked(address, token, "") is not None)
            assert process.poll() is None, (folder / "log").read_text()
            yield address, token, folder, process.pid
        finally:
            process.terminate()
            process.wait(20)


@pytest.fixture(scope="module")
def browser():
    quiet = ["--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run"]
    offline = ["background-networking", "component-update", "sync"]
    with sync_api.sync_playwright() as playwright:
        arguments = [*quiet, *(f"--disable-{what}" for what in offline)]
        chromium = playwright.chromium.launch(executable_path=CHROMIUM, args=arguments)
        yield chromium
        chromium.close()


def notebook(path):
    """Writes a notebook with `CELLS`."""
    cell = {"cell_type": "code", "execution_count": None, "metadata": {}, "outputs": []}
    cells = [{**cell, "id": f"c{n}", "source": source} for n, source in enumerate(CELLS)]
    kernel = {"name": "python3", "display_name": "Python 3 (ipykernel)", "language": "python"}
    whole = {"cells": cells, "metadata": {"kernelspec": kernel}, "nbformat": 4, "nbformat_minor": 5}
    path.write_text(json.dumps(whole))


class Widget:
    """The widget on a page."""

    def __init__(self, page):
        self.page = page
        self.root = page.locator(".zeroset").first
        self.canvas = self.root.locator("canvas")
        self.formula = self.root.locator("textarea")
        self.error = self.root.locator("pre.error")
        self.status = self.root.locator(".status")

    def frames(self):
        return int(self.root.get_attribute("data-frames") or 0)

    def rest(self, after=0):
        """Waits until the widget has drawn more than `after` frames and is at rest."""
        check = "([root, n]) => root.dataset.state === 'rest' && Number(root.dataset.frames) > n"
        self.page.wait_for_function(check, arg=[self.root.element_handle(), after], timeout=60_000)

    def pixels(self):
        """The canvas, as a data URL of a PNG file."""
        return self.canvas.evaluate("canvas => canvas.toDataURL()")

    def painted(self):
        """Number of columns with something other than the background."""
        return self.canvas.evaluate("""canvas => {
            const { width, height } = canvas;
            const row = canvas.getContext("2d").getImageData(0, height >> 1, width, 1).data;
            const colored = [...Array(width).keys()].filter(
                x => Math.abs(row[4 * x] - row[4 * x + 2]) > 30);
            return colored.length;
        }""")

    def center(self):
        box = self.canvas.bounding_box()
        return box["x"] + box["width"] / 2, box["y"] + box["height"] / 2


@pytest.mark.parametrize("place", ["lab/tree", "notebooks"])
def test_widget_is_driven_in_a_browser(server, browser, place):
    address, token, folder, process = server
    name = f"{place.replace('/', '-')}.ipynb"
    notebook(folder / name)
    page = browser.new_page(viewport={"width": 1280, "height": 1000})
    wrong = []
    # Modules of widgets are blobs. Errors of other files are Jupyter's own.
    page.on("pageerror", lambda error: "blob:" in (error.stack or "") and wrong.append(error.stack))
    page.goto(f"{address}/{place}/{name}?token={token}")
    page.locator(".jp-Notebook").wait_for(timeout=60_000)
    # Until the page has a kernel, running would ask for one.
    until(
        lambda: any(
            name in one["path"] and one["kernel"]["execution_state"] == "idle"
            for one in asked(address, token, "sessions")
        )
    )
    quiet = listeners(process)
    page.locator(".jp-Cell").first.click()
    page.keyboard.press("Shift+Enter")
    page.locator(".zeroset canvas").wait_for(timeout=60_000)
    widget = Widget(page)
    widget.rest()
    assert "512 × 512, every pixel proven" in widget.status.inner_text()
    first = widget.pixels()

    # A wrong text shows its place and keeps the picture.
    widget.formula.fill("x^2+y^2+ = 1")
    sync_api.expect(widget.error).to_contain_text("^")
    sync_api.expect(widget.error).to_contain_text("a value is missing")
    assert widget.pixels() == first
    # Typed letter by letter, as people do.
    before = widget.frames()
    widget.formula.fill("")
    widget.formula.press_sequentially("z = b*x*y\nb = 1 in [0, 3]", delay=15)
    sync_api.expect(widget.root.locator(".sliders label")).to_have_text("b")
    sync_api.expect(widget.error).to_have_text("")
    widget.rest(before)
    saddle = widget.pixels()
    assert saddle != first

    # A surface of another size is seen as large as the one before, whether typed or moved.
    slider = widget.root.locator("input[type=range]")
    widths = []
    for radius, share in ((1, 0.9), (30, 0.2)):
        before = widget.frames()
        widget.formula.fill(f"x^2+y^2+z^2 = {radius**2}*r^2\nr = 1 in [0.9, 9]")
        sync_api.expect(widget.root.locator(".sliders label")).to_have_text("r")
        widget.rest(before)
        widths.append(widget.painted())
        before, box = widget.frames(), slider.bounding_box()
        page.mouse.click(box["x"] + share * box["width"], box["y"] + box["height"] / 2)
        widget.rest(before)
        widths.append(widget.painted())
    assert widths[0] > 100
    assert max(widths) - min(widths) < 12, widths
    before = widget.frames()
    widget.formula.fill("z = b*x*y\nb = 1 in [0, 3]")
    sync_api.expect(widget.root.locator(".sliders label")).to_have_text("b")
    widget.rest(before)
    assert widget.pixels() == saddle

    # A slider, by keyboard and by mouse.
    before = widget.frames()
    slider = widget.root.locator("input[type=range]")
    box = slider.bounding_box()
    page.mouse.click(box["x"] + 0.9 * box["width"], box["y"] + box["height"] / 2)
    widget.rest(before)
    moved = widget.pixels()
    assert moved != saddle
    assert 2.4 < float(slider.input_value()) < 3

    # A drag turns the surface.
    before, start = widget.frames(), time.perf_counter()
    x, y = widget.center()
    page.mouse.move(x, y)
    page.mouse.down()
    for step in range(120):
        page.mouse.move(x + 2 * step, y + step / 2)
        # A hand takes time, in which frames are drawn.
        time.sleep(0.01)
    drawn, spent = widget.frames() - before, time.perf_counter() - start
    page.mouse.up()
    widget.rest(before + drawn)
    assert widget.pixels() != moved
    print(f"{place}: {drawn} frames in {spent:.2f} s: {drawn / spent:.1f} a second")
    assert drawn > 3

    # The kernel knows the same surface and view.
    page.get_by_text("print('surface'").first.click()
    page.keyboard.press("Control+Enter")
    output = page.locator(".jp-OutputArea-output").last
    sync_api.expect(output).to_contain_text("z = b*x*y", timeout=30_000)
    # Frames come over the connection that Jupyter has: nothing else listens.
    assert listeners(process) == quiet
    assert {at.ip for at in quiet} == {"127.0.0.1"}
    page.screenshot(path=str(folder / f"{name}.png"))
    if keep := os.environ.get("ZEROSET_SCREENSHOTS"):
        shutil.copy(folder / f"{name}.png", keep)
    assert not wrong, wrong
    page.close()
