"""Counts the examples of pages for users that CI runs, and compiles those in C++ that nothing runs."""

from __future__ import annotations

import re
import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest
from conftest import ROOT
from test_coming_from import BLOCKS
from test_docs import PAGES

FENCED = r"^```(\w*)\n(.*?)^```"
INDENTED = r"(?<=\n\n)((?: {4}\w.*\n)+)"
COMPILED = ["docs/api.md", "docs/coming_from.md", "docs/points.md", "docs/vulkan.md"]
LESSONS = sorted(str(page.relative_to(ROOT)) for page in [*ROOT.glob("docs/teach/*.md"), *ROOT.glob("docs/tutorials/*.md")])
README_TEST = (ROOT / "tests/apps/readme_test.py").read_text()
SHELL = ["README.md", *(f"docs/{name}" for name in re.findall(r'"(\w+\.md)"', README_TEST))]
# Other examples by their beginnings: the script that runs them, or the reason why none does.
RUN = {
    "#include <raymap/raymap.h>": "scripts/check_install.sh",
    "find_package": "scripts/check_install.sh",
    "c++ -std": "scripts/check_install.sh",
    "python -m raymap dataset FOLDER -o OUT --resolution": "python/tests/use_wheel.py",
}
NOT_RUN = {
    "raymap::MeshView eigen": "one name of three libraries",
    "vec3 uvw": "lines of a shader",
    "export PATH": "builds anew",
    "pip install '.[zarr,dask]'": "8192 samples",
    "python -m raymap field": "a cluster",
    "pip install 'raymap[dask]'": "a cluster",
    "raymap generate man.glb": "an animated mesh that is not ours",
    "build/release/bin/raymap_animated": "an animated mesh that is not ours",
    "scripts/bench.sh": "an hour",
    "python3 -m venv wild": "hours",
    "numpy ": "programs that are not ours",
}
DECLARED = """#include <Eigen/Core>
#include <openvdb/openvdb.h>
#include <raymap/raymap.h>
#include <raymap/vulkan.h>
raymap::Mesh mesh;
raymap::Grid grid;
raymap::QueryResult result;
extern raymap::Surface surface, hand, shelf, scan, cad;
std::vector<glm::dvec3> points;
std::vector<Eigen::Vector3d> eigens;
std::vector<glm::dmat4> poses;
glm::dmat4 pose, later;
glm::dvec3 v;
VkInstance instance; VkPhysicalDevice physicalDevice; VkDevice device; uint32_t queueFamily; VkQueue queue;
VkCommandBuffer commandBuffer; VkBuffer vertexBuffer, indexBuffer; VkImage image;
bool report(std::string_view stage, double done = 0);
"""


def examples() -> Iterator[tuple[str, str, str]]:
    """Yields page, language and code of each example of README, docs/ without docs/dev, and examples/."""
    paths = [ROOT / "README.md", ROOT / "python/README.md", *ROOT.glob("docs/*.md"), *ROOT.glob("examples/*/*.md")]
    for page in sorted(str(path.relative_to(ROOT)) for path in paths) + LESSONS:
        text = (ROOT / page).read_text()
        for language, code in re.findall(FENCED, text, re.MULTILINE | re.DOTALL):
            several = (page, language) == ("docs/coming_from.md", "python")
            if language != "text" and not several:
                yield page, language, code
        for code in re.findall(INDENTED, text):
            yield page, "", code.replace("    ", "")
    yield from (("docs/coming_from.md", "python", block) for block in BLOCKS.values())


def is_run(page: str, language: str, code: str) -> bool:
    if language == "glsl" or code.startswith(tuple(NOT_RUN)):
        return False
    if page in LESSONS or code.startswith(tuple(RUN)):
        return True
    return page in {"python": [*PAGES, "docs/coming_from.md"], "cpp": COMPILED}.get(language, SHELL)


def test_every_example_runs_or_says_why() -> None:
    found = list(examples())
    left = [(page, code) for page, language, code in found if not is_run(page, language, code)]
    unknown = [each for each in left if not each[1].startswith(tuple(NOT_RUN))]
    assert not unknown, f"nothing runs {unknown}"
    unused = [start for start in {**RUN, **NOT_RUN} if not any(code.startswith(start) for _, _, code in found)]
    assert not unused, f"no example begins with {unused}"
    sentence = f"Pages for users have {len(found)} examples. CI runs {len(found) - len(left)} of them"
    assert sentence in " ".join((ROOT / "docs/dev/release.md").read_text().split()), sentence


def test_cpp_compiles(tmp_path: Path) -> None:
    if not Path("/usr/include/eigen3").exists() or not Path("/usr/include/openvdb").exists():
        pytest.skip("Eigen or OpenVDB is not installed")
    found = [each for each in examples() if each[1] == "cpp" and each[0] in COMPILED and is_run(*each)]
    assert len(found) == 7
    functions = [f"void example{k}() {{ // {page}\n{code}}}\n" for k, (page, _, code) in enumerate(found)]
    source = tmp_path / "examples.cpp"
    source.write_text(DECLARED + re.sub(r"^#include.*\n", "", "".join(functions), flags=re.MULTILINE))
    command = ["c++", "-std=c++20", "-fsyntax-only", "-I", ROOT / "include", "-I", "/usr/include/eigen3", source]
    done = subprocess.run(command, text=True, check=False, stderr=subprocess.PIPE)
    assert done.returncode == 0, done.stderr
