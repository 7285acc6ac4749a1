#pragma once

// Functions that the parts of `raymap-import` share.

#include <cstddef>
#include <cstdint>
#include <string>

namespace raymap {

// Each reads an open file and writes it to standard output in the format of import_stream.h. Each throws on
// failure.
void sendMesh(int file, const std::string& format);
void sendDraco(int file);
/// The grid with this name is read, or the first level set if the name is empty. A level set
/// with more samples than `mostDense` is sent as a narrow band. If that is 0, all others are refused.
void sendVdb(int file, const std::string& gridName, uint64_t mostDense);
void sendNvdb(int file, const std::string& gridName, uint64_t mostDense);

/// Writes the header of a success, with a warning or an empty text. A later exception only ends the program.
void sendSuccess(const std::string& warning);
void put(const void* data, size_t bytes);
/// Returns all bytes of an open file.
std::string bytesOf(int file);

}  // namespace raymap
