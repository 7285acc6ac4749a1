#!/usr/bin/env python3
"""Checks that no text of the library names a flag or a command of the program raymap: Python and C++ users read it, too.

The faces add their own words to a warning by its code (apps/warnings.cpp, python/raymap/_errors.py). Prints each such text
with its place, and ends with 1 if there is any.

check_messages.py [ROOT]: ROOT is the source tree, by default the one that this script lies in.
"""

import re
import sys
from pathlib import Path

FOLDERS = ("include", "src")
SOURCES = {".h", ".cpp"}
# A comment, or texts of which the compiler makes one.
TOKEN = re.compile(r'//[^\n]*|/\*.*?\*/|#include[^\n]*|"(?:\\.|[^"\\\n])*"(?:\s*"(?:\\.|[^"\\\n])*")*', re.S)


def commands(root):
    return re.findall(r'add_subcommand\("(\w+)"', "".join(path.read_text() for path in sorted((root / "apps").glob("*.cpp"))))


def texts(source):
    """Yields each text of a source file, and its line."""
    for token in TOKEN.finditer(source):
        if token[0].startswith('"'):
            yield re.sub(r'"\s*"', "", token[0]), source.count("\n", 0, token.start()) + 1


def main():
    root = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).resolve().parent.parent
    names = commands(root)
    assert names, "apps/ adds no command"
    of_the_program = re.compile(r"(?<!\w)--[a-z]|\braymap (?:" + "|".join(names) + r")\b")
    count, found = 0, 0
    for path in sorted(path for folder in FOLDERS for path in (root / folder).rglob("*") if path.suffix in SOURCES):
        for text, line in texts(path.read_text()):
            count += 1
            if of_the_program.search(text):
                found += 1
                print(f"{path.relative_to(root)}:{line}: {text} names a flag or a command; use plain words")
    print(f"{count} texts, {found} name a flag or a command")
    return 1 if found or not count else 0


if __name__ == "__main__":
    sys.exit(main())
