"""Pictures and meshes: equal to those of the program, and right by other libraries."""

import inspect
import json
import pickle
import subprocess
import sys
import threading
import time

import numpy as np
import pytest
import trimesh
from conftest import cases
from PIL import Image

import zeroset as zs

DOCUMENTS = [
    "x^2+y^2+z^2 = 1",
    "z = x*y {x^2+y^2 < 4}",
    "(x^2+y^2+z^2+3)^2 = 16*(x^2+y^2)",
    "x^2+y^2+z^2 <= 1",
    "max(abs(x), abs(y), abs(z)) <= 0.8",
    "sin(x)*cos(y)+sin(y)*cos(z)+sin(z)*cos(x) = 0\ndomain 4",
    "z = 1/x",
    "z = sin(4*hypot(x, y))\ndomain 3",
    "x^2+y^2 = z^2\ncolor tomato",
    "z = J_0(3*hypot(x, y))",
    "a = 2\nx^2+y^2 = 1 + a*z^2",
    "x^2+y^2+z^2 = 2\nz = 0 {x > 0}\nlook paper",
    "abs((x+i*y)^3-1) = z^2+1",
    "y = x^3 - z^2\nview front",
    "x^4+y^4+z^4 = 1\naxes on",
    "(x^2+y^2-1)^2+z^2 = 0.05\ncolor viridis(z)",
    "z = mod(x, 1)",
    "exp(-x^2-y^2) = z\nbackground black",
    "sphere((0, 0, 0), 1)",
    "x*y*z = 0.1\nt = 0.5",
]


@pytest.mark.parametrize("number", range(len(DOCUMENTS)))
def test_pictures_are_those_of_the_program(number, program, tmp_path):
    text = DOCUMENTS[number]
    (tmp_path / "a.zset").write_text(text + "\n")
    command = [program, "render", "a.zset", "--size", "96x72", "-o", "a.png", "--json"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=True)
    picture = zs.Surface(text).render(96, 72)
    picture.save(tmp_path / "b.png")
    assert (tmp_path / "b.png").read_bytes() == picture.png()
    # The program's file has the command besides.
    found = [np.asarray(Image.open(tmp_path / name)) for name in ("a.png", "b.png")]
    np.testing.assert_array_equal(*found)
    np.testing.assert_array_equal(found[0], picture.rgb)
    pixels = json.loads(done.stdout)["pixels"]
    assert picture.counts == {key: pixels[key] for key in ("hit", "miss", "undecided")}


def test_arrays_of_a_picture():
    s = zs.Surface("x^2+y^2+z^2 = 1")
    picture = s.render(40, 30, eye=[5, 0, 0], target=[0, 0, 0])
    assert picture.rgb.shape == (30, 40, 3) and picture.rgb.dtype == np.uint8
    assert picture.status.shape == picture.depth.shape == picture.surface.shape == (30, 40)
    assert picture.brackets.shape == (30, 40, 2) and picture.normals.shape == (30, 40, 3)
    hit = picture.status == zs.HIT
    assert hit.sum() == picture.counts["hit"] > 100
    assert picture.undecided == {}
    points = picture.points[hit]
    assert np.abs(np.linalg.norm(points, axis=1) - 1).max() < 0.02
    assert np.abs(points - picture.normals[hit]).max() < 0.05
    assert np.isnan(picture.points[~hit]).all() and np.isinf(picture.depth[~hit]).all()
    near, far = picture.brackets[hit].T
    assert (near <= far).all()
    assert (picture.surface[hit] == 0).all() and (picture.surface[~hit] == -1).all()


def test_images_of_pillow():
    picture = zs.Surface("x = y").render(20, 10)
    assert picture.image.size == (20, 10)
    np.testing.assert_array_equal(np.asarray(picture.image), picture.rgb)
    assert zs.Surface("x = y")._repr_png_().startswith(b"\x89PNG")


