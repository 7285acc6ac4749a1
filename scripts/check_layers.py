#!/usr/bin/env python3
"""Checks that every #include points down, by the layers that src/layers.txt declares.

Also: the declared layers have no cycle, every folder of src and every public header belongs to a layer, a public header
to the one whose .cpp files define what it declares (else calls could point up where no include does), only
src/base/parallel.cpp, parallel_sort.h and what uses NanoVDB include oneTBB, and apps/, examples/ and python/ include no private header. Prints
the number of includes that point up or sideways and of cycles between folders, and ends with 1 if there is anything to
mend.

A function that src/layers.txt keeps to some folders is called in these alone.

A module of the Python package imports only the add-ons that src/layers.txt names for it: the package itself none. An add-on
imports what the package offers its users, and of the package's own modules only those that src/layers.txt names for it.

A room, which is a folder of src or another folder of code, has at most as many lines as src/layers.txt grants it.

check_layers.py [ROOT]: ROOT is the source tree, by default the one that this script lies in.
"""

import ast
import re

from source_tree import COMMENT, chosen_root, files, finish, includes, line_at

SOURCES = {".h", ".cpp", ".c", ".comp", ".glsl", ".inl", ".in"}
CODE = SOURCES | {".py", ".sh", ".frag", ".vert", ".js", ".mjs", ".html"}  # Its lines are counted.
OUTSIDE = ("apps", "examples", "python")  # Users of the library, which see its public headers only.
CALLERS = ("src", "include", "apps", "examples", "python/raymap", "python/src")  # Folders whose calls may be kept apart.
# The only files that may include oneTBB. The last two keep NanoVDB to one thread.
TBB = ("src/base/parallel.cpp", "src/base/parallel_sort.h", "src/io/import/import_nvdb.cpp", "src/io/field/nvdb.cpp")
# Made while building.
GENERATED = re.compile(r"shaders/\w+_(spv|all)\.h|vulkan_names\.h|page_text\.h|@SHADER_STEM@\.spv\.inc")

# Declarations of public headers, and the .cpp files that define them.
ARGUMENTS = r"\(((?:[^()]|\([^()]*\))*)\)"
DECLARED_CLASS = re.compile(r"\b(?:class|struct) RAYMAP_API\w* (\w+)[^;]*?\{")
DECLARED_FUNCTION = re.compile(r"\bRAYMAP_API\s[^;{}()]*?\b(\w+)" + ARGUMENTS + r"[^;{()]*;")
DEFINITION = re.compile(r"^\w[^\n;{}()=]*?\b(\w+)" + ARGUMENTS + r"(?: const)?(?: noexcept)?\s*[:{]", re.MULTILINE)
MEMBER = re.compile(r"^\w?[^\n;{}()=]*?\b(\w+)::~?\w+" + ARGUMENTS, re.MULTILINE)


class Layers:
    """Layers as layers.txt declares them."""

    def __init__(self, path):
        self.below = {}  # Layers that each layer may include.
        self.headers = {}  # Layer of each public header.
        self.budgets = {}  # Most lines of each room.
        self.callers = {}  # Folders that may call a function.
        self.addons = {}  # Add-ons of the Python package: the others and the modules of its own that each imports.
        self.problems = []
        for number, line in enumerate(path.read_text().splitlines(), 1):
            line = line.partition("#")[0].strip()
            if not line:
                continue
            name, colon, rest = line.partition(":")
            if not colon:
                self.problems.append(f"{path.name}:{number}: no colon in '{line}'")
            elif name.startswith("lines "):
                self.budgets[name.split()[1]] = int(rest)
            elif name.startswith("calls "):
                self.callers[name.split()[1]] = rest.split()
            elif name.startswith("addon "):
                self.addons[name.split()[1]] = rest.split()
            elif name.startswith("include "):
                self.headers[name.split()[1]] = rest.strip()
            else:
                self.below[name.strip()] = rest.split()
        declared = [layer for layers in self.below.values() for layer in layers] + list(self.headers.values())
        for layer in sorted(set(declared) - set(self.below)):
            self.problems.append(f"{path.name}: '{layer}' is not a layer")
        for cycle in cycles({layer: set(below) for layer, below in self.below.items()}):
            self.problems.append(f"{path.name}: a cycle between {', '.join(cycle)}")

    def of_folder(self, folder):
        """The layer that a folder of src is, or that the folder around it belongs to."""
        while folder and folder not in self.below:
            folder = folder.rpartition("/")[0]
        return folder or None

    def says(self, layer):
        return f"{layer} may include only {', '.join(self.below[layer]) or 'itself'}"


