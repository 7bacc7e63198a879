"""Values, gradients, bounds, rays and parameters."""

import math

import mpmath
import numpy as np
import pytest
from conftest import cases

import zeroset as zs


def test_values_are_broadcast():
    s = zs.Surface("x^2 + y*z = 1")
    x = np.linspace(-1, 1, 5)
    values = s(x[:, None], 2.0, np.arange(3))
    assert values.shape == (5, 3)
    assert values.dtype == np.float64
    np.testing.assert_array_equal(values, x[:, None] ** 2 + 2.0 * np.arange(3) - 1)


def test_points_may_be_one_array():
    s = zs.Surface("x + 10*y + 100*z = 0")
    points = np.arange(24.0).reshape(2, 4, 3)
    np.testing.assert_array_equal(s(points), points @ [1, 10, 100])
    assert s.gradient(points).shape == (2, 4, 3)
    np.testing.assert_array_equal(s.gradient(points)[1, 2], [1, 10, 100])


@pytest.mark.parametrize("kind", [np.float32, np.int64, list, "strided", "empty"])
def test_arrays_of_other_kinds(kind):
    points = np.arange(12.0).reshape(4, 3)
    if kind is list:
        given = points.tolist()
    elif kind == "strided":
        given = np.repeat(points, 2, axis=0)[::2]
    elif kind == "empty":
        given = points = np.empty((0, 3))
    else:
        given = points.astype(kind)
    np.testing.assert_array_equal(
        zs.Surface("x*y - z = 0")(given), points[:, 0] * points[:, 1] - points[:, 2]
    )


def test_values_are_nan_where_undefined():
    s = zs.Surface("sqrt(x) + ln(y) = z")
    assert np.isnan(s([-1, 1, np.nan], [1, -1, 1], 0)).all()


@pytest.mark.parametrize("points", [np.zeros(2), np.zeros((4, 2)), 3.0, np.zeros((3, 4))])
def test_points_of_other_shapes_are_refused(points):
    with pytest.raises(zs.Error, match="shape"):
        zs.Surface("x = y")(points)


def test_two_coordinates_are_refused():
    with pytest.raises(zs.Error, match="x, y and z"):
        zs.Surface("x = y")(1.0, 2.0)


def test_several_formulas_have_no_function_but_a_picture():
    s = zs.Surface("x = 0\ny = 0")
    assert s.surfaces == ["x = 0", "y = 0"]
    with pytest.raises(zs.Error):
        s(0, 0, 0)
    assert s.render(32, 32).counts["hit"] > 100


@pytest.mark.parametrize(
    ("formula", "exact"),
    [
        ("x^2*y - sin(z) = 0", lambda x, y, z: x**2 * y - mpmath.sin(z)),
        ("exp(x)/(2 + cos(y)) = z", lambda x, y, z: mpmath.exp(x) / (2 + mpmath.cos(y)) - z),
        (
            "sqrt(x^2 + y^2) - atan2(z, 3) = 0",
            lambda x, y, z: mpmath.hypot(x, y) - mpmath.atan2(z, 3),
        ),
        ("x^5 - 3*x*y^3 + z = 0.1", lambda x, y, z: x**5 - 3 * x * y**3 + z - mpmath.mpf(1) / 10),
        ("ln(4 + x*y) + tanh(z) = 0", lambda x, y, z: mpmath.log(4 + x * y) + mpmath.tanh(z)),
        ("besselj(0, x) + erf(y*z) = 0", lambda x, y, z: mpmath.besselj(0, x) + mpmath.erf(y * z)),
        ("abs(x) + max(y, z)^3 = 1", lambda x, y, z: abs(x) + max(y, z) ** 3 - 1),
        (
            "cosh(x)*asinh(y) - cbrt(5 + z) = 0",
            lambda x, y, z: mpmath.cosh(x) * mpmath.asinh(y) - mpmath.cbrt(5 + z),
        ),
    ],
)
def test_bounds_hold_exact_values(formula, exact, random):
    s = zs.Surface(formula)
    lo = random.uniform(-1.5, 1.4, (cases(500), 3))
    hi = lo + random.uniform(0, 0.1, lo.shape) * random.integers(0, 2, (len(lo), 1))
    found = s.enclose(lo, hi)
    assert found.continuous.all() and found.defined.all() and not found.undefined.any()
    inside = lo + (hi - lo) * random.uniform(0, 1, lo.shape)
    inside = np.minimum(np.maximum(inside, lo), hi)
    with mpmath.workprec(120):
        for point, low, high in zip(inside, found.lo, found.hi):
            value = exact(*map(mpmath.mpf, point.tolist()))
            assert low <= value <= high, (formula, point)


