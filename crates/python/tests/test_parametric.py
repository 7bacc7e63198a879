"""Parametric surfaces: each way to give one means what the text means."""

import math
import pickle

import numpy as np
import pytest
import sympy as sp

import zeroset as zs

U, V = sp.symbols("u v")
TUBE = "(cos u, sin u, v) for u in [0, 2pi], v in [-1, 1]"


def ring(u, v, r):
    return (2 + r * np.cos(v)) * np.cos(u), (2 + r * np.cos(v)) * np.sin(u), r * np.sin(v)


def folded(u, v):
    w = max(u, -u) if v > 0 else v * u
    return u, v, w


def torn(s, t):
    return (s, t, s * t) if s > t else np.array([s, t + 1, t])


PAIRS = [
    (zs.Parametric(lambda u, v: (np.cos(u), np.sin(u), v), u=(0, math.tau), v=(-1, 1)), TUBE),
    (zs.Parametric("(cos u, sin u, v)", u=(0, "2pi"), v=(-1, 1)), TUBE),
    (zs.Parametric(["cos u", sp.sin(U), V], u=(0, 2 * sp.pi), v=zs.Interval(-1, 1)), TUBE),
    (zs.Parametric(sp.Matrix([sp.cos(U), sp.sin(U), V]), u=(0, 2 * np.pi), v=[-1, 1]), TUBE),
    (zs.Parametric(TUBE), TUBE),
    (
        zs.Parametric(lambda x, e: (x * e, x, e**2), x=(-2, 2), e=(-2, np.float64(2))),
        "(u v, u, v^2) for u in [-2, 2], v in [-2, 2]",
    ),
    (
        zs.Parametric(ring, u=(0, 2 * np.pi), v=(-np.pi, np.pi), r=0.5),
        "r = 0.5; ((2 + r cos v) cos u, (2 + r cos v) sin u, r sin v) for u in [0, 2pi],"
        " v in [-pi, pi]",
    ),
    (
        zs.Parametric("(u, v, u v - 1)", u=(0, "b"), v=(sp.Rational(1, 3), 1), b=2),
        "(u, v, u v - 1) for u in [0, 2], v in [1/3, 1]",
    ),
    (
        zs.Parametric(folded, u=(-1, 1), v=(-1, 1)),
        "(u, v, if(v > 0, max(u, -u), u v)) for u in [-1, 1], v in [-1, 1]",
    ),
    (
        zs.Parametric(torn, s=(0, 1), t=(0, 1)),
        "(s, if(s > t, t, t + 1), if(s > t, s t, t)) for s in [0, 1], t in [0, 1]",
    ),
]


@pytest.mark.parametrize("number", range(len(PAIRS)))
def test_surfaces_are_those_of_texts(number):
    surface, text = PAIRS[number]
    views = [{"eye": [3, -5, 4], "target": [0, 0, 0]}, {"eye": [4, 6, 1.5], "target": [0.1, 0, 0]}]
    for view in views:
        found, expected = (
            one.render(64, 48, domain=3, fov=45, **view) for one in (surface, zs.Surface(text))
        )
        assert expected.counts["hit"] > 20
        np.testing.assert_array_equal(found.status, expected.status)
        np.testing.assert_array_equal(found.brackets, expected.brackets)
        np.testing.assert_array_equal(found.rgb, expected.rgb)
    assert (surface.render(64, 48).rgb == zs.Surface(text).render(64, 48).rgb).all()


def test_points_are_those_of_the_function():
    surface = zs.Parametric(ring, u=(0, np.pi), v=(0, 2 * np.pi), r=0.75)
    points = surface.render(96, 96, eye=[3, 5, 6]).points
    x, y, z = points[np.isfinite(points[..., 0])].T
    assert len(x) > 1000
    assert y.min() >= -1e-3
    u, v = np.arctan2(y, x), np.arctan2(z, np.hypot(x, y) - 2)
    np.testing.assert_allclose(ring(u, v, 0.75), [x, y, z], atol=2e-2)


def test_values_change_the_surface():
    surface = zs.Parametric(ring, u=(0, math.tau), v=(0, math.tau), r=0.5)
    assert surface.parameters == {"r": 0.5}
    surface.set(r=1)
    other = zs.Parametric(ring, u=(0, math.tau), v=(0, math.tau), r=1)
    assert (surface.render(48, 48).rgb == other.render(48, 48).rgb).all()
    again = pickle.loads(pickle.dumps(surface))
    assert isinstance(again, zs.Parametric) and again.parameters == {"r": 1.0}
    assert (again.render(48, 48).rgb == other.render(48, 48).rgb).all()
    assert repr(again).startswith("<Parametric (")


def test_several_surfaces_of_functions_do_not_mix():
    # Both have parts that are used again.
    one = zs.Parametric(lambda u, v: (u + v, np.sin(u + v), v), u=(0, 1), v=(0, 1))
    other = zs.Parametric(lambda u, v: (u * v, np.cos(u * v), v), u=(0, 1), v=(0, 1))
    sphere = "(x-2)^2 + y^2 + z^2 = 1"
    expected = zs.Surface(
        "(u + v, sin(u + v), v) for u in [0, 1], v in [0, 1]\n"
        f"(u v, cos(u v), v) for u in [0, 1], v in [0, 1]\n{sphere}"
    ).render(64, 64)
    found = zs.plot(one, other, sphere, width=64, height=64)
    assert (found.rgb == expected.rgb).all() and (found.surface == expected.surface).all()
    assert set(np.unique(found.surface)) == {-1, 0, 1, 2}


