"""What the checks of the source tree share: how they choose it, read its C++ and GLSL, and report what they find."""

import re
import sys
from pathlib import Path

# Patterns, for re.DOTALL.
COMMENT = r"//[^\n]*|/\*.*?\*/"
STRING = r'"(?:\\.|[^"\\\n])*"'
INCLUDE = re.compile(r'\s*#\s*include\s*(?:"([^"]+)"|<([^>]+)>)')


def chosen_root():
    """Returns the source tree: the argument of the command line, by default the tree that this script lies in."""
    return Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).resolve().parent.parent


def files(root, folders, endings):
    """Returns the files of some folders with one of the endings, such as `.cpp`, in order."""
    return sorted(path for folder in folders for path in (root / folder).rglob("*") if path.suffix in endings)


def line_at(text, position):
    """Returns the number of the line in which a position of a text lies."""
    return text.count("\n", 0, position) + 1


def includes(text):
    """Yields the line of each include, what it includes, and whether that is in quotes."""
    for number, line in enumerate(text.splitlines(), 1):
        if match := INCLUDE.match(line):
            yield number, match[1] or match[2], match[1] is not None


def commands(root):
    """Returns the names of the commands of the program raymap."""
    sources = "".join(path.read_text() for path in sorted((root / "apps").glob("*.cpp")))
    return re.findall(r'addCommand\(\s*"(\w+)"', sources)


def defined_twice(places):
    """Returns a line for each name that is defined in several places, of the places by file."""
    return [f"{name} is defined in {' and in '.join(f'{path}:{line}' for path, line in sorted(places[name].items()))}"
            for name in sorted(places) if len(places[name]) > 1]  # fmt: skip


def finish(problems, summary, count, remedy=""):
    """Prints the problems and the summary, and ends: with 1 if there is a problem, or if nothing was counted."""
    print(*problems, *([remedy] if problems and remedy else []), summary, sep="\n")
    sys.exit(1 if problems or not count else 0)
