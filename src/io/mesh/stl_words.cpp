#include "io/mesh/stl_words.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <utility>

namespace raymap {

namespace {

struct NamedWord {
  std::string_view name;
  StlWord word;
};

constexpr std::array kWords{
    NamedWord{"vertex", StlWord::Vertex},     NamedWord{"facet", StlWord::Facet},
    NamedWord{"outer", StlWord::Outer},       NamedWord{"endloop", StlWord::EndLoop},
    NamedWord{"endfacet", StlWord::EndFacet}, NamedWord{"color", StlWord::Color},
    NamedWord{"solid", StlWord::Solid},       NamedWord{"endsolid", StlWord::EndSolid}};

StlWord wordOf(std::string_view text) {
  const auto* found = std::ranges::find_if(
      kWords, [&](const NamedWord& word) { return equalsIgnoringCase(text, word.name); });
  if (found != kWords.end()) return found->word;
  const auto begins = [&](std::string_view name) {
    return equalsIgnoringCase(text.substr(0, name.size()), name);
  };
  return begins("solid") ? StlWord::Solid : begins("endsolid") ? StlWord::EndSolid : StlWord::Other;
}

}  // namespace

bool equalsIgnoringCase(std::string_view word, std::string_view lower) {
  return std::ranges::equal(word, lower, [](char a, char b) {
    return std::tolower(static_cast<unsigned char>(a)) == static_cast<unsigned char>(b);
  });
}

StlWord readStlWord(TextScanner& text) {
  const std::string_view word = text.word();
  if (!equalsIgnoringCase(word, "end")) return wordOf(word);
  TextScanner ahead = text;
  if (!ahead.moreOnLine()) return StlWord::Other;
  constexpr std::array kEnds{std::pair("loop", StlWord::EndLoop), std::pair("facet", StlWord::EndFacet),
                             std::pair("solid", StlWord::EndSolid)};
  const std::string_view what = ahead.word();
  for (const auto& [name, end] : kEnds) {
    if (!equalsIgnoringCase(what, name)) continue;
    text.word();
    return end;
  }
  return StlWord::Other;
}

}  // namespace raymap
