// Behaviour of the program at signals. They reach it while it waits for the test.

#include <fcntl.h>
#include <gtest/gtest.h>
#include <raymap/raymap.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <string>
#include <vector>

#include "files.h"
#include "shapes.h"

namespace raymap {
namespace {

namespace fs = std::filesystem;

/// A run of the program in the background.
class Program {
 public:
  /// Starts it with descriptors for stdout and stderr. `ignored` is a signal that it finds ignored. It
  /// ignores no other, also where the test does, as under nohup.
  Program(std::vector<std::string> arguments, int out, int err, int ignored = 0) {
    arguments.insert(arguments.begin(), RAYMAP_BINARY);
    std::vector<char*> words;
    for (std::string& argument : arguments) words.push_back(argument.data());
    words.push_back(nullptr);
    posix_spawn_file_actions_t files;
    posix_spawn_file_actions_init(&files);
    posix_spawn_file_actions_adddup2(&files, out, STDOUT_FILENO);
    posix_spawn_file_actions_adddup2(&files, err, STDERR_FILENO);
    sigset_t others;
    sigemptyset(&others);
    for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGXCPU})
      if (signal != ignored) sigaddset(&others, signal);
    posix_spawnattr_t attributes;
    posix_spawnattr_init(&attributes);
    posix_spawnattr_setsigdefault(&attributes, &others);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGDEF);
    const auto before = ignored != 0 ? std::signal(ignored, SIG_IGN) : SIG_DFL;
    EXPECT_EQ(posix_spawn(&process_, words[0], &files, &attributes, words.data(), environ), 0);
    if (ignored != 0) std::signal(ignored, before);
    posix_spawnattr_destroy(&attributes);
    posix_spawn_file_actions_destroy(&files);
  }
  ~Program() {
    if (process_ == 0) return;
    kill(process_, SIGKILL);
    waitpid(process_, nullptr, 0);
  }
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;

  void send(int signal) const { kill(process_, signal); }
  /// Waits for its end and returns its status.
  int status() {
    int status = -1;
    EXPECT_EQ(waitpid(process_, &status, 0), process_);
    process_ = 0;
    return status;
  }
  int code() {
    const int status = this->status();
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }

 private:
  pid_t process_ = 0;
};

class Signals : public ::testing::Test {
 protected:
  fs::path path(const char* name) const { return folder_.path() / name; }
  size_t fileCount() const { return folder_.fileCount(); }
  int nothing() const { return nothing_; }

 private:
  TemporaryFolder folder_;
  int nothing_ = open("/dev/null", O_WRONLY | O_CLOEXEC);
};

/// A pipe with a name, from which a program reads a mesh. Both wait for each other when they open it.
class MeshPipe {
 public:
  explicit MeshPipe(fs::path path) : path_(std::move(path)) { EXPECT_EQ(mkfifo(path_.c_str(), 0600), 0); }
  ~MeshPipe() { finish(""); }
  MeshPipe(const MeshPipe&) = delete;
  MeshPipe& operator=(const MeshPipe&) = delete;

  /// Waits until the program reads.
  void awaitReader() { descriptor_ = open(path_.c_str(), O_WRONLY | O_CLOEXEC); }
  /// Writes the rest of the mesh.
  void finish(const std::string& bytes) {
    if (descriptor_ < 0) return;
    EXPECT_EQ(write(descriptor_, bytes.data(), bytes.size()), ssize_t(bytes.size()));
    close(descriptor_);
    descriptor_ = -1;
  }

 private:
  fs::path path_;
  int descriptor_ = -1;
};

/// A terminal of which the test has the other end.
class Terminal {
 public:
  Terminal() : master_(posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC)) {
    EXPECT_EQ(grantpt(master_), 0);
    EXPECT_EQ(unlockpt(master_), 0);
    slave_ = open(ptsname(master_), O_RDWR | O_NOCTTY | O_CLOEXEC);
    EXPECT_GE(slave_, 0);
  }
  ~Terminal() {
    close(slave_);
    close(master_);
  }
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;

  int slave() const { return slave_; }
  /// Reads until a text appears.
  void await(const std::string& text) const {
    std::string seen;
    while (seen.find(text) == std::string::npos) {
      char bytes[256];
      const ssize_t count = ::read(master_, bytes, sizeof bytes);
      ASSERT_GT(count, 0) << seen;
      seen.append(bytes, static_cast<size_t>(count));
    }
  }

 private:
  int master_, slave_ = -1;
};

TEST_F(Signals, EndTheProgramAtOnce) {
  MeshPipe mesh(path("mesh.ply"));
  for (const auto& [signal, code] : {std::pair(SIGINT, 130), {SIGTERM, 143}, {SIGHUP, 129}, {SIGXCPU, 152}}) {
    Program program({"generate", path("mesh.ply"), "-o", path("f.nrrd")}, nothing(), nothing());
    mesh.awaitReader();
    program.send(signal);
    EXPECT_EQ(program.code(), code);
    mesh.finish("");
    EXPECT_EQ(fileCount(), 1u);
  }
}

TEST_F(Signals, EndTheProgramByTheSignalOfACore) {
  rlimit cores{};
  getrlimit(RLIMIT_CORE, &cores);
  cores.rlim_cur = 0;  // None is written.
  setrlimit(RLIMIT_CORE, &cores);
  MeshPipe mesh(path("mesh.ply"));
  Program program({"info", path("mesh.ply")}, nothing(), nothing());
  mesh.awaitReader();
  program.send(SIGQUIT);
  const int status = program.status();
  EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGQUIT) << status;
}

TEST_F(Signals, StayIgnored) {
  writeMesh(path("torus.ply"), shapes::torus(2.0, 0.7, 40, 24));
  MeshPipe mesh(path("mesh.ply"));
  for (const int signal : {SIGHUP, SIGQUIT, SIGXCPU}) {
    Program program({"info", path("mesh.ply")}, nothing(), nothing(), signal);
    mesh.awaitReader();
    program.send(signal);
    mesh.finish(readBytes(path("torus.ply")));
    EXPECT_EQ(program.code(), 0) << signal;
  }
}

TEST_F(Signals, CancelTheWork) {
  Mesh mesh = shapes::torus(2.0, 0.7, 40, 24);
  mesh.triangles.pop_back();
  writeMesh(path("torn.ply"), mesh);
  for (const auto& [signal, code] : {std::pair(SIGINT, 130), {SIGTERM, 143}, {SIGHUP, 129}, {SIGXCPU, 152}}) {
    const Terminal terminal;
    // It takes days, so it runs until the signal comes.
    Program program({"generate", path("torn.ply"), "-o", path("f.nrrd"), "--sign", "paths", "--passes",
                     "10000000", "--winding", path("w.npy")},
                    nothing(), terminal.slave());
    terminal.await(" %");
    program.send(signal);
    EXPECT_EQ(program.code(), code);
    EXPECT_EQ(fileCount(), 1u);
  }
}

}  // namespace
}  // namespace raymap
