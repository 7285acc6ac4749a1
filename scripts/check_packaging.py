#!/usr/bin/env python3
"""Fails on a file in packaging/ whose version, options of CMake or packages are not those of CMakeLists.txt and
scripts/install.sh, on a portfile of vcpkg that CMake cannot run, and on a package that wheels are built of and the bill of
materials does not know. check_packaging.py [ROOT]"""

import json
import re
import subprocess
import tempfile
from collections.abc import Iterator

from source_tree import chosen_root, finish

NAME = r"[a-z0-9][a-z0-9.+-]+"
root = chosen_root()
recipe, port = root / "packaging/conda/recipe.yaml", root / "packaging/vcpkg"


def text(path: str) -> str:
    return (root / path).read_text()


def faults() -> Iterator[str]:
    project = text("CMakeLists.txt")
    version = re.search(r"project\(raymap VERSION ([\d.]+)", project)[1]
    versions = {"recipe.yaml": re.search(r"^  version: ([\d.]+)$", recipe.read_text(), re.MULTILINE)[1],
                "vcpkg.json": json.loads((port / "vcpkg.json").read_text())["version"]}
    for name, found in versions.items():
        if found != version:
            yield f"{name}: version {found}, but CMakeLists.txt has {version}"

    options = set(re.findall(r"(?:option|set)\(((?:RAYMAP|BUILD)_\w+)", project))
    for path in ("packaging/conda/recipe.yaml", "packaging/vcpkg/portfile.cmake", "packaging/debian/rules"):
        for option in re.findall(r"-D((?:RAYMAP|BUILD)_\w+)", text(path)):
            if option not in options:
                yield f"{path}: CMakeLists.txt has no option {option}"

    lists = re.sub(r"#.*", "", text("scripts/install.sh").partition("asRoot=")[0])
    control = re.search(r"Build-Depends: debhelper-compat \(= \d+\),(.*?)\n\S", text("packaging/debian/control"), re.DOTALL)[1]
    arm = re.search(r"libraries=\((.*?)\)", text("scripts/aarch64.sh"), re.DOTALL)[1].replace("libstdc++-12-dev", "")
    for path, needed, installed in (("packaging/debian/control", control, lists.partition(")\n")[0]), ("scripts/aarch64.sh", arm, lists)):
        for package in sorted(set(re.findall(NAME, needed)) - set(re.findall(NAME, installed))):
            yield f"{path}: scripts/install.sh does not install {package}"

    requires = re.search(r"^requires = \[(.*)\]$", text("pyproject.toml"), re.MULTILINE)[1]
    for package in set(re.findall(rf'"({NAME})', requires)) - {"scikit-build-core"}:  # A tool
        if f'"pkg:pypi/{package}"' not in text("scripts/sbom.py"):
            yield f"scripts/sbom.py: FOREIGN lacks {package}, of which pyproject.toml builds wheels"

    functions = ("cmake_configure", "cmake_install", "cmake_config_fixup", "fixup_pkgconfig", "install_copyright")
    stubs = "".join(f"function(vcpkg_{name})\nendfunction()\n" for name in functions)
    with tempfile.NamedTemporaryFile("w", suffix=".cmake") as script:
        script.write(f'{stubs}set(CURRENT_PACKAGES_DIR /nowhere)\ninclude("{port.resolve()}/portfile.cmake")\n'
                     'if(NOT EXISTS "${SOURCE_PATH}/CMakeLists.txt")\n  message(FATAL_ERROR "It does not find the tree")\nendif()\n')
        script.flush()
        ran = subprocess.run(["cmake", "-P", script.name], capture_output=True, text=True)
        if ran.returncode:
            yield f"portfile.cmake: {ran.stderr}"


finish(list(faults()), "packaging/ compared with CMakeLists.txt and scripts/install.sh", 1)
