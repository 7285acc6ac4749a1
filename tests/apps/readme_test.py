"""Runs every command of README.md, docs/choose.md, docs/faq.md and `raymap --help`, as printed, in a folder that holds
nothing else, and those of docs/points.md and docs/cli.md, beside files of these names.

readme_test.py RAYMAP README: the program. scripts/check_install.sh tries the code for C++, python/tests/test_docs.py that
for Python, and CI runs the scripts."""

import os
import re
import shutil
import struct
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

RAYMAP, README = (Path(argument).resolve() for argument in (sys.argv.pop(1), sys.argv.pop(1)))
LONG = 240  # Seconds after which a command gives up; nothing is measured.


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

    def test_commands_of_readme(self):
        lines = printed(README.read_text())
        self.assertEqual(len(lines), 6)
        self.run_lines(lines)
        self.assertEqual(self.run_line("raymap check solid.stl").count(": good"), 1)

    def test_commands_of_pages(self):
        for page in "choose.md", "faq.md":
            text = (README.parent / "docs" / page).read_text()
            lines = printed(text) + re.findall(r"^\| [^|]* \| `(raymap .*?)` \|", text, re.MULTILINE)
            self.assertGreater(len(lines), 10, page)
            for line in lines:
                self.run_line(line)

    def test_commands_beside_files(self):
        for line in ("example -o scan.ply", "sample scan.ply -o points.csv -n 100", "convert scan.ply -o scan.stl",
                     "convert scan.ply -o cad.stl"):
            self.run_line(f"raymap -q {line}")
        header = b"{'descr': '<f8', 'fortran_order': False, 'shape': (1, 3), }"
        start = b"\x93NUMPY\1\0" + struct.pack("<H", len(header)) + header
        (self.folder / "points.npy").write_bytes(start + struct.pack("<3d", 1, 2, 3))
        for page, most in ("points.md", 3), ("cli.md", 6):
            text = (README.parent / "docs" / page).read_text()
            lines = re.findall(r"^    (?!.*man\.)(\w.*)$", text, re.MULTILINE)  # Not those of an animation.
            self.assertEqual(len(lines), most, page)
            for line in lines:
                if all(shutil.which(program) for program in ("zstd", "man") if f"| {program} " in line):
                    self.run_line(line)

    def test_commands_of_the_help(self):
        lines = printed(self.run_line("raymap --help").split("Try it:")[1])
        self.assertEqual(len(lines), 3)
        self.run_lines(lines)


if __name__ == "__main__":
    unittest.main(verbosity=2)
