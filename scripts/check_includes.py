#!/usr/bin/env python3
"""Checks that every file of the library and the program includes what it uses, itself or by a header that it includes.

The builds compile several files together, where a missing include goes unseen. Names of ours are those that Universal Ctags
finds at namespace scope in one header alone; those of the standard library are listed here. Prints each missing include, and
ends with 1 if there is any.

check_includes.py [ROOT]: ROOT is the source tree, by default the one that this script lies in.
"""

import re

from check_odr import tags
from source_tree import COMMENT, STRING, chosen_root, files, finish, includes

FOLDERS = ("include/", "src/", "apps/")
IGNORED = re.compile(rf'{COMMENT}|R"(\w*)\(.*?\)\1"|{STRING}|^\s*#\s*include[^\n]*|RAYMAP_ADDRESS\(\w+\)', re.DOTALL | re.MULTILINE)
USED = re.compile(r"(?<![.:])(?<!->)\b([A-Za-z_]\w*)\b")  # No members, and none of other namespaces.
STANDARD = re.compile(r"\bstd::(\w+)")
HEADERS = {  # Of names that other headers of the standard library do not bring along reliably.
    "algorithm": "sort stable_sort nth_element any_of all_of none_of find_if count_if transform fill copy unique remove_if "
                 "lower_bound upper_bound clamp max_element min_element reverse equal",
    "array": "array", "atomic": "atomic", "bit": "bit_cast bit_width popcount countr_zero", "charconv": "from_chars to_chars",
    "chrono": "chrono", "condition_variable": "condition_variable", "cstring": "memcpy memcmp memset strlen",
    "filesystem": "filesystem", "fstream": "ifstream ofstream fstream", "functional": "function hash",
    "future": "async future promise", "iostream": "cout cerr cin", "limits": "numeric_limits", "list": "list", "map": "map multimap",
    "memory": "unique_ptr shared_ptr weak_ptr make_unique make_shared", "mutex": "mutex lock_guard unique_lock scoped_lock call_once",
    "numeric": "accumulate iota partial_sum exclusive_scan inclusive_scan", "optional": "optional nullopt", "queue": "queue priority_queue",
    "random": "mt19937 mt19937_64 uniform_real_distribution", "regex": "regex", "set": "set", "span": "span",
    "sstream": "istringstream ostringstream stringstream", "string": "string to_string", "string_view": "string_view",
    "thread": "thread", "tuple": "tuple", "unordered_map": "unordered_map",
    "unordered_set": "unordered_set", "variant": "variant get_if holds_alternative visit", "vector": "vector",
}  # fmt: skip
HEADER_OF = {name: header for header, names in HEADERS.items() for name in names.split()}


def declared(root):
    """Returns the one header by each name that it declares at namespace scope and nothing else declares as anything else, and
    whether the program has the name, too: its files then need not that of the library."""
    found = {}
    kinds = ["--kinds-C=+deglmpxz", "--kinds-C++=+deglmpxz"]
    for tag in tags(root, kinds):
        if not tag["path"].startswith(FOLDERS) or tag.get("scope", "").rpartition("::")[2] == tag["name"]:
            continue  # Of a program that this one does not see, or a constructor.
        path, scope = tag["path"], tag.get("scopeKind", "namespace")
        is_local = "__anon" in tag.get("scope", "")
        is_own = path.endswith(".h") and not path.endswith("-inl.h") and path.startswith(FOLDERS) and scope == "namespace" and not is_local
        is_same = scope == "namespace" and not is_local and tag["kind"] in ("function", "prototype", "externvar")
        if is_own or not is_same:
            found.setdefault(tag["name"], set()).add(path if is_own else "elsewhere")
    names = {}
    for name, paths in found.items():
        library = {path for path in paths if not path.startswith("apps/")} or paths
        if len(library) == 1 and "elsewhere" not in paths:
            names[name] = library.pop(), len(paths) > 1
    return names


class Tree:
    """The files, what they include, and what they bring along."""

    def __init__(self, root):
        self.files = {str(p.relative_to(root)): p.read_text() for p in files(root, FOLDERS, {".h", ".cpp", ".inl"})}
        self.known = {}

    def resolve(self, file, name):
        """Returns the file of ours that an include names, or the name itself."""
        beside = f"{file.rpartition('/')[0]}/{name}"
        return next((path for path in (beside, f"src/{name}", f"include/{name}", f"apps/{name}") if path in self.files), name)

    def brought(self, file):
        """Returns all that the file includes, itself or by others, and itself."""
        if file not in self.known:
            self.known[file] = {file}
            for _, name, _ in includes(self.files.get(file, "")):
                self.known[file] |= self.brought(self.resolve(file, name))
        return self.known[file]

    def declares(self, files, name):
        """Returns whether one of the files declares the name of a type in advance, as a parameter of a template or as an alias."""
        declaration = re.compile(rf"\b(?:class|struct|enum|using|typename) {name}\b")
        return any(declaration.search(self.files[file]) for file in files & self.files.keys())


def missing(tree, names, file):
    """Yields the names that the file uses without their headers, and these."""
    text, brought = IGNORED.sub(" ", tree.files[file]), tree.brought(file)
    for name in sorted(set(STANDARD.findall(text))):
        if name in HEADER_OF and HEADER_OF[name] not in brought:
            yield f"std::{name}", f"<{HEADER_OF[name]}>"
    for name in sorted(set(USED.findall(text)) & names.keys()):
        header, is_in_program = names[name]
        if header in brought or tree.declares(brought, name) or (is_in_program and file.startswith("apps/")):
            continue
        yield name, header


def main():
    root = chosen_root()
    tree, names = Tree(root), declared(root)
    found = [f"{file}: uses {name} without {header}" for file in tree.files for name, header in missing(tree, names, file)]
    finish(found, f"{len(tree.files)} files, {len(names)} names, {len(found)} missing includes", len(tree.files))


if __name__ == "__main__":
    main()