def test_facts_of_bounds():
    s = zs.Surface("1/x + sqrt(y) = z")
    found = s.enclose([[-1, 1, 0], [1, -2, 0], [1, 1, 0]], [[1, 2, 1], [2, -1, 1], [2, 2, 1]])
    np.testing.assert_array_equal(found.undefined, [False, True, False])
    np.testing.assert_array_equal(found.defined, [False, False, True])
    np.testing.assert_array_equal(found.continuous, [False, False, True])
    assert not found.may_vanish[1]


@pytest.mark.parametrize(("lo", "hi"), [([0, 0, 1], [1, 1, 0]), ([0, 0, np.nan], [1, 1, 1])])
def test_boxes_that_hold_nothing_are_refused(lo, hi):
    with pytest.raises(zs.Error, match="z range of box 0"):
        zs.Surface("x = y").enclose(lo, hi)


def test_rays_against_the_sphere(random):
    s = zs.Surface("x^2 + y^2 + z^2 = 1")
    origins = random.normal(size=(cases(20_000), 3))
    origins *= 3 / np.linalg.norm(origins, axis=1, keepdims=True)
    directions = -origins + random.uniform(-2, 2, origins.shape)
    found = s.trace(origins, directions)
    # |o + t d|² = 1
    a = (directions**2).sum(1)
    b = (origins * directions).sum(1)
    root = b * b - a * 8.0
    clear = np.abs(root) > 1e-9
    np.testing.assert_array_equal(found.status[clear & (root > 0)], zs.HIT)
    np.testing.assert_array_equal(found.status[clear & (root < 0)], zs.MISS)
    hit = clear & (root > 0)
    t = (-b[hit] - np.sqrt(root[hit])) / a[hit]
    near, far = found.bracket[hit].T
    slack = 1e-12
    assert (near <= t + slack).all() and (t - slack <= far).all()
    assert np.abs(found.t[hit] - t).max() < 1e-5
    assert np.isinf(found.t[found.status == zs.MISS]).all()


@pytest.mark.parametrize("name", ["sphere", "steiner-roman", "klein-bottle", "tangle", "gyroid"])
def test_rays_of_pixels_have_the_claims_of_the_picture(name):
    s = zs.example(name)
    side = math.isqrt(cases(4000))
    picture = s.render(side, side, antialias=1)
    origins, directions = picture.rays
    found = s.trace(origins, directions, domain=picture.domain)
    # Another grouping may leave another pixel undecided, but claims never contradict each other.
    both = (found.status != zs.UNDECIDED) & (picture.status != zs.UNDECIDED)
    assert np.array_equal(found.status[both], picture.status[both])
    assert np.count_nonzero(both) > 0.99 * side * side
    hits = both & (found.status == zs.HIT)
    lo, hi = np.moveaxis(picture.brackets, -1, 0)[:, hits]
    near, far = np.moveaxis(found.bracket, -1, 0)[:, hits]
    # Directions of length 1 are rounded, so distances differ by a few units in the last place.
    slack = 1e-12 * hi
    assert np.all(near <= hi + slack) and np.all(lo <= far + slack)


