#pragma once

// Functions that the parts of `raymap-import` share.

#include <sys/resource.h>

#include <cstddef>
#include <cstdint>
#include <string>

namespace raymap {

// Each reads a file and writes it to standard output in the format of import_stream.h. Each throws on
// failure.
void sendMesh(const char* path, const std::string& format);
/// Of several grids the one with this name is read, or the first level set if the name is empty. A level set
/// with more samples than `mostDense` is sent as a narrow band. If that is 0, all others are refused.
void sendVdb(const char* path, const std::string& gridName, uint64_t mostDense);
void sendNvdb(const char* path, const std::string& gridName, uint64_t mostDense);

/// Writes the header of a success, with a warning or an empty text. A later exception only ends the program.
void sendSuccess(const std::string& warning);
void put(const void* data, size_t bytes);
/// Limits the CPU time of this process, in seconds from its start.
void limitSeconds(rlim_t seconds);

}  // namespace raymap
