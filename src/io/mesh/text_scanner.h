#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "io/mesh/mesh_file.h"

namespace raymap {

/// A cursor over a text mesh file. Lines may end in LF, CR LF or CR; `#` starts a comment.
class TextScanner {
 public:
  explicit TextScanner(const MeshFile& file, size_t start = 0);

  /// Moves to the next character on this line that is no blank; false at its end or at a comment. A backslash
  /// at the end of a line continues it.
  bool moreOnLine();
  /// The same across lines; false at the end of the file.
  bool more();
  void nextLine();
  /// What is left of this line, for names and the like; moves to its end.
  std::string_view restOfLine();

  /// The next word, wherever it is; empty at the end of the file.
  std::string_view word();
  /// The next word as a number: fails with the line and the word if it is none. Infinities and NaN are
  /// numbers.
  double real();
  int64_t integer();
  /// An integer here, without moving over blanks; what follows it is left (OBJ's `1/2/3`).
  int64_t integerPrefix();
  void skipRestOfWord() { at_ = wordEnd(at_); }

  [[noreturn]] void fail(const std::string& what) const;
  /// Fails at an earlier place, as `position` gave it.
  [[noreturn]] void failAt(size_t position, const std::string& what) const;
  size_t position() const { return static_cast<size_t>(at_ - begin_); }

 private:
  [[noreturn]] void failWord(const char* start, const char* expected) const;
  const char* wordEnd(const char* start) const;

  const MeshFile& file_;
  const char* begin_;
  const char* at_;
  const char* end_;
};

}  // namespace raymap
