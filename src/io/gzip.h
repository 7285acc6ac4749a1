#pragma once

#include <memory>

#include "field_array.h"

namespace raymap {

/// The rest of the file, inflated from zlib or gzip format piece by piece.
ReadBytes inflated(std::shared_ptr<InputFile> file);

}  // namespace raymap
