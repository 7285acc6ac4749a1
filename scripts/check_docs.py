#!/usr/bin/env python3
"""Fails where the documentation contradicts the tree.

- docs/README.md lists every page of docs/ and of its folders exactly once, docs/dev/decisions/README.md every record.
- Relative links lead to files and headings that exist.
- Files of code named in `backticks` exist.
- docs/dev/decisions/layers.md names every layer of src/layers.txt.
- docs/dev/dependencies.md names every file, or a folder of it, that includes a header of a library, and no other.
- docs/cli.md lists the exit codes that `raymap --help` lists, has a section on every command, and lists every
  command once.
- llms.txt lists the pages of docs/README.md with their questions, and no others.
- Commands and paths in AGENTS.md exist.
- CONTRIBUTING.md lists the folders of the tree, in the order of src/layers.txt, and every stage of .ci/run.
- Pages for users have at most 5,000 lines: README.md, python/README.md and docs/ without docs/dev. Lines between a marker
  "<!-- scripts/… writes what follows. -->" or "<!-- NAME -->" and its end are written by scripts, and do not count.
- Lines of prose end before column 101.
- No sentence of prose, and no comment of a public header, opens with "Of", "What", "Told", "Whose" or "So that", which
  put off the subject. Questions may.

check_docs.py [FOLDER] checks another tree."""

import re
import subprocess
from pathlib import Path

from source_tree import chosen_root, commands, finish, includes

ROOT = chosen_root().resolve()
COLUMNS = 100
USER_LINES = 5000
WRITTEN = re.compile(r"<!-- (?:scripts/\S+ writes what follows\. -->.*?<!-- That is all of it\.|([\w ]+) -->.*?<!-- end of \1) -->",
                     re.DOTALL)
OPENING = re.compile(r"(?:^|(?<=[.:;!?] ))(?:Of(?! course)|What|Told|Whose|So that)\b[^.?!]*\??")
CODE = r"(?:cpp|h|hpp|c|comp|glsl|py|sh|txt|toml|cmake)"
# Headers by which files show that they use a library, as named in docs/dev/dependencies.md.
HEADERS = {
    "oneTBB": r"(oneapi/)?tbb/",
    "Highway": r"hwy/(?!detect)",
    "libpng": r"png\.h",
    "zlib": r"zlib\.h",
    "libzip": r"zip\.h",
    "expat": r"expat\.h",
    "pugixml": r"pugixml",
    "OpenVDB": r"openvdb/",
    "NanoVDB": r"nanovdb/",
    "Assimp": r"assimp/",
    "nlohmann-json": r"nlohmann/",
    "volk": r"volk\.h",
}


def pages():
    for top in sorted(ROOT.iterdir()):
        if top.suffix == ".md":
            yield top
        elif top.name not in ("build", "out", ".git"):  # A build beside may remove files.
            yield from sorted(top.rglob("*.md"))


def prose(text):
    """Yields the numbers and texts of the lines that are in no block of code."""
    fenced = False
    for number, line in enumerate(text.splitlines(), 1):
        if line.lstrip().startswith("```"):
            fenced = not fenced
        elif not fenced:
            yield number, line


def anchor(heading):
    """Returns the fragment under which a heading is linked."""
    kept = re.sub(r"[^\w\- ]", "", re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading).strip().lower())
    return kept.replace(" ", "-")


def anchors(page):
    return {anchor(line.lstrip("#")) for _, line in prose(page.read_text()) if line.startswith("#")}


def check_links(page, number, line):
    for target in re.findall(r"\]\(([^)\s]+)\)", line):
        if re.match(r"[a-z]+:", target):
            continue
        path, _, fragment = target.partition("#")
        linked = (page.parent / path) if path else page
        if not linked.exists():
            yield f"{number}: {target} does not exist"
        elif fragment and linked.suffix == ".md" and fragment not in anchors(linked):
            yield f"{number}: {path or page.name} has no heading #{fragment}"


class Tree:
    """The names of all files, to look up those that the documentation names."""

    def __init__(self):
        listed = subprocess.run(["git", "-C", ROOT, "ls-files", "-co", "--exclude-standard"],
                                capture_output=True, text=True)
        found = listed.stdout.splitlines() if listed.returncode == 0 else []
        self.paths = found or [str(p.relative_to(ROOT)) for p in ROOT.rglob("*") if p.is_file()]
        self.names = {Path(path).name for path in self.paths}

    def has(self, name):
        if "/" not in name:
            return name in self.names
        name = name.removeprefix("../")
        return any(path == name or path.endswith("/" + name) for path in self.paths)


def check_names(page, number, line, tree):
    for quoted in re.findall(r"`([^`]+)`", line):
        # A part in capitals stands for a name, as MESH does in quarantine/MESH/log.txt.
        if re.search(r"(^|/)[A-Z]+(/|$)", quoted):
            continue
        if re.fullmatch(rf"[\w./\-]+\.{CODE}", quoted) and not tree.has(quoted):
            yield f"{number}: no file is named {quoted}"


