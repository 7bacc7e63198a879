"""Adds values to random programs: of Mesa for GLSL, of Python, and of OpenSCAD.

It reads the programs that `programs write` prints, and prints them with a value at each point. A
value is left out, as `?`, if nearby points have other values: then rounding decides it.

GLSL needs the package moderngl and a software OpenGL; OpenSCAD needs the program openscad.
"""

import contextlib
import math
import platform
import struct
import subprocess
import sys
import tempfile

# Largest change of a value between nearby points, relative to the value or to 1.
CHANGE = {"glsl": 1e-4, "python": 1e-7, "openscad": 1e-4}
# Distance of the nearby points, in each coordinate.
STEP = {"glsl": 2.0**-17, "python": 2.0**-32, "openscad": 2.0**-20}
SIDES = [(0, 0, 0), (1, 1, -1), (-1, 1, 1), (1, -1, 1), (-1, -1, -1)]


def of_glsl(text, points):
    import moderngl

    if not hasattr(of_glsl, "context"):
        of_glsl.context = moderngl.create_standalone_context(backend="egl")
    context = of_glsl.context
    program = context.program(vertex_shader=WHOLE_PICTURE, fragment_shader=FRAGMENT % text)
    size = (len(points), 1)
    data = b"".join(struct.pack("4f", *point, 0.0) for point in points)
    places = context.texture(size, 4, data, dtype="f4")
    target = context.texture(size, 1, dtype="f4")
    buffer = context.framebuffer([target])
    buffer.use()
    places.use(0)
    array = context.vertex_array(program, [])
    array.render(moderngl.TRIANGLES, vertices=3)
    found = struct.unpack(f"{len(points)}f", target.read())
    for one in (array, buffer, target, places, program):
        one.release()
    return found


WHOLE_PICTURE = """#version 450
void main() { gl_Position = vec4(gl_VertexID == 1 ? 3. : -1., gl_VertexID == 2 ? 3. : -1., 0., 1.); }
"""
FRAGMENT = """#version 450
%s
uniform sampler2D places;
out float value;
void main() { value = map(texelFetch(places, ivec2(gl_FragCoord.xy), 0).xyz); }
"""


def of_python(text, points):
    names = {}
    with contextlib.redirect_stdout(sys.stderr):
        exec(text, names)
        return [float(names["f"](*point)) for point in points]


def of_openscad(text, points):
    calls = "".join(f"echo(f({x!r}, {y!r}, {z!r}));\n" for x, y, z in points)
    with tempfile.TemporaryDirectory() as folder:
        with open(f"{folder}/a.scad", "w") as file:
            # OpenSCAD prints six digits. A value becomes its integer part and three groups more.
            file.write(text + "\n" + calls.replace("echo(f(", "echo(digits(f(").replace("));", ")));"))
            file.write(DIGITS)
        command = ["openscad", "-o", f"{folder}/a.echo", f"{folder}/a.scad"]
        done = subprocess.run(command, capture_output=True, text=True)
        if done.returncode != 0:
            raise ValueError(done.stderr)
        with open(f"{folder}/a.echo") as file:
            lines = file.read().splitlines()
    # An earlier assignment to a variable is overwritten, as it should be.
    lines = [line for line in lines if "was overwritten" not in line]
    if any(not line.startswith("ECHO: [") for line in lines):
        raise ValueError("\n".join(lines))
    return [joined(line[len("ECHO: [") :].rstrip("]")) for line in lines]


DIGITS = """
function digits(a) = let(b = abs(a), n = floor(b), c = (b - n)*1e5, m = floor(c))
    [a < 0 ? -1 : 1, floor(n/1e5), n % 1e5, m, floor((c - m)*1e5)];
"""


def joined(line):
    sign, high, low, first, second = (float(part) for part in line.split(","))
    return sign * (high * 1e5 + low + first * 1e-5 + second * 1e-10)


def version(language):
    if language == "glsl":
        import moderngl

        info = moderngl.create_standalone_context(backend="egl").info
        return f"{info['GL_RENDERER']}, OpenGL {info['GL_VERSION']}, by moderngl {moderngl.__version__}"
    if language == "python":
        return f"Python {platform.python_version()}"
    return subprocess.run(["openscad", "--version"], capture_output=True, text=True).stderr.strip()


INTERPRETERS = {"glsl": of_glsl, "python": of_python, "openscad": of_openscad}


def near(language, values):
    center = values[0]
    reach = CHANGE[language] * max(1.0, abs(center))
    return math.isfinite(center) and all(abs(value - center) <= reach for value in values)


def interpret(title, text, points):
    language = title.split()[0]
    all_points = [
        tuple(eighth / 8 + side * STEP[language] for eighth, side in zip(point, sides))
        for point in points
        for sides in SIDES
    ]
    values = None
    try:
        values = INTERPRETERS[language](text, all_points)
    except Exception as error:
        print(f"{title}: {error}", file=sys.stderr)
    for index, point in enumerate(points):
        part = values and values[index * len(SIDES) : (index + 1) * len(SIDES)]
        value = repr(part[0]) if part and near(language, part) else "?"
        print("@", *point, "=", value)


def main():
    title, text, points = None, "", []
    is_named = False
    for line in [*sys.stdin, "[end]"]:
        if line.startswith("["):
            if title:
                interpret(title, text, points)
            if line == "[end]":
                break
            title, text, points = line.strip("[]\n"), "", []
            if not is_named:
                print("# Values of", version(title.split()[0]))
                is_named = True
            print(line, end="")
        elif line.startswith("#"):
            print(line, end="")
        elif line.startswith(">"):
            print(line, end="")
            text += line[2:]
        elif line.startswith("@"):
            points.append(tuple(int(part) for part in line[1:].split("=")[0].split()))


main()
