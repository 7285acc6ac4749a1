#include "view_options.h"

#include <raymap/error.h>
#include <raymap/io.h>

#include <cmath>

#include "checks.h"
#include "parser.h"

namespace raymap {

namespace {

/// Returns a direction of the camera that goes down by the same share for each axis that may be up.
glm::dvec3 lookingDown(const glm::dvec3& up) {
  const glm::dvec3 size = glm::abs(up);
  constexpr double kDown = -0.45;
  if (size.z > size.y && size.z > size.x) return {-0.6, 1.0, std::copysign(kDown, -up.z)};
  if (size.x > size.y) return {std::copysign(kDown, -up.x), -0.6, -1.0};
  return {-0.6, std::copysign(kDown, -up.y), -1.0};
}

}  // namespace

void addViewOptions(Command& command, ViewArguments& arguments) {
  addOptions(command,
             {{"--size", &arguments.size}, {"--direction", &arguments.direction}, {"--up", &arguments.up}});
}

void addSceneOptions(Command& command, ViewArguments& arguments, RenderOptions& view) {
  addOptions(command, {{"--eye", &arguments.eye},
                       {"--iso", &view.iso},
                       {"--shell", &view.shell},
                       {"--cut-plane", &arguments.cutPlane},
                       {"--slice-plane", &arguments.slicePlane},
                       {"--range", &view.range}});
}

bool isZUp(const std::filesystem::path& path, const std::string& format) {
  const std::vector<std::string> kinds{".stl", ".3mf"};
  return hasExtension(path, kinds) ||
         (!hasExtension(path, meshExtensions()) && hasExtension("x" + format, kinds));
}

RenderOptions defaultView(bool isZUp) {
  RenderOptions options;
  if (isZUp) options.up = {0.0, 0.0, 1.0};
  options.direction = lookingDown(options.up);
  return options;
}

void setView(const ViewArguments& arguments, bool isZUp, RenderOptions& options) {
  options.width = arguments.size[0];
  options.height = arguments.size[1];
  const auto vector = [](const std::vector<double>& numbers) {
    return glm::dvec3(numbers[0], numbers[1], numbers[2]);
  };
  options.up = arguments.up.empty() ? defaultView(isZUp).up : vector(arguments.up);
  options.direction = arguments.direction.empty() ? lookingDown(options.up) : vector(arguments.direction);
  if (!arguments.eye.empty()) options.eye = vector(arguments.eye);
  if (const std::vector<double>& f = arguments.frame; !f.empty())
    options.frame = Box{{f[0], f[1], f[2]}, {f[3], f[4], f[5]}};
  const auto plane = [&](const std::vector<double>& numbers) -> std::optional<Plane> {
    if (numbers.empty()) return {};
    return Plane{.normal = vector(numbers), .offset = numbers[3]};
  };
  options.cutPlane = plane(arguments.cutPlane);
  options.slice = plane(arguments.slicePlane);
  if (glm::length(glm::cross(options.direction, options.up)) < 1e-9)
    throw Error(ErrorCode::Usage, "--direction and --up must be two different directions, not zero");
}

}  // namespace raymap