def check_width(number, line):
    if len(line) > COLUMNS and not line.startswith(("|", "    ")) and "](http" not in line and "![" not in line:
        yield f"{number}: {len(line)} columns; wrap at {COLUMNS}"


def paragraphs(text):
    """Yields the paragraphs and items of lists as one line each, with the number of their first line."""
    first, words, last = 0, [], 0
    for number, line in prose(text):
        ends = not line.strip() or line.startswith(("|", "#", "    ")) or number != last + 1
        item = re.match(r"\s*(?:[-*]|\d+\.) ", line)
        if (ends or item) and words:
            yield first, " ".join(words)
            words = []
        if line.strip() and not line.startswith(("|", "#", "    ")):
            first = first if words else number
            words.append(line[item.end():] if item else line.strip())
        last = number
    if words:
        yield first, " ".join(words)


def check_openings(number, text):
    for opening in OPENING.findall(text):
        if not opening.endswith("?"):
            yield f'{number}: "{opening[:40]}" puts off the subject; begin with it'


def check_headers():
    for header in sorted((ROOT / "include").rglob("*.h")):
        for number, line in enumerate(header.read_text().splitlines(), 1):
            comment = re.search(r"(?://[/!]?<?|/\*|^ \*) (.*)", line)
            for fault in check_openings(number, comment[1]) if comment else ():
                yield f"{header.relative_to(ROOT)}:{fault}"


def check_length():
    users = [page for page in (ROOT / "docs").rglob("*.md") if (ROOT / "docs/dev") not in page.parents]
    texts = [page.read_text() for page in (ROOT / "README.md", ROOT / "python/README.md", *users)]
    count = sum(len(WRITTEN.sub("", text).splitlines()) for text in texts)
    if count > USER_LINES:
        yield f"pages for users have {count} lines, more than {USER_LINES}; cut what is said twice, or move it to docs/dev"


def check_page(page, tree):
    for number, line in prose(page.read_text()):
        yield from check_links(page, number, line)
        # Records of decisions and changes also name files that are gone.
        if "decisions" not in page.parts and page.name != "CHANGELOG.md":
            yield from check_names(page, number, line, tree)
        yield from check_width(number, line)
    for number, text in paragraphs(page.read_text()):
        yield from check_openings(number, text)


def check_index(folder):
    index = ROOT / folder / "README.md"
    listed = re.findall(r"^\| (?:[\d-]+ \| )?\[[^\]]*\]\(([\w./]+\.md)\)", index.read_text(), re.MULTILINE)
    for page in sorted([*index.parent.glob("*.md"), *index.parent.glob("*/*.md")]):
        name = page.relative_to(index.parent).as_posix()
        if page != index and listed.count(name) != 1:
            yield f"{folder}/README.md: lists {name} {listed.count(name)} times; list it once"


def check_layers():
    named = re.findall(r"`([\w/]+)`", (ROOT / "docs/dev/decisions/layers.md").read_text())
    for layer in re.findall(r"^([\w/]+):", (ROOT / "src/layers.txt").read_text(), re.MULTILINE):
        if layer != "top" and not {layer, layer.rsplit("/", 1)[-1]} & set(named):
            yield f"does not name the layer {layer}"


def check_libraries(tree):
    text = (ROOT / "docs/dev/dependencies.md").read_text()
    sources = [path for path in tree.paths if re.match(r"(src|apps|include)/.*\.(cpp|h)$", path)]
    included = {path: [name for _, name, _ in includes((ROOT / path).read_text())] for path in sources}
    for library, header in HEADERS.items():
        row = re.search(rf"^\| {re.escape(library)} \|.*$", text, re.MULTILINE)
        places = re.findall(r"`([^`]+)`", row[0].rsplit(" | ", 1)[1]) if row else []
        users = [path for path, names in included.items() if any(re.match(header, name) for name in names)]
        for path in users:
            if not any(path.startswith(place) for place in places):
                yield f"{path} includes {library}, which is not said there"
        for place in places:
            if re.match("(src|apps)/", place) and not any(path.startswith(place) for path in users):
                yield f"{place} does not include {library}, as is said there"


def check_exit_codes():
    helped = re.search(r"Exit codes:(.*?)\)\"", (ROOT / "apps/main.cpp").read_text(), re.DOTALL)[1]
    told = {int(number) for number in re.findall(r"\b\d+\b", helped)}
    table = (ROOT / "docs/cli.md").read_text().split("## Exit codes", 1)[1].split("\n## ", 1)[0]
    rows = re.findall(r"^\| ([\d, ]+) \|", table, re.MULTILINE)
    listed = {int(number) for row in rows for number in row.split(",")}
    for code in sorted(told ^ listed):
        yield f"exit code {code} is only in " + ("the program's help" if code in told else "this table")


