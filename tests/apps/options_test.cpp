// One table of options over commands, and what people get who guess.

#include <map>
#include <regex>
#include <set>
#include <sstream>

#include "cli.h"

namespace raymap {
namespace {

class CliOptions : public Cli {
 protected:
  std::vector<std::string> commands() const {
    std::vector<std::string> names;
    const std::regex entry("^  ([a-z]+) ");
    std::istringstream lines(succeed("--help").out);
    std::string line;
    while (std::getline(lines, line) && line != "Commands:") {
    }
    while (std::getline(lines, line) && !line.empty())
      if (std::smatch found; std::regex_search(line, found, entry)) names.push_back(found[1]);
    return names;
  }

  /// Returns the entry of each option in the help of a command: names, value, help and default.
  std::map<std::string, std::string> entries(const std::string& command) const {
    std::map<std::string, std::string> found;
    std::istringstream lines(run(command + " --help", "COLUMNS=2000").out);
    const std::regex names("^  (?:-[a-z], )?(--[a-z-]+)");
    std::string line, name;
    while (std::getline(lines, line)) {
      std::smatch match;
      if (std::regex_search(line, match, names)) {
        name = match[1];
        found[name] = line;
      } else if (line.starts_with("        ") && !name.empty()) {
        found[name] += line;
      } else {
        name.clear();
      }
    }
    for (auto& [option, text] : found)
      if (text.ends_with(" (required)")) text.resize(text.size() - std::string(" (required)").size());
    return found;
  }

