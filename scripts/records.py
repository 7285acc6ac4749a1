#!/usr/bin/env python3
"""Writes the types of Python's records (python/raymap/_records.py), the tables of keys (docs/report.md), and the schema of
what commands print (docs/raymap.schema.json).

The first two are made of include/raymap/records.h, which names the members of each record, of the comments at these members
in the other public headers, and of the names of enum values in src/api/names.cpp. The schema is made of the page, whose
first tables say what each command adds to the records.

records.py writes all; records.py --check fails where they differ. Both fail for a member that records.h leaves out, and for
one without a comment. A folder as last argument is another tree.
"""

import json
import re
import sys
import textwrap
from pathlib import Path

ROOT = Path(sys.argv[-1] if Path(sys.argv[-1]).is_dir() else Path(__file__).resolve().parent.parent)
TYPES, PAGE, SCHEMA = ROOT / "python/raymap/_records.py", ROOT / "docs/report.md", ROOT / "docs/raymap.schema.json"
BEGIN, END = "<!-- scripts/records.py writes what follows. -->", "<!-- That is all of it. -->"
HEAD = '''"""Types of the library's results, dicts with the keys of the command line's JSON, and names of the values of its enums.

scripts/records.py writes this file from include/raymap/records.h.
"""

from __future__ import annotations

from typing import Literal, TypedDict

import numpy as np
import numpy.typing as npt
'''
# Types of members: in Python, and in words.
PLAIN = {
    **dict.fromkeys(("int", "size_t", "unsigned", "uint32_t", "uint64_t"), ("int", "integer")),
    "double": ("float", "number"),
    "bool": ("bool", "boolean"),
    "std::string": ("str", "text"),
    "glm::dvec3": ("list[float]", "x, y, z"),
    "glm::ivec3": ("list[int]", "i, j, k"),
    "Box": ("list[list[float]]", "lowest and highest corner"),
    "std::vector<uint32_t>": ("npt.NDArray[np.uint32]", "indices"),
}
# Types in words, as JSON has them.
NUMBERS = {"type": "array", "minItems": 3, "maxItems": 3}
IN_JSON = {
    **{word: {"type": word} for word in ("integer", "number", "boolean", "null")},
    "text": {"type": "string"},
    "indices": {"type": "integer"},
    "x, y, z": NUMBERS | {"items": {"type": "number"}},
    "i, j, k": NUMBERS | {"items": {"type": "integer"}},
}
IN_JSON["lowest and highest corner"] = {"type": "array", "minItems": 2, "maxItems": 2, "items": IN_JSON["x, y, z"]}


class Struct:
    def __init__(self, text):
        self.text = text
        self.members = {}  # Type and comment of each member.
        self.defaults = {}  # As C++ writes them.


def structs(header):
    """Yields the name and the content of each struct of a header."""
    open_structs, comment, code, last = [], [], "", None
    for line in header.read_text().splitlines():
        code_part, _, after = line.strip().partition("///< ")
        if code_part.startswith("///"):
            comment.append(code_part[3:].strip())
        elif not code_part and after and open_structs:
            last[1] += " " + after
        elif found := re.fullmatch(r"struct (\w+) \{", code_part.strip()):
            open_structs.append((found[1], Struct(" ".join(comment))))
            comment = []
        elif code_part.strip() == "};" and open_structs:
            yield open_structs.pop()
            comment = []
        elif open_structs:
            code += " " + code_part.strip()
            if not code.endswith(";"):
                continue
            if member := re.match(r" ([^(={]+?) (\w+)(?:;| = (.+);|\{(.*)\};)", code):
                last = [member[1].removeprefix("const ").strip().rstrip("&"), " ".join(comment + [after] * bool(after))]
                open_structs[-1][1].members[member[2]] = last
                open_structs[-1][1].defaults[member[2]] = member[3] or member[4] or ""
            code, comment = "", []
        else:
            comment = []


def enums():
    """Returns the names of the values of each enum."""
    text = (ROOT / "src/api/names.cpp").read_text()
    found = re.findall(r"struct Names<(\w+)> \{.*?kNames\{(.*?)\};", text, re.DOTALL)
    return {enum: re.findall(r'"(\w+)"', names) for enum, names in found}


def warning_codes():
    """Returns what each kind of warning means, by its name."""
    text = (ROOT / "include/raymap/warning.h").read_text()
    values = re.search(r"enum class WarningCode \{\n(.*?)\n\};", text, re.DOTALL)[1]
    values = re.sub(r"\n *///<", "", values)
    found = {snake(name): re.sub(r"`(\w+)`", lambda named: f"`{snake(named[1])}`", comment)
             for name, comment in re.findall(r"^  (\w+),? *///< (.*)$", values, re.MULTILINE)}
    assert list(found) == enums()["WarningCode"], "a warning code of names.cpp has no comment in warning.h, or stands elsewhere there"
    return found


