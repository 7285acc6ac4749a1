#pragma once

#include <gtest/gtest.h>

#include <string>

namespace raymap {

/// Returns whether the text contains the part. EXPECT_TRUE then shows both.
inline testing::AssertionResult contains(const std::string& text, const std::string& part) {
  if (text.find(part) != text.npos) return testing::AssertionSuccess();
  return testing::AssertionFailure() << "'" << part << "' is not in '" << text << "'";
}

}  // namespace raymap
