#!/usr/bin/env python3
"""Plants mistakes into copies of the headers and of docs/report.md: scripts/records.py --check must find each and name it."""

import unittest

from planted_tree import PlantedTree


class Records(PlantedTree):
    script = "records.py"
    options = ("--check",)

    def setUp(self):
        super().setUp()
        self.copy("include", "src/api/names.cpp", "python/raymap/_records.py", "docs/report.md", "docs/raymap.schema.json")

    def test_accepts_the_tree(self):
        self.assert_accepted()

    def test_a_name_changes_all_files(self):
        self.edit("include/raymap/records.h", '"sheet_share"', '"share_of_sheets"')
        self.assert_found("_records.py is not what", "report.md is not what", "raymap.schema.json is not what", "3 files differ")
        self.options = ()
        self.assert_accepted()
        self.options = ("--check",)
        self.assert_accepted()
        for name in ("python/raymap/_records.py", "docs/report.md", "docs/raymap.schema.json"):
            self.assertIn("share_of_sheets", (self.root / name).read_text())

    def test_a_comment_changes_all_files(self):
        self.edit("include/raymap/diagnostics.h", "Number of edges with one face", "Edges with one face")
        self.assert_found("3 files differ")

    def test_a_type_changes_all_files(self):
        self.edit("include/raymap/repair.h", "size_t solids = 0;", "bool solids = false;")
        self.assert_found("3 files differ")

    def test_a_key_of_a_command_changes_the_schema(self):
        self.edit("docs/report.md", "| `slowest_step` | text |", "| `longest_step` | text |")
        self.assert_found("raymap.schema.json is not what", "1 files differ")

    def test_a_command_has_a_key_of_no_type(self):
        self.edit("docs/report.md", "| `slowest_step` | text |", "| `slowest_step` | string |")
        self.assert_found("'string' is no type")

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
