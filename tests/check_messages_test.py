#!/usr/bin/env python3
"""Feeds texts that name flags and commands to scripts/check_messages.py, which must find each and name its place."""

import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent


class CheckMessages(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = Path(folder.name)
        self.put("apps/devices.cpp", 'app.add_subcommand("devices", "List devices");\napp.add_subcommand("info", "Report");\n')
        self.put("src/right.cpp", 'throw Error("use a smaller voxel size");\n')

    def put(self, name, text):
        path = self.root / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)

    def check(self, root=None):
        run = subprocess.run([sys.executable, ROOT / "scripts/check_messages.py", root or self.root], capture_output=True,
                             text=True)
        return run.returncode, run.stdout + run.stderr

    def assert_found(self, *places):
        code, output = self.check()
        self.assertEqual(code, 1, output)
        self.assertEqual([line.partition(": ")[0] for line in output.splitlines()[:-1]], list(places))
        self.assertIn(f"texts, {len(places)} name", output)

    def test_accepts_this_tree(self):
        code, output = self.check(ROOT)
        self.assertEqual(code, 0, output)

    def test_finds_flags(self):
        self.put("src/a.cpp", '// "--no"\nwarn("to keep all: --drop-smaller 0");\n')
        self.put("include/b.h", 'inline auto text = "a \\"wall\\", see (--shell)";\n')
        self.assert_found("include/b.h:1", "src/a.cpp:2")

    def test_finds_commands(self):
        self.put("src/a.cpp", 'f("; `raymap devices` lists them");\n')
        self.assert_found("src/a.cpp:1")

    def test_finds_what_two_lines_make(self):
        self.put("src/a.cpp", 'f(1,\n  "use a smaller "\n  "--shell");\nf("see raymap "\n  "info");\n')
        self.assert_found("src/a.cpp:2", "src/a.cpp:4")

    def test_accepts_all_else(self):
        self.put("src/a.cpp", '#include "a--b.h"\n/* "--flag"\n */ // raymap devices "--flag"\nf("raymap was built -- so");\n'
                 'f("raymap device"); g("a--b", c--, "x");\n')
        code, output = self.check()
        self.assertEqual(code, 0, output)

    def test_a_tree_without_texts_is_an_error(self):
        (self.root / "src/right.cpp").write_text("int a;\n")
        self.assertEqual(self.check()[0], 1)


if __name__ == "__main__":
    unittest.main()
