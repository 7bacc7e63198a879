"""Types into the prompt and the window of the program for Windows, under wine, as a user would.

python window.py DIRECTORY COMMAND... starts COMMAND in a pseudo-terminal, with a display of its
own, and leaves screenshots in DIRECTORY. Needs pexpect, pyte, Xvfb, openbox, xdotool, xclip, and
`import` of ImageMagick.

wine's console does not interpret escape sequences, so colors are off. It turns Ctrl-C in the prompt
into the event that ends programs, so that key is tried in the window only.
"""

import os
import pathlib
import subprocess
import sys
import time

import pexpect
import pyte

DISPLAY = ":97"
# Far above each wait here, even on a slow and busy machine.
LIMIT = 60.0


class Program:
    """The program, the screen of its terminal, and its window."""

    def __init__(self, directory: pathlib.Path, command: list[str]) -> None:
        self.directory = directory
        self.environment = {**os.environ, "DISPLAY": DISPLAY, "NO_COLOR": "1", "TERM": "xterm"}
        self.screen = pyte.Screen(100, 40)
        self.stream = pyte.Stream(self.screen)
        self.terminal = pexpect.spawn(
            command[0],
            command[1:],
            dimensions=(40, 100),
            env=self.environment,
            encoding="utf-8",
            cwd=directory,
        )

    def read(self, seconds: float) -> None:
        """Feeds output to the screen for this time."""
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            try:
                self.stream.feed(self.terminal.read_nonblocking(65536, timeout=0.1))
            except pexpect.TIMEOUT:
                pass
            except pexpect.EOF:
                return

    def until(self, met, what: str) -> None:
        """Waits until a condition is met."""
        end = time.monotonic() + LIMIT
        while not met():
            if time.monotonic() > end:
                sys.exit(f"not seen: {what}\n" + "\n".join(self.lines()))
            self.read(0.2)

    def lines(self) -> list[str]:
        return [line.rstrip() for line in self.screen.display if line.strip()]

    def shows(self, text: str) -> None:
        """Waits until the terminal shows a text."""
        self.until(lambda: any(text in line for line in self.lines()), text)

    def run(self, *command: str) -> str:
        done = subprocess.run(
            command, env=self.environment, capture_output=True, text=True, timeout=LIMIT
        )
        return done.stdout

    def copy(self, text: str) -> None:
        """Puts a text into the clipboard. `xclip` stays to hand it over."""
        command = ["xclip", "-quiet", "-selection", "clipboard"]
        quiet = subprocess.DEVNULL
        owner = subprocess.Popen(
            command,
            env=self.environment,
            stdin=subprocess.PIPE,
            stdout=quiet,
            stderr=quiet,
            text=True,
        )
        owner.stdin.write(text)
        owner.stdin.close()

    def window(self) -> str:
        return self.run("xdotool", "search", "--name", "zeroset$").strip()

    def title(self) -> str:
        return self.run("xdotool", "getwindowname", self.window().split("\n")[-1]).strip()

    def press(self, *keys: str) -> None:
        self.run("xdotool", "key", "--delay", "100", *keys)

    def shot(self, name: str) -> None:
        self.run("import", "-window", "root", str(self.directory / f"{name}.png"))

    def clipboard(self) -> str:
        return self.run("timeout", "5", "xclip", "-o", "-selection", "clipboard")


def main() -> None:
    directory = pathlib.Path(sys.argv[1])
    server = subprocess.Popen(["Xvfb", DISPLAY, "-screen", "0", "1000x760x24"])
    time.sleep(2)
    manager = subprocess.Popen(["openbox"], env={**os.environ, "DISPLAY": DISPLAY})
    try:
        try_everything(Program(directory, sys.argv[2:]))
    finally:
        manager.kill()
        server.kill()


def try_everything(program: Program) -> None:
    terminal = program.terminal
    program.shows("zeroset>")
    program.until(program.window, "a window")
    print("the window opens beside the prompt")

    terminal.send("x^2+y^2+z^2 = 1\r")
    program.until(lambda: "formula" in program.title(), "a document in the title")
    terminal.send("x^2 + y² = sn(z)\r")
    program.shows("there is no function `sn`")
    program.shows("^^ no function has this name")
    print("an error has its caret below the place, behind a sign beyond ASCII")
    terminal.send("\x1b[A\x1b[A\r")
    program.until(lambda: "\n".join(program.lines()).count("> x^2+y^2+z^2 = 1") == 2, "history")
    print("arrows bring earlier lines back")
    terminal.send("z = x^3\x1b[D\x7f\x1b[C\x7f2\r")
    program.shows("> z = x2")
    print("lines are edited")

    program.run("xdotool", "windowactivate", "--sync", program.window().split("\n")[-1])
    program.run("xdotool", "type", "--delay", "100", "z = x^2 - y^2")
    program.read(3)
    program.press("Return")
    program.read(2)
    program.shot("typed")
    terminal.send(":list\r")
    program.shows("z = x^2 - y^2")
    print("the window takes typing")

    program.copy("x^4+y^4+z^4 = 1")
    program.press("ctrl+v", "Return")
    program.read(3)
    program.shot("pasted")
    program.press("ctrl+c")
    program.until(lambda: "x^4" in program.clipboard(), "the document in the clipboard")
    print("texts are pasted and copied")
    program.press("F1")
    program.read(2)
    program.shot("help")
    program.press("Escape")

    # An editor replaces the file.
    file = program.directory / "watched file.zset"
    file.write_text("x^2+y^2+z^2 = 1\n")
    terminal.send(":load watched file.zset\r")
    program.until(lambda: "watched file" in program.title(), "the file in the title")
    temporary = program.directory / "watched file.new"
    temporary.write_text("z = sin(x)*cos(y)\n")
    temporary.replace(file)
    program.read(3)
    terminal.send(":list\r")
    program.shows("z = sin(x)*cos(y)")
    print("a file that an editor replaces is read again")
    terminal.send(":quit\r")
    terminal.expect(pexpect.EOF, timeout=LIMIT)
    terminal.close()
    if terminal.exitstatus != 0:
        sys.exit(f"the program ends with {terminal.exitstatus}")
    print("the program ends")


main()
