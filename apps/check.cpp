#include <raymap/json.h>
#include <raymap/raymap.h>

#include <cstdio>
#include <optional>
#include <string>
#include <vector>

#include "checks.h"
#include "commands.h"
#include "field_options.h"
#include "mesh_units.h"
#include "report.h"
#include "terminal.h"
#include "verdict.h"

namespace raymap {

namespace {

namespace fs = std::filesystem;

constexpr const char* kCheckFooter = R"(Examples:
  raymap check part.stl && echo 'ready to print'
  raymap check meshes/*.ply
  raymap check meshes/*.ply --json | jq -r 'select(.good | not) | .file'

Good is a mesh of one or several closed solids with nothing wrong. The exit code is 0 if all are good, and 11 if
one is not. If a file cannot be read, it is that of the first such error; the others are checked all the same.)";

constexpr int kBadMesh = 11;

struct CheckArguments {
  StreamFormat format;
  std::vector<fs::path> meshes;
  bool isJson = false, isFast = false;
  MeshUnits units;
  MachineOptions machine;
};

void print(const Json& line) {
  std::fputs(textOf(line, -1).c_str(), stdout);
  finishText();
}

/// Checks a mesh and prints a line about it. Returns whether it is good.
bool checkMesh(const fs::path& path, const CheckArguments& arguments) {
  const Mesh mesh = loadMesh(path, arguments.format.input, arguments.units);
  ProgressLine line;
  const MachineOptions machine = withProgress(arguments.machine, line);
  const Diagnostics found = diagnose(mesh, {}, machine);
  std::optional<SelfIntersections> crossings;
  Arrangement arrangement = Arrangement::Unknown;
  if (!arguments.isFast) {
    crossings = findSelfIntersections(mesh, machine);
    arrangement = arrangeParts(mesh, found, *crossings, machine);
  }
  const Verdict verdict = judge(found, crossings, arrangement);
  line.clear();
  const bool isGood = verdict.kind == MeshKind::CleanSolid || verdict.kind == MeshKind::SeveralSolids;
  if (arguments.isJson) {
    Json json{{"file", path.string()}, {"good", isGood}};
    json.update(
        toJson(verdict, found, crossings, unitOf(arguments.units, named(path, arguments.format.input))));
    print(json);
  } else {
    std::printf("%s: %s, %s\n", displayName(path).c_str(), isGood ? "good" : "bad",
                describeKind(verdict, found, crossings).c_str());
    finishText();
  }
  return isGood;
}

/// Says why a mesh could not be checked.
void reportError(const fs::path& path, const Error& error, const CheckArguments& arguments) {
  if (arguments.isJson)
    print({{"file", path.string()}, {"error", name(error.code())}, {"message", error.what()}});
  printError(error.what());
}

void run(CheckArguments& arguments) {
  std::vector<Input> inputs;
  for (fs::path& mesh : arguments.meshes) inputs.push_back({mesh, meshExtensions()});
  prepareFiles(arguments.format, inputs, {});
  int code = 0;
  bool areGood = true;
  for (const fs::path& mesh : arguments.meshes) try {
      areGood &= checkMesh(mesh, arguments);
    } catch (const Error& error) {
      if (error.code() == ErrorCode::Cancelled || std::ferror(stdout) != 0) throw;
      if (code == 0) code = exitCodeOf(error.code());
      reportError(mesh, error, arguments);
    }
  finishText();
  if (code == 0 && !areGood) code = kBadMesh;
  if (code != 0) throw ExitCode(code);
}

}  // namespace

void addCheck(Program& program) {
  Command& command = program.addCommand("check", "Report whether each mesh is a clean solid", kCheckFooter);
  auto& arguments = command.runs<CheckArguments>(run);
  addOperand(command, "MESH...", &arguments.meshes, "Meshes to read");
  addOptions(command, {{"--format", &arguments.format.given}});
  addJsonOption(command, arguments.isJson);
  addUnitOptions(command, arguments.units);
  addOptions(command, {{"--fast", &arguments.isFast}});
  addCpuOptions(command, arguments.machine);
}

}  // namespace raymap
