#!/usr/bin/env python3
"""Plants mistakes into copies of the source tree: scripts/check_layers.py must find each and name it."""

import unittest

from planted_tree import PlantedTree


class CheckLayers(PlantedTree):
    script = "check_layers.py"

    def setUp(self):
        super().setUp()
        self.copy("src", "include")

    def prepend(self, name, text):
        self.put(name, text + (self.root / name).read_text())

    def test_accepts_the_tree(self):
        self.assert_accepted(" 0 of them upward or sideways, 0 folder cycles")

    def test_finds_an_upward_include(self):
        self.prepend("src/mesh/weld.cpp", '#include "cpu/backend.h"\n')
        self.assert_found("src/mesh/weld.cpp:1 includes cpu/backend.h: mesh may include only base", " 1 of them upward")

    def test_finds_a_sideways_include(self):
        self.prepend("src/cpu/cells/refine.cpp", '#include "cpu/sign/sign.h"\n')
        self.assert_found("src/cpu/cells/refine.cpp:1 includes cpu/sign/sign.h: cpu/cells may include only")

    def test_finds_an_upward_include_in_a_shader(self):
        self.prepend("src/vulkan/primitives/scan_reduce.comp", '#include "vulkan/stages/mesh.glsl"\n')
        self.assert_found("src/vulkan/primitives/scan_reduce.comp:1 includes vulkan/stages/mesh.glsl")

    def test_finds_an_upward_public_header(self):
        self.prepend("src/field/grid.cpp", "#include <raymap/generate.h>\n")
        self.prepend("include/raymap/mesh.h", "#include <raymap/field.h>\n")
        self.assert_found("src/field/grid.cpp:1 includes raymap/generate.h: field may include only",
                          "include/raymap/mesh.h:1 includes raymap/field.h: mesh may include only base")

    def test_finds_a_cycle_of_folders(self):
        self.prepend("src/base/progress.h", '#include "mesh/weld.h"\n')
        self.assert_found("a cycle of includes between base, mesh", " 1 folder cycles")

    def test_finds_a_declared_cycle(self):
        self.edit("src/layers.txt", "\nbase:\n", "\nbase: mesh\n")
        self.assert_found("layers.txt: a cycle between base, mesh")

    def test_finds_a_function_that_a_higher_layer_defines(self):
        self.prepend("include/raymap/mesh.h", "namespace raymap {\nRAYMAP_API void paint(const Mesh& mesh, int colour = 1);\n}\n")
        self.put("src/render/paint.cpp", "namespace raymap {\nvoid paint(const Mesh& of, int colour) {\n}\n}\n")
        self.put("src/io/paint.cpp", "namespace raymap {\nvoid paint(const Mesh& of) {\n}\n}\n")  # Another one.
        self.assert_found("include/raymap/mesh.h is of the layer mesh, but paint is defined in render\n")

    def test_finds_a_class_that_a_higher_layer_defines(self):
        self.prepend("include/raymap/mesh.h", "namespace raymap {\nclass RAYMAP_API Brush {\n void dip();\n};\n}\n")
        self.put("src/api/brush.cpp", "namespace raymap {\nvoid Brush::dip() {}\n}\n")
        self.assert_found("include/raymap/mesh.h is of the layer mesh, but Brush is defined in api\n")

    def test_finds_what_no_layer_owns(self):
        self.put("src/odds/ends.h", "")
        self.put("include/raymap/odds.h", "")
        self.assert_found("src/odds/ends.h: no line of src/layers.txt", "include/raymap/odds.h: no line of src/layers.txt")

    def test_takes_a_folder_in_a_layer_for_a_part_of_it(self):
        self.put("src/mesh/odds/ends.h", '#include "base/hash.h"\n#include "cpu/backend.h"\n')
        self.assert_found("src/mesh/odds/ends.h:2 includes cpu/backend.h: mesh may include only", " 1 of them upward")

    def test_finds_a_path_that_is_not_whole(self):
        self.prepend("src/mesh/weld.cpp", '#include "holes.h"\n')
        self.assert_found("src/mesh/weld.cpp:1 includes holes.h: no such file")

    def test_finds_tbb_elsewhere(self):
        self.prepend("src/mesh/weld.cpp", "#include <tbb/parallel_sort.h>\n")
        self.assert_found("src/mesh/weld.cpp:1 includes tbb/parallel_sort.h: only src/base/parallel.cpp and")

    def test_finds_an_import_of_an_add_on(self):
        self.put("python/raymap/_mesh.py", "from .dataset.files import readable\n")
        self.put("python/raymap/zarr/store.py", "from .. import torch\nfrom .codecs import zarr_package\n")
        self.put("python/raymap/dataset/run.py", "from ..recipes import recipe_of\nfrom .work import Job\n")
        self.assert_found("python/raymap/_mesh.py:1 imports the add-on dataset", "python/raymap/zarr/store.py:1 imports the add-on torch")

    def test_finds_an_import_of_the_package_by_an_add_on(self):
        self.put("python/raymap/__init__.py", '__all__ = [\n    "Field",\n]\n')
        self.put("python/raymap/jax.py", "from ._field import Field, core_of_field\nfrom ._trilinear import interpolate\n")
        printed = self.assert_found("python/raymap/jax.py:1 imports core_of_field of _field: src/layers.txt does not let it")
        self.assertEqual(len(printed), 2)

    def test_finds_a_call_where_it_may_not_stand(self):
        self.put("apps/slabs.cpp", "// regionBytes(size)\nsize_t bytes = surface.regionBytes(size) + slabRegionBytes(size);\n")
        self.put("python/raymap/blocks.py", "# region_bytes(dims)\nneeded = _raymap.region_bytes(dims)\n")
        printed = self.assert_found("apps/slabs.cpp:2 calls regionBytes: only include, ", "python/raymap/blocks.py:2 calls region_bytes: only")
        self.assertEqual(len(printed), 3)

    def test_finds_a_room_above_its_budget(self):
        self.edit("src/layers.txt", "\nbase:\n", "\nlines src/odds: 3\nlines src/odds/ends: 2\nbase:\nodds:\n")
        self.put("src/odds/one.h", "\n\n\n")
        self.put("src/odds/ends/two.comp", "\n\n")
        self.put("src/odds/ends/notes.txt", "\n\n\n")  # Not code.
        self.assert_accepted()
        self.put("src/odds/one.h", "\n\n\n\n")
        self.put("src/odds/ends/three.cpp", "\n")
        self.assert_found("src/odds has 4 lines, and its budget in src/layers.txt is 3", "src/odds/ends has 3 lines, and its budget in src/layers.txt is 2")

    def test_finds_a_room_without_a_budget(self):
        self.edit("src/layers.txt", "\nlines src/mesh:", "\n# lines src/mesh:")
        self.assert_found("src/layers.txt: no `lines src/mesh: …` limits this folder")

    def test_finds_private_headers_in_programs(self):
        self.put("apps/main.cpp", '#include "base/memory.h"\n')
        self.put("examples/odds/main.cpp", '#include "base/memory.h"\n')
        self.assert_found("apps/main.cpp:1 includes base/memory.h", "examples/odds/main.cpp:1 includes base/memory.h")


if __name__ == "__main__":
    unittest.main()
