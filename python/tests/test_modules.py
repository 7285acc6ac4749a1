"""Modules of the package import each other without circles, and keep their private names to themselves."""

from __future__ import annotations

import ast
import graphlib
from collections.abc import Iterator
from pathlib import Path

import pytest
import raymap


class Module:
    """A module of a package, and what is wrong with it by itself."""

    def __init__(self, name: str, is_package: bool, source: str, modules: set[str]) -> None:
        self.name, self.modules, self.tree = name, modules, ast.parse(source)
        self.package = name if is_package else name.rpartition(".")[0]
        self.classes = {node.name for node in ast.walk(self.tree) if isinstance(node, ast.ClassDef)}
        self.foreign = {
            (alias.asname or alias.name).partition(".")[0]
            for node in ast.walk(self.tree)
            if isinstance(node, ast.Import)
            for alias in node.names
        }

    def imported(self, node: ast.AST) -> dict[str, str]:
        """Returns the modules of the package that a statement imports, by the names that it imports of them."""
        if isinstance(node, ast.Import):
            return {alias.name: alias.name for alias in node.names if alias.name in self.modules}
        if not isinstance(node, ast.ImportFrom):
            return {}
        above = self.package.split(".")[: 1 - node.level or None] if node.level else []
        source = ".".join([*above, *filter(None, [node.module])])
        if source not in self.modules:
            return {}
        inner = {alias.name: f"{source}.{alias.name}" for alias in node.names}
        return {name: path if path in self.modules else source for name, path in inner.items()}

    def imports(self) -> set[str]:
        return {module for node in ast.walk(self.tree) for module in self.imported(node).values()}

    def faults(self) -> Iterator[str]:
        for line, fault in sorted(set(self._faults(self.tree, frozenset(), False))):
            yield f"{self.name}:{line}: {fault}"

    def _faults(self, node: ast.AST, own: frozenset[str], is_inside: bool) -> Iterator[tuple[int, str]]:
        """Yields faults. `own` are the names of values whose class is one of this module."""
        if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef)):
            own, is_inside = own | self._values(node), True
        for name, module in self.imported(node).items():
            if is_inside:
                yield node.lineno, f"imports {module} in a function"
            if is_private(name) and not module.endswith(f".{name}"):
                yield node.lineno, f"uses {name} of {module}"
        if isinstance(node, ast.Attribute) and is_private(node.attr):
            base = node.value
            mine = own | self.classes | self.foreign | {"self", "cls"}
            if not (isinstance(base, ast.Name) and base.id in mine):
                yield node.lineno, f"uses {ast.unparse(node)}"
        for child in ast.iter_child_nodes(node):
            yield from self._faults(child, own, is_inside)

    def _values(self, function: ast.FunctionDef | ast.AsyncFunctionDef) -> set[str]:
        """Returns a function's arguments and variables that are declared to be, or made, of a class of this module."""
        arguments = [*function.args.posonlyargs, *function.args.args, *function.args.kwonlyargs]
        own = self.classes | {"Self"}
        found = {a.arg for a in arguments if isinstance(a.annotation, ast.Name) and a.annotation.id in own}
        for node in ast.walk(function):
            if isinstance(node, ast.Assign) and isinstance(node.value, ast.Call):
                maker = node.value.func
                of = maker.value if isinstance(maker, ast.Attribute) and maker.attr == "__new__" else maker
                if isinstance(of, ast.Name) and of.id in self.classes | {"cls"}:
                    found |= {target.id for target in node.targets if isinstance(target, ast.Name)}
        return found


def is_private(name: str) -> bool:
    return name.startswith("_") and not name.endswith("__")


def faults(folder: Path) -> list[str]:
    """Returns what is wrong with the modules of a package."""
    paths = {
        ".".join(path.relative_to(folder.parent).with_suffix("").parts).removesuffix(".__init__"): path
        for path in sorted(folder.rglob("*.py"))
    }
    known = {*paths, f"{folder.name}._raymap"}  # The extension module has no source here.
    modules = [Module(name, path.stem == "__init__", path.read_text(), known) for name, path in paths.items()]
    found = [fault for module in modules for fault in module.faults()]
    try:
        graphlib.TopologicalSorter({module.name: module.imports() for module in modules}).prepare()
    except graphlib.CycleError as error:
        found.append(f"a circle of imports: {' <- '.join(error.args[1])}")
    return found


def test_the_package_has_no_faults() -> None:
    assert faults(Path(raymap.__file__).parent) == []


@pytest.mark.parametrize(
    "source, fault",
    [
        ("from . import a", "a circle of imports: p.a <- p.b <- p.a"),
        ("from .a import A", "a circle of imports: p.a <- p.b <- p.a"),
        ("import p.a", "a circle of imports: p.a <- p.b <- p.a"),
        ("def f():\n    from .deep import c", "p.b:2: imports p.deep.c in a function"),
        ("from .deep.c import _hidden", "p.b:1: uses _hidden of p.deep.c"),
        ("from .deep import c\nc._hidden()", "p.b:2: uses c._hidden"),
        ("from .deep.c import C\ndef f(given: C): return given._core", "p.b:2: uses given._core"),
        ("class B:\n    def f(self, given): return self._core or given._core", "p.b:2: uses given._core"),
    ],
)
def test_faults_are_found(source: str, fault: str, tmp_path: Path) -> None:
    assert fault in faults(package(tmp_path, source))


@pytest.mark.parametrize(
    "source",
    [
        "from .deep import c\nfrom .deep.c import C",
        "from . import _raymap\nfrom ._raymap import version as _version",
        "import sys\nsys._getframe()",
        "class B:\n    def f(self): return self._core",
        "class B: pass\ndef f(given: B): return given._core",
        "class B: pass\ndef f():\n    made = B.__new__(B)\n    made._core = 1",
        "def f(given): return given.__class__",
    ],
)
def test_what_is_right_is_no_fault(source: str, tmp_path: Path) -> None:
    assert faults(package(tmp_path, source)) == []


def package(folder: Path, source: str) -> Path:
    """Makes the package p, whose module p.b has this source."""
    made = folder / "p"
    (made / "deep").mkdir(parents=True)
    (made / "__init__.py").touch()
    (made / "a.py").write_text("from .b import *\n")
    (made / "b.py").write_text(source)
    (made / "deep/__init__.py").touch()
    (made / "deep/c.py").touch()
    return made