def snake(name):
    return re.sub(r"(?<=[a-z])[A-Z]", lambda letter: "_" + letter[0], name.rpartition("::")[2]).lower()


class Record:
    def __init__(self, name, struct, variable, body):
        self.name, self.text = name.rpartition("::")[2], struct.text
        self.base, self.keys = None, []  # Name, type and text of each key.
        names = {}
        for line in body.splitlines():
            if base := re.fullmatch(rf"  forEachMember\({variable}\.(\w+), use\);", line):
                self.base = struct.members[base[1]][0]
                continue
            key, value, own = re.fullmatch(r'  use\("(\w+)", (.+?)\);(?:  ///< (.*))?', line).groups()
            made, member = re.fullmatch(rf"(?:(\w+)\{{)?{variable}\.(\w+).*", value).groups()
            kind, text = struct.members[member]
            names[member] = key
            self.keys.append((key, "size_t" if value.endswith("size()") else made or kind, own or text))
        left_out = [member for member in struct.members if not re.search(rf"{variable}\.{member}\b", body)]
        assert not left_out, f"include/raymap/records.h leaves out {left_out} of {name}"
        assert all(text for _, _, text in self.keys), f"a member of {name} has no comment"
        # Comments name members as C++ does.
        self.keys = [(key, kind, re.sub(r"`([\w:]+)`", lambda named: f"`{names.get(named[1]) or snake(named[1])}`", text))
                     for key, kind, text in self.keys]


def all_structs():
    return {name: struct for header in sorted((ROOT / "include/raymap").glob("*.h")) for name, struct in structs(header)}


def records():
    found = all_structs()
    text = (ROOT / "include/raymap/records.h").read_text()
    functions = re.findall(r"^void forEachMember\(const ([\w:]+)& (\w+), auto&& use\) \{\n(.*?)\n\}", text,
                           re.DOTALL | re.MULTILINE)
    return [Record(name, found[name.rpartition("::")[2]], variable, body) for name, variable, body in functions]


def type_of(kind, is_python, enum_names):
    """Returns a type in Python, or in words."""
    if kind in PLAIN:
        return PLAIN[kind][0 if is_python else 1]
    if kind in enum_names:
        return kind if is_python else "one of " + ", ".join(f"`{name}`" for name in enum_names[kind])
    if found := re.fullmatch(r"std::optional<(.+)>", kind):
        return type_of(found[1], is_python, enum_names) + (" | None" if is_python else " or null")
    if found := re.fullmatch(r"std::vector<(.+)>", kind):
        element = type_of(found[1], is_python, enum_names)
        return f"list[{element}]" if is_python else f"list of {element}"
    return kind if is_python else f"[{kind}](#{kind.lower()})"


def docstring(text, indent):
    words = f'"""{text.replace("`", "``")}"""'
    return textwrap.fill(words, 120, initial_indent=indent, subsequent_indent=indent, break_on_hyphens=False) + "\n"


def python_types(all_records, enum_names):
    text = HEAD
    for enum in ("Arrangement", "DeviceTestState", "DeviceType", "DistanceMode", "FieldArray", "FieldForm", "FieldReason", "MeshKind", "Orientation", "Part", "Remedy", "RepairDepth",
                 "Sampling", "SignMode", "WarningCode"):
        values = "".join(f'    "{name}",\n' for name in enum_names[enum])
        text += f"\n{enum} = Literal[\n{values}]\n"
    for record in all_records:
        text += f"\n\nclass {record.name}({record.base or 'TypedDict'}):\n" + docstring(record.text, "    ") + "\n"
        for key, kind, comment in record.keys:
            text += f"    {key}: {type_of(kind, True, enum_names)}\n" + docstring(comment, "    ")
    return text


def tables(all_records, enum_names):
    text = ""
    for record in all_records:
        base = f" It also has the keys of [{record.base}](#{record.base.lower()})." if record.base else ""
        text += f"\n## {record.name}\n\n" + textwrap.fill(record.text + base, 100, break_on_hyphens=False)
        text += "\n\n| key | type | value |\n|---|---|---|\n"
        for key, kind, comment in record.keys:
            text += f"| `{key}` | {type_of(kind, False, enum_names)} | {comment} |\n"
    text += "\n## Warning codes\n\nKinds of warnings, and the fields that each has. All other fields are empty or 0.\n"
    text += "\n| code | meaning |\n|---|---|\n"
    for code, meaning in warning_codes().items():
        text += f"| `{code}` | {meaning} |\n"
    return text + "\n"


