#pragma once

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstdio>
#include <glm/glm.hpp>
#include <ranges>
#include <stdexcept>
#include <string>
#include <string_view>

namespace raymap::vulkan {

/// First difference between what a device gave and what it should give. Checks throw it.
class Difference : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

inline void require(bool isTrue, const std::string& otherwise) {
  if (!isTrue) throw Difference(otherwise);
}

/// Puts the name of a case before the differences that the work finds.
template <class Work>
void inCase(const std::string& name, Work&& work) {
  try {
    work();
  } catch (const Difference& difference) {
    throw Difference(name + ": " + difference.what());
  }
}

inline std::string textOf(std::floating_point auto value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.9g", double(value));
  return text;
}
inline std::string textOf(std::integral auto value) {
  return std::to_string(value);
}
template <int N, class T>
std::string textOf(const glm::vec<N, T>& value) {
  std::string text = "(" + textOf(value[0]);
  for (int i = 1; i < N; ++i) text += " " + textOf(value[i]);
  return text + ")";
}
inline std::string textOf(const glm::ivec3& dims, std::string_view by) {
  return textOf(dims.x).append(by) + textOf(dims.y).append(by) + textOf(dims.z);
}

/// Throws a `Difference` unless all values satisfy `isSame(ours, theirs)`. It names the first that do not and
/// says how many there are.
template <class Ours, class Theirs, class IsSame>
void requireAll(const std::string& what, const Ours& ours, const Theirs& theirs, IsSame&& isSame) {
  const size_t count = std::ranges::size(theirs);
  require(std::ranges::size(ours) == count,
          what + ": " + textOf(std::ranges::size(ours)) + " values, not " + textOf(count));
  size_t first = count, unlike = 0;
  for (size_t i = 0; i < count; ++i)
    if (!isSame(ours[i], theirs[i]) && unlike++ == 0) first = i;
  if (unlike > 0)
    throw Difference(what + ": number " + textOf(first) + " is " + textOf(ours[first]) + ", not " +
                     textOf(theirs[first]) + "; " + textOf(unlike) + " of " + textOf(count) + " differ");
}

template <class Ours, class Theirs>
void requireEqual(const std::string& what, const Ours& ours, const Theirs& theirs) {
  requireAll(what, ours, theirs, [](const auto& a, const auto& b) { return a == b; });
}

/// Allows differences up to `allowed`, and up to the share `relative` of the right value.
template <class Ours, class Theirs>
void requireNear(const std::string& what, const Ours& ours, const Theirs& theirs, double allowed,
                 double relative = 0.0) {
  requireAll(what, ours, theirs, [&](double a, double b) {
    return std::abs(a - b) <= std::max(allowed, relative * std::abs(b));
  });
}

}  // namespace raymap::vulkan
