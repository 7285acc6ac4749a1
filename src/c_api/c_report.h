#pragma once

// Reports as JSON.

#include <raymap/json.h>

#include "c_api/c_handles.h"

namespace raymap::c {

/// Returns the JSON that `make` makes as a text for the caller to free; null if it throws.
char* report(auto&& make) noexcept {
  char* text = nullptr;
  guard([&] { text = ownText(textOf(make())); });
  return text;
}

}  // namespace raymap::c
