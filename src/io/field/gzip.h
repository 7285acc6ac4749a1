#pragma once

#include <memory>

#include "io/field/field_array.h"

namespace raymap {

/// The rest of the file, inflated from zlib or gzip format piece by piece.
ReadBytes inflated(std::shared_ptr<InputFile> file);

}  // namespace raymap
