#include <raymap/raymap.h>

#include <cstdio>
#include <iostream>

#include "checks.h"
#include "commands.h"
#include "report.h"

namespace raymap {

namespace {

namespace fs = std::filesystem;

constexpr const char* kFooter = R"(Example:
  raymap generate bunny.obj -o a.nrrd
  raymap generate bunny.obj -o b.nrrd --sign paths
  raymap compare a.nrrd b.nrrd -o difference.png

The picture shows the slice with the most sign differences: red is inside in a only, green in b only. If no
sign differs, it shows the slice with the largest difference, from white (equal) to dark red.)";

struct Arguments {
  fs::path a, b, picture;
  bool isJson = false;
};

Json toJson(const Comparison& found) {
  return {{"samples", found.samples},
          {"max", found.maxError},
          {"mean", found.meanError},
          {"rms", found.rmsError},
          {"sign_differences", found.signDifferences},
          {"non_finite", found.nonFinite},
          {"worst_sample", {found.worstSample.x, found.worstSample.y, found.worstSample.z}}};
}

void print(const Comparison& found) {
  std::printf("samples           %s\n", grouped(found.samples).c_str());
  std::printf("sign differences  %s, %.4g %%\n", grouped(found.signDifferences).c_str(),
              100.0 * double(found.signDifferences) / double(found.samples));
  std::printf("largest           %.4g samples, at %d %d %d\n", found.maxError, found.worstSample.x,
              found.worstSample.y, found.worstSample.z);
  std::printf("mean              %.4g samples\n", found.meanError);
  std::printf("root mean square  %.4g samples\n", found.rmsError);
  if (found.nonFinite > 0)
    std::printf("not finite        %s, left out of all the above\n", grouped(found.nonFinite).c_str());
}

void run(const Arguments& arguments) {
  checkOutputs({{"--output", arguments.picture, {".png"}}});
  const Field a = readField(arguments.a), b = readField(arguments.b);
  const Comparison found = compareFields(a, b);
  if (!arguments.picture.empty()) writePng(arguments.picture, renderComparison(a, b));
  if (arguments.isJson) {
    std::cout << toJson(found).dump(2) << "\n";
    return;
  }
  print(found);
  if (!arguments.picture.empty()) printWritten(arguments.picture);
}

}  // namespace

void addCompare(CLI::App& app) {
  CLI::App* command = app.add_subcommand("compare", "Compare two fields on the same grid");
  const auto arguments = std::make_shared<Arguments>();
  command->add_option("a", arguments->a, "First field")->type_name("FIELD")->required();
  command->add_option("b", arguments->b, "Second field")->type_name("FIELD")->required();
  command->add_option("-o,--output", arguments->picture, "Picture of the differences, .png")
      ->type_name("FILE");
  command->add_flag("--json", arguments->isJson, "Print JSON");
  command->footer(kFooter);
  command->callback([arguments] { run(*arguments); });
}

}  // namespace raymap
