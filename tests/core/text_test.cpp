#include "base/text.h"

#include <gtest/gtest.h>

namespace raymap {
namespace {

TEST(Text, KnowsCharacters) {
  const auto decoded = [](std::string_view text) {
    uint32_t code = 0;
    const size_t bytes = decodeUtf8(text, code);
    return bytes == 0 ? std::pair<size_t, uint32_t>() : std::pair(bytes, code);
  };
  using Pair = std::pair<size_t, uint32_t>;
  EXPECT_EQ(decoded("a."), Pair(1, 'a'));
  EXPECT_EQ(decoded(std::string_view("\0", 1)), Pair(1, 0));
  EXPECT_EQ(decoded("\x7f"), Pair(1, 0x7f));
  EXPECT_EQ(decoded("\xc2\x80"), Pair(2, 0x80));
  EXPECT_EQ(decoded("\xdf\xbf\xbf"), Pair(2, 0x7ff));
  EXPECT_EQ(decoded("\xe0\xa0\x80"), Pair(3, 0x800));
  EXPECT_EQ(decoded("\xed\x9f\xbf"), Pair(3, 0xd7ff));
  EXPECT_EQ(decoded("\xee\x80\x80"), Pair(3, 0xe000));
  EXPECT_EQ(decoded("\xf0\x90\x80\x80"), Pair(4, 0x10000));
  EXPECT_EQ(decoded("\xf4\x8f\xbf\xbf"), Pair(4, 0x10ffff));
  for (const char* none :
       {"", "\x80", "\xbf", "\xc2", "\xc2.", "\xc1\xbf", "\xe0\x9f\xbf", "\xed\xa0\x80", "\xed\xbf\xbf",
        "\xf0\x8f\xbf\xbf", "\xf4\x90\x80\x80", "\xf8\x88\x80\x80", "\xff"})
    EXPECT_EQ(decoded(none), Pair()) << none;
}

TEST(Text, EscapesWhatCommandsATerminalOrTurnsText) {
  EXPECT_EQ(printableText("a\x1f\x20~\x7f"), "a\\x1f ~\\x7f");
  EXPECT_EQ(printableText("\xc2\x9f\xc2\xa0"), "\\x9f\xc2\xa0");
  EXPECT_EQ(printableText("\xd8\x9b\xd8\x9c\xd8\x9d"), "\xd8\x9b\\u061c\xd8\x9d");
  EXPECT_EQ(printableText("\xe2\x80\x8d\xe2\x80\x8e\xe2\x80\x8f\xe2\x80\x90"),
            "\xe2\x80\x8d\\u200e\\u200f\xe2\x80\x90");
  EXPECT_EQ(printableText("\xe2\x80\xa7\xe2\x80\xa8\xe2\x80\xae\xe2\x80\xaf"),
            "\xe2\x80\xa7\\u2028\\u202e\xe2\x80\xaf");
  EXPECT_EQ(printableText("\xe2\x81\xa5\xe2\x81\xa6\xe2\x81\xa9\xe2\x81\xaa"),
            "\xe2\x81\xa5\\u2066\\u2069\xe2\x81\xaa");
  EXPECT_EQ(printableText("\xe9t\xc3\xa9"), "\\xe9t\xc3\xa9");
}

TEST(Text, ShortensToCharacters) {
  EXPECT_EQ(shortText("abc", 3), "abc");
  EXPECT_EQ(shortText("abcd", 3), "abc...");
  EXPECT_EQ(shortText("\xc3\xa9\xff\x1b", 3), "\xc3\xa9\\xff\\x1b");
  EXPECT_EQ(shortText("\xc3\xa9\xff\x1bz", 3), "\xc3\xa9\\xff\\x1b...");
  EXPECT_EQ(excerpt("root:x:0:0:root:/root"), "'root:x:0:0:root:/roo...'");
  EXPECT_EQ(excerpt("root:x:0:0:root:/roo"), "'root:x:0:0:root:/roo'");
}

TEST(Text, ShortensQuotesOfOthersMessages) {
  const std::string twenty = "12345678901234567890";
  EXPECT_EQ(withExcerpts("can't take \"" + twenty + "\" or '" + twenty + "1'!"),
            "can't take '" + twenty + "' or '" + twenty + "...'!");
  EXPECT_EQ(withExcerpts("'" + twenty + "1"), "'" + twenty + "...'");
  EXPECT_EQ(withExcerpts("plain"), "plain");
  EXPECT_EQ(withExcerpts(twenty + " " + twenty + "1 \xb0 \x1b"), twenty + " " + twenty + "... \\xb0 \\x1b");
  EXPECT_EQ(withExcerpts(twenty + "'" + twenty + "1'"), twenty + "'" + twenty + "...'");
  std::string many;
  for (int i = 0; i < 400; ++i) many += i % 2 == 0 ? 'a' : ' ';
  EXPECT_EQ(withExcerpts(many), many.substr(0, 300));
}

}  // namespace
}  // namespace raymap
