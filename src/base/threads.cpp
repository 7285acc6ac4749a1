#include <raymap/error.h>
#include <raymap/threads.h>

#include <atomic>
#include <charconv>
#include <cstdlib>
#include <string>

namespace raymap {

namespace {

constexpr int kUnset = -1;
std::atomic<int> chosen{kUnset};

int readVariable() {
  const char* const value = std::getenv("RAYMAP_THREADS");
  const std::string text = value ? value : "";
  if (text.empty()) return 0;
  int threads = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), threads);
  if (error == std::errc() && end == text.data() + text.size() && threads >= 0) return threads;
  throw Error(ErrorCode::Usage, "the environment variable RAYMAP_THREADS is '" + text +
                                    "'; it must be a number of threads, or 0 for all");
}

}  // namespace

void setDefaultThreads(int threads) {
  if (threads < 0)
    throw Error(ErrorCode::Usage,
                "the number of threads must not be negative, not " + std::to_string(threads));
  chosen = threads;
}

int defaultThreads() {
  if (const int threads = chosen; threads != kUnset) return threads;
  static const int variable = readVariable();
  return variable;
}

}  // namespace raymap
