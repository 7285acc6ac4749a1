#!/usr/bin/env python3
"""Checks that no constant `k...` is defined for the CPU and for the GPU in two places, where the values could part.

Such a constant belongs in a header that both languages read: `<stem>_shared.h`, or `<stem>_push.h` (base/shader_types.h).
Two things that only share a name need two names. A specialization constant gets its value from C++, so its declaration in
GLSL does not count. Prints each name and its places, and ends with 1 if there is any.

check_constants.py [ROOT]: ROOT is the source tree, by default the one that this script lies in.
"""

import re

from source_tree import COMMENT, STRING, chosen_root, defined_twice, files, finish, line_at

FOLDERS = ("include", "src")
SHADERS = {".comp", ".glsl"}
SOURCES = SHADERS | {".h", ".cpp"}
COMMENT_OR_STRING = re.compile(f"{COMMENT}|{STRING}", re.S)
MACRO = re.compile(r"#[ \t]*define[ \t]+(k[A-Z]\w*)")
STATEMENT = re.compile(r"\b(?:constexpr|const|RAYMAP_CONSTANT|enum)\b[^;]*")
NAME = re.compile(r"(?<![.\w])(k[A-Z]\w*)\s*(?:\[[^\]]*\]\s*)*(?:=(?!=)|\{)")


def without_comments(text):
    """Returns the text with its lines, but without comments and strings."""
    return COMMENT_OR_STRING.sub(lambda match: "\n" * match[0].count("\n"), text)


def constants(text):
    """Yields each constant that the text defines, and its line."""
    text = without_comments(text)
    for match in MACRO.finditer(text):
        yield match[1], line_at(text, match.start(1))
    for statement in STATEMENT.finditer(text):
        before = text[text.rfind(";", 0, statement.start()) + 1: statement.start()]
        if re.search(r"\bconstant_id\b[^;{}]*$", before):
            continue
        for match in NAME.finditer(text, *statement.span()):
            yield match[1], line_at(text, match.start(1))


def main():
    root = chosen_root()
    places, languages = {}, {}
    count = 0
    for path in files(root, FOLDERS, SOURCES):
        text = path.read_text()
        is_shared = '#include "base/shader_types.h"' in text
        for name, line in constants(text):
            count += 1
            places.setdefault(name, {}).setdefault(path.relative_to(root).as_posix(), line)
            languages.setdefault(name, set()).update(
                ("C++", "GLSL") if is_shared else ("GLSL",) if path.suffix in SHADERS else ("C++",))
    twice = defined_twice({name: where for name, where in places.items() if len(languages[name]) > 1})
    finish(twice, f"{count} constants, {len(twice)} defined for the CPU and for the GPU apart", count,
           "Define it once, in a header that C++ and GLSL read (base/shader_types.h), or give the other thing another name.")


if __name__ == "__main__":
    main()
