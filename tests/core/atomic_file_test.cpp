#include <raymap/atomic_file.h>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <raymap/error.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <string>

#include "base/temporary_file.h"
#include "error_code.h"
#include "files.h"

namespace raymap {
namespace {

namespace fs = std::filesystem;

class AtomicFile : public testing::Test {
 protected:
  fs::path file(const char* name) const { return folder_.path() / name; }
  size_t entries() const { return folder_.fileCount(); }
  static void writeText(const fs::path& path, const std::string& text) {
    writeAtomically(path, [&](std::ostream& out) { out << text; });
  }
  /// Runs `work` in a child process and ends it with `signal` once it has begun to write. Returns its wait
  /// status.
  template <class Work>
  static int endedBy(int signal, Work&& work) {
    int begun[2];
    EXPECT_EQ(pipe(begun), 0);
    const pid_t child = fork();
    if (child == 0) {
      work(begun[1]);
      _exit(0);
    }
    char byte = 0;
    EXPECT_EQ(::read(begun[0], &byte, 1), 1);
    kill(child, signal);
    int status = 0;
    waitpid(child, &status, 0);
    close(begun[0]);
    close(begun[1]);
    return status;
  }
  /// A write that never ends.
  static void writeForever(const fs::path& path, int begun) {
    writeAtomically(path, [&](std::ostream& out) {
      out << std::string(1 << 20, 'x') << std::flush;
      waitForever(begun);
    });
  }
  /// The same under a hidden name.
  static void writeHiddenForever(const fs::path& path, int begun) {
    TemporaryFile file(path, path, TemporaryFile::Name::Hidden);
    if (::write(file.descriptor(), "x", 1) == 1) waitForever(begun);
  }
  static void waitForever(int begun) {
    if (::write(begun, "b", 1) != 1) _exit(1);
    for (;;) pause();
  }
  static void publish(TemporaryFile& file, const std::string& text) {
    EXPECT_EQ(::write(file.descriptor(), text.data(), text.size()), ssize_t(text.size()));
    file.publish();
  }
  /// Returns the hidden name that the class gives.
  fs::path hidden(const char* name, unsigned number) const {
    return file(("." + std::string(name) + ".tmp" + std::to_string(geteuid()) + "-" + std::to_string(number))
                    .c_str());
  }
  bool hasNamelessFiles() const {
    const int descriptor = open(folder_.path().c_str(), O_TMPFILE | O_WRONLY, 0600);
    if (descriptor >= 0) close(descriptor);
    return descriptor >= 0;
  }

