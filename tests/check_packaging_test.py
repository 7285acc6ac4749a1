#!/usr/bin/env python3
"""Plants faults in files of packages that scripts/check_packaging.py must find."""

import unittest

from planted_tree import PlantedTree


class CheckPackaging(PlantedTree):
    script = "check_packaging.py"

    def setUp(self):
        super().setUp()
        self.copy("packaging", "CMakeLists.txt", "pyproject.toml", "scripts/install.sh", "scripts/aarch64.sh",
                  "scripts/sbom.py")

    def test_accepts_the_tree(self):
        self.assert_accepted()

    def test_finds_another_version(self):
        for path, old in (("packaging/conda/recipe.yaml", "version: 0.1"), ("packaging/vcpkg/vcpkg.json", '"version": "0.1')):
            self.edit(path, old, old.replace("0.1", "7.1"))
            self.assert_found(f"{path.rpartition('/')[2]}: version 7.1")
            self.copy("packaging")

    def test_finds_options_that_do_not_exist(self):
        self.edit("packaging/debian/rules", "-DRAYMAP_BUILD_TESTS", "-DRAYMAP_TESTS")
        self.assert_found("packaging/debian/rules: CMakeLists.txt has no option RAYMAP_TESTS")

    def test_finds_packages_that_nothing_installs(self):
        self.edit("packaging/debian/control", "libpng-dev", "libpng16-dev")
        self.assert_found("packaging/debian/control: scripts/install.sh does not install libpng16-dev")

    def test_finds_what_the_bill_of_materials_lacks(self):
        self.edit("scripts/sbom.py", "pkg:pypi/nanobind", "pkg:pypi/pybind11")
        self.assert_found("scripts/sbom.py: FOREIGN lacks nanobind")

    def test_finds_a_port_that_does_not_run(self):
        self.edit("packaging/vcpkg/portfile.cmake", "../..", "..")
        self.assert_found("portfile.cmake: ")


if __name__ == "__main__":
    unittest.main()