def test_ends_at_multiples_of_pi_are_exact():
    def text(**ranges):
        return zs.Parametric("(u, v, u v)", **ranges).text.split(" for ")[1]

    assert text(u=(-np.pi, math.tau), v=(math.pi / 12, 3 * math.pi / 2)) == (
        "u in [-pi, 2*pi], v in [pi/12, 3*pi/2]"
    )
    assert text(u=(0, 6.283), v=(-1 / 3, sp.sqrt(2))) == (
        "u in [0, 6.283], v in [-0.3333333333333333, sqrt((2))]"
    )
    # No ray passes between the ends.
    tube = zs.Parametric(lambda u, v: (np.cos(u), np.sin(u), v), u=(0, math.tau), v=(-1, 1))
    picture = tube.render(65, 65, eye=[5, 0, 0.01], target=[1, 0, 0], fov=1)
    assert picture.counts["miss"] == 0


WRONG = [
    ((lambda u, v: (u, v),), {}, "three coordinates x, y and z, and not 2"),
    ((lambda u, v: u,), {}, "three coordinates x, y and z, and not 1"),
    (((U, V, U, V),), {}, "three coordinates x, y and z, and not 4"),
    ((lambda u, v: (u, v, "u"),), {}, "a str has no meaning in a formula"),
    ((lambda u, v: (u, v, v),), {"v": None}, "v=None is no range: give v=(low, high)"),
    ((lambda u, v: (u, v, v),), {"v": (0, 1, 2)}, "v=(0, 1, 2) is no range: give v=(low, high)"),
    ((lambda u, v: (u, v, v),), {"v": 2.0}, "ranges of two parameters: give v=(low, high), too"),
    ((lambda u, v: (u, v, v),), {"v": (1, 0)}, "the range of v ends where it begins, or before"),
    ((lambda u, v: (u, v, v),), {"v": (0, math.inf)}, "an end inf, which is no finite number"),
    ((lambda u, v: (u, v, v),), {"w": (0, 1)}, "w is no parameter of the surface: it has u and v"),
    ((lambda u, v: (u, v, v),), {"r": 2.0}, "r is no parameter of the surface: it has u and v"),
    ((lambda u: (u, u, u),), {}, "has two arguments, such as u and v"),
    ((lambda u, v, r: (u, v, r),), {}, "needs a value for r"),
    (((U, V, sp.Symbol("q")),), {}, "`q` is not defined"),
    (((U, V, V),), {"w": (0, 1)}, "a surface has two parameters, and these are u, v and w"),
    (("(u, v, u)",), {"v": ("1 + 1", "1")}, "must be"),
    (("(u, v)",), {}, "a point of space has three coordinates"),
    ((TUBE,), {}, "the text has ranges: leave out u and v"),
    ((5,), {}, "three coordinates"),
]


@pytest.mark.parametrize("number", range(len(WRONG)))
def test_wrong_surfaces_are_refused_for_their_reason(number):
    formulas, changed, why = WRONG[number]
    with pytest.raises(zs.Error) as error:
        zs.Parametric(*formulas, **{"u": (0, 1), "v": (0, 1), **changed})
    assert why in str(error.value)


def test_what_is_no_parametric_surface_is_refused():
    for text in ["x^2 + y^2 = 1", "(cos t, sin t, t) for t in [0, 9]; z = 1"]:
        with pytest.raises(zs.Error, match="the text has no parametric surface"):
            zs.Parametric(text)
    with pytest.raises(zs.Error, match=r"give u=\(low, high\) and v=\(low, high\), too"):
        zs.Parametric(lambda u, v: (u, v, v))


def test_a_mesh_is_closed_along_its_seams():
    mesh = zs.Parametric(ring, u=(0, math.tau), v=(0, math.tau), r=0.5).mesh(0.05)
    assert mesh.proven
    assert len(mesh.vertices) - len(mesh.faces) * 3 // 2 + len(mesh.faces) == 0


def test_measures_and_values_are_refused():
    tube = zs.Parametric(TUBE)
    why = "parametric surfaces are drawn and meshed, but measures leave them out"
    with pytest.raises(zs.Error, match=why):
        tube.measure()
    for work in (
        lambda: tube(0, 0, 0),
        lambda: tube.gradient(0, 0, 0),
        lambda: tube.enclose([0, 0, 0], [1, 1, 1]),
        lambda: tube.trace([0, 0, 5], [0, 0, -1]),
        lambda: tube.domain,
    ):
        with pytest.raises(zs.Error, match="this is a parametric surface and not a function"):
            work()


def test_a_widget_shows_one():
    pytest.importorskip("anywidget")
    surface = zs.Parametric(ring, u=(0, math.tau), v=(0, math.tau), r=0.5)
    widget = surface.explore(64, 48)
    assert widget.sliders == [{"name": "r", "low": 0.0, "high": 1.0, "time": False}]
    widget.values = {"r": 0.75}
    assert widget.surface.parameters == {"r": 0.75}
    widget.text = surface.text.replace("sin(v)", "sin(2*v)")
    assert widget.error == ""
    assert widget.surface.render(32, 32).counts["hit"] > 100
    widget.text = "(u, v, w) for u in [0, 1], v in [0, 1]"
    assert "`w` is not defined" in widget.error
    bundle = zs.explore(TUBE, 64, 48)._repr_mimebundle_()
    assert bundle[0]["image/png"]
    assert surface._repr_png_().startswith(b"\x89PNG")