def option_types(enum_names):
    """Returns the type of each option of raymap/named_options.h, in words."""
    from options import first_options, options

    plain = {name: type_of(row.kind, False, enum_names) for name, row in first_options(options()).items()}
    nullable = {name for name, row in first_options(options()).items() if row.kind == "double" and row.default is None}
    return {name: words + " or null" * (name in nullable) for name, words in plain.items()}


def schema_of(words, option_words):
    """Returns the schema of a type in words."""
    if words in IN_JSON:
        return IN_JSON[words]
    if words.startswith("lines of "):
        return schema_of(words.removeprefix("lines of "), option_words)
    if words.startswith("list of "):
        return {"type": "array", "items": schema_of(words.removeprefix("list of "), option_words)}
    if words.startswith("object of "):
        members = re.findall(r"`(\w+)` ?(.*?)(?:, (?=`)|$)", words)
        return object_of({key: schema_of(kind or option_words[key], option_words) for key, kind in members})
    first, _, rest = words.partition(" or ")
    if rest:
        rest = schema_of(rest, option_words)
        return {"anyOf": [schema_of(first, option_words), *rest.get("anyOf", [rest])]}
    if words.startswith("one of "):
        return {"enum": re.findall(r"`(\w+)`", words)}
    record = re.fullmatch(r"\[(\w+)\]\(#\w+\)", words)
    assert record, f"docs/report.md: {words!r} is no type"
    return {"$ref": "#/$defs/" + record[1]}


def object_of(properties):
    return {"type": "object", "required": list(properties), "properties": properties}


def schema(page, option_words):
    """Returns the JSON Schema of all tables of a page, and of what its first table says that commands print."""
    found = {}
    for section in page.split("\n## ")[1:]:
        heading, _, body = section.partition("\n")
        text = " ".join(body.partition("\n|")[0].split())
        if heading == "What commands print":
            for command, words in re.findall(r"^\| `(.*)` \| (.*) \|$", body, re.MULTILINE):
                found[re.sub(r"\W+", "_", command)] = schema_of(words, option_words)
        elif rows := re.findall(r"^\| (`.*?`) \| ([^|]+) \| (.*) \|$", body, re.MULTILINE):
            properties = {key: schema_of(words, option_words) | {"description": meaning}
                          for keys, words, meaning in rows for key in re.findall(r"\w+", keys)}
            base = re.search(r"It also has the keys of \[(\w+)\]", text)
            found[heading] = {"description": text, "base": base and base[1], **object_of(properties)}
    for record in found.values():
        base = found.get(record.pop("base", None))
        while base:
            record["properties"] = base["properties"] | record["properties"]
            base = found.get(base.get("base"))
        if "properties" in record:
            record["required"] = list(record["properties"])
    text = json.dumps({"$schema": "https://json-schema.org/draft/2020-12/schema",
                       "title": "What the commands of raymap print with --json: scripts/records.py writes it from report.md",
                       "$defs": found}, indent=1)
    # An object of text and numbers takes one line.
    return re.sub(r"[\[{]\n[^{}\[\]]*[\]}]", lambda flat: re.sub(r"\s*\n\s*", " ", flat[0]), text) + "\n"


def within(path, made):
    """Returns a page whose made part is replaced."""
    page = path.read_text()
    return page.partition(BEGIN)[0] + BEGIN + "\n" + made + END + page.partition(END)[2]


def finish(wanted, source, counted):
    """Writes files, or with --check returns 1 if one has another text."""
    if "--check" not in sys.argv[1:]:
        for path, text in wanted.items():
            path.write_text(text)
        return 0
    old = [path for path, text in wanted.items() if not path.exists() or path.read_text() != text]
    for path in old:
        print(f"{path.relative_to(ROOT)} is not what {source} says; run scripts/{Path(sys.argv[0]).name}")
    print(f"{counted}, {len(old)} files differ")
    return 1 if old else 0


def main():
    all_records, enum_names = records(), enums()
    page = within(PAGE, tables(all_records, enum_names))
    wanted = {TYPES: python_types(all_records, enum_names), PAGE: page, SCHEMA: schema(page, option_types(enum_names))}
    keys = sum(len(record.keys) for record in all_records)
    return finish(wanted, "include/raymap/records.h", f"{len(all_records)} records, {keys} keys")


if __name__ == "__main__":
    sys.exit(main())
