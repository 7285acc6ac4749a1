#include "counters/races.h"

#include <algorithm>
#include <optional>
#include <utility>

namespace raymap::vulkan {

namespace {

using Kind = Access::Kind;

/// One word of an access.
struct Word {
  uint64_t scope;  // Of shared memory, its group: each has its own.
  uint64_t place;
  uint64_t turn;  // Command, group, and barriers of the group before it.
  Access access;

  uint64_t group() const { return turn >> 16; }
  uint32_t command() const { return uint32_t(turn >> 34); }
  bool isAt(const Word& other) const { return scope == other.scope && place == other.place; }
  bool operator==(const Word& other) const = default;
  bool operator<(const Word& other) const {
    if (place != other.place) return place < other.place;
    if (scope != other.scope) return scope < other.scope;
    if (turn != other.turn) return turn < other.turn;
    return access < other.access;
  }
};

using Run = std::span<const Word>;

/// Returns the elements before the first that does not fit.
template <class T, class Fits>
std::span<T> headOf(std::span<T> all, Fits&& fits) {
  return all.first(static_cast<size_t>(std::ranges::find_if_not(all, fits) - all.begin()));
}

bool isRace(const Word& a, const Word& b) {
  if (a.access.kind() == b.access.kind() && a.access.kind() != Kind::Write) return false;
  if (a.group() != b.group()) return true;
  if (a.access.who == b.access.who || a.turn != b.turn) return false;
  return a.access.subgroup() != b.access.subgroup() || a.access.phases == b.access.phases;
}

std::optional<std::pair<Word, Word>> findRace(Run run) {
  const auto isOf = [&](Kind kind) {
    return std::ranges::all_of(run, [&](const Word& word) { return word.access.kind() == kind; });
  };
  if (isOf(Kind::Read) || isOf(Kind::Atomic)) return std::nullopt;
  for (const Word& a : run)
    if (a.access.kind() != Kind::Read)
      for (const Word& b : run)
        if (isRace(a, b)) return std::pair(a, b);
  return std::nullopt;
}

/// Returns a race at one word. Accesses of one group race only within a turn; those of several groups race
/// unless all are reads or all are atomic.
std::optional<std::pair<Word, Word>> findRaceAt(Run run) {
  if (run.front().group() != run.back().group()) return findRace(run);
  while (!run.empty()) {
    const Run turn = headOf(run, [&](const Word& word) { return word.turn == run.front().turn; });
    if (auto race = findRace(turn)) return race;
    run = run.subspan(turn.size());
  }
  return std::nullopt;
}

/// Calls `visit` with each word that the commands of a step touch.
template <class Visit>
void forEachWord(std::span<const LoggedCommand> step, Visit&& visit) {
  for (uint32_t c = 0; c < step.size(); ++c) {
    for (const Access& access : step[c].accesses) {
      const uint64_t group = uint64_t{c} << 18 | access.group();
      for (uint64_t w = 0; w < access.words(); ++w)
        visit(Word{access.isShared() ? group + 1 : 0, access.place() + 4 * w,
                   group << 16 | access.phases >> 16, access});
    }
    if (step.size() == 1) continue;
    for (const TouchedRange& range : step[c].command->ranges)
      for (uint64_t at = range.address; at < range.address + range.bytes; at += 4)
        visit(Word{0, at, uint64_t{c} << 34, {.what = uint64_t(range.kind) << 48}});
  }
}

/// Returns the accesses to words that are written, in order. A filter drops most of the others.
std::vector<Word> writtenWords(std::span<const LoggedCommand> step) {
  constexpr size_t kBits = size_t{1} << 22;
  std::vector<bool> isWritten(kBits);
  const auto bit = [](const Word& word) {
    return (word.scope * 0x9E3779B97F4A7C15U ^ word.place / 4 * 0xD6E8FEB86659FD93U) >> 42;
  };
  forEachWord(step, [&](const Word& word) {
    if (word.access.kind() != Kind::Read) isWritten[bit(word)] = true;
  });
  std::vector<Word> words;
  forEachWord(step, [&](const Word& word) {
    if (isWritten[bit(word)]) words.push_back(word);
  });
  std::sort(words.begin(), words.end());
  words.erase(std::unique(words.begin(), words.end()), words.end());
  return words;
}

const char* nameOf(Kind kind) {
  return kind == Kind::Read ? "read" : kind == Kind::Write ? "write" : "atomic";
}

std::string textOf(const CountedCommand& command, const Word& word) {
  const Access& access = word.access;
  const std::string kind = command.name + ": " + nameOf(access.kind());
  return access.words() == 0
             ? kind
             : kind + " by invocation " + std::to_string(access.index()) + " of group " +
                   std::to_string(access.group()) + ", subgroup " + std::to_string(access.subgroup());
}

/// Adds the races in the commands of one step.
void findRacesOfStep(std::span<const LoggedCommand> step,
                     const std::function<std::string(const CountedCommand&, const Access&)>& placeOf,
                     Races& races) {
  const std::vector<Word> words = writtenWords(step);
  for (Run rest(words); !rest.empty();) {
    const Run run = headOf(rest, [&](const Word& word) { return word.isAt(rest.front()); });
    rest = rest.subspan(run.size());
    const auto race = findRaceAt(run);
    if (!race) continue;
    const auto& [a, b] = *race;
    const CountedCommand &one = *step[a.command()].command, &other = *step[b.command()].command;
    const std::string where = placeOf(one, {.what = (a.access.what >> 48 << 48) | a.place});
    races.try_emplace(one.name + other.name + nameOf(a.access.kind()) + nameOf(b.access.kind()) +
                          where.substr(0, where.find(" + ")),
                      where + ", stage '" + one.stage + "', step " + std::to_string(one.step) + ": " +
                          textOf(one, a) + "; " + textOf(other, b));
  }
}

}  // namespace

void findRaces(std::span<const LoggedCommand> commands,
               const std::function<std::string(const CountedCommand&, const Access&)>& placeOf,
               Races& races) {
  while (!commands.empty()) {
    const auto step = headOf(commands, [&](const LoggedCommand& logged) {
      return logged.command->step == commands.front().command->step;
    });
    findRacesOfStep(step, placeOf, races);
    commands = commands.subspan(step.size());
  }
}

}  // namespace raymap::vulkan