def check_commands():
    text = (ROOT / "docs/cli.md").read_text()
    headings = "".join(re.findall(r"^## .*\n", text, re.MULTILINE))
    listed = re.findall(r"^\| \[`(\w+)`\]\(#", text, re.MULTILINE)
    for command in commands(ROOT):
        if not re.search(rf"\b{command}\b", headings):
            yield f"has no section on the command {command}"
        if listed.count(command) != 1:
            yield f"lists the command {command} {listed.count(command)} times; list it once"


def check_folders(tree):
    lines = re.search(r"^```\n(include/.*?)^```", (ROOT / "CONTRIBUTING.md").read_text(), re.DOTALL | re.MULTILINE)[1]
    listed = []
    for folder, described in re.findall(r"^(\S+)/ +(.*)$", lines, re.MULTILINE):
        listed.append(folder)
        inner = re.findall(r"(?<![\w/])([\w/]+)/(?!\w)", described)
        listed += [name if name.startswith(folder) else f"{folder}/{name}" for name in inner]
    folders = {str(parent) for path in tree.paths for parent in Path(path).parents}
    for folder in sorted(set(listed) - folders):
        yield f"lists the folder {folder}, which does not exist"
    for folder in sorted(folders):
        is_listed = any(name == folder or name.startswith(folder + "/") for name in listed)
        if re.fullmatch(r"[a-z]\w*|src/\w+(/\w+)?", folder) and not is_listed:
            yield f"does not list the folder {folder}"
    places = {name.removeprefix("src/"): place for place, name in enumerate(listed)}
    for layer, used in re.findall(r"^(?!top)([\w/]+):(.*)$", (ROOT / "src/layers.txt").read_text(), re.MULTILINE):
        place = places.get(layer, places.get(layer.split("/")[0], len(listed)))
        for below in sorted({name.split("/")[0] for name in used.split()} - {layer.split("/")[0]}):
            if places.get(below, -1) > place:
                yield f"lists src/{below} below {layer}, which includes it"


def check_stages():
    text = (ROOT / "CONTRIBUTING.md").read_text()
    stages = re.findall(r"^ *stage ((?:scripts|tests)/[\w.]+)", (ROOT / ".ci/run").read_text(), re.MULTILINE)
    for script in sorted(set(stages)):
        if script not in text:
            yield f"does not list {script}, a stage of .ci/run"


def page_map():
    """Returns the lines of llms.txt: the headings, pages and questions of docs/README.md."""
    for line in (ROOT / "docs/README.md").read_text().splitlines():
        row = re.match(r"\| (\[[^\]]*\])\(([^)]*)\) \| (.*) \|$", line)
        if row:
            yield f"- {row[1]}({row[2].removeprefix('../') if row[2].startswith('../') else 'docs/' + row[2]}): {row[3]}"
        elif line.startswith("## "):
            yield line


def check_map():
    listed = [line for line in (ROOT / "llms.txt").read_text().splitlines() if line.startswith(("- ", "## "))]
    expected = list(page_map())
    yield from (f"lacks `{line}`" for line in expected if line not in listed)
    yield from (f"has `{line}`, which docs/README.md has not" for line in listed if line not in expected)


def check_agents():
    text = (ROOT / "AGENTS.md").read_text()
    presets = re.findall(r'"name": "(\w+)"', (ROOT / "CMakePresets.json").read_text())
    for quoted, line in re.findall(r"`([^`]+)`|^    (\S.*)$", text, re.MULTILINE):
        words = re.sub(r"\s+#.*", "", quoted or line).split()
        for path in (word for word in words if re.search(r"\w/\w|^\.\w", word) and not word.startswith("build/")):
            if not (ROOT / path).exists():
                yield f"{path} does not exist"
        if words[0] == "raymap" and words[1] not in ("COMMAND", *commands(ROOT)):
            yield f"raymap has no command {words[1]}"
        for preset in words[words.index("--preset") + 1:][:1] if "--preset" in words else ():
            if preset not in presets:
                yield f"there is no preset {preset}"


def main():
    tree = Tree()
    faults = [f"{page.relative_to(ROOT)}:{fault}" for page in pages() for fault in check_page(page, tree)]
    faults += [*check_length(), *check_headers()]
    faults += [fault for folder in ("docs", "docs/dev/decisions") for fault in check_index(folder)]
    faults += [f"docs/dev/decisions/layers.md: {fault}" for fault in check_layers()]
    faults += [f"docs/dev/dependencies.md: {fault}" for fault in check_libraries(tree)]
    faults += [f"docs/cli.md: {fault}" for check in (check_exit_codes, check_commands) for fault in check()]
    faults += [f"llms.txt: {fault}" for fault in check_map()]
    faults += [f"AGENTS.md: {fault}" for fault in check_agents()]
    faults += [f"CONTRIBUTING.md: {fault}" for fault in [*check_folders(tree), *check_stages()]]
    count = len(list(pages()))
    finish(faults, f"{count} pages, {len(faults)} faults", count)


if __name__ == "__main__":
    main()
