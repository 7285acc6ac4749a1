#pragma once

#include <raymap/error.h>

#include <exception>
#include <string>
#include <string_view>

#include "parser.h"

namespace raymap {

// One file per subcommand. Each function adds its options and the function to run.
using AddCommand = void(Program& program);
AddCommand addGenerate, addInfo, addCheck, addQuery, addSample, addMesh, addRender, addView, addRepair,
    addSimplify, addCompare, addConvert, addExample, addDevices, addCompletion, addManual;

/// Thrown by a command that ends with another exit code than 0, but printed all that is to be said.
struct ExitCode : std::exception {
  explicit ExitCode(int number) : code(number) {}
  int code;
};

/// Returns the exit code of an error, as docs/cli.md lists it.
int exitCodeOf(ErrorCode code);

/// Message and exit code for an exception.
struct Failure {
  int code;               ///< Exit code.
  std::string_view kind;  ///< Name of the kind of error.
  std::string message;
};

/// Describes the exception that is being handled. Ends the program if the reader of its data has ended.
Failure describeFailure();

}  // namespace raymap
