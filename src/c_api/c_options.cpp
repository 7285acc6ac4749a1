// The functions of raymap/c.h about options.

#include <raymap/c.h>
#include <raymap/names.h>

#include <cmath>
#include <limits>
#include <string>

#include "c_api/c_handles.h"

using namespace raymap;
using raymap::c::create;
using raymap::c::guard;
using raymap::c::need;

namespace {

/// Returns a number if it is whole, at least 0 and at most `most`. Throws `Error(Usage)` for any other.
double whole(const std::string& option, double value, double most) {
  if (value >= 0.0 && value <= most && value == std::floor(value)) return value;
  throw Error(ErrorCode::Usage, "the option '" + option + "' must be a whole number from 0 to " +
                                    std::to_string(static_cast<uint64_t>(most)) + ", not " +
                                    std::to_string(value));
}

void setText(Options& options, const std::string& option, const char* value) {
  if (option == "distance")
    options.distance = fromName<DistanceMode>(value);
  else if (option == "sign")
    options.sign = fromName<SignMode>(value);
  else if (option == "sampling")
    options.sampling = fromName<Sampling>(value);
  else if (option == "orientation")
    options.orientation = fromName<Orientation>(value);
  else if (option == "device")
    options.device = value;
  else
    throw Error(ErrorCode::Usage, "there is no option '" + option +
                                      "' with a name; use distance, sign, sampling, orientation or device");
}

/// Sets an option that is a number. Throws `Error(Usage)` for another name.
void setNumber(Options& options, const std::string& option, double value) {
  const auto integer = [&] {
    return static_cast<int>(whole(option, value, std::numeric_limits<int>::max()));
  };
  const auto isOn = [&] { return whole(option, value, 1.0) == 1.0; };
  if (option == "passes")
    options.passes = integer();
  else if (option == "threads")
    options.threads = integer();
  else if (option == "memory_limit")
    options.memoryLimit = static_cast<size_t>(whole(option, value, 0x1p62));
  else if (option == "threshold")
    options.threshold = value;
  else if (option == "band")
    options.band = value;
  else if (option == "thickness")
    options.thickness = value;
  else if (option == "invert")
    options.invert = isOn();
  else if (option == "close_holes")
    options.closeHoles = isOn();
  else if (option == "triangle_ids")
    options.triangleIds = isOn();
  else if (option == "winding")
    options.winding = isOn();
  else if (option == "confidence")
    options.confidence = isOn();
  else
    throw Error(ErrorCode::Usage,
                "there is no option '" + option +
                    "' with a number; use passes, threshold, band, thickness, threads, "
                    "memory_limit, invert, close_holes, triangle_ids, winding or confidence");
}

}  // namespace

SurfaceOptions raymap::c::surfaceOptions(const raymap_options* options) {
  const Options& given = optionsOr(options);
  if (given.sign != SignMode::Harmonic && given.sign != SignMode::None)
    throw Error(ErrorCode::Usage, "a surface cannot use the sign '" + std::string(name(given.sign)) +
                                      "'; use harmonic or none");
  return onMachine(SurfaceOptions{.sign = given.sign == SignMode::Harmonic,
                                  .orientation = given.orientation,
                                  .threshold = given.threshold},
                   options);
}

raymap_options* raymap_options_create(void) {
  return create([] { return std::make_unique<raymap_options>(); });
}

void raymap_options_free(raymap_options* options) {
  delete options;
}

raymap_result raymap_options_set_text(raymap_options* options, const char* option, const char* value) {
  return guard([&] {
    setText(need(options, "the handle of options").options, &need(option, "the option"),
            &need(value, "the value"));
  });
}

raymap_result raymap_options_set_number(raymap_options* options, const char* option, double value) {
  return guard(
      [&] { setNumber(need(options, "the handle of options").options, &need(option, "the option"), value); });
}

raymap_result raymap_options_set_offsets(raymap_options* options, const int32_t* offsets, size_t count) {
  return guard([&] {
    std::vector<glm::ivec3>& points = need(options, "the handle of options").options.offsets;
    if (count > 0) need(offsets, "the array of offsets");
    points.resize(count);
    for (size_t p = 0; p < count; ++p) points[p] = {offsets[3 * p], offsets[3 * p + 1], offsets[3 * p + 2]};
  });
}

raymap_result raymap_options_set_progress(raymap_options* options, raymap_progress_callback callback,
                                          void* user) {
  return guard([&] {
    ProgressCallback& progress = need(options, "the handle of options").options.progress;
    progress = nullptr;
    if (callback)
      progress = [callback, user](std::string_view stage, double done) {
        return callback(std::string(stage).c_str(), done, user);
      };
  });
}

raymap_result raymap_options_set_warning(raymap_options* options, raymap_warning_callback callback,
                                         void* user) {
  return guard([&] {
    WarningCallback& warn = need(options, "the handle of options").options.warn;
    warn = nullptr;
    if (callback)
      warn = [callback, user](std::string_view message) { callback(std::string(message).c_str(), user); };
  });
}
