// The functions of raymap/c.h that report as JSON.

#include <raymap/c.h>
#include <raymap/json.h>

#include <cstdlib>
#include <cstring>
#include <new>
#include <string>

#include "c_api/c_handles.h"

using namespace raymap;
using raymap::c::guard;
using raymap::c::need;

namespace {

/// Returns JSON as a text for the caller to free.
char* ownedText(const nlohmann::ordered_json& json) {
  const std::string text = textOf(json);
  char* copy = static_cast<char*>(std::malloc(text.size() + 1));
  if (!copy) throw std::bad_alloc();
  std::memcpy(copy, text.c_str(), text.size() + 1);
  return copy;
}

}  // namespace

char* raymap_inspection_json(const raymap_inspection* inspection) {
  char* text = nullptr;
  guard([&] {
    const auto& [found, crossings, verdict] = need(inspection, "the inspection");
    nlohmann::ordered_json json = toJson(Inspection{found, crossings});
    json["verdict"] = toJson(verdict);
    text = ownedText(json);
  });
  return text;
}

char* raymap_repaired_json(const raymap_repaired* repaired) {
  char* text = nullptr;
  guard([&] { text = ownedText(toJson(need(repaired, "the repaired mesh").report)); });
  return text;
}