  TemporaryFolder folder_;
};

TEST_F(AtomicFile, WritesReplacesAndSeeks) {
  writeText(file("a"), "one");
  EXPECT_EQ(readBytes(file("a")), "one");
  writeText(file("a"), std::string(1 << 20, 'x') + "end");
  EXPECT_EQ(readBytes(file("a")), std::string(1 << 20, 'x') + "end");
  writeAtomically(file("a"), [](std::ostream& out) {
    out << "0123456789";
    const auto end = out.tellp();
    EXPECT_EQ(end, std::streampos(10));
    out.seekp(2) << "XY";
    out.seekp(end) << "!";
  });
  EXPECT_EQ(readBytes(file("a")), "01XY456789!");
  EXPECT_EQ(entries(), 1U);
}

TEST_F(AtomicFile, KeepsNoRightsOfAnOwner) {
  writeText(file("target"), "old");
  ASSERT_EQ(chmod(file("target").c_str(), 07751), 0);
  writeText(file("target"), "new");
  EXPECT_EQ(fs::status(file("target")).permissions(), fs::perms(0751));
}

TEST_F(AtomicFile, KeepsLinksAndPermissions) {
  writeText(file("target"), "old");
  fs::permissions(file("target"), fs::perms(0640));
  fs::create_symlink("target", file("link"));
  writeText(file("link"), "new");
  EXPECT_TRUE(fs::is_symlink(file("link")));
  EXPECT_EQ(readBytes(file("target")), "new");
  EXPECT_EQ(fs::status(file("target")).permissions(), fs::perms(0640));
  fs::create_symlink("later", file("dangling"));
  writeText(file("dangling"), "made");
  EXPECT_EQ(readBytes(file("later")), "made");
}

TEST_F(AtomicFile, FailsLeavingTheOldFile) {
  writeText(file("a"), "old");
  EXPECT_THROW(writeAtomically(file("a"),
                               [](std::ostream& out) {
                                 out << std::string(1 << 20, 'x');
                                 throw Error(ErrorCode::Cancelled, "stop");
                               }),
               Error);
  EXPECT_EQ(readBytes(file("a")), "old");
  EXPECT_EQ(entries(), 1U);
}

TEST_F(AtomicFile, RefusesFoldersAndMissingFolders) {
  EXPECT_THROW(writeText(folder_.path(), "x"), Error);
  EXPECT_THROW(writeText(folder_.path() / "missing" / "a", "x"), Error);
  EXPECT_EQ(entries(), 0U);
}

TEST_F(AtomicFile, WritesDevicesInPlace) {
  writeText("/dev/null", "gone");
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
  if (!fs::exists("/dev/full")) GTEST_SKIP() << "no /dev/full";
  EXPECT_NE(messageOf(ErrorCode::File, [&] { writeText("/dev/full", "x"); }).find("No space left"),
            std::string::npos);
}

TEST_F(AtomicFile, WritesDescriptorsWhereTheyStand) {
  std::ofstream(file("a")) << "0123456789";
  const int descriptor = open(file("a").c_str(), O_RDWR);
  ASSERT_GE(descriptor, 0);
  ASSERT_EQ(lseek(descriptor, 4, SEEK_SET), 4);
  const std::string name = "/dev/fd/" + std::to_string(descriptor);
  writeAtomically(name, [](std::ostream& out) {
    EXPECT_EQ(out.tellp(), std::ostream::pos_type(-1));
    out.clear();
    out << "ab";
  });
  EXPECT_EQ(lseek(descriptor, 0, SEEK_CUR), 6);
  fs::create_symlink(name, file("link"));
  writeText(file("link"), "cd");
  close(descriptor);
  EXPECT_EQ(readBytes(file("a")), "0123abcd89");
  EXPECT_TRUE(fs::is_symlink(file("link")));
  EXPECT_EQ(entries(), 2U);
}

TEST_F(AtomicFile, SaysThatTheReaderOfAPipeHasEnded) {
  int ends[2];
  ASSERT_EQ(pipe(ends), 0);
  close(ends[0]);
  const auto handler = std::signal(SIGPIPE, SIG_IGN);
  EXPECT_NE(messageOf(ErrorCode::File, [&] { writeText("/dev/fd/" + std::to_string(ends[1]), "x"); })
                .find("the program that reads it has ended"),
            std::string::npos);
  std::signal(SIGPIPE, handler);
  close(ends[1]);
}

TEST_F(AtomicFile, ReplacesFilesInMemory) {
  const fs::path path = "/dev/shm/raymap_test_" + std::to_string(getpid());
  if (!fs::exists("/dev/shm")) GTEST_SKIP() << "no /dev/shm";
  writeText(path, "first, longer");
  writeText(path, "second");
  EXPECT_EQ(readBytes(path), "second");
  fs::remove(path);
}

TEST_F(AtomicFile, AFullDiskLeavesNothing) {
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  rlimit small = before;
  small.rlim_cur = 100'000;
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
  EXPECT_NE(messageOf(ErrorCode::File, [&] { writeText(file("a"), std::string(1 << 20, 'x')); })
                .find(file("a").string()),
            std::string::npos);
  setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, handler);
  EXPECT_EQ(entries(), 0U);
}

TEST_F(AtomicFile, AKillLeavesTheOldFileAlone) {
  if (!hasNamelessFiles()) GTEST_SKIP() << "no files without names here";
  writeText(file("a"), "old");
  const int status = endedBy(SIGKILL, [&](int begun) { writeForever(file("a"), begun); });
  EXPECT_TRUE(WIFSIGNALED(status));
  EXPECT_EQ(readBytes(file("a")), "old");
  EXPECT_EQ(entries(), 1U);
}

TEST_F(AtomicFile, AHandledSignalLeavesNothing) {
  const int status = endedBy(SIGTERM, [&](int begun) {
    std::signal(SIGTERM, [](int) {
      removeTemporaries();
      _exit(5);
    });
    writeHiddenForever(file("a"), begun);
  });
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 5);
  EXPECT_EQ(entries(), 0U);
}

