#pragma once

#include <functional>
#include <map>
#include <span>
#include <string>

#include "counters/work_counter.h"

namespace raymap::vulkan {

/// A command and the accesses that its kernel logged.
struct LoggedCommand {
  const CountedCommand* command;
  std::span<const Access> accesses;
};

/// Races by what makes them alike: kernels, kinds of access, and buffer or shared variable.
using Races = std::map<std::string, std::string>;

/// Adds the races in commands, in the order in which they were recorded: two accesses to one word, at least
/// one of them a write, not both atomic, of different invocations that nothing orders. Describes the first
/// of those that are alike. `placeOf` names the place of an access, with " + " before an offset.
void findRaces(std::span<const LoggedCommand> commands,
               const std::function<std::string(const CountedCommand&, const Access&)>& placeOf, Races& races);

}  // namespace raymap::vulkan
