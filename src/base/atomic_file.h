#pragma once

#include <filesystem>
#include <functional>
#include <iosfwd>

namespace raymap {

/// Writes a file that appears whole or not at all. `write` fills a hidden temporary in the same folder, which
/// is flushed to the disk and then renamed. Every output file of this project is written here.
///
/// The stream is binary and seekable. The first write that fails throws `Error(File)` with the path and the
/// system's reason, such as a full disk. If anything throws, the temporary is removed and an existing file
/// stays untouched. Symbolic links are followed, and an existing file's permissions are kept. Devices and
/// pipes are written in place and are not seekable.
void writeAtomically(const std::filesystem::path& path, const std::function<void(std::ostream&)>& write);

/// Removes the temporaries of all writes in progress. Safe in a signal handler that then ends the process.
void removeTemporaries() noexcept;

}  // namespace raymap
