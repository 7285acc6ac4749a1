#!/usr/bin/env python3
"""Writes what is made of the one description of options.

include/raymap/named_options.h names the options of each struct. Their types, defaults and texts stand at the members in the
other public headers. Made of them: docs/options.md, src/describe/option_texts.cpp, and in the Python package the texts of
arguments in docstrings and the arguments that functions lack.

options.py writes all; options.py --check fails where they differ, where an argument of Python has another default, and
where the bindings of C or Python name an option. A folder as last argument is another tree.
"""

import ast
import re
import sys
import textwrap

from records import ROOT, all_structs, enums, finish, snake, within

TABLE, TEXTS = ROOT / "docs/options.md", ROOT / "src/describe/option_texts.cpp"
PACKAGE = ROOT / "python/raymap"
TEXTS_HEAD = """// Texts of all options. scripts/options.py writes this file from raymap/named_options.h.

#include <raymap/named_options.h>

#include <array>

namespace raymap {

// clang-format off
"""
# Functions of Python with the options of these structs. Arguments after a colon have a form of their own there, or none.
FUNCTIONS = """
_generate.py generate GridOptions FieldOptions MachineOptions: resolution bounds shape band thickness triangle winding confidence
_repair.py repair GridOptions RepairOptions MachineOptions: resolution shape bounds padding thickness align measure cut_plane
_repair.py simplify SimplifyOptions MachineOptions: tolerance device memory_limit
_surface.py Surface SurfaceOptions MachineOptions: sign threshold device
_field.py Field.render RenderOptions MachineOptions: cut_plane slice_plane frame array range memory_limit
"""
TYPES = {"generate": "SurfaceFieldOptions"}  # The arguments that other functions hand on.
ZEROS = ("offset", "shell", "drain_hole", "iso")  # Lengths whose default is 0 in Python, too.
# Names of results, which options have too.
RESULTS = {"array", "bounds", "confidence", "direction", "distance", "inside", "outside", "thickness", "triangle", "winding"}
# Ranges of numbers, in words.
RANGES = {"": "", "kFromZero": "0 or more", "kAboveZero": "above 0", "kFromOne": "1 or more", "kLimit": "above 0, or infinite",
          "{0.0, false, true}": "0 or more, or infinite"}
PYTHON_TYPES = {"bool": "bool", "int": "int", "size_t": "int", "uint64_t": "int", "double": "float", "std::string": "str",
                "glm::dvec3": "Vector"}


class Option:
    def __init__(self, name, unit, limits, kind, default, text):
        self.name, self.unit, self.range, self.text = name, unit, RANGES[limits], text
        found = re.fullmatch(r"std::optional<(.+)>", kind)
        self.kind = found[1] if found else kind
        self.default = None if found else self.value(default.strip())

    def value(self, default):
        """Returns a default of C++ as one of Python; None for none and for no limit."""
        if default in ("true", "false"):
            return default == "true"
        if "infinity" in default or default in ("", "{}"):
            return None
        if text := re.fullmatch(r'"(.*)"', default):
            return text[1]
        if enum := re.fullmatch(r"\w+::(\w+)", default):
            return snake("::" + enum[1])
        numbers = [float(number) for number in default.replace("'", "").strip("{}").split(",")]
        numbers = [int(number) if number == int(number) and self.kind != "double" else number for number in numbers]
        return numbers[0] if len(numbers) == 1 and not self.kind.startswith("std::vector") else tuple(map(float, numbers))

    @property
    def python_default(self):
        """Returns the default in Python, where None stands for a length of 0 and for no number."""
        is_none = self.default == 0 and self.default is not False and self.name not in ZEROS
        return None if is_none else self.default

    @property
    def python_type(self):
        return PYTHON_TYPES.get(self.kind, self.kind) + (" | None" if self.python_default is None else "")

    @property
    def shown_default(self):
        if isinstance(self.default, bool):
            return "yes" if self.default else "no"
        if isinstance(self.default, tuple):
            return ", ".join(f"{number:g}" for number in self.default)
        return "" if self.default is None else f"{self.default:g}" if isinstance(self.default, float) else str(self.default)

    def python_text(self, values):
        """Returns the text as docstrings have it: None for what is not given, values in quotes."""
        text = self.text
        if self.python_default is None and self.default is not None:
            text = re.sub(r"([;,]) 0 = ", r"\1 None = ", text)
        text = text.replace("Unset: ", "None: ")
        quoted = lambda found: f'``"{found[1]}"``' if found[1] in values or ":" in found[1] else f"``{found[1]}``"
        return re.sub(r"`([^`]+)`", quoted, text).replace("``default_threads``", "``raymap.get_threads()``")


def options():
    """Returns the options of each struct, by its name."""
    structs = all_structs()
    header = (ROOT / "include/raymap/named_options.h").read_text()
    bodies = re.findall(r"^void forEachOption\(OptionsOf<(\w+)> auto& options.*?\{\n(.*?)\n\}", header, re.DOTALL | re.MULTILINE)
    rows, names = {}, {}  # Names of members: what C++ calls box is the option bounds.
    for struct, body in bodies:
        rows[struct] = re.findall(r'use\(OptionName\{"(\w+)"(?:, "([^"]*)"(?:, ([^)]+?))?)?\}, options\.(\w+)\);', body)
        assert len(rows[struct]) == body.count("use("), f"an option of {struct} cannot be read"
        names |= {member: name for name, *_, member in rows[struct]}
    result = {}
    for struct in rows:
        result[struct] = []
        for name, unit, limits, member in rows[struct]:
            kind, text = structs[struct].members[member]
            assert text, f"the option {name} of {struct} has no comment"
            text = re.sub(r"`(?:\w+::)?(\w+)`", lambda named: f"`{names.get(named[1]) or snake(named[1])}`", text)
            result[struct].append(Option(name, unit, limits, kind, structs[struct].defaults[member], text))
    return result


