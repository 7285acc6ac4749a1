#pragma once

// What the parts of `raymap-import` share.

#include <sys/resource.h>

#include <cstddef>
#include <string>

namespace raymap {

// Each reads a file and writes it to the standard output as import_stream.h says, or throws.
void sendMesh(const char* path);
void sendVdb(const char* path);

/// The header that all is well; after it nothing may throw but what ends the program.
void sendSuccess(const std::string& warning);
void put(const void* data, size_t bytes);
/// The processor time, from its start, that this process may take.
void limitSeconds(rlim_t seconds);

}  // namespace raymap
