#pragma once

#include <raymap/error.h>

#include <CLI/CLI.hpp>

namespace raymap {

// One file per subcommand. Each function adds its options and the function to run.
void addGenerate(CLI::App& app);
void addInfo(CLI::App& app);
void addCheck(CLI::App& app);
void addQuery(CLI::App& app);
void addSample(CLI::App& app);
void addMesh(CLI::App& app);
void addRender(CLI::App& app);
void addView(CLI::App& app);
void addRepair(CLI::App& app);
void addSimplify(CLI::App& app);
void addCompare(CLI::App& app);
void addConvert(CLI::App& app);
void addExample(CLI::App& app);
void addDevices(CLI::App& app);
void addCompletion(CLI::App& app);
void addManual(CLI::App& app);

/// Returns the exit code of an error, as docs/cli.md lists it.
int exitCodeOf(ErrorCode code);

}  // namespace raymap
