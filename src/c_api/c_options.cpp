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

void setText(raymap_options& options, const std::string& option, const char* value) {
  if (option == "distance")
    options.field.distance = fromName<DistanceMode>(value);
  else if (option == "sign")
    options.field.sign = fromName<SignMode>(value);
  else if (option == "sampling")
    options.field.sampling = fromName<Sampling>(value);
  else if (option == "orientation")
    options.field.orientation = fromName<Orientation>(value);
  else if (option == "device")
    options.machine.device = value;
  else
    throw Error(ErrorCode::Usage, "there is no option '" + option +
                                      "' with a name; use distance, sign, sampling, orientation or device");
}

/// Sets an option that is a number. Throws `Error(Usage)` for another name.
void setNumber(raymap_options& options, const std::string& option, double value) {
  const auto integer = [&] {
    return static_cast<int>(whole(option, value, std::numeric_limits<int>::max()));
  };
  const auto isOn = [&] { return whole(option, value, 1.0) == 1.0; };
  if (option == "passes")
    options.field.passes = integer();
  else if (option == "threads")
    options.machine.threads = integer();
  else if (option == "memory_limit")
    options.machine.memoryLimit = static_cast<size_t>(whole(option, value, 0x1p62));
  else if (option == "threshold")
    options.field.threshold = value;
  else if (option == "band")
    options.field.band = value;
  else if (option == "thickness")
    options.field.thickness = value;
  else if (option == "compact")
    options.isCompact = isOn();
  else if (option == "invert")
    options.field.invert = isOn();
  else if (option == "close_holes")
    options.field.closeHoles = isOn();
  else if (option == "triangle")
    options.field.triangle = isOn();
  else if (option == "winding")
    options.field.winding = isOn();
  else if (option == "confidence")
    options.field.confidence = isOn();
  else if (option == "allow_empty")
    options.field.allowEmpty = isOn();
  else
    throw Error(ErrorCode::Usage, "there is no option '" + option +
                                      "' with a number; use passes, threshold, band, thickness, threads, "
                                      "memory_limit, compact, invert, close_holes, triangle, winding, "
                                      "confidence or allow_empty");
}

}  // namespace

raymap_options* raymap_options_create(void) {
  return create([] { return std::make_unique<raymap_options>(); });
}

void raymap_options_free(raymap_options* options) {
  delete options;
}

raymap_result raymap_options_set_text(raymap_options* options, const char* option, const char* value) {
  return guard([&] {
    setText(need(options, "the handle of options"), &need(option, "the option"), &need(value, "the value"));
  });
}

raymap_result raymap_options_set_number(raymap_options* options, const char* option, double value) {
  return guard(
      [&] { setNumber(need(options, "the handle of options"), &need(option, "the option"), value); });
}

raymap_result raymap_options_set_offsets(raymap_options* options, const int32_t* offsets, size_t count) {
  return guard([&] {
    std::vector<glm::ivec3>& points = need(options, "the handle of options").field.offsets;
    if (count > 0) need(offsets, "the array of offsets");
    points.resize(count);
    for (size_t p = 0; p < count; ++p) points[p] = {offsets[3 * p], offsets[3 * p + 1], offsets[3 * p + 2]};
  });
}

raymap_result raymap_options_set_progress(raymap_options* options, raymap_progress_callback callback,
                                          void* user) {
  return guard([&] {
    ProgressCallback& progress = need(options, "the handle of options").machine.progress;
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
    WarningCallback& warn = need(options, "the handle of options").machine.warn;
    warn = nullptr;
    if (callback)
      warn = [callback, user](const Warning& warning) {
        callback(std::string(name(warning.code)).c_str(), warning.message.c_str(), user);
      };
  });
}