TEST_F(AtomicFile, TheNextWriteRemovesWhatAKillLeft) {
  const auto kill = [&] { endedBy(SIGKILL, [&](int begun) { writeHiddenForever(file("a"), begun); }); };
  kill();
  EXPECT_TRUE(fs::exists(hidden("a", 0)));
  EXPECT_EQ(entries(), 1U);
  writeText(file("a"), "new");
  EXPECT_EQ(entries(), 1U) << "also where files have no names";
  EXPECT_EQ(readBytes(file("a")), "new");
  kill();
  EXPECT_EQ(entries(), 2U);
  {
    TemporaryFile next(file("a"), file("a"), TemporaryFile::Name::Hidden);
    EXPECT_TRUE(fs::exists(hidden("a", 0)));
    EXPECT_EQ(entries(), 2U);
    publish(next, "newer");
  }
  EXPECT_EQ(entries(), 1U);
  EXPECT_EQ(readBytes(file("a")), "newer");
  {
    const TemporaryFile other(file("a"), file("a"), TemporaryFile::Name::Hidden);
    kill();
    EXPECT_TRUE(fs::exists(hidden("a", 1)));
  }
  writeText(file("a"), "newest");
  EXPECT_EQ(entries(), 1U) << "also what a second writer left";
}

TEST_F(AtomicFile, WritersOfOneFileLeaveEachOtherAlone) {
  for (const auto name : {TemporaryFile::Name::None, TemporaryFile::Name::Hidden}) {
    writeText(file("a"), "old");
    TemporaryFile first(file("a"), file("a"), TemporaryFile::Name::Hidden);
    EXPECT_TRUE(fs::exists(hidden("a", 0)));
    TemporaryFile second(file("a"), file("a"), name);
    EXPECT_EQ(fs::exists(hidden("a", 1)), name == TemporaryFile::Name::Hidden || !hasNamelessFiles());
    EXPECT_TRUE(fs::exists(hidden("a", 0)));
    publish(second, "second");
    EXPECT_EQ(readBytes(file("a")), "second");
    EXPECT_TRUE(fs::exists(hidden("a", 0)));
    EXPECT_EQ(entries(), 2U);
    publish(first, "first");
    EXPECT_EQ(readBytes(file("a")), "first");
    EXPECT_EQ(entries(), 1U);
  }
}

TEST_F(AtomicFile, FilesThatAreNotPublishedGo) {
  for (const auto name : {TemporaryFile::Name::None, TemporaryFile::Name::Hidden}) {
    { const TemporaryFile file(this->file("a"), this->file("a"), name); }
    EXPECT_EQ(entries(), 0U);
    TemporaryFile made(file("a"), file("a"), name);
    publish(made, "text");
    EXPECT_EQ(readBytes(file("a")), "text");
    EXPECT_EQ(entries(), 1U);
    fs::remove(file("a"));
  }
}

TEST_F(AtomicFile, LeavesWhatOnlyHasAHiddenName) {
  std::ofstream(file("other")) << "other";
  fs::create_symlink("other", hidden("a", 0));
  fs::create_directory(hidden("a", 1));
  ASSERT_EQ(mkfifo(hidden("a", 2).c_str(), 0600), 0);
  std::ofstream(hidden("a", 3)) << "of another user";
  const bool isGiven = chown(hidden("a", 3).c_str(), geteuid() + 1, gid_t(-1)) == 0;  // Root may.
  {
    TemporaryFile made(file("a"), file("a"), TemporaryFile::Name::Hidden);
    EXPECT_EQ(fs::exists(hidden("a", 4)), isGiven);
    publish(made, "text");
  }
  writeText(file("a"), "again");
  EXPECT_EQ(readBytes(file("a")), "again");
  EXPECT_EQ(readBytes(file("other")), "other");
  EXPECT_TRUE(fs::is_symlink(hidden("a", 0)));
  EXPECT_TRUE(fs::is_directory(hidden("a", 1)));
  EXPECT_TRUE(fs::is_fifo(hidden("a", 2)));
  EXPECT_EQ(entries(), isGiven ? 6U : 5U);
}

TEST_F(AtomicFile, NewFilesHaveThePermissionsOfTheUser) {
  const mode_t before = umask(027);
  writeText(file("a"), "text");
  {
    TemporaryFile made(file("b"), file("b"), TemporaryFile::Name::Hidden);
    publish(made, "text");
  }
  umask(before);
  EXPECT_EQ(fs::status(file("a")).permissions(), fs::perms(0640));
  EXPECT_EQ(fs::status(file("b")).permissions(), fs::perms(0640));
}

}  // namespace
}  // namespace raymap
