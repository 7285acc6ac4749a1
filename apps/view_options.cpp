#include "view_options.h"

#include <raymap/error.h>

namespace raymap {

void addViewOptions(CLI::App& command, ViewArguments& arguments) {
  command.add_option("--size", arguments.size, "Width and height in pixels (default 1024 768)")
      ->expected(2)
      ->check(CLI::Range(1, kMaxPictureSide).description("1 to " + std::to_string(kMaxPictureSide)));
  command.add_option("--direction", arguments.direction, "Direction of the camera (default -0.6 -0.45 -1)")
      ->expected(3);
  command.add_option("--up", arguments.up, "Direction of up (default 0 1 0)")->expected(3);
}

void setView(const ViewArguments& arguments, RenderOptions& options) {
  options.width = arguments.size[0];
  options.height = arguments.size[1];
  const auto set = [](const std::vector<double>& numbers, glm::dvec3& vector) {
    if (!numbers.empty()) vector = {numbers[0], numbers[1], numbers[2]};
  };
  set(arguments.direction, options.direction);
  set(arguments.up, options.up);
  if (glm::length(glm::cross(options.direction, options.up)) < 1e-9)
    throw Error(ErrorCode::Usage, "--direction and --up must be two different directions, not zero");
}

}  // namespace raymap
