#!/usr/bin/env python3
"""Checks the one-definition rule: no two files define the same name with external linkage.

The compiler sees one file at a time, and the linker takes any one of two inline functions or classes that share a name.
So nothing else reports such a pair. All files count as one program; `main` and the entry points of fuzzers excepted.
Universal Ctags reads the sources, whatever a build would leave out. Prints each pair, and ends with 1 if there is any.

check_odr.py [ROOT]: ROOT is the source tree, by default the one that this script lies in.
"""

import json
import re
import subprocess
import sys

from source_tree import chosen_root, defined_twice, finish

FOLDERS = ("include", "src", "apps", "python/src", "examples", "bench", "fuzz", "tests")
ENTRY_POINTS = {"main", "LLVMFuzzerTestOneInput"}
# Builds without RAYMAP_IO or RAYMAP_RENDER compile them instead of c_files.cpp and c_json.cpp, or c_render.cpp.
ALTERNATIVES = {"src/c_api/c_files_missing.cpp", "src/c_api/c_render_missing.cpp"}
# Macros that stand between ctags and a definition (src/base/shader_types.h, RAYMAP_API, Highway's, GLSL's).
MACROS = ("RAYMAP_SHARED_BEGIN(space)=namespace space {", "RAYMAP_SHARED_END=}", "RAYMAP_CONSTANT=inline constexpr",
          "RAYMAP_FUNCTION=inline", "RAYMAP_API=", "RAYMAP_API_EXCEPTION=", "HWY_INLINE=inline", "layout(list)=")
CTAGS = ["ctags", "--quiet", "--languages=C,C++", "--output-format=json", "--sort=no", "--fields=+nSpZK",
         "--kinds-C=fgsuv", "--kinds-C++=cfgsuv", "--fields-C=+{properties}",
         "--fields-C++=+{properties}{specialization}", *(f"-D{macro}" for macro in MACROS), "-f", "-", "-R"]


def tags(root, options=()):
    """Yields what ctags finds in the tree, by further options."""
    folders = [folder for folder in FOLDERS if (root / folder).is_dir()]
    try:
        run = subprocess.run([*CTAGS[:-3], *options, *CTAGS[-3:], *folders], cwd=root, capture_output=True, text=True, check=True)
    except FileNotFoundError:
        sys.exit("There is no ctags. scripts/install.sh --checks installs it.")
    except subprocess.CalledProcessError as error:
        sys.exit(f"ctags failed; Universal Ctags with JSON is needed: {error.stderr.strip()}")
    for line in run.stdout.splitlines():
        yield json.loads(line)


def is_external(tag):
    """Whether the name has external linkage. Two variables clash without help, unless they are inline."""
    scope, properties = tag.get("scope", ""), tag.get("properties", "").split(",")
    if "__anon" in scope + tag["name"] or tag.get("scopeKind") == "function":
        return False
    if tag["kind"] == "variable":
        return "inline" in properties
    return "static" not in properties or tag.get("scopeKind", "namespace") != "namespace"


def types_of(signature):
    """Returns the types of the parameters, without their names and defaults, and what follows them."""
    body, _, suffix = signature[1:].rpartition(")")
    types, depth = [""], 0
    for character in body:
        depth += (character in "(<[{") - (character in ")>]}")
        if character == "," and depth == 0:
            types.append("")
        else:
            types[-1] += character
    types = [re.sub(r"(?<=[\s&*])\w+((\[\w*\])*)$", r"\1", kind.partition("=")[0].strip()).strip() for kind in types]
    return f"({', '.join(types)}){suffix}"


def main():
    places = {}
    count = 0
    for tag in tags(chosen_root()):
        if not is_external(tag) or tag["name"] in ENTRY_POINTS or tag["path"] in ALTERNATIVES:
            continue
        count += 1
        name = "::".join(filter(None, (tag.get("scope"), tag["name"])))
        name += f"<{tag['specialization']}>" if "specialization" in tag else ""
        name += types_of(tag["signature"]) if "signature" in tag else ""
        places.setdefault(name, {}).setdefault(tag["path"], tag["line"])
    twice = defined_twice(places)
    finish(twice, f"{count} definitions, {len(twice)} names with several", count,
           "Move what one file alone needs into an unnamed namespace, or rename it.")


if __name__ == "__main__":
    main()
