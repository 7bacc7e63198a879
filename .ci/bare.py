"""Run with NumPy alone beside the package: what needs more says what to install."""

import importlib.util

import numpy as np

import zeroset as zs

EXTRAS = ["PIL", "sympy", "anywidget", "trimesh", "pyvista", "matplotlib"]
present = [name for name in EXTRAS if importlib.util.find_spec(name)]
assert not present, f"not alone: {present}"

s = zs.Surface("x^2 + y^2 + z^2 = 1")
assert s.render(16, 16).png().startswith(b"\x89PNG")
assert zs.Surface(lambda x, y, z: np.sin(x) - z)(0, 0, 1) == -1
USES = {
    "pillow": lambda: s.render(8, 8).image,
    "anywidget": s.explore,
    "trimesh": lambda: s.mesh(0.3).to_trimesh(),
    "pyvista": lambda: s.mesh(0.3).to_pyvista(),
}
for package, use in USES.items():
    try:
        use()
    except ImportError as error:
        assert str(error).endswith(f"pip install {package}"), error
    else:
        raise AssertionError(f"{package} is not there, and nothing said so")
print(f"{len(USES)} messages name what lacks")
