#!/usr/bin/env python3
"""Plants mistakes into copies of the headers: scripts/records.py --check must find each and name it."""

import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent


class Records(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = Path(folder.name)
        shutil.copytree(ROOT / "include", self.root / "include")
        for name in ("src/api/names.cpp", "python/raymap/_records.py", "docs/report.md"):
            (self.root / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(ROOT / name, self.root / name)

    def edit(self, name, old, new):
        text = (self.root / name).read_text()
        self.assertIn(old, text)
        (self.root / name).write_text(text.replace(old, new, 1))

    def check(self, *options):
        run = subprocess.run([sys.executable, ROOT / "scripts/records.py", *options, self.root], capture_output=True,
                             text=True)
        return run.returncode, run.stdout + run.stderr

    def assert_found(self, *messages):
        code, output = self.check("--check")
        self.assertEqual(code, 1, output)
        for message in messages:
            self.assertIn(message, output)

    def test_this_tree_is_right(self):
        self.assertEqual(self.check("--check")[0], 0)

    def test_a_name_changes_both_files(self):
        self.edit("include/raymap/records.h", '"sheet_share"', '"share_of_sheets"')
        self.assert_found("_records.py is not what", "report.md is not what", "2 files differ")
        self.assertEqual(self.check()[0], 0)
        self.assertEqual(self.check("--check")[0], 0)
        for name in ("python/raymap/_records.py", "docs/report.md"):
            self.assertIn("share_of_sheets", (self.root / name).read_text())

    def test_a_comment_changes_both_files(self):
        self.edit("include/raymap/diagnostics.h", "Number of edges with one face", "Edges with one face")
        self.assert_found("2 files differ")

    def test_a_type_changes_both_files(self):
        self.edit("include/raymap/repair.h", "size_t solids = 0;", "bool solids = false;")
        self.assert_found("2 files differ")

    def test_a_warning_code_is_explained(self):
        self.edit("include/raymap/warning.h", "is sheets or dropped parts", "is sheets")
        self.assert_found("report.md is not what", "1 files differ")

    def test_a_warning_code_has_no_comment(self):
        self.edit("include/raymap/warning.h", "  NoHollow,  ", "  NoHollow,  //")
        self.assert_found("has no comment in warning.h")

    def test_a_member_is_left_out(self):
        self.edit("include/raymap/records.h", '  use("watertight", found.watertight);\n', "")
        self.assert_found("leaves out ['watertight'] of Diagnostics")

    def test_a_member_has_no_comment(self):
        self.edit("include/raymap/repair.h", "///< Largest distance.", "")
        self.assert_found("a member of Deviation has no comment")


if __name__ == "__main__":
    unittest.main()