@pytest.mark.parametrize(
    "options",
    [
        {"domain": 2.0, "view": "top", "look": "paper"},
        {
            "domain": [[-1, 1], [-2, 2], [0, 1]],
            "eye": [3, 4, 5],
            "target": [0, 0, 0],
            "up": [0, 1, 0],
        },
        {"orthographic": 3.0, "shadows": True, "occlusion": False, "antialias": 4},
        {"fov": 20.0, "background": (255, 0, 0), "light": [1, 2, 9], "ambient": 0.5},
        {"undecided": "hatch", "axes": True, "legend": True, "method": "knoll", "max_depth": 8},
        {"precision": "f64", "tolerance": 0.1, "domain": "auto"},
        {"method": "march", "steps": 64, "budget": 60.0},
        {"haze": 0.5, "ground": True, "outlines": False, "legend": None},
    ],
)
def test_options_of_pictures(options):
    picture = zs.Surface("x^2+y^2+z^2 = 1").render(24, 24, **options)
    assert (picture.surface == 0).sum() > 5
    assert picture.method == options.get("method", "affine")


def test_light_is_what_the_bytes_encode():
    surface = zs.Surface("x^2+y^2+z^2 = 1")
    plain = surface.render(32, 32, antialias=1)
    fine = surface.render(32, 32, antialias=1, bits=16)
    assert plain.light is None
    assert fine.light.shape == (32, 32, 4) and fine.light.dtype == np.float32
    assert (fine.light[..., 3] == 1).all()
    light = fine.light[..., :3].astype(float)
    encoded = np.where(light <= 0.0031308, 12.92 * light, 1.055 * light ** (1 / 2.4) - 0.055)
    assert np.abs(255 * encoded - plain.rgb).max() < 0.51
    assert fine.png()[24] == 16 and plain.png()[24] == 8


@pytest.mark.parametrize(
    ("options", "error"),
    [
        ({"width": 0}, zs.Error),
        ({"width": -1}, OverflowError),
        ({"width": 10**9, "height": 10**9}, zs.Error),
        ({"look": "shiny"}, zs.Error),
        ({"view": "inside"}, zs.Error),
        ({"undecided": "gone"}, zs.Error),
        ({"budget": -1.0}, zs.Error),
        ({"antialias": 3}, zs.Error),
        ({"bits": 12}, zs.Error),
        ({"haze": 1.5}, zs.Error),
        ({"ground": 0.5}, zs.Error),
        ({"ground": "maybe"}, TypeError),
        ({"eye": [1, 2]}, ValueError),
        ({"fov": "wide"}, TypeError),
        ({"background": (300, 0, 0)}, OverflowError),
        ({"colour": "red"}, TypeError),
        ({"domain": 1e300}, zs.Error),
        ({"domain": float("nan")}, zs.Error),
    ],
)
def test_options_out_of_range(options, error):
    with pytest.raises(error):
        zs.Surface("x = y").render(**{"width": 8, "height": 8, **options})


def test_choices_have_the_values_that_they_name():
    surface = zs.Surface("x = y")
    assert len(zs.choices()) >= 7
    assert {"haze", "title"} <= set(inspect.signature(surface.render).parameters)
    for name, help in zs.choices().items():
        values = (0.0, 1.0) if "share from 0 to 1" in help else (False, True)
        for value in values:
            surface.render(8, 8, **{name: value})
        with pytest.raises(zs.Error, match=f"{name} must be "):
            surface.render(8, 8, **{name: 1.5})


def test_names_of_files(tmp_path):
    picture = zs.Surface("x = y").render(8, 8)
    with pytest.raises(zs.Error, match="png"):
        picture.save(tmp_path / "a.jpg")
    with pytest.raises(OSError):
        picture.save(tmp_path / "none" / "a.png")
    assert list(tmp_path.iterdir()) == []


