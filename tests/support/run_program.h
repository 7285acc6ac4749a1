#pragma once

// Runs a program and returns its exit code, its stderr and its peak memory.

#include <fcntl.h>
#include <gtest/gtest.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "files.h"

namespace raymap {

struct ProgramRun {
  int code = -1;  ///< Exit code; -1 if a signal ended the program.
  std::string error;
  size_t peakBytes = 0;  ///< Largest resident size of the program and of any process it waited for.
};

inline ProgramRun runProgram(std::vector<std::string> arguments) {
  const std::filesystem::path errors =
      std::filesystem::temp_directory_path() / ("raymap_stderr_" + std::to_string(getpid()));
  std::vector<char*> words;
  for (std::string& argument : arguments) words.push_back(argument.data());
  words.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, errors.c_str(), O_WRONLY | O_CREAT | O_TRUNC,
                                   0600);
  pid_t child = 0;
  EXPECT_EQ(posix_spawn(&child, words[0], &actions, nullptr, words.data(), environ), 0) << words[0];
  posix_spawn_file_actions_destroy(&actions);
  int status = -1;
  rusage usage{};
  EXPECT_EQ(wait4(child, &status, 0, &usage), child);
  ProgramRun run;
  if (WIFEXITED(status)) run.code = WEXITSTATUS(status);
  run.error = readBytes(errors);
  run.peakBytes = static_cast<size_t>(usage.ru_maxrss) << 10;
  std::filesystem::remove(errors);
  return run;
}

}  // namespace raymap
