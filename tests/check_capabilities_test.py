#!/usr/bin/env python3
"""Feeds faults of the table of capabilities to scripts/check_capabilities.py, which must find each and name it."""

import unittest

from planted_tree import PlantedTree
HEAD = "| feature | C++ | C | Python | Command line |\n|---|---|---|---|---|\n"
REASONS = "\n1. Not there yet.\n"


class CheckCapabilities(PlantedTree):
    script = "check_capabilities.py"

    def put_tree(self):
        """Writes a small tree, whose every public name the table of `rows` mentions."""
        self.put("include/raymap/mesh.h", """
#pragma once
namespace raymap {
/// A mesh; `notThere(1)` is only mentioned.
struct Mesh {
  std::vector<glm::vec3> vertices = {};
  std::function<void(Mesh&)> roundResult = {};
};
enum class Kind : uint8_t { Open, Closed };
struct Options {
  double band = 0.0, most = std::numeric_limits<double>::infinity();
};
RAYMAP_API Mesh readMesh(const std::filesystem::path& path, const std::function<bool(int)>& f = {});
inline int count(const Mesh& mesh) {
  if (mesh.vertices.empty()) return helper(mesh);
  return 1;
}
class RAYMAP_API Surface {
 public:
  explicit Surface(const Mesh& mesh);
  ~Surface();
  Surface& operator=(Surface&&) noexcept;
  double distance(glm::dvec3 point) const;

 private:
  double hidden(int i) const;
};
namespace vulkan {
RAYMAP_API void record();
}
}  // namespace raymap
""")
        self.put("include/raymap/c.h", """
#ifdef __cplusplus
extern "C" {
#endif
/* Reads. */
typedef struct raymap_mesh raymap_mesh;
typedef struct raymap_view {
  size_t size; /* sizeof */
  double up[3];
} raymap_view;
typedef bool (*raymap_callback)(const char* stage);
RAYMAP_API raymap_mesh* raymap_mesh_load(const char* path, double min[3]);
#ifdef __cplusplus
}
#endif
""")
        self.put("include/raymap/named_options.h", 'struct List {\n  void all() { use(OptionName{"band", "N"}, options.band); }\n};\n')
        self.put("python/raymap/__init__.py", '__all__ = ["Field", "load"]\n')
        self.put("python/raymap/_load.py", """
class Base(TypedDict):
    band: float
class Options(Base):
    threads: int
class Field:
    distance: float
    def sample(self, points, *, outside="bound"): ...
def load(path, **options: Unpack[Options]): ...
""")
        self.put("apps/info.cpp", 'app.addCommand(\n      "info", "Reports");\nentry("-h, --help", "Help");\n')
        self.put("docs/dev/option_table.md", "| option | also written | value | default | commands |\n|---|---|---|---|---|\n"
                                "| `--json` | `-j` |  |  | info |\n| `-o`, `--output` |  | FILE |  | mesh |\n"
                                "| `--quiet` |  |  |  | all |\n")

    def rows(self, **changes):
        """Returns the table of the small tree, with cells changed by the names of their features and columns."""
        table = {
            "read": ["`readMesh`, `Mesh::vertices`", "`raymap_mesh_load`", "`load`", "– (1)"],
            "inspect": ["`count`, `Kind::Closed`, `vulkan::record`", "`raymap_view::up`", "`Field.distance`",
                        "`raymap info --json`, `raymap info -j --quiet`, `raymap --help`"],
            "band": ["`Options::band`", '`"band"`', "`load(band)`", "– (1)"],
            "sample": ["`Surface::distance`, `Options::most`", "– (1)", "`Field.sample(outside)`, `load(threads)`", "– (1)"],
        }
        for place, cell in changes.items():
            feature, column = place.split("_")
            table[feature][("cpp", "c", "python", "cli").index(column)] = cell
        return HEAD + "".join(f"| {feature} | {' | '.join(cells)} |\n" for feature, cells in table.items())

    def assert_found(self, page, *problems):
        self.put("docs/capabilities.md", page)
        printed = super().assert_found(f" {len(problems)} faults")
        self.assertEqual(printed[:-1], [f"docs/capabilities.md:{problem}" for problem in problems])

    def test_accepts_the_tree(self):
        self.copy("include", "src/c_api", "apps", "python/raymap", "docs")
        self.assert_accepted()

    def test_accepts_names_of_every_kind(self):
        self.put_tree()
        self.put("docs/capabilities.md", self.rows() + REASONS)
        self.assert_accepted()

    def test_finds_names_that_do_not_exist(self):
        self.put_tree()
        for place, line, name in (
                ("read_cpp", 3, "readMesh`, `notThere"), ("read_cpp", 3, "readMesh`, `Mesh::faces"),
                ("read_cpp", 3, "readMesh`, `helper"), ("read_cpp", 3, "readMesh`, `record"),
                ("read_cpp", 3, "readMesh`, `path"), ("sample_cpp", 6, "Surface::distance`, `Options::most`, `Surface::hidden"),
                ("read_c", 3, "raymap_mesh_load`, `raymap_mesh_write"), ("read_c", 3, "raymap_mesh_load`, `\"size\""),
                ("inspect_c", 4, "raymap_view::down"), ("read_python", 3, "load`, `save"), ("read_python", 3, "load`, `Options"),
                ("sample_python", 6, "Field.sample(inside)"), ("sample_python", 6, "Field.save"),
                ("band_python", 5, "load(bend)"), ("read_cli", 3, "raymap read"),
                ("inspect_cli", 4, "raymap info --fast"), ("inspect_cli", 4, "raymap info --output"),
                ("inspect_cli", 4, "raymap info --json --output"), ("inspect_cli", 4, "raymap info`, `raymap --json"), ("inspect_cli", 4, "raymap info`, `raymap --quiet")):
            with self.subTest(name):
                feature, column = place.split("_")
                label = {"cpp": "C++", "c": "C", "python": "Python", "cli": "Command line"}[column]
                self.assert_found(self.rows(**{place: f"`{name}`"}) + REASONS,
                                  f"{line}: {feature}, {label}: there is no {name.split('`')[-1]}")

    def test_finds_public_names_that_no_row_mentions(self):
        self.put_tree()
        for place, name, label in (
                ("read_cpp", "readMesh", "C++"), ("sample_cpp", "Surface::distance", "C++"),
                ("read_c", "raymap_mesh_load", "C"), ("inspect_cli", "raymap info", "Command line")):
            with self.subTest(name):
                rest = ", `Options::most`" if place == "sample_cpp" else ""
                self.assert_found(self.rows(**{place: "– (1)" if not rest else rest[2:]}) + REASONS,
                                  f" no row mentions {name} ({label})")
        self.assert_found(self.rows(inspect_python="– (1)", sample_python="– (1)") + REASONS,
                          " no row mentions Field (Python)")

    def test_finds_new_names(self):
        self.put_tree()
        self.put("include/raymap/new.h", "namespace raymap {\nRAYMAP_API void writeMesh(const Mesh&);\n}\n")
        self.put("apps/new.cpp", 'app.addCommand("repair", "Repairs");\n')
        self.put("python/raymap/__init__.py", '__all__ = ["Field", "load", "save"]\n')
        self.assert_found(self.rows() + REASONS, " no row mentions writeMesh (C++)", " no row mentions save (Python)",
                          " no row mentions raymap repair (Command line)")

    def test_finds_cells_without_a_reason(self):
        self.put_tree()
        for cell in "", "–", "no", "– (x)":
            with self.subTest(cell):
                self.assert_found(self.rows(read_cli=cell) + REASONS, "3: read, Command line: is empty; name what offers it, "
                                  "or write – and the number of a reason: – (1)")
        self.assert_found(self.rows(read_cli="– (2)") + REASONS, "3: read, Command line: there is no reason 2")

    def test_finds_rows_with_too_few_cells(self):
        self.put_tree()
        self.assert_found(self.rows() + "| more | – (1) |\n" + REASONS, "7: more has 1 cells instead of 4")

    def test_a_page_without_rows_is_an_error(self):
        self.put("docs/capabilities.md", "# Nothing\n")
        self.put("docs/dev/option_table.md", "")
        self.assertIn("0 features", self.output(1))


if __name__ == "__main__":
    unittest.main()
