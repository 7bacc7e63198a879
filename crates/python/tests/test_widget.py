"""The kernel's half of the widget. `test_explorer.py` drives the other half in a browser."""

import math
import queue
import threading

import pytest

import zeroset as zs

pytest.importorskip("anywidget")


class Browser:
    """A view of a widget that asks for pictures and takes answers."""

    def __init__(self, widget, view="one"):
        self.widget, self.view, self.number = widget, view, 0
        self.answers = queue.Queue()
        widget.send = lambda content, buffers=(): self.answers.put((content, buffers))

    def ask(self, **changes):
        self.number += 1
        request = {"view": self.view, "number": self.number, "width": 64, "height": 64}
        request |= {"final": True, "camera": None, "domain": None, "values": {}, **changes}
        self.widget._receive(None, request, [])

    def answer(self):
        return self.answers.get(timeout=60)


def test_a_picture_is_that_of_render():
    w = zs.explore("x^2 + y^2 + z^2 = r^2", r=1)
    browser = Browser(w)
    browser.ask(values={"r": 1.5})
    answer, (png,) = browser.answer()
    assert answer["counts"]["undecided"] == 0 and answer["size"] == [64, 64]
    assert png == w.surface.render(64, 64).png()
    assert w.surface.parameters == {"r": 1.5} and w.picture.counts == answer["counts"]
    # The view that is told draws the same picture again.
    assert w.surface.render(64, 64, **w.camera).png() == png
    browser.ask(camera=answer["camera"], domain=answer["domain"], values={"r": 1.5})
    assert browser.answer()[1] == [png]


def test_the_view_follows_the_surface_unless_it_was_moved():
    w = zs.explore("x^2 + y^2 + z^2 = r^2", 32, 32, r=1)
    browser = Browser(w)
    browser.ask()
    small = browser.answer()[0]["camera"]

    def ratio(camera):
        return math.dist(camera["eye"], (0, 0, 0)) / math.dist(small["eye"], (0, 0, 0))

    w.text = "x^2 + y^2 + z^2 = 900*r^2\nr = 1"
    assert w.camera == {}
    browser.ask()
    answer, _ = browser.answer()
    large = answer["camera"]
    assert ratio(large) == pytest.approx(30, rel=0.05)
    w.values = {"r": 20.0}
    assert w.camera == {}
    assert ratio(w.surface.render(64, 64, **w.camera).camera) == pytest.approx(600, rel=0.05)
    # Somebody turns it: the view stays, and the domain is that of the surface.
    eye = [100.0, 0.0, 0.0]
    browser.ask(camera={**large, "eye": eye}, values={"r": 20.0})
    browser.answer()
    w.text = "x^2 + y^2 + z^2 = 400"
    assert w.camera["eye"] == eye and "domain" not in w.camera


def test_options_reach_the_picture():
    w = zs.explore("z = x*y", 48, 32, options={"look": "studio", "fov": 20, "axes": True})
    browser = Browser(w)
    browser.ask(width=48, height=32)
    _, (png,) = browser.answer()
    assert png == zs.Surface("z = x*y").render(48, 32, look="studio", fov=20, axes=True).png()


def test_a_wrong_text_leaves_the_surface():
    w = zs.explore("x^2 + y^2 + z^2 = 1")
    before = w.surface
    w.text = "x^2 + y^2 + = 1"
    assert "^" in w.error and w.surface is before and w.revision == 0
    w.text = "x^2 + y^2 = 1"
    assert w.error == "" and w.surface.surfaces == ["x^2 + y^2 = 1"] and w.revision == 1
    # The old text is right again, though nothing is read anew.
    w.text = "x^2 +"
    w.text = "x^2 + y^2 = 1"
    assert w.error == "" and w.revision == 1


def test_values_that_were_moved_stay():
    w = zs.explore("z = a*x + b*y\na = 1\nb = 2 in [0, 5]")
    w.values = {"a": 3.0, "b": 4.0}
    assert w.surface.parameters == {"a": 3.0, "b": 4.0}
    w.text = "z = a*x + b*y + c\na = 1\nb = 1 in [0, 5]\nc = 0"
    # The text gives b a new value, and a the same as before.
    assert w.values == {"a": 3.0, "b": 1.0, "c": 0.0} == w.surface.parameters


def test_ranges_of_sliders():
    w = zs.explore("z = a*x + b*y + c*sin(x + t)\na = 2\nb = 0\nc = 1 in [-1, 4]")
    rows = {row["name"]: (row["low"], row["high"], row["time"]) for row in w.sliders}
    assert rows == {
        "a": (0, 4, False),
        "b": (-1, 1, False),
        "c": (-1, 4, False),
        "t": (0, 2 * math.pi, True),
    }


def test_a_picture_that_cannot_be_drawn_is_an_answer():
    w = zs.explore("x^2 + y^2 + z^2 = 1")
    browser = Browser(w)
    browser.ask(width=0)
    assert "error" in browser.answer()[0]
    browser.ask(camera={"eye": [0, 0, 0], "target": [0, 0, 0]})
    assert "same point" in browser.answer()[0]["error"]
    browser.ask()
    assert "error" not in browser.answer()[0]


def test_a_newer_request_ends_an_older_one():
    slow = "sum(k = 1..10, tan(k*1e6*x + k*y)) = z\ndomain 1"
    w = zs.explore(slow)
    browser = Browser(w)
    started = threading.Event()
    draw = w._render
    w._render = lambda *request: started.set() or draw(*request)
    browser.ask(width=3000, height=3000)
    assert started.wait(60)
    w.text = "x^2 + y^2 + z^2 = 1"
    browser.ask(width=16, height=16)
    answer, _ = browser.answer()
    assert answer["number"] == 2 and browser.answers.empty()


def test_pictures_that_move_are_all_drawn_in_turn():
    w = zs.explore("x^2 + y^2 + z^2 = r^2", r=1)
    browser = Browser(w)
    for step in range(5):
        browser.ask(final=False, values={"r": 1 + step / 10})
    found = [browser.answer()[0]["number"] for _ in range(5)]
    assert found == [1, 2, 3, 4, 5]


def test_readers_without_widgets_see_a_picture():
    import base64

    w = zs.explore("x^2 + y^2 + z^2 = 1", 32, 24)
    bundle, _ = w._repr_mimebundle_()
    assert base64.b64decode(bundle["image/png"]).startswith(b"\x89PNG")
