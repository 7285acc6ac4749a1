#include <raymap/error.h>
#include <raymap/version.h>

#include <cstdio>
#include <exception>
#include <iterator>
#include <string>
#include <vector>

#include "commands.h"
#include "terminal.h"

namespace raymap {

namespace {

constexpr const char* kFooter = R"(Try it:
  raymap example -o globe.ply
  raymap generate globe.ply -o globe.vdb --resolution 256
  raymap render globe.vdb -o globe.png

'raymap COMMAND --help' shows a command's options and examples.

Exit codes: 0 success, 2 invalid option, 3 invalid content of a file, 4 a file cannot be read or written,
5 not enough memory, 6 cancelled, 7 not supported by this build or machine, 8 the GPU stopped answering,
9 a GPU failed its test, 10 the GPU has no memory left, 1 a bug in raymap,
130 or 143 stopped by Ctrl-C or SIGTERM, 129 or 152 stopped by SIGHUP or SIGXCPU.)";

int fail(int code, const std::string& message) {
  std::fprintf(stderr, "raymap: error: %s\n", withDisplayNames(message).c_str());
  return code;
}

/// Returns the command that was understood, for example "raymap generate".
std::string commandName(const CLI::App& app) {
  std::string name = app.get_name();
  for (const CLI::App* command : app.get_subcommands()) name += " " + command->get_name();
  return name;
}

/// Returns what is wrong with the arguments, in their order. CLI11 lists unknown ones last first, and reports
/// a misspelt command only as missing.
std::string describe(const CLI::App& app, const CLI::ParseError& error) {
  const std::vector<std::string> unknown = app.remaining(true);
  if (app.get_subcommands().empty()) {
    std::string text =
        unknown.empty() ? "name a command:" : "unknown command '" + unknown.front() + "'; use one of:";
    for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
      text += " " + command->get_name();
    return text;
  }
  if (dynamic_cast<const CLI::ExtrasError*>(&error) == nullptr) return error.what();
  std::string text = "not understood:";
  for (const std::string& argument : unknown) text += " " + argument;
  return text;
}

/// Returns the arguments, last first as CLI11 wants them. Writes -.5 as -0.5: CLI11 would take the former
/// for an option.
std::vector<std::string> readArguments(int argc, char** argv) {
  std::vector<std::string> arguments(std::reverse_iterator(argv + argc), std::reverse_iterator(argv + 1));
  for (std::string& argument : arguments)
    if (argument.size() > 2 && argument.starts_with("-.") && argument[2] >= '0' && argument[2] <= '9')
      argument.insert(1, "0");
  return arguments;
}

/// Returns the exit code of an error, as docs/cli.md lists it.
int exitCode(ErrorCode code) {
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

int run(int argc, char** argv) {
  CLI::App app("Turns any triangle mesh, however broken, into a signed distance field.", "raymap");
  app.set_version_flag("--version", std::string("raymap ") + version().text);
  app.footer(kFooter);
  app.require_subcommand(1);
  app.get_formatter()->column_width(34);
  addGenerate(app);
  addInfo(app);
  addQuery(app);
  addSample(app);
  addMesh(app);
  addRender(app);
  addRepair(app);
  addCompare(app);
  addConvert(app);
  addExample(app);
  addDevices(app);
  try {
    app.parse(readArguments(argc, argv));
    finishText();
    return 0;
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) {  // --help, --version
      app.exit(error);
      finishText();
      return 0;
    }
    if (dynamic_cast<const CLI::RuntimeError*>(&error) != nullptr) return error.get_exit_code();
    return fail(exitCode(ErrorCode::Usage), describe(app, error) + "; see " + commandName(app) + " --help");
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
    const bool isStopped = error.code() == ErrorCode::Cancelled && caughtSignal() != 0;
    return fail(isStopped ? 128 + caughtSignal() : exitCode(error.code()), error.what());
  } catch (const std::bad_alloc&) {
    return fail(exitCode(ErrorCode::Memory), "out of memory; use a lower resolution");
  } catch (const std::exception& error) {
    return fail(1, std::string("this is a bug, please report it: ") + error.what());
  }
}
