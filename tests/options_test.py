#!/usr/bin/env python3
"""Plants mistakes into copies of the headers: scripts/options.py --check must find each and name it."""

import unittest

from planted_tree import PlantedTree

STRUCTS = "include/raymap/options.h"
NAMES = "include/raymap/named_options.h"


class Options(PlantedTree):
    script = "options.py"
    options = ("--check",)

    def setUp(self):
        super().setUp()
        self.copy("include", "src/api/names.cpp", "src/describe", "python/raymap", "docs/options.md")

    def write(self):
        """Lets the script write all files."""
        self.options = ()
        self.assert_accepted()
        self.options = ("--check",)
        self.assert_accepted()

    def test_accepts_the_tree(self):
        self.assert_accepted("0 files differ")

    def test_a_comment_changes_every_file(self):
        self.edit(STRUCTS, "A point is inside if", "A sample is inside if")
        self.assert_found("options.md is not what", "option_texts.cpp is not what", "_generate.py is not what", "3 files differ")
        self.write()
        self.assertIn("threshold: A sample is inside if", (self.root / "python/raymap/_generate.py").read_text())

    def test_a_new_option_reaches_every_face(self):
        self.edit(STRUCTS, "  bool invert = false;", "  double blur = 0.25;  ///< Width of the blur, in samples.\n  bool invert = false;")
        self.edit(NAMES, '  use(OptionName{"invert"}', '  use(OptionName{"blur", "SAMPLES", kFromZero}, options.blur);\n  use(OptionName{"invert"}')
        self.assert_found("options.md is not what", "option_texts.cpp is not what", "_generate.py is not what")
        self.write()
        python = (self.root / "python/raymap/_generate.py").read_text()
        self.assertIn("    blur: float = 0.25,\n    progress:", python)
        self.assertIn("        blur: Width of the blur, in samples.\n        progress:", python)
        self.assertIn("    blur: float\n", python)
        self.assertIn("| `blur` | SAMPLES | 0 or more | 0.25 | Width of the blur, in samples. | `FieldOptions` |",
                      (self.root / "docs/options.md").read_text())

    def test_a_range_is_shown(self):
        self.edit(NAMES, '"threshold", "W", kFromZero', '"threshold", "W", kAboveZero')
        self.assert_found("options.md is not what", "1 files differ")
        self.write()
        self.assertIn("| `threshold` | W | above 0 |", (self.root / "docs/options.md").read_text())

    def test_an_option_has_no_comment(self):
        self.edit(STRUCTS, "  ///< A point is inside if |winding number| exceeds this.", "")
        self.assert_found("the option threshold of FieldOptions has no comment")

    def test_another_default_in_python(self):
        self.edit("python/raymap/_repair.py", "drain_holes: int = 1,", "drain_holes: int = 2,")
        self.assert_found("repair: the default of drain_holes is 2, not 1")

    def test_a_binding_names_an_option(self):
        self.put("src/c_api/c_options.cpp", 'int a;\nif (name == "close_holes") options.closeHoles = true;\n')
        self.put("python/src/repair.cpp", 'options.def_rw("remesh", &RepairOptions::remesh);\nmodule.def("f", &f, "base"_a);\n')
        lines = self.assert_found("c_options.cpp:2: names the option close_holes", "repair.cpp:1: names the option remesh")
        self.assertEqual(len(lines), 2)

    def test_a_row_that_cannot_be_read(self):
        self.edit(NAMES, 'use(OptionName{"invert"}, options.invert)', 'use(OptionName{invert}, options.invert)')
        self.assert_found("an option of FieldOptions cannot be read")


if __name__ == "__main__":
    unittest.main()