def test_several_surfaces_in_one_picture():
    picture = zs.plot("x^2+y^2+z^2 = 1", lambda x, y, z: z - x * y, width=32, height=32, domain=2)
    assert set(np.unique(picture.surface)) == {-1, 0, 1}
    with pytest.raises(zs.Error, match="needs a formula"):
        zs.plot()


def test_meshes_by_trimesh(tmp_path):
    mesh = zs.Surface("(hypot(x, y) - 1)^2 + z^2 <= 0.1").mesh(0.01)
    assert mesh.proven and mesh.tolerance == 0.01
    body = mesh.to_trimesh()
    assert isinstance(body, trimesh.Trimesh) and len(body.vertices) == len(mesh.vertices)
    assert body.is_watertight and body.euler_number == 0
    assert body.volume == pytest.approx(2 * np.pi**2 * 0.1, rel=0.01)
    for name in ["a.stl", "a.obj", "a.ply", "a.3mf", "a.glb"]:
        mesh.save(tmp_path / name)
        assert (tmp_path / name).stat().st_size > 1000
    with pytest.raises(zs.Error):
        mesh.save(tmp_path / "a.xyz")


def test_meshes_of_several_surfaces():
    mesh = zs.Surface("x^2+y^2+z^2 = 1\n(x-3)^2+y^2+z^2 = 1").mesh(0.1)
    first, second = mesh.surfaces
    assert first.closed and second.proven and first.name == "x^2 + y^2 + z^2 = 1"
    assert len(mesh.vertices) == len(first.vertices) + len(second.vertices)
    assert mesh.faces.max() == len(mesh.vertices) - 1
    assert first.unproven.shape == (0, 3, 2)


def test_measures():
    one = zs.Surface("x^2/4 + y^2 + z^2 <= 1").measure(relative=1e-3)[0]
    assert 8 * np.pi / 3 in one.volume and one.volume.width < 0.01
    assert all(0 in axis for axis in one.centroid)
    assert one.genus == (0,) and one.proven
    assert 2 in one.corners[1][0]
    assert zs.Surface("x^2+y^2+z^2 = 1").measure()[0].volume is None
    with pytest.raises(zs.Error, match="domain"):
        zs.Surface("x <= y").measure()
    only = zs.Surface("x^2 + y^2 + z^2 <= 1").measure(only=["volume", "centroid"])[0]
    assert 4 * np.pi / 3 in only.volume and 0 in only.centroid[0]
    assert [only.moments, only.corners, only.area, only.genus, only.proven] == [None] * 5
    ball = zs.Surface("x^2 + y^2 + z^2 <= 1")
    with pytest.raises(zs.Error, match="'weight' is not a measure: volume, mass, centroid"):
        ball.measure(only="weight")
    with pytest.raises(zs.Error, match="a mass needs a density"):
        ball.measure(only="mass")
    area = ball.measure(only="area", relative=0.01)[0]
    assert 4 * np.pi in area.area_bounds and area.area_bounds.width < 0.13


def test_densities():
    ball = zs.Surface("x^2 + y^2 + z^2 <= r^2", r=1.0)
    one = ball.measure(density="1 + x/r", relative=0.01)[0]
    assert 4 * np.pi / 3 in one.mass and 0.2 in one.centroid[0] and 0 in one.centroid[1]
    # The density takes the value that a parameter has now.
    ball.set(r=2.0)
    one = ball.measure(only=["mass", "centroid"], density="1 + x/r", relative=0.01)[0]
    assert 32 * np.pi / 3 in one.mass and 0.4 in one.centroid[0] and one.volume is None
    assert ball.measure(only="volume")[0].mass is None
    with pytest.raises(zs.Error, match="not proven to be bounded in the solid near"):
        ball.measure(density="1/x")
    with pytest.raises(zs.Error, match="`q` is not defined"):
        ball.measure(density="q")


