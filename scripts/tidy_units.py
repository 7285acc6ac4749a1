#!/usr/bin/env python3
"""Joins our source files to units that clang-tidy reads faster: most of its time goes to headers.

tidy_units.py make BUILD     Writes BUILD/units, with a compile_commands.json, for the unity build in BUILD, and prints its files.
tidy_units.py name BUILD     Copies messages about these files from standard input, with the names and lines of our sources.

clang-tidy's analyzer looks at functions of the main file alone. So a unit holds the text of sources, and does not include it.
"""

import json
import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
INCLUDED = re.compile(r'^#include "(.+)"$', re.MULTILINE)
TRIED_ELSEWHERE = ("tests", "bench", "fuzz", "build")


def is_ours(path):
    return path.is_relative_to(ROOT) and path.relative_to(ROOT).parts[0] not in TRIED_ELSEWHERE


def openvdb_headers():
    """Returns what a file that includes OpenVDB holds. Clang does not compile Boost's headers of Debian 12, which it includes."""
    headers = [h for h in (ROOT / "src").rglob("*.h") if "<openvdb/" in h.read_text()]
    return ["<openvdb/", *(f'"{h.relative_to(ROOT / "src")}"' for h in headers)]


def make(build):
    units, commands, origins = build / "units", [], {}
    units.mkdir(exist_ok=True)
    unreadable = openvdb_headers()
    for entry in json.loads((build / "compile_commands.json").read_text()):
        file = Path(entry["file"])
        is_unity = file.name.startswith("unity_")
        sources = [Path(p) for p in INCLUDED.findall(file.read_text())] if is_unity else [file]
        sources = [p for p in sources if is_ours(p) and not any(text in p.read_text() for text in unreadable)]
        if not sources:
            continue
        unit = units / ("_".join(p.stem for p in sources[:3]) + f"_{len(commands)}.cpp") if is_unity else file
        if is_unity:
            texts = [p.read_text() for p in sources]
            unit.write_text("".join(texts))
            origins[str(unit)] = [(str(p.relative_to(ROOT)), text.count("\n")) for p, text in zip(sources, texts, strict=True)]
        folders = " ".join(sorted({f"-iquote{p.parent}" for p in sources}))
        commands.append({**entry, "file": str(unit), "command": entry["command"].replace(str(file), str(unit)) + " " + folders})
    (units / "compile_commands.json").write_text(json.dumps(commands))
    (units / "origins.json").write_text(json.dumps(origins))
    print(*(command["file"] for command in commands), sep="\n")


def name(build):
    origins = json.loads((build / "units/origins.json").read_text())

    def placed(match):
        line = int(match[2])
        for source, lines in origins.get(match[1], ()):
            if line <= lines:
                return f"{source}:{line}"
            line -= lines
        return match[0]

    place = re.compile(f"({'|'.join(map(re.escape, origins))}):(\\d+)")
    for text in sys.stdin:
        sys.stdout.write(place.sub(placed, text))


if __name__ == "__main__":
    {"make": make, "name": name}[sys.argv[1]](ROOT / sys.argv[2])
