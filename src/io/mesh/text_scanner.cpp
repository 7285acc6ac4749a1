#include "io/mesh/text_scanner.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "base/text.h"

namespace raymap {

namespace {

bool isNewline(char c) {
  return c == '\n' || c == '\r';
}
bool isBlank(char c) {
  return c == ' ' || c == '\t' || c == '\v' || c == '\f' || c == '\0';
}
bool isSpace(char c) {
  return isBlank(c) || isNewline(c);
}

/// Returns the value that a number beyond the range of double rounds to.
double outOfRangeValue(std::string_view word) {
  const size_t e = word.find_first_of("eE");
  const bool small = e != word.npos ? word.substr(e + 1).starts_with('-') : word.find('.') <= 2;
  return small ? 0.0 : word.starts_with('-') ? -INFINITY : INFINITY;
}

}  // namespace

TextScanner::TextScanner(const MeshFile& file, size_t start)
    : file_(file), begin_(file.text().data()), at_(begin_ + start), end_(begin_ + file.text().size()) {
  if (start > 0) return;
  constexpr std::string_view kUtf8 = "\xef\xbb\xbf", kUtf16 = "\xff\xfe", kUtf16Big = "\xfe\xff";
  if (file.text().starts_with(kUtf8)) at_ += kUtf8.size();
  // Without a mark, every second byte of its first letters is 0.
  const std::string_view begin = file.text().substr(0, 4);
  const auto isZero = [&](size_t at) { return begin[at] == '\0'; };
  const bool isWide =
      begin.size() == 4 && isZero(0) == isZero(2) && isZero(1) == isZero(3) && isZero(0) != isZero(1);
  if (isWide || begin.starts_with(kUtf16) || begin.starts_with(kUtf16Big))
    file.fail("it is text in UTF-16; save it as UTF-8");
}

/// Returns where the next line begins if a backslash at `at` continues the line, else null.
const char* TextScanner::afterContinuation(const char* at) const {
  if (at == end_ || *at != '\\') return nullptr;
  at = std::find_if_not(at + 1, end_, isBlank);
  if (at == end_) return at;
  if (!isNewline(*at)) return nullptr;
  return at + (*at == '\r' && at + 1 != end_ && at[1] == '\n' ? 2 : 1);
}

bool TextScanner::moreOnLine() {
  for (;;) {
    while (at_ != end_ && isBlank(*at_)) ++at_;
    if (at_ == end_ || isNewline(*at_) || *at_ == '#') return false;
    const char* next = afterContinuation(at_);
    if (!next) return true;
    at_ = next;
  }
}

bool TextScanner::more() {
  while (!moreOnLine()) {
    if (at_ == end_) return false;
    nextLine();
  }
  return true;
}

void TextScanner::nextLine() {
  restOfLine();
  if (at_ == end_) return;
  const bool carriageReturn = *at_++ == '\r';
  if (carriageReturn && at_ != end_ && *at_ == '\n') ++at_;
}

std::string_view TextScanner::restOfLine() {
  const char* start = at_;
  while (at_ != end_ && !isNewline(*at_)) ++at_;
  return {start, static_cast<size_t>(at_ - start)};
}

const char* TextScanner::wordEnd(const char* start) const {
  while (start != end_ && !isSpace(*start) && !afterContinuation(start)) ++start;
  return start;
}

std::string_view TextScanner::word() {
  return more() ? restOfWord() : std::string_view();
}

std::string_view TextScanner::restOfWord() {
  const char* start = at_;
  at_ = wordEnd(start);
  return {start, static_cast<size_t>(at_ - start)};
}

double TextScanner::real() {
  if (!more()) fail("the file ends where a number should be");
  const char* start = at_ + (*at_ == '+' ? 1 : 0);
  double value = 0.0;
  const auto [stop, error] = std::from_chars(start, end_, value);
  if (error == std::errc::invalid_argument || stop != wordEnd(stop)) failWord(at_, "a number");
  if (error == std::errc::result_out_of_range)
    value = outOfRangeValue({at_, static_cast<size_t>(stop - at_)});
  at_ = stop;
  return value;
}

int64_t TextScanner::integerPrefix() {
  const char* start = at_ + (at_ != end_ && *at_ == '+' ? 1 : 0);
  int64_t value = 0;
  const auto [stop, error] = std::from_chars(start, end_, value);
  if (error != std::errc{}) failWord(at_, "a whole number");
  at_ = stop;
  return value;
}

int64_t TextScanner::integer() {
  if (!more()) fail("the file ends where a whole number should be");
  const char* start = at_;
  const int64_t value = integerPrefix();
  if (at_ != wordEnd(at_)) failWord(start, "a whole number");
  return value;
}

void TextScanner::failWord(const char* start, const char* expected) const {
  const std::string_view word(start, static_cast<size_t>(wordEnd(start) - start));
  failAt(static_cast<size_t>(start - begin_),
         std::string("expected ") + expected + ", found " + excerpt(word));
}

void TextScanner::fail(const std::string& what) const {
  failAt(position(), what);
}

void TextScanner::failAt(size_t position, const std::string& what) const {
  // Counts lines only here, which keeps reading fast.
  file_.fail("line " + std::to_string(lineAt(position)) + ": " + what);
}

size_t TextScanner::lineAt(size_t position) const {
  const std::string_view before(begin_, position);
  size_t line = 1;
  for (size_t i = 0; i < before.size(); ++i)
    if (before[i] == '\n' || (before[i] == '\r' && (i + 1 == before.size() || before[i + 1] != '\n'))) ++line;
  return line;
}

}  // namespace raymap
