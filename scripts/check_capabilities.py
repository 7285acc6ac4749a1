#!/usr/bin/env python3
"""Checks docs/capabilities.md, which says what of Raymap each of its four interfaces offers.

Each row of the page's tables is a feature. Its cells name, in `backticks`, what offers it:

- C++: a name of include/raymap in the namespace raymap, such as `readMesh`, `Surface::query` or `Options::band`.
- C: a name of raymap/c.h, such as `raymap_repair` or `raymap_view::cut`, or an option that is set by its name: `"band"`.
- Python: a name of the package raymap: `load_mesh`, `Field.sample`, `torch.signed_distance`, or an argument: `info(fast)`.
- Command line: `raymap info`, with an option that this command has: `raymap info --fast`.

A cell without any is a dash and the number of a reason in the list at the end of the page: `- (2)`.

Prints each name that does not exist, each cell that is empty without a reason, and each public name that no row mentions:
functions and methods of C++, functions of C, names of `raymap.__all__`, commands. Ends with 1 if there is any.
scripts/records.py lists all options in docs/options.md.

check_capabilities.py [ROOT]: ROOT is the source tree, by default the one that this script lies in.
"""

import ast
import re

from source_tree import COMMENT, chosen_root, commands, finish

PAGE = "docs/capabilities.md"
OPTIONS_PAGE, OPTIONS_COLUMNS = "docs/dev/option_table.md", 5
COLUMNS = ("C++", "C", "Python", "Command line")
COMMENT_OR_DIRECTIVE = re.compile(COMMENT + r"|^[ \t]*#(?:\\\n|[^\n])*", re.S | re.M)
SCOPE = re.compile(r"\b(namespace|class|struct|union|enum(?: class)?)\s+(?:RAYMAP_\w+\s+)?([\w:]*)(?!.*\b(?:class|struct)\b)[^()]*$",
                   re.S)


def declarations(text):
    """Yields (scope, kind, declaration) for each declaration of a header that is not private. The scope is the name of
    the namespace and class around it, and the kind that of the innermost: "namespace", "exported class", "struct", ..."""
    text = COMMENT_OR_DIRECTIVE.sub("", text)
    scopes = [("", "namespace", True)]  # Name, kind, and whether its members are public.
    start = position = 0
    while position < len(text):
        char = text[position]
        name, kind, is_public = scopes[-1]
        if char in ";{}" or (char == "," and kind == "enum"):
            found = text[start:position]
            for label in re.findall(r"\b(public|private|protected)\s*:(?!:)", found):
                is_public = label == "public"
            scopes[-1] = name, kind, is_public
            found = re.sub(r"\b(?:public|private|protected)\s*:(?!:)", "", found).strip()
            if found and is_public:
                yield name, kind, found
            if char == "{":
                match = SCOPE.search(found)
                if match or found.endswith('extern "C"'):
                    inner, kind = (match[2], match[1].split()[0]) if match else ("", "namespace")
                    scopes.append(("::".join(filter(None, (name, inner))),
                                   "exported class" if "RAYMAP_API" in found else kind, kind != "class"))
                else:  # The body of a function, or the value of a variable.
                    depth = 1
                    while depth:
                        position += 1
                        depth += {"{": 1, "}": -1}.get(text[position], 0)
            elif char == "}" and len(scopes) > 1:
                scopes.pop()
            start = position + 1
        position += 1


def without_templates(text):
    """Returns a declaration without its lists in angle brackets."""
    while (shorter := re.sub(r"<[^<>]*>", "", text)) != text:
        text = shorter
    return text


def functions(declaration):
    """Returns the name of the function that a declaration declares, as a list; empty if it declares none."""
    match = re.search(r"(~?\w+)\s*\(", without_templates(declaration).split("=")[0])
    if not match or "operator" in declaration or match[1].isupper() or match[1] in ("static_assert", "requires"):
        return []
    return [match[1]]


def names(declaration):
    """Returns all names that a declaration declares."""
    text = without_templates(declaration)
    if "operator" in text:
        return []
    if match := re.match(r"using (\w+)", text):
        return [match[1]]
    if match := SCOPE.search(text):
        return [match[2]]
    return functions(text) or [found[1] for part in text.split(",")
                               if (found := re.search(r"(\w+)\s*(?:\[[^\]]*\]\s*)*(?:=.*)?$", part, re.S))]


class Headers:
    """The names that headers declare: all, and those that a row must mention."""

    def __init__(self, paths, is_c):
        self.all, self.wanted = set(), set()
        for path in paths:
            for scope, kind, declaration in declarations(path.read_text()):
                scope = re.sub(r"^raymap(?:::|$)", "", scope)
                self.all |= {"::".join(filter(None, (scope, name))) for name in names(declaration)}
                within = scope.split("::")[-1]
                called = [] if declaration.startswith(("using", "typedef")) else functions(declaration)
                if is_c or kind == "namespace":
                    self.wanted |= {"::".join(filter(None, (scope, name))) for name in called}
                elif kind == "exported class" or "RAYMAP_API" in declaration:
                    self.wanted |= {f"{scope}::{name}" for name in called if name.lstrip("~") != within}


