#pragma once

#include <raymap/export.h>

#include <filesystem>
#include <functional>
#include <iosfwd>

namespace raymap {

/// Writes a file that appears whole or not at all. All functions of raymap that write files use it.
///
/// `write` fills a temporary in the same folder, which is flushed to the disk and then gets its name. The
/// stream is binary and seekable. At the first write that fails it throws `Error(File)` with the path and the
/// system's reason, for example a full disk. If anything throws, the temporary is removed and an existing
/// file is untouched.
///
/// The temporary has no name where the file system can do without (O_TMPFILE), so that even a killed process
/// leaves nothing. Elsewhere it has a hidden name. A temporary that a killed process left is removed
/// when the same file is written again.
///
/// Symbolic links are followed, and an existing file keeps its permissions. Devices, pipes and descriptors
/// such as /dev/stdout are written in place, and are not seekable.
RAYMAP_API void writeAtomically(const std::filesystem::path& path,
                                const std::function<void(std::ostream&)>& write);

/// Removes the temporaries with hidden names of all writes in progress. Safe in a signal handler that then
/// ends the process.
RAYMAP_API void removeTemporaries() noexcept;

}  // namespace raymap
