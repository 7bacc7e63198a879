"""A widget for notebooks in which one turns a surface, types formulas and moves sliders.

The browser asks for pictures, a few ahead: see ``explorer.js``. A thread of the kernel draws them
in turn, so that cells can run at the same time.
"""

from __future__ import annotations

import base64
import math
import pathlib
import threading
from concurrent.futures import ThreadPoolExecutor
from typing import TYPE_CHECKING, Any

import anywidget
import traitlets

from ._zeroset import Error, Stop

if TYPE_CHECKING:
    from ._surface import Surface
    from ._zeroset import Picture

_HERE = pathlib.Path(__file__).parent
# Seconds that the picture may take that stands in for the widget.
STILL = 1.0


class Explorer(anywidget.AnyWidget):
    """A surface that is turned with the mouse, with its formula and sliders of its parameters.

    `Surface.explore` and `explore` make one. `surface`, `picture` and `camera` tell what it shows
    now: ``w.surface.render(2000, 1500, **w.camera)`` draws it large.
    """

    _esm = _HERE / "explorer.js"
    _css = _HERE / "explorer.css"

    text = traitlets.Unicode(help="The formula and further lines.").tag(sync=True)
    error = traitlets.Unicode(help="Why the text cannot be read; empty if it can.").tag(sync=True)
    values = traitlets.Dict(help="Parameters and their values.").tag(sync=True)
    width = traitlets.Int(help="Pixels in a row.").tag(sync=True)
    height = traitlets.Int(help="Rows of pixels.").tag(sync=True)
    axes = traitlets.Bool(help="Whether axes are drawn.").tag(sync=True)
    sliders: Any = traitlets.List(help="Name, range and kind of each slider.").tag(sync=True)
    revision = traitlets.Int(help="Number of texts that were read.").tag(sync=True)

    def __init__(
        self,
        surface: Surface,
        width: int = 512,
        height: int = 512,
        *,
        axes: bool = False,
        **options: Any,
    ) -> None:
        self._lock = threading.Lock()
        # The newest request of each view in a browser, and the flag that ends its picture.
        self._wanted: dict[str, tuple[dict[str, Any], Stop]] = {}
        self._options = options
        self._surface = surface
        self._typed = surface.parameters
        self._picture: Picture | None = None
        self._camera: dict[str, Any] = {}
        # Whether somebody turned, moved or zoomed the surface.
        self._is_moved = False
        self._painter = ThreadPoolExecutor(max_workers=1, thread_name_prefix="zeroset")
        super().__init__(
            text=surface.text,
            width=width,
            height=height,
            axes=axes,
            values=surface.parameters,
            sliders=_sliders(surface),
        )
        self.on_msg(self._receive)

    @property
    def surface(self) -> Surface:
        """What is shown: the last text without an error, with the values of the sliders."""
        return self._surface

    @property
    def picture(self) -> Picture | None:
        """The last picture at rest, if there is one."""
        return self._picture

    @property
    def camera(self) -> dict[str, Any]:
        """The present view and domain, as options of `Surface.render`."""
        return dict(self._camera)

    @traitlets.observe("text")
    def _read(self, change: Any) -> None:
        from ._surface import Surface

        if change.new == self._surface.text:
            self.error = ""
            return
        try:
            surface = Surface(change.new)
        except Error as error:
            self.error = str(error)
            return
        # A value that was moved stays, unless the text gives it a new one.
        typed, moved = surface.parameters, self._surface.parameters
        kept = {n: moved[n] for n, v in typed.items() if n in moved and self._typed.get(n) == v}
        surface.set(**kept)
        self._surface, self._typed = surface, typed
        self._fit()
        with self.hold_sync():
            self.values = surface.parameters
            self.sliders = _sliders(surface)
            self.error = ""
            self.revision += 1

    @traitlets.observe("values")
    def _set(self, change: Any) -> None:
        known = self._surface.parameters
        changed = {name: v for name, v in change.new.items() if known.get(name) != v}
        self._surface.set(**changed)
        if changed:
            self._fit()

    def _fit(self) -> None:
        """Forgets the domain of an earlier surface, and its view unless somebody chose it."""
        view = {key: value for key, value in self._camera.items() if key != "domain"}
        self._camera = view if self._is_moved else {}

    def _receive(self, _: Any, request: dict[str, Any], __: Any) -> None:
        """Takes a request for a picture."""
        stop = Stop()
        with self._lock:
            before = self._wanted.get(request["view"])
            self._wanted[request["view"]] = request, stop
        # A picture at rest is of no use once something moves. Pictures that move are drawn in turn.
        if before is not None and before[0]["final"]:
            before[1].set()
        self._painter.submit(self._draw, request, stop)

    def _draw(self, request: dict[str, Any], stop: Stop) -> None:
        """Draws a picture and sends it. One at rest is left out if a newer one is wanted."""

        def is_wanted() -> bool:
            with self._lock:
                return not request["final"] or self._wanted[request["view"]][1] is stop

        if not is_wanted():
            return
        answer = {key: request[key] for key in ("view", "number")}
        png: list[bytes] = []
        try:
            picture = self._render(request, stop)
            png.append(picture.png())
            answer |= {
                "camera": picture.camera,
                "domain": picture.domain,
                "counts": picture.counts,
                "size": [picture.width, picture.height],
            }
        except Exception as error:
            # Nobody else would see it.
            answer["error"] = str(error)
        if not is_wanted():
            return
        if png:
            self._camera = {**picture.camera, "domain": picture.domain}
            if request["final"]:
                self._picture = picture
                self._is_moved = request["camera"] is not None
        self.send(answer, png)

    def _render(self, request: dict[str, Any], stop: Stop) -> Picture:
        options: dict[str, Any] = {"axes": self.axes, **self._options}
        if not request["final"]:
            options["antialias"] = 1
        options |= request["camera"] or {}
        if request["domain"] is not None:
            options["domain"] = request["domain"]
        surface = self._surface
        known = surface.parameters
        surface.set(**{n: v for n, v in request["values"].items() if known.get(n, v) != v})
        size = int(request["width"]), int(request["height"])
        return surface._scene.render(*size, options, stop)

    def _repr_mimebundle_(self, **options: Any) -> Any:
        """The widget, and a picture for readers that show no widgets."""
        bundle = super()._repr_mimebundle_(**options)
        if bundle is not None:
            # The cell waits for this picture, and most readers never see it.
            options = {"budget": STILL, **self._options, **self._camera}
            still = self._surface.render(self.width, self.height, **options)
            bundle[0]["image/png"] = base64.b64encode(still.png()).decode()
        return bundle


def _sliders(surface: Surface) -> list[dict[str, Any]]:
    """Ranges of the sliders: those of the text. Otherwise the time gets [0, 2π], and other values
    get a range from 0 to twice the value, or [-1, 1] around 0.
    """
    rows, ranges = [], surface.ranges
    for name, value in surface.parameters.items():
        if name in ranges:
            low, high = ranges[name]
        elif name == "t":
            low, high = 0.0, 2 * math.pi
        elif value == 0:
            low, high = -1.0, 1.0
        else:
            low, high = sorted((0.0, 2 * value))
        row = {"name": name, "low": min(low, value), "high": max(high, value), "time": name == "t"}
        rows.append(row)
    return rows
