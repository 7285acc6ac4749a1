#include <raymap/error.h>
#include <raymap/version.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <exception>
#include <string>
#include <system_error>
#include <vector>

#include "commands.h"
#include "options.h"
#include "report.h"
#include "terminal.h"
#include "usage.h"

namespace raymap {

int exitCodeOf(ErrorCode code) {
  switch (code) {
    case ErrorCode::Usage:
      return 2;
    case ErrorCode::Input:
      return 3;
    case ErrorCode::File:
      return 4;
    case ErrorCode::Memory:
      return 5;
    case ErrorCode::Cancelled:
      return 6;
    case ErrorCode::Unsupported:
      return 7;
    case ErrorCode::DeviceLost:
      return 8;
    case ErrorCode::DeviceMemory:
      return 10;
  }
  return 1;
}

namespace {

constexpr const char* kMainFooter = R"(Try it:
  raymap example -o globe.ply
  raymap generate globe.ply -o globe.vdb --resolution 256
  raymap render globe.vdb -o globe.png

'raymap COMMAND --help' shows a command's options and examples.

Exit codes: 0 success, 2 invalid option, 3 invalid content of a file, 4 a file cannot be read or written,
5 not enough memory, 6 cancelled, 7 not supported by this build or machine, 8 the GPU stopped answering,
9 a GPU failed its test, 10 the GPU has no memory left, 11 check found a bad mesh, 1 a bug in raymap,
130 or 143 stopped by Ctrl-C or SIGTERM, 141 by a closed pipe, 129 or 152 stopped by SIGHUP or SIGXCPU.)";

int fail(int code, const std::string& message) {
  printError(message);
  return code;
}

int failAsBug(const std::exception& error) {
  return fail(1, std::string("this is a bug, please report it: ") + error.what());
}

int failOfMemory() {
  return fail(exitCodeOf(ErrorCode::Memory), "out of memory: the work needs more than the " +
                                                 sizeText(peakMemory()) +
                                                 " that it held; allow more, or use a lower resolution");
}

/// Returns the command that was understood, for example "raymap generate".
std::string commandName(const CLI::App& app) {
  std::string name = app.get_name();
  for (const CLI::App* command : app.get_subcommands()) name += " " + command->get_name();
  return name;
}

/// Returns the arguments as CLI11 reads them. Options that every command has may stand before it, and
/// `help COMMAND` stands for `COMMAND --help`.
std::vector<std::string> readArguments(int argc, char** argv) {
  std::vector<std::string> arguments = normalized(std::vector<std::string>(argv + 1, argv + argc));
  constexpr std::array kAnywhere{"-q", "--quiet", "-v", "--verbose", "--progress"};
  auto command = arguments.begin();
  while (command != arguments.end() &&
         std::ranges::count(kAnywhere, command->substr(0, command->find('='))) > 0)
    command += *command == "--progress" && command + 1 != arguments.end() ? 2 : 1;
  std::rotate(arguments.begin(), command, arguments.end());
  if (!arguments.empty() && CLI::detail::to_lower(arguments.front()) == "help") {
    arguments.erase(arguments.begin());
    arguments.emplace_back("--help");
  }
  return arguments;
}

int run(int argc, char** argv) {
  CLI::App app("Turns any triangle mesh, however broken, into a signed distance field.", "raymap");
  app.set_version_flag("-V,--version", std::string("raymap ") + version().text, "Print the version");
  app.set_help_flag("-h,--help", "Print this help");
  app.footer(kMainFooter);
  app.require_subcommand(1);
  app.ignore_case();
  app.formatter(std::make_shared<HelpFormatter>());
  app.get_formatter()->label("SUBCOMMAND", "COMMAND");
  addGenerate(app);
  addInfo(app);
  addCheck(app);
  addQuery(app);
  addSample(app);
  addMesh(app);
  addRender(app);
  addView(app);
  addRepair(app);
  addSimplify(app);
  addCompare(app);
  addConvert(app);
  addExample(app);
  addDevices(app);
  addCompletion(app);
  addManual(app);
  for (CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
    command->group("Commands");
    addTextOptions(*command);
  }
  const std::vector<std::string> arguments = readArguments(argc, argv);
  try {
    app.parse(std::vector<std::string>(arguments.rbegin(), arguments.rend()));  // CLI11 wants the last first.
    finishText();
    return 0;
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) {  // --help, --version
      app.exit(error);
      finishText();
      return 0;
    }
    if (dynamic_cast<const CLI::RuntimeError*>(&error) != nullptr) return error.get_exit_code();
    return fail(exitCodeOf(ErrorCode::Usage),
                describeUsageError(app, error, arguments) + "; see " + commandName(app) + " --help");
  }
}

}  // namespace

}  // namespace raymap

int main(int argc, char** argv) {
  using namespace raymap;
  catchSignals();
  try {
    return run(argc, argv);
  } catch (const Error& error) {
    endIfReaderEnded(error);
    const bool isStopped = error.code() == ErrorCode::Cancelled && caughtSignal() != 0;
    return fail(isStopped ? 128 + caughtSignal() : exitCodeOf(error.code()), error.what());
  } catch (const std::bad_alloc&) {
    return failOfMemory();
  } catch (const std::system_error& error) {
    const bool isMemory = error.code() == std::errc::resource_unavailable_try_again;  // For a thread.
    return isMemory ? failOfMemory() : failAsBug(error);
  } catch (const std::exception& error) {
    return failAsBug(error);
  }
}
