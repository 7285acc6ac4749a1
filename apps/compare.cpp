#include <raymap/json.h>
#include <raymap/raymap.h>

#include <cstdio>
#include <iostream>
#include <variant>

#include "checks.h"
#include "commands.h"
#include "field_array.h"
#include "field_options.h"
#include "report.h"
#include "terminal.h"

namespace raymap {

namespace {

namespace fs = std::filesystem;

constexpr const char* kCompareFooter = R"(Example:
  raymap generate bunny.obj -o a.nrrd
  raymap generate bunny.obj -o b.nrrd --sign paths
  raymap compare a.nrrd b.nrrd -o difference.png

The picture shows the slice with the most sign differences: red is inside in a only, green in b only. If no
sign differs, it shows the slice with the largest difference, from white (equal) to dark red.

Files of generate --winding, --confidence and --triangle-ids are compared too.)";

struct CompareArguments {
  StreamFormat format;
  fs::path a, b, picture;
  std::string as;
  size_t memoryLimit = 0;
  bool isJson = false;
};

void printCount(const char* what, size_t count, const Comparison& found) {
  std::printf("%-16s  %s, %.4g %%\n", what, grouped(count).c_str(),
              100.0 * double(count) / double(found.samples));
}

void print(const Comparison& found, FieldArray array) {
  std::printf("samples           %s\n", grouped(found.samples).c_str());
  if (array == FieldArray::Triangle) {
    printCount("differences", found.differences, found);
    return;
  }
  const char* const unit = array == FieldArray::Distance ? " samples" : "";
  if (array == FieldArray::Distance) printCount("sign differences", found.signDifferences, found);
  std::printf("largest           %.4g%s, at %d %d %d\n", found.maxError, unit, found.worstSample.x,
              found.worstSample.y, found.worstSample.z);
  std::printf("mean              %.4g%s\n", found.meanError, unit);
  std::printf("root mean square  %.4g%s\n", found.rmsError, unit);
  if (found.nonFinite > 0)
    std::printf("not finite        %s, left out of all the above\n", grouped(found.nonFinite).c_str());
}

FieldArray chooseCommon(const CompareArguments& arguments, Field& a, Field& b) {
  const FieldArray ofA = chooseArray(arguments.a, arguments.as, a);
  const FieldArray ofB = chooseArray(arguments.b, arguments.as, b);
  if (ofA != ofB)
    throw Error(ErrorCode::Usage, arguments.a.string() + " holds the array '" + std::string(name(ofA)) +
                                      "', " + arguments.b.string() + " the array '" + std::string(name(ofB)) +
                                      "'; compare files of the same array, or say " +
                                      "with --as which one to take");
  return ofA;
}

Field load(const fs::path& path, const CompareArguments& arguments) {
  return loadField(path, arguments.format.input, arguments.format.grid);
}

void compare(const CompareArguments& arguments, Field& a, Field& b) {
  const FieldArray array = chooseCommon(arguments, a, b);
  const Comparison found = compareFields(a, b, array);
  constexpr int kWidth = 1024;
  if (!arguments.picture.empty()) writePng(arguments.picture, renderComparison(a, b, kWidth, array));
  if (arguments.isJson) {
    Json json = toJson(found);
    json["array"] = name(array);
    std::cout << textOf(json);
    return;
  }
  print(found, array);
  if (!arguments.picture.empty()) printWritten(arguments.picture);
}

void run(CompareArguments& arguments) {
  const std::vector<Output> outputs{{"--output", arguments.picture, {".png"}}};
  prepareFiles(arguments.format, {{arguments.a, fieldExtensions()}, {arguments.b, fieldExtensions()}},
               outputs);
  Field a = load(arguments.a, arguments), b = load(arguments.b, arguments);
  if (a.narrow && !b.narrow) a = toDense(a);
  if (b.narrow && !a.narrow) b = toDense(b);
  compare(arguments, a, b);
}

}  // namespace

void addCompare(Program& program) {
  Command& command = program.addCommand("compare", "Compare two fields on the same grid", kCompareFooter);
  auto& arguments = command.runs<CompareArguments>(run);
  addOperand(command, "FIELD", &arguments.a, "First field");
  addOperand(command, "FIELD", &arguments.b, "Second field");
  addOutput(command, arguments.picture, "Picture of the differences to write", {".png"});
  addOptions(command, {{"--format", &arguments.format.given},
                       {"--grid", &arguments.format.grid},
                       {"--as", &arguments.as},
                       {"--overwrite", &arguments.format.mayOverwrite}});
  addMemoryLimit(command, arguments.memoryLimit);
  addJsonOption(command, arguments.isJson);
}

}  // namespace raymap
