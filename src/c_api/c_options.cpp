// The functions of raymap/c.h about options.

#include <raymap/c.h>
#include <raymap/names.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <new>
#include <string>
#include <string_view>
#include <vector>

#include "c_api/c_report.h"

using namespace raymap;
using raymap::c::create;
using raymap::c::guard;
using raymap::c::need;

namespace {

using Json = nlohmann::ordered_json;

AllOptions& allOf(raymap_options* options) {
  return need(options, "the handle of options").all;
}

raymap_result set(raymap_options* options, const char* option, const auto& value) {
  return guard([&] { setOption(allOf(options), &need(option, "the option"), value()); });
}

/// Appends the numbers of nested lists.
void append(const std::string& option, const Json& json, std::vector<double>& numbers) {
  if (json.is_number()) return numbers.push_back(json.get<double>());
  if (!json.is_array())
    throw Error(ErrorCode::Usage, option + " must be a list of numbers, not " + json.dump());
  for (const Json& each : json) append(option, each, numbers);
}

OptionValue valueOf(const std::string& option, const Json& json) {
  if (json.is_boolean()) return json.get<bool>();
  if (json.is_string()) return json.get<std::string>();
  if (json.is_number_float()) return json.get<double>();
  if (json.is_number_unsigned()) return json.get<uint64_t>();
  if (json.is_number()) return json.get<int64_t>();
  std::vector<double> numbers;
  append(option, json, numbers);
  return numbers;
}

Json parsed(const char* text) {
  Json json = Json::parse(text, nullptr, false);
  if (json.is_discarded()) throw Error(ErrorCode::Usage, "the text is no JSON");
  return json;
}

/// Returns a number by keys with dots between them. Throws `Error(Usage)` if there is none.
double numberIn(const Json& json, const std::string& keys) {
  std::string path = "/" + keys;
  std::ranges::replace(path, '.', '/');
  const Json::json_pointer pointer(path);
  const Json found = json.contains(pointer) ? json.at(pointer) : Json("");
  if (found.is_number()) return found.get<double>();
  if (found.is_boolean()) return found.get<bool>() ? 1.0 : 0.0;
  if (found.is_null()) return std::numeric_limits<double>::quiet_NaN();
  throw Error(ErrorCode::Usage, "the JSON has no number '" + keys + "'");
}

}  // namespace

char* raymap::c::ownText(const std::string& text) {
  char* copy = static_cast<char*>(std::malloc(text.size() + 1));
  if (!copy) throw std::bad_alloc();
  std::memcpy(copy, text.c_str(), text.size() + 1);
  return copy;
}

raymap_result raymap_json_number(const char* json, const char* keys, double* number) {
  return guard([&] {
    need(number, "the number") = numberIn(parsed(&need(json, "the JSON")), &need(keys, "the keys"));
  });
}

raymap_options* raymap_options_create(void) {
  return create([] { return std::make_unique<raymap_options>(); });
}

void raymap_options_free(raymap_options* options) {
  delete options;
}

raymap_result raymap_options_set_text(raymap_options* options, const char* option, const char* value) {
  return set(options, option, [&] { return std::string(&need(value, "the value")); });
}

raymap_result raymap_options_set_number(raymap_options* options, const char* option, double value) {
  return set(options, option, [&] { return value; });
}

raymap_result raymap_options_set_numbers(raymap_options* options, const char* option, const double* values,
                                         size_t count) {
  return set(options, option, [&] {
    if (count > 0) need(values, "the array of values");
    return std::vector<double>(values, values + count);
  });
}

raymap_result raymap_options_set_json(raymap_options* options, const char* json) {
  return guard([&] {
    AllOptions changed = allOf(options);
    const Json given = parsed(&need(json, "the JSON"));
    if (!given.is_object()) throw Error(ErrorCode::Usage, "the JSON is no object");
    for (const auto& [option, value] : given.items()) setOption(changed, option, valueOf(option, value));
    options->all = std::move(changed);
  });
}

raymap_result raymap_options_set_progress(raymap_options* options, raymap_progress_callback callback,
                                          void* user) {
  return guard([&] {
    ProgressCallback& progress = allOf(options).machine.progress;
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
    WarningCallback& warn = allOf(options).machine.warn;
    warn = nullptr;
    if (callback)
      warn = [callback, user](const Warning& warning) {
        callback(std::string(name(warning.code)).c_str(), warning.message.c_str(), user);
      };
  });
}
