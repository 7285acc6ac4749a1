#pragma once

#include <memory>

#include "io/field/field_array.h"

namespace raymap {

/// Returns a reader that inflates the rest of the file piece by piece, in zlib or gzip format.
ReadBytes inflated(std::shared_ptr<InputFile> file);

}  // namespace raymap