def first_options(all_options):
    """Returns each option once, as the first struct has it, by name."""
    return {row.name: row for rows in reversed(all_options.values()) for row in reversed(rows)}


def table(all_options):
    homes = {}
    for struct, rows in all_options.items():
        for row in rows:
            homes.setdefault(row.name, []).append(f"`{struct}`")
    text = "\n| option | value | range | default | meaning | structs |\n|---|---|---|---|---|---|\n"
    for name, row in sorted(first_options(all_options).items()):
        meaning = row.text.replace("|", "\\|")
        text += f"| `{name}` | {row.unit} | {row.range} | {row.shown_default} | {meaning} | {', '.join(homes[name])} |\n"
    return text + "\n"


def texts(all_options):
    found = sorted(first_options(all_options).items())
    text = TEXTS_HEAD + f"constexpr std::array<OptionText, {len(found)}> kTexts{{{{\n"
    for name, row in found:
        lines = textwrap.wrap(row.text.replace('"', '\\"'), 98, break_on_hyphens=False)
        joined = " \"\n     \"".join(lines)
        text += f'    {{"{name}",\n     "{joined}"}},\n'
    return text + "}};\n// clang-format on\n\nstd::span<const OptionText> optionTexts() {\n  return kTexts;\n}\n\n}  // namespace raymap\n"


def definition(tree, name):
    """Returns the last definition of a function or class, after its overloads, and the function with its arguments."""
    node = tree
    for part in name.split("."):
        node = [each for each in node.body if getattr(each, "name", None) == part][-1]
    inner = [each for each in getattr(node, "body", ()) if getattr(each, "name", None) == "__init__"]
    return node, inner[0] if inner else node


def before_progress(source, line, more):
    """Returns the source with more lines before the first one from a line on that describes `progress`."""
    lines = source.splitlines(keepends=True)
    at = next(k for k in range(line, len(lines)) if lines[k].strip().startswith("progress: "))
    space = lines[at][: len(lines[at]) - len(lines[at].lstrip())]
    return "".join(lines[:at] + [f"{space}{each}\n" for each in more] + lines[at:])


def with_texts(source, function, rows, values):
    """Returns the source with the texts of arguments that are options, and with those that the function lacks."""
    node, function_node = definition(ast.parse(source), function)
    arguments = function_node.args
    given = {each.arg: default for each, default in zip(arguments.kwonlyargs, arguments.kw_defaults)}
    for name in given.keys() & rows.keys():
        default = ast.literal_eval(given[name])
        if default != rows[name].python_default:
            raise SystemExit(f"{function}: the default of {name} is {default!r}, not {rows[name].python_default!r}")
    missing = [row for name, row in rows.items() if name not in given]
    source = before_progress(source, function_node.lineno, [
        f"{row.name}: {row.python_type} = {row.python_default!r},".replace("'", '"') for row in missing])
    if function in TYPES:
        node, _ = definition(ast.parse(source), TYPES[function])
        source = before_progress(source, node.lineno, [f"{row.name}: {row.python_type}" for row in missing])
    node, _ = definition(ast.parse(source), function)
    source = before_progress(source, node.body[0].lineno, [f"{row.name}: ." for row in missing])
    indent = " " * (node.body[0].col_offset + 4)
    node, _ = definition(ast.parse(source), function)
    start, end = node.body[0].lineno - 1, node.body[0].end_lineno
    lines = source.splitlines(keepends=True)
    doc = "".join(lines[start:end])
    for name, row in rows.items():
        wanted = textwrap.fill(f"{name}: {row.python_text(values)}", 120, initial_indent=indent, subsequent_indent=indent + "    ",
                               break_on_hyphens=False)
        doc = re.sub(rf"^{indent}{name}: .*(?:\n{indent}    .*)*", lambda _: wanted, doc, count=1, flags=re.MULTILINE)
    return "".join(lines[:start]) + doc + "".join(lines[end:])


def python_files(all_options):
    """Returns the text of each file of the package that has functions with options."""
    values = {value for names in enums().values() for value in names} | {"cpu", "vulkan"}
    made = {}
    for line in FUNCTIONS.strip().splitlines():
        (file, function, *structs), own = line.partition(":")[0].split(), line.partition(":")[2].split()
        rows = {row.name: row for struct in structs for row in all_options[struct] if row.name not in own}
        path = PACKAGE / file
        made[path] = with_texts(made.get(path) or path.read_text(), function, rows, values)
    return made


def strays(all_options):
    """Returns the places in the bindings of C and Python that name an option themselves."""
    names = "|".join(first_options(all_options).keys() - RESULTS)
    found = []
    for path in sorted((*ROOT.glob("src/c_api/*.cpp"), *ROOT.glob("python/src/*.cpp"))):
        for number, line in enumerate(path.read_text().splitlines(), 1):
            if name := re.search(rf'"({names})"(?!_a)', line):
                found.append(f"{path.relative_to(ROOT)}:{number}: names the option {name[1]}; setOption knows it")
    return found


def main():
    all_options = options()
    if faults := strays(all_options):
        sys.exit("\n".join(faults))
    wanted = {TABLE: within(TABLE, table(all_options)), TEXTS: texts(all_options), **python_files(all_options)}
    return finish(wanted, "include/raymap/named_options.h", f"{len(first_options(all_options))} options")


if __name__ == "__main__":
    sys.exit(main())
