#!/usr/bin/env python3
"""Takes includes out of copies of the source tree: scripts/check_includes.py must find each and name it."""

import unittest

from planted_tree import PlantedTree


class CheckIncludes(PlantedTree):
    script = "check_includes.py"

    def setUp(self):
        super().setUp()
        self.copy("src", "include", "apps")

    def assert_found_without(self, file, include, message):
        self.edit(file, f"#include {include}\n", "")
        self.assert_found(message)

    def test_accepts_the_tree(self):
        self.assertRegex(self.output(0), r"[1-9]\d\d files, [1-9]\d{2,} names, 0 missing includes")

    def test_finds_headers_of_the_standard_library(self):
        self.put("apps/new.h", "#include <string>\n\nvoid f(const std::string& text);\n")
        self.assert_accepted()
        self.assert_found_without("apps/new.h", "<string>", "apps/new.h: uses std::string without <string>")

    def test_finds_headers_of_functions(self):
        self.put("src/mesh/new.cpp", '#include "mesh/other.h"\n\nint f() { return shaderName(info); }\n')
        self.put("src/mesh/other.h", '#pragma once\n#include "counters/shader_names.h"\n')
        self.assert_accepted()
        self.assert_found_without("src/mesh/other.h", '"counters/shader_names.h"',
                                  "src/mesh/new.cpp: uses shaderName without src/counters/shader_names.h")  # fmt: skip

    def test_finds_headers_of_types_and_constants(self):
        self.put("src/mesh/new.h", '#include "vulkan/device/shader.h"\n#include <raymap/field.h>\n\nvoid f(Shader s, int i = kNoTriangle);\n')
        self.assert_accepted()
        self.assert_found_without("src/mesh/new.h", '"vulkan/device/shader.h"', "src/mesh/new.h: uses Shader without")
        self.assert_found_without("src/mesh/new.h", "<raymap/field.h>", "src/mesh/new.h: uses kNoTriangle without")

    def test_finds_headers_of_classes_that_have_constructors_and_a_namesake_in_the_program(self):
        self.put("src/mesh/new.h", "#include <raymap/buffer.h>\n\nBuffer<int> f();\n")
        self.put("apps/new.h", "namespace raymap::view {\nstruct Buffer {};\nvoid f(Buffer&);\n}\n")
        self.assert_accepted()
        self.assert_found_without("src/mesh/new.h", "<raymap/buffer.h>", "src/mesh/new.h: uses Buffer without include/raymap/buffer.h")

    def test_knows_members_other_namespaces_and_comments(self):
        self.put("src/mesh/new.cpp", 'int f() { return a.shaderName() + b->shaderName() + c::shaderName(); }  // shaderName\n'
                 'const char* kText = "shaderName";\n')  # fmt: skip
        self.assert_accepted()

    def test_knows_types_that_are_declared_in_advance(self):
        self.put("src/mesh/new.h", "class SurfaceTree;\nvoid f(SurfaceTree& tree);\n")
        self.assert_accepted()
        self.put("src/mesh/new.h", "void f(SurfaceTree& tree);\n")
        self.assert_found("src/mesh/new.h: uses SurfaceTree without ")


if __name__ == "__main__":
    unittest.main()
