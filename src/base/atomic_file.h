#pragma once

#include <filesystem>
#include <functional>
#include <iosfwd>

namespace raymap {

/// Writes a file so that it appears whole or not at all: `write` fills a hidden temporary in the same folder,
/// which is flushed to the disk and then renamed. Every output of this project goes through here.
///
/// The stream is binary and seekable, and throws `Error(File)` with the path and the system's reason (a full
/// disk, say) at the first write that fails. If anything throws, the temporary is gone and an existing file
/// untouched. Symbolic links are followed and an existing file's permissions kept. Devices and pipes are
/// written in place, and are not seekable.
void writeAtomically(const std::filesystem::path& path, const std::function<void(std::ostream&)>& write);

/// Removes the temporaries of all writes in progress. Safe in a signal handler that then ends the process.
void removeTemporaries() noexcept;

}  // namespace raymap
