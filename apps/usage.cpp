#include "usage.h"

#include <raymap/io.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <vector>

#include "checks.h"
#include "text.h"

namespace raymap {

namespace {

/// Names that people try, and what helps instead. An empty command means any.
struct Guess {
  std::string_view words, command, advice;
};

constexpr Guess kGuesses[] = {
    {"--thickness", "repair",
     "--min-thickness T makes thin parts T thick, --shell T hollows out and leaves walls of T"},
    {"--simplify,--decimate,--reduce,--quality,--ratio,--faces,--target,--target-faces", "",
     "--triangles N or --tolerance T of simplify, repair and mesh writes fewer triangles"},
    {"--dry-run", "", "raymap info MESH says what is wrong and what to do, and writes nothing"},
    {"--input,-i,--in,--file,--mesh", "",
     "files that are read are named without an option: raymap COMMAND FILE"},
    {"--cube", "", "--shape N N N makes N samples along every side"},
    {"--gpu,--cuda,--vulkan", "", "--device vulkan computes on a GPU"},
    {"--cpu,--no-gpu", "", "--device cpu computes on the CPU"},
    {"--width,--height,--image-size", "", "--size WIDTH HEIGHT of render"},
    {"--camera,--view,--angle,--eye", "", "--direction X Y Z of render is where the camera looks"},
    {"--ascii,--binary", "", "the format decides; binary is written where there is a choice"},
    {"--fix,--heal,--watertight,--make-manifold", "",
     "raymap repair MESH -o RESULT makes a watertight solid"},
    {"--sdf,--level-set", "", "raymap generate MESH -o FIELD makes a signed distance field"},
    {"--smooth,--smoothing", "", "there is no smoothing; a larger --voxel-size leaves out details"},
    {"--support,--supports", "", "a slicer makes supports; --drain-hole empties what --shell hollows out"},
    {"--extrude,--plinth,--skirt,--base", "",
     "raymap repair MESH -o RESULT --base Z joins the rim of a terrain to a flat base"},
    {"--y-up", "", "--up y"},
    {"--z-up", "", "--up z"},
    {"--mm,--inch,--inches,--cm", "", "--from in --to mm converts, for example"},
    {"--half-width,--halfwidth,--exterior-band,--interior-band,--bandwidth,--narrow-band,--truncate", "",
     "--band SAMPLES of generate clamps distances to so many samples, the half width of a level set"},
    {"--background", "",
     "--band SAMPLES of generate: the background of a .vdb is so many times the distance between samples"},
    {"--name,--gridname", "", "--grid-name NAME of generate and convert names the grid of a .vdb or .nvdb"},
    {"decimate,reduce", "", "raymap simplify MESH -o RESULT --triangles N"},
    {"fix,heal,clean,watertight,solidify,print", "", "raymap repair MESH -o RESULT"},
    {"sdf,voxelize,voxelise,voxelizer,levelset,field,gen", "", "raymap generate MESH -o FIELD"},
    {"view,show,draw,preview,picture,slice", "", "raymap render MESH -o PICTURE"},
    {"diff", "", "raymap compare FIELD FIELD"},
    {"help,man", "", "raymap help COMMAND, or raymap manual COMMAND"},
    {"check,inspect,analyze,analyse,stats,validate,diagnose,thickness", "", "raymap info MESH"},
    {"export,import,save", "", "raymap convert INPUT -o OUTPUT"},
    {"isosurface,contour,marching-cubes,remesh,polygonize", "", "raymap mesh FIELD -o MESH"},
    {"hollow,shell", "", "raymap repair MESH -o RESULT --shell T"},
    {"distance,measure", "", "raymap query MESH POINTS -o RESULTS"},
    {"gpu,gpus,device", "", "raymap devices"},
};

std::string adviceOn(std::string_view word, std::string_view command) {
  for (const Guess& guess : kGuesses) {
    const std::vector<std::string> words = split(guess.words, ',');
    const bool isMeant = guess.command.empty() || guess.command == command;
    if (isMeant && std::ranges::count(words, word) > 0) return std::string(guess.advice);
  }
  return {};
}

/// Returns the number of letters to insert, drop, replace or swap to make one word of the other.
size_t editDistance(std::string_view a, std::string_view b) {
  std::vector<std::vector<size_t>> cost(a.size() + 1, std::vector<size_t>(b.size() + 1));
  for (size_t i = 0; i <= a.size(); ++i)
    for (size_t j = 0; j <= b.size(); ++j) {
      if (i == 0 || j == 0) {
        cost[i][j] = i + j;
        continue;
      }
      cost[i][j] = std::min(
          {cost[i - 1][j] + 1, cost[i][j - 1] + 1, cost[i - 1][j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1)});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        cost[i][j] = std::min(cost[i][j], cost[i - 2][j - 2] + 1);
    }
  return cost[a.size()][b.size()];
}

/// Returns the name that was most likely meant; empty if none is near: of 3 letters 1 may be
/// wrong, of 7 letters 2, and so on.
std::string closest(std::string_view word, const std::vector<std::string>& names) {
  std::string best;
  size_t least = (1 + word.size() - std::min(word.find_first_not_of('-'), word.size())) / 4;
  for (const std::string& name : names) {
    const bool isStart = word.size() > 4 && name.starts_with(word);
    const size_t distance = isStart ? 0 : editDistance(word, name);
    if (distance <= least && (best.empty() || distance < least)) {
      least = distance;
      best = name;
    }
  }
  return best;
}

std::vector<std::string> longNames(const Command& command) {
  std::vector<std::string> names{"--help"};
  if (command.name.empty()) names.emplace_back("--version");
  for (const Argument& each : command.options)
    for (const std::string& name : split(allSpellings(each.row), ' '))
      if (name.starts_with("--")) names.push_back(name.substr(0, name.find(',')));
  return names;
}

/// Returns "generate, mesh and render": the commands that have an option.
std::string commandsWith(const Program& program, const std::string& name) {
  std::vector<std::string> found;
  for (const Command& command : program.commands)
    if (command.find(name) != nullptr) found.push_back(command.name);
  return joined(found, ", ", " and ");
}

/// Returns what was meant by an option that a command does not have; empty if nothing is near.
std::string meantBy(const Program& program, const Command& command, const std::string& argument) {
  const std::string name = argument.substr(0, argument.find('='));
  if (const std::string advice = adviceOn(name, command.name); !advice.empty()) return advice;
  const bool isFile = hasExtension(argument, meshExtensions()) || hasExtension(argument, fieldExtensions()) ||
                      hasExtension(argument, writableMeshExtensions()) ||
                      hasExtension(argument, {".png", ".json", ".csv"});
  if (isFile) return "it begins like an option; a file of this name is ./" + argument;
  if (const OptionRow* row = findRow(name)) {
    const std::string known = longName(*row), others = commandsWith(program, known);
    if (!others.empty()) return (known == name ? "it" : known) + " is an option of " + others;
  }
  const std::string near = closest(name, longNames(command));
  return near.empty() ? "" : "did you mean " + near + "?";
}

std::string describeUnknown(const Program& program, const Parsed& parsed) {
  std::string text;
  for (const std::string& word : parsed.unknown) {
    if (!word.starts_with('-') || word == "-") continue;
    const std::string meant = meantBy(program, *parsed.command, word);
    text += (text.empty() ? "" : "; ") + std::string("not understood: ") + word +
            (meant.empty() ? "" : "; " + meant);
  }
  if (!text.empty() || !parsed.mistake.empty() || parsed.unknown.empty()) return text;
  return "there are more files than the command takes: " + joined(parsed.unknown, " ");
}

std::string describeNoCommand(const Program& program, const std::vector<std::string>& unknown) {
  std::vector<std::string> names;
  for (const Command& command : program.commands) names.push_back(command.name);
  const std::string all = joined(names, " ");
  if (unknown.empty()) return "name a command: " + all;
  const std::string& word = unknown.front();
  std::string meant = adviceOn(lower(word), "");
  if (meant.empty() && word.starts_with('-')) meant = meantBy(program, {}, word);
  if (meant.empty()) {
    const std::string near = closest(lower(word), names);
    meant = near.empty() ? "use one of: " + all : "did you mean " + near + "?";
  }
  return "unknown command '" + word + "'; " + meant;
}

// ---- Help ----------------------------------------------------------------------------------------------

size_t terminalWidth() {
  constexpr size_t kLeast = 40, kUsual = 100;
  size_t width = 0;
  if (const char* columns = std::getenv("COLUMNS"))
    std::from_chars(columns, columns + std::string_view(columns).size(), width);
  winsize size{};
  if (width == 0 && isatty(STDOUT_FILENO) == 1 && ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0)
    width = size.ws_col;
  return width == 0 ? kUsual : std::max(width, kLeast);
}

/// Returns a text in lines that are at most as wide as the terminal. All but the first begin with `indent`
/// blanks; the first has `used` letters already.
std::string wrapped(const std::string& text, size_t indent, size_t used) {
  const size_t width = terminalWidth();
  std::string result;
  bool isFirst = true;
  for (const std::string& word : split(text, ' ')) {
    if (!isFirst && used + 1 + word.size() > width) {
      result += "\n" + std::string(indent, ' ');
      used = indent;
      isFirst = true;
    }
    result += (isFirst ? "" : " ") + word;
    used += word.size() + (isFirst ? 0 : 1);
    isFirst = false;
  }
  return result + "\n";
}

/// Returns an entry of a list: its name, then what it means in a column of its own.
std::string entry(const std::string& name, const std::string& meaning) {
  const size_t column = terminalWidth() < 70 ? 8 : 30;
  std::string line = "  " + name;
  line += line.size() + 2 > column ? "\n" + std::string(column, ' ') : std::string(column - line.size(), ' ');
  return line + wrapped(meaning, column, column);
}

std::string footerOf(const std::string& footer) {
  std::string result;
  for (const auto& [indent, text] : footerLines(footer))
    result += std::string(indent, ' ') + wrapped(text, indent + (indent > 0 ? 4 : 0), indent);
  return result;
}

constexpr const char* kHelp = "Print this help";

}  // namespace

std::vector<FooterLine> footerLines(const std::string& footer) {
  std::vector<FooterLine> lines;
  for (const std::string& line : split(footer, '\n')) {
    const size_t indent = std::min(line.find_first_not_of(' '), line.size());
    const bool isOfParagraph = indent == 0 && !line.empty() && !lines.empty() && lines.back().indent == 0 &&
                               !lines.back().text.empty() && !lines.back().text.ends_with(':');
    if (isOfParagraph)
      lines.back().text += " " + line;
    else
      lines.push_back({indent, line.substr(indent)});
  }
  return lines;
}

std::string describeMistake(const Program& program, const Parsed& parsed) {
  if (parsed.command == nullptr) return describeNoCommand(program, parsed.unknown);
  const std::string unknown = describeUnknown(program, parsed);
  return unknown.empty() ? parsed.mistake : unknown;
}

std::string helpOf(const Program& program) {
  std::string text = wrapped(program.description, 0, 0) + "Usage: raymap [OPTIONS] COMMAND\n\nOptions:\n" +
                     entry("-V, --version", "Print the version") + entry("-h, --help", kHelp) +
                     "\nCommands:\n";
  for (const Command& command : program.commands) text += entry(command.name, command.description);
  return text + "\n" + footerOf(program.footer);
}

std::string helpOf(const Command& command) {
  std::string text = wrapped(command.description, 0, 0) + "Usage: raymap " + command.name + " [OPTIONS]";
  for (const Argument& each : command.operands)
    text += each.isRequired ? " " + each.shown() : " [" + each.shown() + "]";
  text += command.operands.empty() ? "\n" : "\n\nPositionals:\n";
  for (const Argument& each : command.operands) text += entry(each.shown(), each.help);
  text += "\nOptions:\n" + entry("-h, --help", kHelp);
  std::vector<std::string> groups;
  for (const Argument& each : command.options)
    if (std::ranges::count(groups, each.row.group) == 0) groups.emplace_back(each.row.group);
  for (const std::string& group : groups) {
    text += "\n" + group + ":\n";
    for (const Argument& each : command.options)
      if (each.row.group == group)
        text += entry(allSpellings(each.row) + (*each.row.value == '\0' ? "" : " ") + each.row.value,
                      each.help + (each.isRequired ? " (required)" : ""));
  }
  return text + "\n" + footerOf(command.footer);
}

}  // namespace raymap
