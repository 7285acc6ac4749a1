#pragma once

// Runs the program as a user would.

#include <gtest/gtest.h>
#include <raymap/raymap.h>
#include <sys/wait.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <regex>
#include <string>
#include <vector>

#include "error_code.h"
#include "files.h"
#include "shapes.h"

namespace raymap {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// A test of the program in a folder of its own.
class Cli : public ::testing::Test {
 protected:
  struct Result {
    int code;  ///< Exit code; -1 if a signal ended the shell.
    std::string out, err;
  };

  /// Runs a line of bash in the folder. $R is the program.
  Result shell(const std::string& line) const {
    const fs::path script = captured_.path() / "line", out = captured_.path() / "out",
                   err = captured_.path() / "err";
    std::ofstream(script) << "R='" RAYMAP_BINARY "'\n" << line << "\n";
    const auto quoted = [](const fs::path& file) { return "'" + file.string() + "'"; };
    const std::string command = "cd " + quoted(folder_.path()) + " && bash " + quoted(script) + " >" +
                                quoted(out) + " 2>" + quoted(err) + " </dev/null";
    const int status = std::system(command.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, readBytes(out), readBytes(err)};
  }

  /// Runs `raymap arguments` in the folder, with `prefix` before the command.
  Result run(const std::string& arguments, const std::string& prefix = "") const {
    return shell(prefix + " $R " + arguments);
  }

  /// Runs it too. Leaves the lines out that a slow machine sees after each minute.
  Result runQuietly(const std::string& arguments) const {
    Result result = run(arguments);
    result.err = std::regex_replace(result.err, std::regex("raymap: [0-9]+ s: [^\n]*\n"), "");
    return result;
  }

  /// Expects the exit code 0 and nothing on stderr.
  Result succeed(const std::string& arguments) const {
    Result result = runQuietly(arguments);
    EXPECT_EQ(result.code, 0) << arguments << "\n" << result.err;
    EXPECT_EQ(result.err, "") << arguments;
    return result;
  }

  /// Expects one line on stderr that contains `message`, nothing on stdout, and the code.
  void expectFailure(const std::string& arguments, ErrorCode code, const std::string& message) const {
    SCOPED_TRACE(arguments);
    const Result result = runQuietly(arguments);
    EXPECT_EQ(result.code, exitCode(code)) << result.err;
    EXPECT_EQ(result.out, "");
    EXPECT_EQ(result.err.rfind("raymap: error: ", 0), 0u) << result.err;
    EXPECT_EQ(result.err.find('\n'), result.err.size() - 1) << result.err;
    EXPECT_NE(result.err.find(message), std::string::npos) << result.err;
  }

  fs::path path(const std::string& name) const { return folder_.path() / name; }
  size_t fileCount() const { return folder_.fileCount(); }
  Json json(const std::string& name) const { return Json::parse(readBytes(path(name))); }
  void writeTorus() const { writeMesh(path("torus.ply"), shapes::torus(2.0, 0.7, 40, 24)); }

  static bool hasFieldFormat(const std::string& extension) {
    return std::ranges::count(fieldExtensions(), extension) > 0;
  }

 private:
  TemporaryFolder folder_;
  TemporaryFolder captured_;  ///< Holds the command and what it printed.
};

}  // namespace raymap