class Package:
    """The names of the Python package, by its source."""

    def __init__(self, folder):
        self.modules, self.known = {}, {}
        for path in sorted(folder.rglob("*.py")):
            tree = ast.parse(path.read_text())
            module = ".".join(path.relative_to(folder).with_suffix("").parts).removesuffix(".__init__").removesuffix("__init__")
            self.modules[module] = {node.name: node for node in tree.body if hasattr(node, "name")}
            for name, node in self.modules[module].items():
                if not isinstance(node, ast.FunctionDef) or not node.decorator_list:  # Not an overload.
                    self.known.setdefault(name, node)
        root = ast.parse((folder / "__init__.py").read_text()) if (folder / "__init__.py").exists() else ast.Module([], [])
        self.wanted = {name for node in root.body if isinstance(node, ast.Assign)
                       and getattr(node.targets[0], "id", "") == "__all__" for name in ast.literal_eval(node.value)}

    def node(self, name):
        """Returns the definition of a function or class, or a method of one; None if there is none."""
        first, _, rest = name.partition(".")
        if rest and first in self.modules:
            return self.modules[first].get(rest)
        node = self.known.get(first)
        return self.member(node, rest) if rest else node

    def member(self, node, name):
        """Returns what defines a member of a class, or of a class that it builds on; None if nothing does."""
        for each in getattr(node, "body", ()):
            if name == getattr(each, "name", getattr(getattr(each, "target", None), "id", None)):
                return each
        bases = [self.known.get(getattr(base, "id", "")) for base in getattr(node, "bases", ())]
        return next(filter(None, (self.member(base, name) for base in bases if base)), None)

    def has_argument(self, node, name):
        if isinstance(node, ast.ClassDef):
            node = self.member(node, "__init__")
        if not isinstance(node, ast.FunctionDef):
            return False
        arguments = node.args
        if any(name == each.arg for each in arguments.args + arguments.kwonlyargs):
            return True
        options = re.search(r"Unpack\[(\w+)\]", ast.unparse(arguments.kwarg.annotation or ast.Constant(""))) if arguments.kwarg else None
        return bool(options and self.member(self.known.get(options[1]), name))

    def has(self, name):
        match = re.fullmatch(r"([\w.]+)(?:\((\w+)\))?", name)
        if not match:
            return False
        first = match[1].partition(".")[0]
        if first not in self.wanted and first not in self.modules:
            return False
        node = self.node(match[1])
        if match[2]:
            return self.has_argument(node, match[2])
        return bool(node) or match[1] in self.wanted


class Program:
    """The commands of the program, by its source, and their options, by docs/dev/option_table.md. A test compares that page with
    the program."""

    def __init__(self, root):
        text = "\n".join(path.read_text() for path in sorted((root / "apps").glob("*.cpp")))
        self.wanted = {f"raymap {name}" for name in commands(root)}
        flags = re.findall(r'entry\("(-\w, --\w+)"', text)
        self.commands = {flag: {"raymap"} for names in flags for flag in names.split(", ")}  # "all" stands for all.
        for _, cells in rows((root / OPTIONS_PAGE).read_text()):
            for option in re.findall(r"`(-[\w-]+)`", " ".join(cells[:2])) if len(cells) == OPTIONS_COLUMNS else ():
                self.commands[option] = set(cells[-1].split(", "))

    def has(self, name):
        command, *options = re.split(r" (?=-)", name)
        users = {"all" if command in self.wanted else "raymap", command.removeprefix("raymap ")}
        return command in self.wanted | {"raymap"} and all(users & self.commands.get(option, set()) for option in options)


def named_options(root):
    path = root / "include/raymap/named_options.h"
    return {f'"{name}"' for name in re.findall(r'OptionName\{"(\w+)"', path.read_text())} if path.exists() else set()


def rows(text):
    """Yields the line number and the cells of each row of a table."""
    for number, line in enumerate(text.splitlines(), 1):
        cells = [cell.strip() for cell in re.split(r"(?<!\\)\|", line.strip().strip("|"))]
        if line.startswith("|") and not re.fullmatch(r"[-:| ]+", line) and tuple(cells[1:]) != COLUMNS:
            yield number, cells


def check(root):
    """Returns the number of rows and what is wrong with the page."""
    page = (root / PAGE).read_text()
    public = root / "include/raymap"
    headers = Headers((path for path in sorted(public.glob("*.h")) if path.name != "c.h"), is_c=False)
    c = Headers([public / "c.h"] if (public / "c.h").exists() else [], is_c=True)
    package, program, options = Package(root / "python/raymap"), Program(root), named_options(root)
    exists = (headers.all.__contains__, lambda name: name in c.all or name in options, package.has, program.has)
    wanted = (headers.wanted, c.wanted, package.wanted, program.wanted)
    reasons = set(re.findall(r"^(\d+)\. ", page, re.M))
    mentioned, problems, count = [set() for _ in COLUMNS], [], 0
    for number, (feature, *cells) in rows(page):
        count += 1
        if len(cells) != len(COLUMNS):
            problems.append(f"{PAGE}:{number}: {feature} has {len(cells)} cells instead of {len(COLUMNS)}")
        for column, cell in enumerate(cells[:len(COLUMNS)]):
            where = f"{PAGE}:{number}: {feature}, {COLUMNS[column]}"
            symbols = re.findall(r"`([^`]+)`", cell)
            for symbol in symbols:
                mentioned[column] |= {symbol, symbol.partition(" -")[0], symbol.partition("(")[0], symbol.partition(".")[0]}
                if not exists[column](symbol):
                    problems.append(f"{where}: there is no {symbol}")
            reason = re.fullmatch(r"– \((\d+)\)", cell)
            if not symbols and not reason:
                problems.append(f"{where}: is empty; name what offers it, or write – and the number of a reason: – (1)")
            elif reason and reason[1] not in reasons:
                problems.append(f"{where}: there is no reason {reason[1]}")
    for column, names in enumerate(wanted):
        problems += [f"{PAGE}: no row mentions {name} ({COLUMNS[column]})" for name in sorted(names - mentioned[column])]
    return count, problems


def main():
    count, problems = check(chosen_root())
    finish(problems, f"{count} features, {len(problems)} faults", count)


if __name__ == "__main__":
    main()
