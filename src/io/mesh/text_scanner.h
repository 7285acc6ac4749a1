#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "io/mesh/mesh_file.h"

namespace raymap {

/// A cursor over a text mesh file. Lines may end in LF, CR LF or CR; `#` starts a comment. A backslash with
/// nothing but blanks behind it continues a line.
class TextScanner {
 public:
  /// Begins at a position, or behind a byte order mark. Throws `Error(Input)` for text in UTF-16.
  explicit TextScanner(const MeshFile& file, size_t start = 0);

  /// Moves to the next non-blank character on this line. Returns false at the line's end or at a
  /// comment.
  bool moreOnLine();
  /// Moves to the next non-blank character on this or a later line. Returns false at the end of the file.
  bool more();
  void nextLine();
  /// Returns the rest of this line, such as a name, and moves to the line's end.
  std::string_view restOfLine();

  /// Returns the next word on this or a later line; empty at the end of the file.
  std::string_view word();
  /// Returns the next word as a number. Fails with the line and the word if it is none. Infinities and NaN
  /// are numbers.
  double real();
  int64_t integer();
  /// Reads an integer at the cursor without skipping blanks, and leaves what follows it (OBJ's `1/2/3`).
  int64_t integerPrefix();
  /// Returns what is left of the word at the cursor, and moves behind it.
  std::string_view restOfWord();

  [[noreturn]] void fail(const std::string& what) const;
  /// Fails because of the word at the cursor.
  [[noreturn]] void failWord(const char* expected) const { failWord(at_, expected); }
  /// Fails with the line of an earlier `position()`.
  [[noreturn]] void failAt(size_t position, const std::string& what) const;
  size_t position() const { return static_cast<size_t>(at_ - begin_); }
  /// Returns the number of the line of a position, counted from 1. Reads the file up to there.
  size_t lineAt(size_t position) const;

 private:
  [[noreturn]] void failWord(const char* start, const char* expected) const;
  const char* wordEnd(const char* start) const;
  const char* afterContinuation(const char* at) const;

  const MeshFile& file_;
  const char* begin_;
  const char* at_;
  const char* end_;
};

}  // namespace raymap
