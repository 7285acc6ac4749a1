#pragma once

#include <gtest/gtest.h>

#include <string>

namespace raymap {

/// For EXPECT_TRUE, which then shows the text.
inline testing::AssertionResult contains(const std::string& text, const std::string& part) {
  if (text.find(part) != text.npos) return testing::AssertionSuccess();
  return testing::AssertionFailure() << "'" << part << "' is not in '" << text << "'";
}

}  // namespace raymap