def cycles(graph):
    """The groups of nodes that reach each other (Tarjan's strongly connected components of two nodes and more)."""
    order, low, stack, found = {}, {}, [], []

    def visit(node):
        order[node] = low[node] = len(order)
        stack.append(node)
        for other in sorted(graph.get(node, ())):
            if other not in order:
                visit(other)
                low[node] = min(low[node], low[other])
            elif other in stack:
                low[node] = min(low[node], order[other])
        if low[node] == order[node]:
            group = stack[stack.index(node) :]
            del stack[stack.index(node) :]
            if len(group) > 1 or node in graph.get(node, ()):
                found.append(sorted(group))

    for node in sorted(graph):
        if node not in order:
            visit(node)
    return found


def space(text):
    """The first namespace of a file; none in C."""
    match = re.search(r"^namespace ([\w:]+)", text, re.MULTILINE)
    return match and match[1]


def types(arguments):
    """The types of a function's arguments, without names, default values and spaces."""
    text = re.sub(r"\s*=[^,]*", "", " ".join(arguments.split()))
    return tuple(re.sub(r"(?<=[\s&*>])\w+$", "", each.strip()).replace(" ", "") for each in text.split(","))


def definers(src, layers):
    """The layers whose .cpp files define a function, by its namespace, name and types, or members of a class, by
    its namespace and name."""
    found = {}
    for path in src.rglob("*.cpp"):
        text, layer = path.read_text(), layers.of_folder(path.parent.relative_to(src).as_posix())
        for name, arguments in DEFINITION.findall(text):
            found.setdefault((space(text), name, types(arguments)), set()).add(layer)
        for name, _ in MEMBER.findall(text):
            found.setdefault((space(text), name), set()).add(layer)
    return found


def declared(header):
    """Declarations of a public header: (name, key in `definers`)."""
    text = header.read_text()
    yield from ((name, (space(text), name)) for name in DECLARED_CLASS.findall(text))
    for name, arguments in DECLARED_FUNCTION.findall(text):
        yield name, (space(text), name, types(arguments))


def misplaced(public, src, layers):
    """The public headers that declare what another layer than their own defines."""
    found = definers(src, layers)
    for header, layer in sorted(layers.headers.items()):
        if not (public / header).is_file():
            continue
        for name, key in declared(public / header):
            others = found.get(key, set()) - {layer, *layers.below.get(layer, ())}
            if others:
                yield f"include/raymap/{header} is of the layer {layer}, but {name} is defined in {', '.join(sorted(others))}"


def over_budget(root, budgets):
    """The rooms with more lines than they may have, or without a budget. A file counts in the innermost room around it."""
    rooms = {f"src/{path.name}" for path in (root / "src").iterdir() if path.is_dir()}
    yield from (f"src/layers.txt: no `lines {room}: …` limits this folder" for room in sorted(rooms - set(budgets)))
    lines = dict.fromkeys(budgets, 0)
    for path in files(root, sorted({room.partition("/")[0] for room in budgets}), CODE):
        inside = [room for room in budgets if path.is_relative_to(root / room)]
        if inside:
            lines[max(inside, key=len)] += len(path.read_bytes().splitlines())
    for room, most in budgets.items():
        if lines[room] > most:
            yield f"{room} has {lines[room]} lines, and its budget in src/layers.txt is {most}: make it smaller, or say why it grows"


def misplaced_calls(root, callers):
    """The calls of functions outside of the folders that may call them."""
    for path in files(root, CALLERS, CODE):
        name, text = path.relative_to(root), path.read_text()
        comment = r"#[^\n]*" if path.suffix == ".py" else COMMENT
        for called, folders in callers.items():
            if f"{called}(" not in text or any(name.is_relative_to(folder) for folder in folders):
                continue
            code = re.sub(comment, lambda found: re.sub(r"[^\n]", " ", found[0]), text, flags=re.S)
            yield from (f"{name}:{line_at(code, found.start())} calls {called}: only {', '.join(folders)} may"
                        for found in re.finditer(rf"\b{called}\(", code))


