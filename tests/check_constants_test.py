#!/usr/bin/env python3
"""Feeds constants that both languages define to scripts/check_constants.py, which must find each and name it."""

import unittest

from planted_tree import PlantedTree


class CheckConstants(PlantedTree):
    script = "check_constants.py"

    def assert_found(self, *lines):
        printed = super().assert_found(f"constants, {len(lines)} defined for the CPU and for the GPU apart")
        self.assertEqual(printed[:-2], list(lines))

    def assert_clean(self):
        self.assert_accepted("constants, 0 defined for the CPU and for the GPU apart")

    def test_accepts_the_tree(self):
        self.copy("include", "src")
        self.assert_clean()

    def test_finds_what_the_review_at_53326ab_found(self):
        # The text of 53326ab, shortened.
        self.put("include/raymap/field.h", "inline constexpr uint32_t kNoTriangle = 0xffffffffu;\n")
        self.put("src/cpu/render/sphere_trace.cpp", "// Share of the distance that a step takes.\n"
                 "constexpr double kCaution = 0.9;\nconstexpr double kLeastStep = 0.05;\nconstexpr double kLightSize = 0.11;\n")
        self.put("src/cpu/sign/crossings.cpp", "constexpr int kMaxFractionBits = 20;\nconstexpr int kCoordinateBits = 40;\n"
                 "constexpr int64_t kNarrowExtent = int64_t{1} << 30;  // below this extent, orient2d fits into 64 bits\n")
        self.put("src/cpu/sign/orientation_measure.cpp", "Sides sidesOf(const FieldReader& field) {\n"
                 "  constexpr float kPartLength = 2.0f, kMostParts = 8.0f;\n}\n")
        self.put("src/method/cell_lattice.h", "inline constexpr uint32_t kNoCell = 0xffffffffu;\n")
        self.put("src/method/winding_harmonic_lattices.h", "inline constexpr int kHarmonicMargin = 4;\n")
        self.put("src/method/winding_paths_offsets.h", "inline constexpr int kPathsPerPoint = 6;  // xyz, xzy\n")
        self.put("src/vulkan/stages/surface_tree.cpp", "constexpr uint32_t kVerticesEach = 8;\n")
        self.put("src/vulkan/stages/cell_lattice.glsl", "const uint kNoCell = 0xffffffffu;\n")
        self.put("src/vulkan/stages/crossings.glsl", "const int kMaxFractionBits = 20;\nconst int kCoordinateBits = 40;\n")
        self.put("src/vulkan/stages/crossings_triangles.comp", "const int64_t kNarrowExtent = 1l << 30;\n")
        self.put("src/vulkan/stages/exact_distance.glsl", "const uint kNoTriangle = 0xffffffffu;\n")
        self.put("src/vulkan/stages/orientation_sides.comp", "const float kPartLength = 2.0;\nconst float kMostParts = 8.0;\n")
        self.put("src/vulkan/stages/sphere_trace.glsl",
                 "const float kCaution = 0.9;\nconst float kLeastStep = 0.05;\nconst float kLightSize = 0.11;\n")
        self.put("src/vulkan/stages/surface_tree_bounds.comp", "const uint kVerticesEach = 8;\n")
        self.put("src/vulkan/stages/winding_harmonic.glsl", "const int kHarmonicMargin = 4;\n")
        self.put("src/vulkan/stages/winding_paths.comp", "const float kPathsPerPoint = 6.0;  // xyz, xzy\n")
        trace = "src/cpu/render/sphere_trace.cpp:{0} and in src/vulkan/stages/sphere_trace.glsl:{1}"
        sides = "src/cpu/sign/orientation_measure.cpp:2 and in src/vulkan/stages/orientation_sides.comp:"
        crossings = "src/cpu/sign/crossings.cpp:{0} and in src/vulkan/stages/crossings.glsl:{0}"
        self.assert_found(*(f"{name} is defined in {places}" for name, places in (
            ("kCaution", trace.format(2, 1)),
            ("kCoordinateBits", crossings.format(2)),
            ("kHarmonicMargin", "src/method/winding_harmonic_lattices.h:1 and in src/vulkan/stages/winding_harmonic.glsl:1"),
            ("kLeastStep", trace.format(3, 2)),
            ("kLightSize", trace.format(4, 3)),
            ("kMaxFractionBits", crossings.format(1)),
            ("kMostParts", sides + "2"),
            ("kNarrowExtent", "src/cpu/sign/crossings.cpp:3 and in src/vulkan/stages/crossings_triangles.comp:1"),
            ("kNoCell", "src/method/cell_lattice.h:1 and in src/vulkan/stages/cell_lattice.glsl:1"),
            ("kNoTriangle", "include/raymap/field.h:1 and in src/vulkan/stages/exact_distance.glsl:1"),
            ("kPartLength", sides + "1"),
            ("kPathsPerPoint", "src/method/winding_paths_offsets.h:1 and in src/vulkan/stages/winding_paths.comp:1"),
            ("kVerticesEach", "src/vulkan/stages/surface_tree.cpp:1 and in src/vulkan/stages/surface_tree_bounds.comp:1"))))

    def test_finds_every_form_of_a_definition(self):
        self.put("src/a.cpp", "static constexpr int kOne{1}, kTwo[2] = {1, 2};\n#define kThree 3\n"
                 "enum { kFour = 4 };\nconst auto kFive =\n    5;\n")
        self.put("src/a.comp", "const uint kOne = 1, kTwo = 2;\n# define kThree 3\nconst uint kFour\n  = 4;\n"
                 "void main() { const float kFive[2] = float[](1.0, 2.0); }\n")
        self.assert_found("kFive is defined in src/a.comp:5 and in src/a.cpp:4",
                          "kFour is defined in src/a.comp:3 and in src/a.cpp:3",
                          "kOne is defined in src/a.comp:1 and in src/a.cpp:1",
                          "kThree is defined in src/a.comp:2 and in src/a.cpp:2",
                          "kTwo is defined in src/a.comp:1 and in src/a.cpp:1")

    def test_finds_a_copy_of_what_both_read(self):
        self.put("src/a_shared.h", '#include "base/shader_types.h"\nRAYMAP_CONSTANT int kOne = 1;\n')
        self.put("src/a.cpp", "constexpr int kOne = 1;\n")
        self.assert_found("kOne is defined in src/a.cpp:1 and in src/a_shared.h:2")

    def test_accepts_what_both_read_and_what_one_language_has(self):
        self.put("src/a_shared.h", '#include "base/shader_types.h"\nRAYMAP_CONSTANT int kShared = 1;\n')
        self.put("src/a.cpp", "constexpr int kOwn = kShared;\nvoid f() { g(kOurs == 1, {.a = kTheirs}); }\n")
        self.put("src/b.h", "constexpr int kOwn = 2;\n")
        self.put("src/a.comp", "const int kOurs = kShared;\nvoid main() { const bool isOne = kOwn == 1; }\n")
        self.put("src/b.comp", "const int kOurs = 3, kTheirs = 4;\n")
        self.assert_clean()

    def test_accepts_specialization_constants_and_comments(self):
        self.put("src/a.cpp", "constexpr int kRun = 512;  // Not kAxis = 1;\nconstexpr int kAxis = 1;\n")
        self.put("src/a.comp", "layout(constant_id = 1) const uint kRun = 2;\n// const int kAxis = 2;\n"
                 "/* const int\n kAxis = 2; */\nconst int kOther = 1;\n")
        self.assert_clean()

    def test_a_tree_without_constants_is_an_error(self):
        self.put("src/a.h", "// Nothing.\n")
        self.assertIn("0 constants", self.output(1))


if __name__ == "__main__":
    unittest.main()
