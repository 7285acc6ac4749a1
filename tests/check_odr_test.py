#!/usr/bin/env python3
"""Plants second definitions into copies of the source tree: scripts/check_odr.py must find each and name it."""

import re
import unittest

from planted_tree import PlantedTree


class CheckOdr(PlantedTree):
    script = "check_odr.py"

    def put_both(self, text, other=None):
        self.put("src/mesh/one.cpp", f"namespace raymap {{\n{text}\n}}\n")
        self.put("src/field/two.cpp", f"namespace raymap {{\n\n{text if other is None else other}\n}}\n")

    def copy_sources(self):
        self.copy("src", "include", "apps", "tests")

    def export_names_of(self, *names):
        """Removes the unnamed namespaces in the SIMD code of these files."""
        for name in names:
            path = self.root / name
            text, opened = re.subn(r"HWY_NAMESPACE \{\nnamespace \{\n", "HWY_NAMESPACE {\n", path.read_text())
            text, closed = re.subn(r"\n\}  // namespace\n(\}  // namespace .*HWY_NAMESPACE\n)", r"\n\1", text)
            self.assertEqual((opened, closed), (1, 1), name)
            path.write_text(text)

    def assert_found(self, *lines):
        printed = super().assert_found(f"definitions, {len(lines)} names with several")
        self.assertEqual(printed[:-2], list(lines))

    def assert_clean(self):
        self.assert_accepted("definitions, 0 names with several")

    def test_accepts_the_tree(self):
        self.copy_sources()
        self.assert_clean()

    def test_finds_the_functions_and_classes_that_simd_files_shared(self):
        self.copy_sources()
        self.export_names_of("src/cpu/distance/exact_distance.cpp", "src/cpu/points/nearest_triangles.cpp",
                             "src/cpu/cells/closest_triangles.cpp", "src/cpu/sign/orientation_measure.cpp",
                             "src/cpu/distance/surface_leaves.cpp", "src/cpu/points/closest_point.cpp")
        output = self.output(1)
        space = "raymap::cpu::HWY_NAMESPACE::"
        for name, one, two in (
                ("widestNode(float)", "cpu/distance/exact_distance.cpp", "cpu/points/nearest_triangles.cpp"),
                ("Vector", "cpu/cells/closest_triangles.cpp", "cpu/sign/orientation_measure.cpp"),
                ("Vectors", "cpu/distance/surface_leaves.cpp", "cpu/points/closest_point.cpp")):
            self.assertRegex(output, rf"(?m)^{re.escape(space + name)} is defined in src/{one}:\d+ and in src/{two}:\d+$")

    def test_sees_every_layer_of_the_tree(self):
        self.copy_sources()
        self.put("tests/core/odd_test.cpp", "namespace raymap {\nclass Surface {};\nstruct Grid {};\n"
                 "namespace vulkan {\nstruct CrossingsPush {};\n}\n}\n")
        output = self.output(1)
        for name, place in (("raymap::Surface", "include/raymap/surface.h"), ("raymap::Grid", "include/raymap/grid.h"),
                            ("raymap::vulkan::CrossingsPush", "src/vulkan/stages/crossings_push.h")):
            self.assertRegex(output, rf"(?m)^{name} is defined in {place}:\d+ and in tests/core/odd_test.cpp:\d+$")

    def test_finds_a_class_and_an_enumeration_of_one_name(self):
        self.put_both("struct FaceMeasure {\n  double area = 0.0;\n};", "enum class FaceMeasure { Rise, Wholeness };")
        self.assert_found("raymap::FaceMeasure is defined in src/field/two.cpp:3 and in src/mesh/one.cpp:2")

    def test_finds_functions_whose_parameters_have_other_names(self):
        self.put_both("float widest(const float* reach, int count[3], std::pair<int, int> p = {}) { return 0.0f; }",
                      "constexpr float widest(const float* far, int n[3], std::pair<int, int> q) { return 1.0f; }")
        self.assert_found("raymap::widest(const float *, int [3], std::pair<int,int>) is defined in src/field/two.cpp:3 and"
                          " in src/mesh/one.cpp:2")

    def test_finds_a_member_function_defined_twice(self):
        self.put_both("void Keeper::put(int what) const { a(); }", "inline void Keeper::put(int which) const {}")
        self.assert_found("raymap::Keeper::put(int) const is defined in src/field/two.cpp:3 and in src/mesh/one.cpp:2")

    def test_finds_inline_variables_and_static_members(self):
        self.put_both("inline constexpr int kFew = 3;", "inline constexpr int kFew = 4;")
        self.put("src/mesh/three.cpp", "struct A {\n  static int f() { return 1; }\n};\n")
        self.put("src/mesh/four.cpp", "struct A {\n  static int f() { return 2; }\n};\n")
        self.assert_found("A is defined in src/mesh/four.cpp:1 and in src/mesh/three.cpp:1",
                          "A::f() is defined in src/mesh/four.cpp:2 and in src/mesh/three.cpp:2",
                          "raymap::kFew is defined in src/field/two.cpp:3 and in src/mesh/one.cpp:2")

    def test_looks_between_the_library_and_its_users(self):
        for name in ("include/raymap/a.h", "apps/a.cpp", "python/src/a.cpp", "examples/a/a.cpp", "bench/a.cpp",
                     "fuzz/a.cpp", "tests/core/a_test.cpp"):
            self.put(name, "union Both {};\n")
        self.assert_found("Both is defined in apps/a.cpp:1 and in bench/a.cpp:1 and in examples/a/a.cpp:1 and in"
                          " fuzz/a.cpp:1 and in include/raymap/a.h:1 and in python/src/a.cpp:1 and in"
                          " tests/core/a_test.cpp:1")

    def test_accepts_names_that_one_file_keeps_to_itself(self):
        self.put_both("namespace {\nstruct Own {};\nint own() { return 1; }\n}\nstatic int mine() { return 1; }\n"
                      "constexpr int kOwn = 1;\nvoid %s() { struct Local {}; }" % "one",
                      "namespace {\nstruct Own { int a; };\nint own() { return 2; }\n}\nstatic int mine() { return 2; }\n"
                      "constexpr int kOwn = 2;\nvoid %s() { struct Local { int a; }; }" % "two")
        self.assert_clean()

    def test_accepts_overloads_declarations_and_specializations(self):
        self.put_both("void f(int a) {}\nvoid f() const {}\nstruct Later;\nvoid g();\ntemplate <>\nstruct S<int> {};",
                      "void f(float a) {}\nvoid f() {}\nstruct Later {};\nvoid g() {}\ntemplate <>\nstruct S<float> {};")
        self.assert_clean()

    def test_accepts_two_programs(self):
        self.put("apps/main.cpp", "int main(int argc, char** argv) {}\n")
        self.put("bench/main.cpp", "int main(int count, char** words) {}\n")
        self.put("src/c.cpp", "int c() { return 1; }\n")
        self.assert_clean()

    def test_a_tree_without_definitions_is_an_error(self):
        self.put("src/a.h", "// Nothing.\n")
        self.assertIn("0 definitions", self.output(1))


if __name__ == "__main__":
    unittest.main()
