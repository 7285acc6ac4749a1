#include "method/pose.h"

#include <raymap/error.h>

#include <cmath>

#include "base/text.h"

namespace raymap {

namespace {

/// Squares of smaller or larger scales leave few digits to the numbers of a pose.
constexpr double kLeastSquared = 1e-24;

/// Returns what is wrong with the matrix and what to do; empty if nothing is.
std::string wrongWith(const glm::dmat4& pose) {
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 4; ++column)
      if (!std::isfinite(pose[column][row]))
        return "has a number that is not finite in row " + std::to_string(row) + ", column " +
               std::to_string(column);
  const glm::dvec4 last(pose[0].w, pose[1].w, pose[2].w, pose[3].w);
  if (last != glm::dvec4(0.0, 0.0, 0.0, 1.0))
    return "has the last row " + numberText(last.x) + " " + numberText(last.y) + " " + numberText(last.z) +
           " " + numberText(last.w) + " instead of 0 0 0 1; the translation belongs into the last column";
  const glm::dmat3 axes(pose);
  const double squared = glm::dot(axes[0], axes[0]);
  if (!(squared > kLeastSquared && squared < 1.0 / kLeastSquared))
    return "has a scale of " + numberText(std::sqrt(squared)) + ", which is too small or too large";
  for (int a = 0; a < 3; ++a)
    if (!(std::abs(glm::dot(axes[a], axes[a]) - squared) <= 2.0 * kRigid * squared))
      return std::string("scales unevenly: its x axis has the length ") + numberText(std::sqrt(squared)) +
             ", and its " + "xyz"[a] + " axis " + numberText(glm::length(axes[a])) +
             "; stretch the mesh before its surface is made";
  for (int a = 0; a < 3; ++a)
    if (!(std::abs(glm::dot(axes[a], axes[(a + 1) % 3])) <= kRigid * squared))
      return std::string("shears: its ") + "xyz"[a] + " and " + "xyz"[(a + 1) % 3] +
             " axes are not perpendicular; deform the mesh before its surface is made";
  if (glm::determinant(axes) < 0.0)
    return "mirrors: its axes are left-handed; mirror the mesh before its surface is made";
  return {};
}

}  // namespace

void checkPose(const glm::dmat4& pose, const std::function<std::string()>& nameOf) {
  if (const std::string wrong = wrongWith(pose); !wrong.empty())
    throw Error(ErrorCode::Usage, nameOf() + " is no scaled rigid motion: it " + wrong);
}

}  // namespace raymap
