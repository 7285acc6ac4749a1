#!/usr/bin/env python3
"""Checks that no text of the library names a flag or a command of the program raymap: Python and C++ users read it, too.

The faces add their own words to a warning by its code (apps/warnings.cpp, python/raymap/_errors.py). Prints each such text
with its place, and ends with 1 if there is any.

check_messages.py [ROOT]: ROOT is the source tree, by default the one that this script lies in.
"""

import re

from source_tree import COMMENT, STRING, chosen_root, commands, files, finish, line_at

FOLDERS = ("include", "src")
SOURCES = {".h", ".cpp"}
# A comment, or texts of which the compiler makes one.
TOKEN = re.compile(rf"{COMMENT}|#include[^\n]*|{STRING}(?:\s*{STRING})*", re.S)


def texts(source):
    """Yields each text of a source file, and its line."""
    for token in TOKEN.finditer(source):
        if token[0].startswith('"'):
            yield re.sub(r'"\s*"', "", token[0]), line_at(source, token.start())


def main():
    root = chosen_root()
    names = commands(root)
    assert names, "apps/ adds no command"
    of_the_program = re.compile(r"(?<!\w)--[a-z]|\braymap (?:" + "|".join(names) + r")\b")
    count, found = 0, []
    for path in files(root, FOLDERS, SOURCES):
        for text, line in texts(path.read_text()):
            count += 1
            if of_the_program.search(text):
                found.append(f"{path.relative_to(root)}:{line}: {text} names a flag or a command; use plain words")
    finish(found, f"{count} texts, {len(found)} name a flag or a command", count)


if __name__ == "__main__":
    main()