def test_a_budget_ends_the_work():
    s = zs.Surface("sum(k = 1..10, tan(k*1e6*x + k*y)) = z")
    assert s.render(400, 400, domain=1, budget=0.2).undecided["effort or time ran out"] > 0
    with pytest.raises(zs.Error, match="within"):
        zs.Surface("x^2+y^2+z^2 <= 1").mesh(1e-6, budget=0.05)


def test_an_interrupt_ends_the_work():
    import _thread

    s = zs.Surface("sum(k = 1..10, tan(k*1e6*x + k*y)) = z")
    timer = threading.Timer(0.5, _thread.interrupt_main)
    timer.start()
    begun = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        s.render(2000, 2000, domain=1)
    assert time.monotonic() - begun < 60
    # The same surface goes on as before.
    assert s.render(8, 8, domain=1, budget=0.5).width == 8


def test_a_slow_picture_tells_how_much_of_it_is_done():
    s = zs.Surface("sum(k = 1..10, tan(k*1e6*x + k*y)) = z")
    told = []
    s.render(200, 200, domain=1, budget=3, progress=lambda *now: told.append(now))
    percents = [percent for stage, percent in told if stage == "tracing"]
    assert percents == sorted(set(percents)) and 0 < max(percents) <= 100, told
    assert {stage for stage, _ in told} <= {"tracing", "smoothing"}

    def refuse(stage, percent):
        raise ValueError(f"{stage} {percent}")

    with pytest.raises(ValueError, match="tracing"):
        s.render(2000, 2000, domain=1, progress=refuse)


def test_a_surface_is_sent_to_other_processes():
    s = zs.Surface("x^2 + y^2 + z^2 = r^2", r=1)
    s.set(r=1.5)
    again = pickle.loads(pickle.dumps(s))
    assert again.parameters == {"r": 1.5}
    assert again.render(32, 32).png() == s.render(32, 32).png()


def test_threads_give_equal_results():
    texts = DOCUMENTS[:8]
    alone = [zs.Surface(text).render(64, 64).png() for text in texts]
    found = [None] * len(texts)

    def work(number):
        for _ in range(3):
            found[number] = zs.Surface(texts[number]).render(64, 64).png()

    threads = [threading.Thread(target=work, args=(n,)) for n in range(len(texts))]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert found == alone


def test_one_surface_in_many_threads():
    s = zs.Surface("x^2 + y^2 + z^2 = r^2", r=1)
    wrong = []

    def work(number):
        for step in range(200):
            s.set(r=1 + number + step % 7 / 10)
            if not -200 < s(0, 0, 0) < 0 or s.render(8, 8).width != 8:
                wrong.append(number)

    threads = [threading.Thread(target=work, args=(n,)) for n in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not wrong


@pytest.mark.parametrize(
    ("module", "use"),
    [
        ("PIL.Image", lambda s: s.render(8, 8).image),
        ("trimesh", lambda s: s.mesh(0.3).to_trimesh()),
        ("pyvista", lambda s: s.mesh(0.3).to_pyvista()),
        ("anywidget", lambda s: s.explore()),
    ],
)
def test_packages_that_lack_are_named(module, use, monkeypatch):
    monkeypatch.setitem(sys.modules, module, None)
    # This one is imported once only.
    monkeypatch.delitem(sys.modules, "zeroset._explorer", raising=False)
    with pytest.raises(ImportError, match="pip install"):
        use(zs.Surface("x^2 + y^2 + z^2 = 1"))


def memory():
    with open("/proc/self/statm") as file:
        return int(file.read().split()[1]) * 4096


@pytest.mark.skipif(not __import__("pathlib").Path("/proc/self/statm").exists(), reason="no /proc")
def test_memory_stays_flat():
    s = zs.Surface("x^2 + y^2 = a*z\na = 1 in [0, 9]")

    def work(rounds):
        for step in range(rounds):
            s.set(a=step % 9)
            s(0.5, 0.5, 0.5)
            if step % 10 == 0:
                s.render(16, 16)

    work(2000)
    before = memory()
    work(cases(10_000))
    assert memory() - before < 20e6
