#!/usr/bin/env python3
"""Feeds texts that name flags and commands to scripts/check_messages.py, which must find each and name its place."""

import unittest

from planted_tree import PlantedTree


class CheckMessages(PlantedTree):
    script = "check_messages.py"

    def setUp(self):
        super().setUp()
        self.put("apps/devices.cpp", 'app.addCommand("devices", "List devices");\napp.addCommand("info", "Report");\n')
        self.put("src/right.cpp", 'throw Error("use a smaller voxel size");\n')

    def assert_found(self, *places):
        printed = super().assert_found(f"texts, {len(places)} name")
        self.assertEqual([line.partition(": ")[0] for line in printed[:-1]], list(places))

    def test_accepts_the_tree(self):
        self.copy("src", "include", "apps")
        self.assert_accepted()

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
        self.assert_accepted()

    def test_a_tree_without_texts_is_an_error(self):
        self.put("src/right.cpp", "int a;\n")
        self.assertIn("0 texts", self.output(1))


if __name__ == "__main__":
    unittest.main()
