#pragma once

// Parallel loops. parallel.cpp runs them with oneTBB, whose headers would cost a second in each file.

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <type_traits>
#include <vector>

namespace raymap {

/// Refers to a function `void(Arguments...)`, which must live until the call that it is passed to returns.
template <class... Arguments>
class FunctionView {
 public:
  template <class Function,
            class = std::enable_if_t<!std::is_same_v<std::remove_cvref_t<Function>, FunctionView>>>
  FunctionView(Function&& function)
      : object_(const_cast<void*>(static_cast<const void*>(std::addressof(function)))),
        call_([](void* object, Arguments... arguments) {
          (*static_cast<std::remove_reference_t<Function>*>(object))(arguments...);
        }) {}

  void operator()(Arguments... arguments) const { call_(object_, arguments...); }

 private:
  void* object_;
  void (*call_)(void* object, Arguments... arguments);
};

/// Elements of a part of a loop, each of which takes a few instructions.
inline constexpr size_t kCheapGrain = size_t{1} << 16;

/// Calls `work(begin, end)` on parts of [0, count) with at most `grain` elements each. The work must not
/// depend on which thread gets which part. Outside of `withThreads` it uses `defaultThreads`.
void parallelFor(size_t count, size_t grain, FunctionView<size_t, size_t> work);

/// Starts all threads that `defaultThreads` allows, which otherwise start when they are needed.
void startThreads();

/// Returns the number of threads that a loop may use here.
size_t parallelThreads();

/// Calls `work(next)` on each thread, where `next()` hands out the numbers below `count` in order, and then
/// `count` for ever. For work that profits from what a thread remembers, but does not depend on it.
template <class Work>
void parallelWorkers(size_t count, Work&& work) {
  std::atomic<size_t> numbers{0};
  const auto next = [&] { return std::min(numbers++, count); };
  parallelFor(std::min(parallelThreads(), count), 1, [&](size_t, size_t) { work(next); });
}

/// Returns the elements of all parts of a loop, in order.
template <class T>
std::vector<T> joined(const std::vector<std::vector<T>>& parts) {
  std::vector<T> all;
  for (const std::vector<T>& part : parts) all.insert(all.end(), part.begin(), part.end());
  return all;
}

/// Returns the numbers below `count` for which `isWanted(number)` holds, ascending. A thread tests `grain` of
/// them at a time.
template <class Predicate>
std::vector<uint32_t> parallelSelect(size_t count, Predicate&& isWanted, size_t grain = kCheapGrain) {
  std::vector<std::vector<uint32_t>> parts((count + grain - 1) / grain);
  parallelFor(parts.size(), 1, [&](size_t part, size_t) {
    for (size_t k = part * grain; k < std::min((part + 1) * grain, count); ++k)
      if (isWanted(uint32_t(k))) parts[part].push_back(uint32_t(k));
  });
  return joined(parts);
}

/// Runs `work` with at most this many threads. Throws `Error(Usage)` if they are negative. 0 = those of the
/// `withThreads` around this one, or else `defaultThreads`. Limits nothing else in the process. Throws what
/// `defaultThreads` throws.
void withThreads(int threads, FunctionView<> work);

/// Runs `work` as `withThreads(0, work)` does, but in the same arena if there is a `withThreads` around it.
void withCallersThreads(FunctionView<> work);

}  // namespace raymap
