"""Runs the examples of all docstrings, pages and lessons."""

from __future__ import annotations

import doctest
import importlib
import os
import pkgutil
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import raymap
from conftest import ROOT
from pages import run_page, run_test

FOUND = [module.name for module in pkgutil.walk_packages(raymap.__path__, "raymap.")]
MODULES = ["raymap", *(name for name in FOUND if name not in ("raymap._raymap", "raymap.jax", "raymap.torch"))]
LESSONS = sorted(Path(ROOT, "docs/teach").glob("*.md"))
PAGES = ["README.md", "docs/python.md", "docs/datasets.md", "docs/samples.md", "docs/huge_fields.md", "python/README.md"]


@pytest.mark.parametrize("name", MODULES)
def test_docstrings(name: str) -> None:
    module = importlib.import_module(name)
    for test in doctest.DocTestFinder().find(module, name, globs={"raymap": raymap, "np": np}):
        run_test(test)


@pytest.mark.parametrize("page", PAGES)
def test_pages(page: str) -> None:
    shutil.copy("ball.ply", "scan.ply")
    run_page(Path(ROOT, page).read_text(), page)


@pytest.fixture(scope="module")
def shell(tmp_path_factory: pytest.TempPathFactory) -> dict[str, str]:
    """The environment of a user who has installed the program, the library and the package."""
    build = Path(os.environ.get("RAYMAP_BINARY", Path(ROOT, "build/release/bin/raymap"))).parents[1]
    if not Path(build, "cmake_install.cmake").exists():
        pytest.skip("the build tree is not there; name its program in RAYMAP_BINARY")
    prefix = tmp_path_factory.mktemp("installed")
    subprocess.run(["cmake", "--install", build, "--prefix", prefix], check=True, capture_output=True)
    package = Path(raymap.__file__).parents[1]
    paths = (Path(prefix, "bin"), Path(sys.executable).parent, os.environ["PATH"])
    return os.environ | {"PATH": ":".join(map(str, paths)), "PYTHONPATH": str(package), "RAYMAP_CACHE": "off",
                         "CMAKE_PREFIX_PATH": str(prefix), "MPLBACKEND": "agg"}  # fmt: skip


def run_lesson(lesson: Path, shell: dict[str, str], folder: Path) -> str:
    """Runs a lesson in an empty folder. Returns its faults."""
    command = [sys.executable, str(Path(ROOT, "scripts/tutorials.py")), "--here", str(lesson)]
    folder.mkdir()
    done = subprocess.run(command, cwd=folder, env=shell, text=True, check=False, stderr=subprocess.PIPE)
    return done.stderr if done.returncode else ""


@pytest.mark.parametrize("lesson", LESSONS, ids=lambda lesson: lesson.stem)
def test_lessons(lesson: Path, shell: dict[str, str], tmp_path: Path) -> None:
    faults = run_lesson(lesson, shell, tmp_path / "lesson")
    assert not faults, faults


@pytest.mark.parametrize("end, fault", [
    ("```text\nscan.ply: good, ...\n```\n", "prints\nscan.ply: bad"),
    ("", "prints\nscan.ply: bad"),
    ("```text\nscan.ply: bad, ...\n```\n```python\nprint(1 / 0)\n```\n", "ZeroDivisionError"),
    ("```text\nscan.ply: bad, ...\n```\n![A](../images/tutorials/a.png)\n", "does not draw a.png"),
], ids=["another output", "no output", "error", "no picture"])  # fmt: skip
def test_a_wrong_lesson_is_found(end: str, fault: str, shell: dict[str, str], tmp_path: Path) -> None:
    lesson = tmp_path / "lesson.md"
    lesson.write_text("```sh\nraymap example -o scan.ply --holes -q\nraymap check scan.ply || true\n```\n" + end)
    assert fault in run_lesson(lesson, shell, tmp_path / "lesson")


def test_everything_public_has_a_docstring() -> None:
    for name in raymap.__all__:
        value = getattr(raymap, name)
        if not callable(value):
            continue
        assert value.__doc__, name
        for member in vars(value) if isinstance(value, type) else ():
            if not member.startswith("_") and callable(getattr(value, member)):
                assert getattr(value, member).__doc__, f"{name}.{member}"
