#!/usr/bin/env python3
"""Takes includes out of copies of the source tree: scripts/check_includes.py must find each and name it."""

import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent


class CheckIncludes(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.root = Path(self.folder.name)
        for name in ("src", "include", "apps"):
            shutil.copytree(ROOT / name, self.root / name)

    def check(self):
        run = subprocess.run([sys.executable, ROOT / "scripts/check_includes.py", self.root], capture_output=True, text=True)
        return run.returncode, run.stdout + run.stderr

    def assert_found_without(self, file, include, message):
        path = self.root / file
        text = path.read_text()
        self.assertIn(f"#include {include}\n", text)
        path.write_text(text.replace(f"#include {include}\n", ""))
        code, output = self.check()
        self.assertEqual(code, 1, output)
        self.assertIn(message, output)

    def put(self, file, text):
        (self.root / file).write_text(text)

    def test_accepts_the_tree(self):
        code, output = self.check()
        self.assertEqual(code, 0, output)
        self.assertRegex(output, r"[1-9]\d\d files, [1-9]\d{2,} names, 0 missing includes")

    def test_finds_headers_of_the_standard_library(self):
        self.assert_found_without("apps/movie.h", "<string>", "apps/movie.h: uses std::string without <string>")

    def test_finds_headers_of_functions(self):
        self.put("src/mesh/new.cpp", '#include "mesh/other.h"\n\nint f() { return shaderName(info); }\n')
        self.put("src/mesh/other.h", '#pragma once\n#include "testing/kernels/shader_names.h"\n')
        self.assertEqual(self.check()[0], 0)
        self.assert_found_without("src/mesh/other.h", '"testing/kernels/shader_names.h"',
                                  "src/mesh/new.cpp: uses shaderName without src/testing/kernels/shader_names.h")  # fmt: skip

    def test_finds_headers_of_types_and_constants(self):
        self.assert_found_without("src/testing/kernels/shader_names.h", '"vulkan/device/shader.h"', "uses Shader without")
        self.assert_found_without("src/cpu/distance/exact_distance_samples-inl.h", "<raymap/field.h>", "uses kNoTriangle without")

    def test_knows_members_other_namespaces_and_comments(self):
        self.put("src/mesh/new.cpp", 'int f() { return a.shaderName() + b->shaderName() + c::shaderName(); }  // shaderName\n'
                 'const char* kText = "shaderName";\n')  # fmt: skip
        self.assertEqual(self.check()[0], 0)

    def test_knows_types_that_are_declared_in_advance(self):
        self.put("src/mesh/new.h", "class SurfaceTree;\nvoid f(SurfaceTree& tree);\n")
        self.assertEqual(self.check()[0], 0)
        self.put("src/mesh/new.h", "void f(SurfaceTree& tree);\n")
        self.assertIn("src/mesh/new.h: uses SurfaceTree without ", self.check()[1])


if __name__ == "__main__":
    unittest.main()
