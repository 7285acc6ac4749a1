#!/usr/bin/env python3
"""Plants mistakes into copies of the documentation: scripts/check_docs.py must find each and name it."""

import subprocess
import unittest

from planted_tree import ROOT, PlantedTree


class CheckDocs(PlantedTree):
    script = "check_docs.py"

    def setUp(self):
        super().setUp()
        files = subprocess.run(["git", "-C", ROOT, "ls-files", "-co", "--exclude-standard"], capture_output=True,
                               text=True, check=True).stdout.splitlines()
        for name in files:
            if (ROOT / name).is_file():
                is_read = name.endswith((".md", ".cpp", ".h", ".txt", ".ci/run", "CMakePresets.json"))
                self.copy(name) if is_read else self.put(name, "")

    def append(self, name, text):
        with (self.root / name).open("a") as file:
            file.write(text + "\n")

    def assert_found(self, *messages):
        lines = super().assert_found(*messages)
        self.assertEqual(len(lines), len(messages) + 1, lines)

    def test_accepts_the_documentation(self):
        self.assert_accepted(" 0 faults")

    def test_finds_files_that_are_gone(self):
        self.edit("docs/dev/walks.md", "`orientation_sides.comp`", "`orientation_rises.comp`")
        self.append("docs/points.md", "See `src/cpu/points/gone.h`, and `quarantine/MESH/log.txt`.")
        lines = (self.root / "docs/dev/walks.md").read_text().splitlines()
        line = 1 + next(k for k, text in enumerate(lines) if "orientation_rises.comp" in text)
        self.assert_found(f"docs/dev/walks.md:{line}: no file is named orientation_rises.comp",
                          "no file is named src/cpu/points/gone.h")

    def test_finds_pages_that_no_index_lists_once(self):
        self.edit("docs/README.md", "| [points.md](points.md)", "| [cli.md](cli.md)")
        self.edit("llms.txt", "- [points.md](docs/points.md)", "- [cli.md](docs/cli.md)")
        self.edit("docs/dev/decisions/README.md", "[first_card](first_card.md)", "[first_card](3mf.md)")
        self.assert_found("docs/README.md: lists points.md 0 times", "docs/README.md: lists cli.md 2 times",
                          "docs/dev/decisions/README.md: lists first_card.md 0 times",
                          "docs/dev/decisions/README.md: lists 3mf.md 2 times")

    def test_finds_what_llms_txt_lacks_and_invents(self):
        self.edit("llms.txt", "- [points.md](docs/points.md): What", "- [points.md](docs/points.md): Why")
        self.assert_found("llms.txt: lacks `- [points.md](docs/points.md): What", "llms.txt: has `- [points.md](docs/points.md): Why")

    def test_finds_what_agents_cannot_run(self):
        self.edit("AGENTS.md", "scripts/format.sh --check", "scripts/style.sh --check")
        self.edit("AGENTS.md", "`raymap COMMAND --help`", "`raymap paint --help`")
        self.edit("AGENTS.md", "--build --preset release", "--build --preset quick")
        self.assert_found("AGENTS.md: scripts/style.sh does not exist", "AGENTS.md: raymap has no command paint",
                          "AGENTS.md: there is no preset quick")

    def test_finds_links_that_lead_nowhere(self):
        self.append("docs/points.md", "[a](gone.md) [b](cli.md#gone) [c](#gone) [d](cli.md#exit-codes) [e](https://x.y)")
        self.assert_found("gone.md does not exist", "cli.md has no heading #gone", "points.md has no heading #gone")

    def test_finds_libraries_in_files_that_are_not_named(self):
        self.append("src/mesh/weld.cpp", "#include <hwy/highway.h>")
        self.append("apps/report.cpp", "#include <png.h>")
        self.assert_found("src/mesh/weld.cpp includes Highway", "apps/report.cpp includes libpng")

    def test_finds_libraries_in_places_that_do_not_use_them(self):
        place = "`src/render/write_png.cpp`"
        self.edit("docs/dev/dependencies.md", place, f"{place}, `src/render/slice_view.cpp`")
        self.assert_found("src/render/slice_view.cpp does not include libpng")

    def test_finds_commands_without_a_section(self):
        self.append("apps/convert.cpp", 'void add(Program& program) { program.addCommand("paint", "Paint a mesh", ""); }')
        self.assert_found("docs/cli.md: has no section on the command paint",
                          "docs/cli.md: lists the command paint 0 times; list it once")

    def test_finds_commands_that_are_not_listed_once(self):
        self.edit("docs/cli.md", "| [`view`](#view)", "| [`mesh`](#view)")
        self.assert_found("docs/cli.md: lists the command view 0 times", "docs/cli.md: lists the command mesh 2 times")

    def test_finds_folders_that_are_not_listed_or_gone(self):
        self.edit("CONTRIBUTING.md", "src/picture/ ", "src/pictures/")
        self.edit("CONTRIBUTING.md", "cells/ (", "cell/ (")
        self.assert_found("lists the folder src/cpu/cell,", "lists the folder src/pictures,",
                          "does not list the folder src/cpu/cells", "does not list the folder src/picture")

    def test_finds_folders_in_another_order_than_layers(self):
        self.append("src/layers.txt", "mesh: method")
        self.assert_found("lists src/method below mesh, which includes it")

    def test_finds_stages_that_are_not_listed(self):
        self.append(".ci/run", "stage scripts/check_spelling.py --all")
        self.assert_found("does not list scripts/check_spelling.py, a stage of .ci/run")

    def test_finds_layers_that_are_not_named(self):
        self.append("src/layers.txt", "cpu/bands: base")
        self.assert_found("docs/dev/decisions/layers.md: does not name the layer cpu/bands")

    def test_finds_sentences_that_put_off_the_subject(self):
        lines = len((self.root / "docs/points.md").read_text().splitlines())
        self.append("docs/points.md", "\nIt reads files. What it\nreads is kept. What is kept? Of course all.\n\n"
                    "- Of a mesh, it reads faces.\n\n```\nWhat is code.\n```\n\n| Of a mesh | What it is. |\n")
        self.append("include/raymap/mesh.h", "/// Reads it. Of a mesh, all.\nint a;  ///< What it is.\nint Of = 1;\n")
        self.assert_found(f'docs/points.md:{lines + 2}: "What it reads is kept" puts off the subject; begin with it',
                          f'docs/points.md:{lines + 5}: "Of a mesh, it reads faces" puts off the subject',
                          '"Of a mesh, all" puts off the subject', '"What it is" puts off the subject')

    def test_finds_more_lines_for_users_than_agreed(self):
        self.append("docs/dev/walks.md", "\n" * 5000)
        self.append("docs/options.md", "<!-- scripts/some.py writes what follows. -->" + "\n" * 5000 + "<!-- That is all of it. -->")
        self.append("docs/wild.md", "<!-- a table -->" + "\n" * 5000 + "<!-- end of a table -->")
        self.assert_accepted(" 0 faults")
        self.append("docs/points.md", "\n" * 5000)
        self.assert_found("lines, more than 5000")

    def test_finds_exit_codes_that_are_listed_once_only(self):
        self.edit("docs/cli.md", "| 9 | ", "| 12 | ")
        self.assert_found("exit code 9 is only in the program's help", "exit code 12 is only in this table")

    def test_finds_long_lines_of_prose_only(self):
        long = "word " * 20 + "x"
        self.append("docs/points.md", f"{long}\n{long[:100]}\n\n| {long} |\n\n    {long}\n\n```\n{long}\n```")
        self.assert_found("101 columns; wrap at 100")


if __name__ == "__main__":
    unittest.main()
