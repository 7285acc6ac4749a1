"""Checks types: the package itself, its stub, a program that uses it, and the lines of docs that users copy."""

from __future__ import annotations

import doctest
import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
import raymap
from conftest import ROOT
from helpers import load
from pages import code_of
from test_coming_from import BLOCKS
from test_docs import PAGES

PACKAGE = Path(raymap.__file__).parent
PROGRAM = Path(__file__).with_name("typed_program.py")


@pytest.mark.parametrize("checked", [PACKAGE, PROGRAM], ids=["package", "program"])
def test_types(checked: Path, tmp_path: Path) -> None:
    found = subprocess.run(
        [sys.executable, "-m", "mypy", "--strict", "--allow-any-generics", "--cache-dir", str(tmp_path), str(checked)],
        capture_output=True,
        text=True,
        env={**os.environ, "MYPYPATH": str(PACKAGE.parent)},
        check=False,
    )
    assert found.returncode == 0, found.stdout + found.stderr


# The blocks of docs/coming_from.md use these names.
NAMES = """import numpy as np
import raymap
vertices, faces, points = np.zeros((3, 3)), np.zeros((1, 3), np.int32), np.zeros((5, 3))
"""


def test_pyright_accepts_the_program_and_the_pages(tmp_path: Path) -> None:
    load("pyright")
    shutil.copy(PROGRAM, tmp_path)
    for page in PAGES:
        code = code_of(Path(ROOT, page).read_text(), page)
        program = doctest.script_from_examples(code) if ">>>" in code else code
        (tmp_path / f"{page.replace('/', '-')}.py").write_text(program)
    for package, block in BLOCKS.items():
        (tmp_path / f"coming_from-{package}.py").write_text(NAMES + block)
    ran = subprocess.run(
        [sys.executable, "-m", "pyright", "--outputjson", "--pythonpath", sys.executable, str(tmp_path)],
        capture_output=True,
        text=True,
        check=False,
    )
    found = json.loads(ran.stdout)
    assert found["summary"]["filesAnalyzed"] == 1 + len(PAGES) + len(BLOCKS)
    errors = [error for error in found["generalDiagnostics"] if error["severity"] == "error" and is_ours(error)]
    assert not errors, errors


def is_ours(error: dict) -> bool:
    """Tells errors of our lines from those of other packages, whose types docs/coming_from.md cannot mend."""
    file = Path(error["file"])
    line = file.read_text().splitlines()[error["range"]["start"]["line"]]
    return not file.name.startswith("coming_from") or "raymap" in line


def test_the_program_runs(tmp_path: Path) -> None:
    ran = subprocess.run([sys.executable, str(PROGRAM)], capture_output=True, text=True, check=False)
    assert ran.returncode == 0, ran.stderr


def test_the_package_is_marked_as_typed() -> None:
    assert (PACKAGE / "py.typed").exists() and (PACKAGE / "_raymap.pyi").exists()