def imported(path, package):
    """What a module of a package imports from it, as (line, parts of the module's name, name)."""
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.ImportFrom) and node.level:
            parts = path.relative_to(package).parts[: -node.level] + tuple(filter(None, (node.module or "").split(".")))
            yield from ((node.lineno, parts or (name.name,), name.name) for name in node.names)


def offered(package):
    """The names that a package offers its users."""
    front = package / "__init__.py"
    found = re.search(r"^__all__ = (\[.*?\])", front.read_text() if front.is_file() else "", re.MULTILINE | re.DOTALL)
    return ast.literal_eval(found[1]) if found else []


def misplaced_imports(root, addons):
    """The imports that src/layers.txt does not let modules have. The package's front and its commands know all."""
    package = root / "python/raymap"
    for path in files(root, ("python/raymap",), {".py"}):
        own = path.relative_to(package).parts[0].removesuffix(".py")
        if own in ("__init__", "__main__"):
            continue
        for line, (module, *_), name in imported(path, package):
            if module == own or module in addons.get(own, ()):
                continue
            if module in addons or (own in addons and name not in offered(package)):
                what = f"the add-on {module}" if module in addons else f"{name} of {module}"
                yield f"{path.relative_to(root)}:{line} imports {what}: src/layers.txt does not let it"


def check(root):
    """Returns what is wrong, the number of includes that point up or sideways, and the cycles between folders."""
    src, public = root / "src", root / "include/raymap"
    layers = Layers(src / "layers.txt")
    problems = list(layers.problems)
    wrong, seen, folders = 0, 0, {}

    def layer_of(path):
        if path.parent == public:
            return layers.headers.get(path.name)
        return layers.of_folder(path.parent.relative_to(src).as_posix())

    for path in files(root, ("src", "include/raymap"), SOURCES):
        name, layer = path.relative_to(root), layer_of(path)
        if layer not in layers.below:
            problems.append(f"{name}: no line of src/layers.txt says which layer this is")
            continue
        for number, target, quoted in includes(path.read_text()):
            if target.startswith("tbb/") and name.as_posix() not in TBB:
                problems.append(f"{name}:{number} includes {target}: only {' and '.join(TBB)} may")
            if target.startswith("raymap/"):
                other = public / target.removeprefix("raymap/")
            elif quoted and not GENERATED.fullmatch(target):
                other = src / target
            else:
                continue
            seen += 1
            if not other.is_file():
                problems.append(f"{name}:{number} includes {target}: no such file; paths begin at src/")
                continue
            target_layer = layer_of(other)
            if target_layer not in layers.below:
                continue  # Reported at that file.
            folders.setdefault(layer, set()).update({target_layer} - {layer})
            if target_layer != layer and target_layer not in layers.below[layer]:
                wrong += 1
                problems.append(f"{name}:{number} includes {target}: {layers.says(layer)}")

    problems += [*misplaced(public, src, layers), *over_budget(root, layers.budgets), *misplaced_calls(root, layers.callers),
                 *misplaced_imports(root, layers.addons)]
    for header in sorted(layers.headers):
        if not (public / header).is_file():
            problems.append(f"src/layers.txt: there is no include/raymap/{header}")
    for layer in layers.below:
        if not (src / layer).is_dir() and layer not in layers.headers.values():
            problems.append(f"src/layers.txt: there is no folder src/{layer}")

    for path in files(root, OUTSIDE, SOURCES):
        for number, target, quoted in includes(path.read_text()):
            if target.startswith("tbb/") or (quoted and not (path.parent / target).is_file()):
                problems.append(f"{path.relative_to(root)}:{number} includes {target}: private to the library")
    return problems, seen, wrong, cycles(folders)


def main():
    problems, seen, wrong, folder_cycles = check(chosen_root())
    problems += [f"a cycle of includes between {', '.join(cycle)}" for cycle in folder_cycles]
    finish(problems, f"{seen} includes, {wrong} of them upward or sideways, {len(folder_cycles)} folder cycles", seen)


if __name__ == "__main__":
    main()