  /// Returns the last line of stderr, or all of stdout if it is empty.
  std::string said(const std::string& arguments) const {
    const Result result = run(arguments);
    EXPECT_LE(result.code, 10) << arguments;
    return result.err.empty() ? result.out : result.err;
  }
};

TEST_F(CliOptions, AreDescribedAlikeInEveryCommand) {
  std::map<std::string, std::string> known;
  std::map<std::string, std::set<std::string>> users;
  const std::vector<std::string> all = commands();
  ASSERT_EQ(all.size(), 16u);
  for (const std::string& command : all)
    for (const auto& [option, text] : entries(command)) {
      const auto [same, isNew] = known.emplace(option, text);
      EXPECT_TRUE(same->second == text || option == "--output") << command << text;
      users[option].insert(command);
    }
  EXPECT_GT(known.size(), 60u);
  const auto expectIn = [&](const char* option, const std::set<std::string>& wanted) {
    EXPECT_EQ(users[option], wanted) << option;
  };
  expectIn("--threads",
           {"generate", "info", "check", "query", "sample", "mesh", "render", "view", "repair", "simplify"});
  expectIn("--memory-limit", {"generate", "info", "check", "query", "sample", "mesh", "render", "view",
                              "repair", "simplify", "compare", "convert"});
  expectIn("--device", {"generate", "mesh", "render", "view", "repair"});
  expectIn("--stats", {"generate", "query", "sample", "mesh", "repair", "simplify"});
  expectIn("--json", {"generate", "info", "check", "query", "sample", "mesh", "repair", "simplify", "compare",
                      "devices"});
  expectIn("--overwrite", {"generate", "info", "query", "sample", "mesh", "render", "repair", "simplify",
                           "compare", "convert"});
  for (const char* option :
       {"--unit", "--from", "--to", "--scale", "--height", "--fit", "--rotate", "--translate"})
    expectIn(option, {"generate", "info", "check", "query", "sample", "mesh", "render", "repair", "simplify",
                      "convert"});
  expectIn("--up", {"info", "mesh", "render", "view", "repair", "simplify", "convert"});
  expectIn("--recenter", {"mesh", "repair", "simplify", "convert"});
  expectIn("--tolerance", {"mesh", "repair", "simplify"});
  expectIn("--triangles", {"mesh", "repair", "simplify"});
  expectIn("--bounds", {"generate", "mesh", "render"});
  expectIn("--voxel-size", {"generate", "mesh", "render", "repair"});
  expectIn("--shape", {"generate", "mesh", "render"});
  expectIn("--close-holes", {"generate", "mesh", "view", "repair"});
  expectIn("--quiet", {all.begin(), all.end()});
  expectIn("--verbose", {all.begin(), all.end()});
  expectIn("--progress", {all.begin(), all.end()});
}

TEST_F(CliOptions, SayWhatEachCommandWrites) {
  const std::string meshes = "Mesh to write: .ply, .obj, .stl, .glb or .3mf",
                    folder = "; or a folder, for a mesh of each input, with its name";
  const std::map<std::string, std::string> texts{
      {"generate",
       "Field to write: .nrrd, .npy, .npz, .vti, .vdb or .nvdb; or a folder, for a field of each input, with "
       "its name"},
      {"query", "Results to write: .csv, .npy, .npz or .ply"},
      {"sample", "Points to write: .npz, .csv or .ply"},
      {"mesh", meshes},
      {"repair", meshes + folder},
      {"simplify", meshes + folder},
      {"render", "Picture to write: .png; or a page: .html; of --frames, also a movie: .mp4"},
      {"compare", "Picture of the differences to write: .png"},
      {"convert",
       "File to write. Of a field: .nrrd, .npy, .npz, .vti, .vdb or .nvdb. Of a mesh: .ply, .obj, .stl, .glb "
       "or .3mf. Or a folder, for a file of each input, with its name"},
      {"example", "Mesh to write: .ply"},
      {"completion", "Script to write; without it, it is printed"},
      {"manual", "Page to write; without it, it is printed. In a folder it is raymap.1 or raymap-COMMAND.1"}};
  size_t count = 0;
  for (const std::string& command : commands()) {
    const auto all = entries(command);
    const auto output = all.find("--output");
    EXPECT_EQ(output != all.end(), texts.contains(command)) << command;
    if (output == all.end()) continue;
    const std::string name = "  -o, --output, --out FILE", blanks(30 - name.size(), ' ');
    EXPECT_EQ(output->second.rfind(name + blanks + texts.at(command), 0), 0u) << output->second;
    EXPECT_EQ(output->second.size() == 30 + texts.at(command).size(), command != "manual") << output->second;
    ++count;
  }
  EXPECT_EQ(count, texts.size());
}

TEST_F(CliOptions, ShowAllSpellingsShortOnesFirst) {
  const std::string help = run("generate --help", "COLUMNS=2000").out;
  for (const char* names :
       {"\n  -r, --resolution, --res N  ", "\n  --voxel-size, --voxel, --spacing LENGTH\n",
        "\n  -f, --overwrite, --force    ", "\n  -j, --threads, --jobs N     ",
        "\n  --close-holes, --no-close-holes, --fill-holes, --no-fill-holes\n", "\n  -v, --verbose   "})
    EXPECT_NE(help.find(names), std::string::npos) << names << help;
}

TEST_F(CliOptions, AreListedInTheDocs) {
  const std::string table = succeed("manual --table").out;
  EXPECT_NE(
      table.find("| `--voxel-size` | `--voxel`, `--spacing` | LENGTH |  | generate, mesh, render, repair |"),
      std::string::npos)
      << table;
  EXPECT_NE(readBytes(RAYMAP_DOCS "/dev/option_table.md").find("\n" + table), std::string::npos)
      << "docs/dev/option_table.md: replace the table by the output of raymap manual --table";
}

TEST_F(CliOptions, AreUnderstoodOrNamed) {
  writeTorus();
  std::ofstream(path("p.csv")) << "x,y,z\n0,0,0\n";
  // What a newcomer writes, and what the program says: empty if it does what is meant.
  const std::vector<std::pair<std::string, std::string>> guesses{
      {"repair torus.ply -o o.stl -q --res 64 --hollow 0.3", ""},
      {"repair torus.ply -o o.stl -q --res 64 --wall 0.3", ""},
      {"repair torus.ply -o o.stl --thickness 2",
       "--min-thickness T makes thin parts T thick, --shell T hollows"},
      {"repair torus.ply -o o.stl --simplify 0.5",
       "--triangles N or --tolerance T of simplify, repair and mesh"},
      {"repair torus.ply -o o.stl --decimate 0.5",
       "--triangles N or --tolerance T of simplify, repair and mesh"},
      {"simplify torus.ply -o o.stl --target 99",
       "--triangles N or --tolerance T of simplify, repair and mesh"},
      {"mesh torus.ply -o o.stl --faces 99", "--triangles N or --tolerance T of simplify, repair and mesh"},
      {"repair torus.ply -o o.stl -q --max-triangles 500", ""},
      {"convert torus.ply o.stl --max-triangles 99", "--triangles is an option of mesh, repair and simplify"},
      {"convert torus.ply o.3mf -q --units MM", ""},
      {"convert torus.ply o.3mf -q --unit inches", ""},
      {"convert torus.ply o.stl -q --center", ""},
      {"convert torus.ply o.stl -q --recentre", ""},
      {"convert torus.ply torus.ply -q --force", ""},
      {"generate torus.ply -o o.nrrd -q --res 8", ""},
      {"generate torus.ply -o o.nrrd -q -r 8", ""},
      {"generate torus.ply -o o.nrrd -q --voxel 1", ""},
      {"generate torus.ply -o o.nrrd -q --spacing 1 --fill-holes", ""},
      {"generate torus.ply --out o.nrrd -q --RES=8 --sign HARMONIC -j 1", ""},
      {"generate torus.ply -o o.nrrd -q --res 8 --distance neighbors", ""},
      {"generate torus.ply -o o.nrrd -q --voxel 1 --bounds -4,-3,-1,4,3,1", ""},
      {"generate torus.ply -o o.nrrd -q --voxel 1 --bounds '-4 -3 -1, 4 3 1'", ""},
      {"generate torus.ply -o o.nrrd --bounds -4 -3 -1 4 3", "--bounds takes 6 numbers, and here are 5"},
      {"generate torus.ply -o o.nrrd --dry-run", "raymap info MESH says what is wrong and what to do"},
      {"generate torus.ply -o o.nrrd --resolutoin 8", "did you mean --resolution?"},
      {"generate torus.ply -o o.nrrd --siz 8", "not understood: --siz; see raymap generate --help\n"},
      {"generate torus.ply -o o.nrrd --fsp 8", "did you mean --fps?"},
      {"generate torus.ply -o o.nrrd --foo 8", "not understood: --foo; see raymap generate --help\n"},
      {"generate torus.ply -o o.nrrd --grd 8", "not understood: --grd; see raymap generate --help\n"},
      {"generate torus.ply -o o.vdb --half-width 3", "--half-width; --band SAMPLES of generate clamps"},
      {"generate torus.ply -o o.vdb --exterior-band 3", "--exterior-band; --band SAMPLES of generate clamps"},
      {"generate torus.ply -o o.vdb --background 3", "--band SAMPLES of generate: the background of a .vdb"},
      {"convert torus.ply -o o.vdb --name s", "--grid-name NAME of generate and convert names the grid"},
      {"mend torus.ply", "unknown command 'mend'; use one of: generate"},
      {"viw torus.ply", "unknown command 'viw'; did you mean view?"},
      {"generate torus.ply -o o.nrrd -q --dims 8 8 8", ""},
      {"generate torus.ply -o o.nrrd --cube", "--shape N N N makes N samples along every side"},
      {"generate torus.ply -o o.nrrd --gpu", "--device vulkan computes on a GPU"},
      {"generate torus.ply -o o.nrrd --cut", "--cut; it is an option of render"},
      {"generate torus.ply -o o.nrrd --sign harmonc", "--sign: must be one of harmonic, exact, paths,"},
      {"generate torus.ply -o o.nrrd --resolution 8 --resolution 9", "--resolution is given more than once"},
      {"generate torus.ply -o o.nrrd --invert=3", "--invert takes no value"},
      {"generate -i torus.ply -o o.nrrd", "files that are read are named without an option"},
      {"generate torus.ply", "--output FILE is required"},
      {"generate torus.ply -o", "--output needs a value: --output FILE"},
      {"query torus.ply p.csv -q -o o.ply --color", ""},
      {"sample torus.ply -q -o o.npz -n 10 --normalise", ""},
      {"-q render torus.ply -o o.png --res 16 --size 20 10 --up Z", ""},
      {"render torus.ply -o o.png --up w", "3 numbers, or an axis such as z or -y, and here are 0 before w"},
      {"render torus.ply -o o.png --width 100", "--size WIDTH HEIGHT of render"},
      {"convert torus.ply -dash.off", "it begins like an option; a file of this name is ./-dash.off"},
      {"convert torus.ply a.ply b.ply", "--output is required"},
      {"mesh torus.ply b.ply -o o.ply", "there are more files than the command takes: b.ply"},
      {"genrate torus.ply", "unknown command 'genrate'; did you mean generate?"},
      {"fix torus.ply", "raymap repair MESH -o RESULT"},
      {"voxelize torus.ply", "raymap generate MESH -o FIELD"},
      {"decimate torus.ply", "raymap simplify MESH -o RESULT --triangles N"},
      {"INFO torus.ply -q", ""},
      {"generate --bounds -4 -3 -1 4 3 1 torus.ply -o o.nrrd -q --voxel 1", ""},
      {"render --size 20 10 torus.ply -o o.png -qr16", ""},
      {"query --arrays distance,closest torus.ply p.csv -qo o.csv", ""},
      {"query torus.ply p.csv -q -o o.csv --arrays distance closest", ""},
      {"generate -qfo o.nrrd -r8 -- torus.ply", ""},
      {"generate -- torus.ply", "--output FILE is required"},
      {"check -q -- torus.ply torus.ply", ""},
      {"mesh torus.ply torus.ply -o o.ply", "more files than the command takes: torus.ply;"},
      {"generate torus.ply torus.ply -o o.nrrd", "name a folder for them"},
      {"info torus.ply -q=3", "not understood: -=3"},
      {"-V", "raymap 0."},
      {"help repair", "Usage: raymap repair [OPTIONS] MESH"},
  };
  EXPECT_GE(guesses.size(), 40u);
  for (const auto& [arguments, answer] : guesses) {
    const std::string text = said(arguments);
    if (answer.empty())
      EXPECT_EQ(text, "") << arguments;
    else
      EXPECT_NE(text.find(answer), std::string::npos) << arguments << ": " << text;
  }
}

TEST_F(CliOptions, MeanTheSameInEverySpelling) {
  writeTorus();
  const auto made = [&](const std::string& options) {
    succeed("generate torus.ply -o f.nrrd -q --device cpu " + options);
    return readBytes(path("f.nrrd"));
  };
  const std::string plain = made("--voxel-size 1 --bounds -4 -3 -1 4 3 1");
  EXPECT_EQ(made("--VOXEL-SIZE=1 --bounds=-4,-3,-1,4,3,1"), plain);
  EXPECT_EQ(made("--spacing 1 --box '-4, -3, -1' 4 3,1"), plain);
  EXPECT_NE(made("--voxel-size 1 --bounds -4 -3 -1 4 3 2"), plain);
  const auto turned = [&](const std::string& up) {
    succeed("convert torus.ply t.ply -q --up " + up);
    return readBytes(path("t.ply"));
  };
  EXPECT_EQ(turned("y"), turned("0 1 0"));
  EXPECT_EQ(turned("-X"), turned("-2,0,0"));
  EXPECT_NE(turned("y"), turned("-y"));
  EXPECT_EQ(turned("z"), readBytes(path("torus.ply")));
}

TEST_F(CliOptions, TakeARedundantFormat) {
  writeTorus();
  succeed("convert torus.ply o.stl --format stl");
  succeed("convert torus.ply o.obj --format .PLY");
  expectFailure(
      "convert torus.ply o.stl --format obj", ErrorCode::Usage,
      "--format obj: is not what the names of o.stl and torus.ply say; leave it out, or rename the file");
}

TEST_F(CliOptions, PrintAsMuchAsIsWanted) {
  writeTorus();
  EXPECT_EQ(succeed("generate torus.ply -o f.nrrd --resolution 8 --quiet").out, "");
  EXPECT_EQ(succeed("-q info torus.ply").out, "");
  EXPECT_EQ(Json::parse(succeed("-q info torus.ply --json").out)["triangles"], 1920);
  EXPECT_EQ(readBytes(path("f.nrrd")).substr(0, 4), "NRRD");
  EXPECT_EQ(succeed("convert f.nrrd - --format nrrd -q").out, readBytes(path("f.nrrd")));
  const Result loud = run("generate torus.ply -o f.nrrd --resolution 8 -v");
  EXPECT_TRUE(std::regex_search(loud.err, std::regex("raymap: [0-9.]+ s: diagnose\n"))) << loud.err;
  EXPECT_EQ(
      Json::parse(
          shell("$R generate torus.ply -o f.nrrd --resolution 8 --json 2>/dev/null").out)["grid"]["dims"][0],
      8);
  expectFailure("info torus.ply -q -v", ErrorCode::Usage, "cannot be used together");
}

TEST_F(CliOptions, FitTheTerminal) {
  for (const int width : {60, 120}) {
    std::istringstream lines(run("help generate", "COLUMNS=" + std::to_string(width)).out);
    size_t longest = 0;
    for (std::string line; std::getline(lines, line);)
      if (line.starts_with("        ")) longest = std::max(longest, line.size());
    EXPECT_LE(longest, size_t(width));
    EXPECT_GT(longest, size_t(width) - 20);
  }
}

TEST_F(CliOptions, AreCompletedByShells) {
  const auto completed = [&](const std::string& words, const std::string& last) {
    return shell("source <($R completion bash)\nCOMP_WORDS=(raymap " + words + " '" + last +
                 "'); COMP_CWORD=$((${#COMP_WORDS[@]} - 1)); _raymap; echo ${COMPREPLY[*]}")
        .out;
  };
  EXPECT_EQ(completed("", "gen"), "generate\n");
  EXPECT_EQ(completed("repair a.ply", "--vox"), "--voxel-size\n");
  EXPECT_EQ(completed("generate a.ply --sign", "ra"), "rays ray\n");
  EXPECT_EQ(completed("devices", "--vox"), "\n");
  const std::string zsh = succeed("completion zsh").out, fish = succeed("completion FISH").out;
  EXPECT_NE(zsh.find("'--sign["), std::string::npos);
  EXPECT_NE(zsh.find(":MODE:(harmonic exact paths evolution rays ray none)'"), std::string::npos);
  EXPECT_NE(
      fish.find(
          "complete -c raymap -n '__fish_seen_subcommand_from generate' -l sign -x -a 'harmonic exact paths"),
      std::string::npos);
  for (const char* check : {"command -v zsh || exit 0; $R completion zsh >f; zsh -n f",
                            "command -v fish || exit 0; $R completion fish >f; fish -n f"})
    EXPECT_EQ(shell(check).err, "");
  expectFailure("completion tcsh", ErrorCode::Usage, "must be one of bash, zsh, fish, not tcsh");
}

TEST_F(CliOptions, AreOnManPages) {
  EXPECT_NE(succeed("manual").out.find("\n.B repair\nMake a watertight solid"), std::string::npos);
  for (const std::string& command : commands()) {
    const std::string page = succeed("manual " + command).out;
    EXPECT_EQ(page.find(".TH raymap\\-" + command + " 1"), 0u) << page;
    for (const auto& [option, text] : entries(command)) {
      const std::string name = std::regex_replace(option, std::regex("-"), "\\-");
      EXPECT_TRUE(option == "--help" || page.find(name) != std::string::npos) << option;
    }
  }
  EXPECT_NE(succeed("manual repair").out.find("\n.B \\-r, \\-\\-resolution, \\-\\-res N\n"),
            std::string::npos);
  EXPECT_NE(succeed("manual repair")
                .out.find("\n.TP\n.B \\-o, \\-\\-output, \\-\\-out FILE\nMesh to write: .ply, "),
            std::string::npos);
  EXPECT_EQ(shell("command -v groff || exit 0; $R manual repair | groff -man -Tutf8 -ww -z").err, "");
  expectFailure("manual paint", ErrorCode::Usage, "there is no command paint");
}

TEST_F(CliOptions, HaveAManPageOfEveryCommandInAFolder) {
  fs::create_directory(path("man1"));
  const Result all = succeed("manual -o man1");
  EXPECT_EQ(all.out.rfind("wrote man1/raymap.1, ", 0), 0u) << all.out;
  EXPECT_EQ(readBytes(path("man1/raymap.1")), succeed("manual").out);
  size_t count = 1;
  for (const std::string& command : commands()) {
    EXPECT_EQ(readBytes(path("man1/raymap-" + command + ".1")), succeed("manual " + command).out);
    ++count;
  }
  EXPECT_EQ(
      static_cast<size_t>(std::distance(fs::directory_iterator(path("man1")), fs::directory_iterator())),
      count);
  fs::create_directory(path("one"));
  EXPECT_EQ(succeed("manual check -q -o one").out, "");
  EXPECT_EQ(readBytes(path("one/raymap-check.1")), readBytes(path("man1/raymap-check.1")));
  EXPECT_EQ(std::distance(fs::directory_iterator(path("one")), fs::directory_iterator()), 1);
}

TEST_F(CliOptions, WrapParagraphsAsOne) {
  const auto below = [&](int width) {
    const std::string help = run("check --help", "COLUMNS=" + std::to_string(width)).out;
    return help.substr(help.find("Examples:"));
  };
  const std::string example = "  raymap check part.stl && echo 'ready to print'\n";
  const std::string wide = below(400);
  EXPECT_EQ(wide.rfind("Examples:\n" + example, 0), 0u) << wide;
  const std::string paragraph = wide.substr(wide.find("\n\nGood is") + 2);
  EXPECT_EQ(std::ranges::count(paragraph, '\n'), 1) << paragraph;
  const std::string narrow = below(60);
  std::istringstream lines(narrow.substr(narrow.find("\n\nGood is") + 2));
  std::string joined;
  for (std::string line, last; std::getline(lines, line); last = line) {
    EXPECT_LE(line.size(), 60u);
    EXPECT_TRUE(last.empty() || last.size() + 1 + line.find(' ') > 60u) << last;
    joined += line + " ";
  }
  EXPECT_EQ(joined.substr(0, joined.size() - 1) + "\n", paragraph);
}

class CliUnits : public Cli {};

TEST_F(CliUnits, AreConvertedInEveryCommand) {
  writeMesh(path("box.stl"), shapes::box(glm::dvec3(0.0), glm::dvec3(1, 2, 3)));
  const glm::dvec3 inches = 25.4 * glm::dvec3(1, 2, 3);
  const auto expectSize = [&](const Box& box, double tolerance) {
    for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(box.size()[axis], inches[axis], tolerance);
  };
  const std::string units = " --from in --to mm ";
  succeed("convert box.stl a.stl" + units);
  expectSize(bounds(readMesh(path("a.stl"))), 1e-4);
  succeed("repair box.stl -o a.stl" + units);
  expectSize(bounds(readMesh(path("a.stl"))), 1e-4);
  succeed("mesh box.stl -o a.stl --voxel-size 2" + units);
  expectSize(bounds(readMesh(path("a.stl"))), 0.2);
  EXPECT_NEAR(Json::parse(succeed("info box.stl --json" + units).out)["bounds"][1][0].get<double>(), 25.4,
              1e-5);
  EXPECT_EQ(Json::parse(succeed("info box.stl --json" + units).out)["unit"], "mm");
  succeed("generate box.stl -o f.nrrd --voxel-size 1 --bounds 0 0 0 30 60 80" + units);
  const Field field = readField(path("f.nrrd"));
  EXPECT_NEAR(field.distance[field.grid.index({10, 25, 30})], -10.5, 1e-4);
  std::ofstream(path("p.csv")) << "x,y,z\n12.7,25.4,0.5\n";
  succeed("query box.stl p.csv -o r.csv" + units);
  const std::string rows = readBytes(path("r.csv"));
  EXPECT_NEAR(std::stod(rows.substr(rows.rfind(',') + 1)), -0.5, 1e-5);
  succeed("sample box.stl -o s.csv -n 10 --surface 1 --near 0 --stats s.json" + units);
  EXPECT_NEAR(json("s.json")["centre"][2].get<double>(), 0.0, 40.0);
  expectFailure("convert box.stl a.stl --to mm", ErrorCode::Usage,
                "--to mm: box.stl does not state its unit; add --from");
  expectFailure("convert box.stl a.stl --unit mm --to mm", ErrorCode::Usage, "cannot be used together");
  EXPECT_NE(succeed("convert box.stl a.3mf --unit in")
                .out.find("does not state its unit: its numbers are taken as inches (in), and stay; "
                          "--from U --to in converts them from U\n"),
            std::string::npos);
}

TEST_F(CliUnits, ScaleAndMoveFields) {
  writeTorus();
  succeed("generate torus.ply -o f.nrrd --resolution 12 --device cpu");
  succeed("convert f.nrrd g.nrrd --from cm --to mm --translate 1 2 3");
  const Field before = readField(path("f.nrrd")), after = readField(path("g.nrrd"));
  EXPECT_NEAR(after.grid.spacing, 10.0 * before.grid.spacing, 1e-9);
  EXPECT_NEAR(after.grid.origin.y, 10.0 * before.grid.origin.y + 2.0, 1e-9);
  EXPECT_EQ(after.distance[7], 10.0f * before.distance[7]);
  expectFailure("convert f.nrrd g.nrrd --rotate 90 0 0", ErrorCode::Usage, "f.nrrd is a field");
}

TEST_F(CliUnits, TurnAndMoveMeshes) {
  writeMesh(path("box.ply"), shapes::box(glm::dvec3(0.0), glm::dvec3(1, 2, 3)));
  const auto expectBox = [&](const std::string& options, const glm::dvec3& low, const glm::dvec3& high) {
    succeed("convert box.ply a.ply " + options);
    const Mesh mesh = readMesh(path("a.ply"));
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_NEAR(bounds(mesh).min[axis], low[axis], 1e-6) << options << axis;
      EXPECT_NEAR(bounds(mesh).max[axis], high[axis], 1e-6) << options << axis;
    }
    EXPECT_NEAR(diagnose(mesh).signedVolume, 6.0, 1e-5) << options;
  };
  expectBox("--rotate 90 0 0", {0, -3, 0}, {1, 0, 2});
  expectBox("--rotate 0 0 90", {-2, 0, 0}, {0, 1, 3});
  expectBox("--rotate 90 0 90", {0, 0, 0}, {3, 1, 2});
  expectBox("--translate 1 -2,.5", {1, -2, 0.5}, {2, 0, 3.5});
  expectBox("--up x", {-3, 0, 0}, {0, 2, 1});
  expectBox("--up -z", {0, -2, -3}, {1, 0, 0});
  expectBox("--up 0 0 7", {0, 0, 0}, {1, 2, 3});
  expectFailure("convert box.ply a.ply --up 0 0 0", ErrorCode::Usage, "--up: must be a direction, not 0 0 0");
}

}  // namespace
}  // namespace raymap
