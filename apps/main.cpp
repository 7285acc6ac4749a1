#include <raymap/error.h>
#include <raymap/names.h>
#include <raymap/version.h>

#include <cstdio>
#include <exception>
#include <string>
#include <system_error>

#include "commands.h"
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

Failure bug(const std::exception& error) {
  return {1, "bug", std::string("this is a bug, please report it: ") + error.what()};
}

Failure outOfMemory() {
  return {exitCodeOf(ErrorCode::Memory), name(ErrorCode::Memory),
          "out of memory: the work needs more than the " + sizeText(peakMemory()) +
              " that it held; allow more, or use a lower resolution"};
}

/// Adds the options for the text that a command prints, which every command has.
void addTextOptions(Command& command) {
  const auto set = [](TextLevel level) { return [=](const std::string&) { setTextLevel(level); }; };
  addOptions(command, {{"--verbose", set(TextLevel::Verbose)},
                       {"--quiet", set(TextLevel::Quiet)},
                       {"--progress", setProgressStyle}});
}

int run(int argc, char** argv) {
  Program program;
  program.description = "Turns any triangle mesh, however broken, into a signed distance field.";
  program.footer = kMainFooter;
  for (AddCommand* add :
       {addGenerate, addInfo, addCheck, addQuery, addSample, addMesh, addRender, addView, addRepair,
        addSimplify, addCompare, addConvert, addExample, addDevices, addCompletion, addManual})
    add(program);
  for (Command& command : program.commands) addTextOptions(command);
  const Parsed parsed = parse(program, {argv + 1, argv + argc});
  if (parsed.isVersion || (parsed.isHelp && parsed.mistake.empty())) {
    std::printf("%s", parsed.isVersion ? (std::string("raymap ") + version().text + "\n").c_str()
                      : parsed.command ? helpOf(*parsed.command).c_str()
                                       : helpOf(program).c_str());
    finishText();
    return 0;
  }
  if (const std::string mistake = describeMistake(program, parsed); !mistake.empty())
    return fail(
        exitCodeOf(ErrorCode::Usage),
        mistake + "; see raymap " + (parsed.command == nullptr ? "" : parsed.command->name + " ") + "--help");
  if (parsed.command->prepare) parsed.command->prepare();
  parsed.command->run();
  finishText();
  return 0;
}

}  // namespace

Failure describeFailure() {
  try {
    throw;
  } catch (const Error& error) {
    endIfReaderEnded(error);
    const bool isStopped = error.code() == ErrorCode::Cancelled && caughtSignal() != 0;
    return {isStopped ? 128 + caughtSignal() : exitCodeOf(error.code()), name(error.code()), error.what()};
  } catch (const std::bad_alloc&) {
    return outOfMemory();
  } catch (const std::system_error& error) {
    const bool isMemory = error.code() == std::errc::resource_unavailable_try_again;  // For a thread.
    return isMemory ? outOfMemory() : bug(error);
  } catch (const std::exception& error) {
    return bug(error);
  }
}

}  // namespace raymap

int main(int argc, char** argv) {
  using namespace raymap;
  catchSignals();
  try {
    return run(argc, argv);
  } catch (const ExitCode& exit) {
    return exit.code;
  } catch (const std::exception&) {
    const Failure failure = describeFailure();
    return fail(failure.code, failure.message);
  }
}
