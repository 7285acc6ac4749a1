"""Runs every command of README.md, and those of `raymap --help`, as printed, in a folder that holds nothing else.

readme_test.py RAYMAP README: the program. `raymap view` gets a display in memory; it is left out without Xvfb and xdotool,
unless RAYMAP_REQUIRE_WINDOW is set. scripts/check_install.sh tries the code for C++, python/tests/test_docs.py that for
Python, and CI runs the scripts."""

import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path

RAYMAP, README = (Path(argument).resolve() for argument in (sys.argv.pop(1), sys.argv.pop(1)))
LONG = 240  # Seconds after which a command gives up; nothing is measured.
BOX = "".join(f"v {x} {y} {z}\n" for z in (0, 40) for y in (0, 40) for x in (0, 40))
FACES = "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n"


def printed(text):
    return re.findall(r"^ +(raymap .*)$", text, re.MULTILINE)


class ReadmeTest(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.folder = Path(scratch.name)
        path = f"{RAYMAP.parent}:{os.environ['PATH']}"
        self.environment = {**os.environ, "PATH": path, "RAYMAP_CACHE": "off"}

    def run_line(self, line):
        """Runs a line of a shell, which must do without a warning. Returns its stdout."""
        done = subprocess.run(["bash", "-c", line], cwd=self.folder, env=self.environment, text=True, capture_output=True,
                              timeout=LONG)
        self.assertEqual((done.returncode, re.findall("raymap: (?:warning|error).*", done.stderr)), (0, []), line)
        return done.stdout

    def run_lines(self, lines):
        """Runs lines, which leave the files that they name and no others."""
        named = {file for line in lines for file in re.findall(r"(?:-o|--picture) (\S+)", line)}
        for line in lines:
            self.run_line(line)
        self.assertEqual({file.name for file in self.folder.iterdir() if file.stat().st_size > 0}, named)

    def open_window(self, line):
        """Runs a line that opens a window, and closes it once it is there."""
        ours, its = os.pipe()
        server = subprocess.Popen(["Xvfb", "-noreset", "-displayfd", str(its)], pass_fds=[its], stderr=subprocess.DEVNULL)
        self.addCleanup(server.wait)
        self.addCleanup(server.kill)
        os.close(its)
        with open(ours) as number:
            self.environment["DISPLAY"] = ":" + number.readline().strip()
        process = subprocess.Popen(["bash", "-c", "exec " + line], cwd=self.folder, env=self.environment,
                                   stdout=subprocess.DEVNULL)
        self.addCleanup(process.kill)
        end, window = time.monotonic() + LONG, ""
        while not window and process.poll() is None and time.monotonic() < end:
            time.sleep(0.1)
            search = ["xdotool", "search", "--pid", str(process.pid)]
            window = subprocess.run(search, env=self.environment, text=True, stdout=subprocess.PIPE).stdout.split("\n")[0]
        self.assertNotEqual(window, "", line)
        subprocess.run(["xdotool", "windowfocus", "--sync", window, "key", "--window", window, "q"], env=self.environment,
                       check=True)
        self.assertEqual(process.wait(LONG), 0, line)

    def test_commands_of_readme(self):
        lines = printed(README.read_text())
        views = [line for line in lines if line.startswith("raymap view")]
        self.assertEqual((len(lines), len(views)), (13, 1))
        self.run_lines([line for line in lines if line not in views])
        self.assertEqual(self.run_line("raymap check surface.stl solid.stl").count(": good"), 2)
        if os.environ.get("RAYMAP_REQUIRE_WINDOW") or (shutil.which("Xvfb") and shutil.which("xdotool")):
            self.open_window(views[0])

    def test_commands_in_sentences(self):
        inline = [" ".join(code.split()) for code in re.findall(r"`(raymap [^`]*)`", README.read_text())]
        lines = [line for line in inline if "COMMAND" not in line]
        self.assertEqual(len(lines), 1)
        (self.folder / "bust.obj").write_text(BOX + FACES)
        self.run_line("raymap convert bust.obj bust.stl")
        self.run_line(lines[0])
        self.run_line("raymap check hollow.stl")

    def test_commands_of_the_help(self):
        lines = printed(self.run_line("raymap --help").split("Try it:")[1])
        self.assertEqual(len(lines), 3)
        self.run_lines(lines)


if __name__ == "__main__":
    unittest.main(verbosity=2)