def test_one_origin_for_many_rays():
    s = zs.Surface("z = 0")
    directions = np.array([[[1, 0, -1], [0, 1, 1.0]]])
    found = s.trace([0, 0, 1], directions, domain=4)
    assert found.status.tolist() == [[1, 0]]
    assert found.bracket.shape == (1, 2, 2)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"method": "magic"}, "magic"),
        ({"precision": "f16"}, "known are"),
        ({"domain": "here"}, "a domain is"),
        ({"domain": [[1, 0], [0, 1], [0, 1]]}, "1"),
    ],
)
def test_options_of_rays_are_checked(options, message):
    with pytest.raises(zs.Error, match=message):
        zs.Surface("x = y").trace([0, 0, 1], [1, 0, 0], **options)


def test_rays_without_direction_are_refused():
    with pytest.raises(zs.Error, match="ray 1"):
        zs.Surface("x = y").trace([[0, 0, 1], [0, 0, 2]], [[1, 0, 0], [0, 0, 0]])


def test_parameters():
    s = zs.Surface("x^2 + y^2 = r^2 + a*z\nr = 2 in [1, 3]", a=0.5)
    assert s.parameters == {"r": 2.0, "a": 0.5}
    assert s.ranges == {"r": zs.Interval(1.0, 3.0)}
    assert s(0, 0, 2) == -5
    s.set(r=3, a=1)
    assert s(0, 0, 2) == -11
    assert s.parameters == {"r": 3.0, "a": 1.0}
    assert zs.Surface("x = r\nr = 2 in [1, 3]", r=2.5).parameters == {"r": 2.5}


def test_unknown_parameters_are_named():
    s = zs.Surface("x = a", a=1)
    with pytest.raises(zs.Error, match="`b` is not a parameter of the text: `a`"):
        s.set(b=2)
    with pytest.raises(zs.Error, match="not a number"):
        s.set(a=float("nan"))


def test_set_compiles_nothing_and_changes_all():
    s = zs.Surface("x^2 + y^2 + z^2 = r^2", r=1)
    seen = {"domain": 3, "eye": [0, 0, 9], "target": [0, 0, 0]}
    before = s.render(32, 32, **seen).counts["hit"]
    s.set(r=2)
    assert s.render(32, 32, **seen).counts["hit"] > 3 * before
    assert s.enclose([0, 0, 0], [0, 0, 0]).lo == -4
    assert s.trace([0, 0, 5], [0, 0, -1], domain=3).t == pytest.approx(3)


@pytest.mark.parametrize("text", ["", "x^2 + foo(y)", "x^2 +", "((((", "\0", "é=ü", "1 = 1" * 9000])
def test_texts_without_sense_are_errors(text):
    with pytest.raises(zs.Error):
        zs.Surface(text).render(8, 8)


def test_the_message_shows_the_place():
    with pytest.raises(zs.Error) as caught:
        zs.Surface("x^2 + foo(y)")
    assert "foo(y)\n  |       ^^^ no function" in str(caught.value)
    assert isinstance(caught.value, ValueError)


@pytest.mark.parametrize("formula", [3, None, b"x", ["x"], object()])
def test_formulas_of_other_kinds_are_refused(formula):
    with pytest.raises(zs.Error, match="a formula is"):
        zs.Surface(formula)


def test_the_gallery_is_there():
    assert len(zs.examples()) >= 10
    name = next(iter(zs.examples()))
    assert zs.example(name).render(16, 16).width == 16
    with pytest.raises(zs.Error, match="no surface 'nothing'"):
        zs.example("nothing")


def test_names_of_choices():
    assert "affine" in zs.methods()
    assert "studio" in zs.looks()
    assert "iso" in zs.views()


def test_notes_tell_how_a_text_was_read():
    assert any("time" in note or "read" in note for note in zs.Surface("T_4(x) = y").notes)


def test_domains():
    x, y, z = zs.Surface("x^2 + y^2/4 + z^2/9 = 1").domain
    assert x.hi < y.hi < z.hi
    assert zs.Surface("x = y\ndomain 5").domain == ((-5, 5),) * 3
    assert 0 in x and x.width > 2 and abs(x.middle) < 0.1
