// Landlock restricts what can be opened, and seccomp what the kernel can be asked for. Both are used by their
// system calls: their numbers and structures never change, and old kernels refuse them.

#include "io/import/confine.h"

#include <fcntl.h>
#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstddef>
#include <fstream>
#include <initializer_list>
#include <vector>

namespace raymap {

namespace {

void limit(int resource, rlim_t most) {
  const rlimit both{most, most};
  setrlimit(static_cast<__rlimit_resource_t>(resource), &both);
}

/// Limits the address space to `bytes` more than the process has now.
void limitMemory(uint64_t bytes) {
  uint64_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  limit(RLIMIT_AS, pages * static_cast<uint64_t>(sysconf(_SC_PAGESIZE)) + bytes);
}

/// Lets this process open no file but one, for reading.
void restrictFiles(int file) {
#ifdef SYS_landlock_create_ruleset
  constexpr uint64_t kReadFile = uint64_t{1} << 2;
  constexpr std::array<uint64_t, 4> kRights{(1U << 13) - 1, (1U << 14) - 1, (1U << 15) - 1, (1U << 15) - 1};
  constexpr unsigned kAskVersion = 1, kBeneath = 1;
  const long version = syscall(SYS_landlock_create_ruleset, nullptr, 0, kAskVersion);
  if (version < 1) return;
  const uint64_t rights = kRights[std::min<size_t>(static_cast<size_t>(version), kRights.size()) - 1];
  const long rules = syscall(SYS_landlock_create_ruleset, &rights, sizeof rights, 0);
  if (rules < 0) return;
  struct [[gnu::packed]] {
    uint64_t allowed;
    int32_t file;
  } const rule{kReadFile, file};
  syscall(SYS_landlock_add_rule, rules, kBeneath, &rule, 0);
  syscall(SYS_landlock_restrict_self, rules, 0);
  close(static_cast<int>(rules));
#else
  static_cast<void>(file);
#endif
}

#if defined(__x86_64__)
constexpr uint32_t kMachine = AUDIT_ARCH_X86_64;
#elif defined(__aarch64__)
constexpr uint32_t kMachine = AUDIT_ARCH_AARCH64;
#else
constexpr uint32_t kMachine = 0;
#endif

/// System calls that no importer can do harm with: they concern its own memory, time, signals and open files.
constexpr long kAllowed[] = {SYS_read,           SYS_write,           SYS_readv,
                             SYS_writev,         SYS_pread64,         SYS_lseek,
                             SYS_close,          SYS_fstat,           SYS_fadvise64,
                             SYS_mmap,           SYS_munmap,          SYS_mremap,
                             SYS_mprotect,       SYS_madvise,         SYS_brk,
                             SYS_futex,          SYS_sched_yield,     SYS_getpid,
                             SYS_gettid,         SYS_getrandom,       SYS_clock_gettime,
                             SYS_gettimeofday,   SYS_clock_nanosleep, SYS_nanosleep,
                             SYS_getrusage,      SYS_rt_sigaction,    SYS_rt_sigreturn,
                             SYS_rt_sigprocmask, SYS_restart_syscall, SYS_sched_getaffinity,
                             SYS_sysinfo,        SYS_uname,           SYS_exit,
                             SYS_exit_group,     SYS_membarrier};

constexpr uint32_t at(size_t offset) {
  return static_cast<uint32_t>(offset);
}

/// Refuses all system calls that are not listed, with ENOSYS. Those with further conditions: `openat` for
/// reading if the process may open files, `prlimit64` of itself, and `tgkill` of itself, for abort().
void restrictCalls(bool canOpen) {
  if (kMachine == 0) return;
  constexpr uint32_t kCall = at(offsetof(seccomp_data, nr));
  const auto argument = [](size_t i) { return at(offsetof(seccomp_data, args) + i * sizeof(uint64_t)); };
  const uint32_t refuse = SECCOMP_RET_ERRNO | ENOSYS;
  std::vector<sock_filter> program{BPF_STMT(BPF_LD | BPF_W | BPF_ABS, at(offsetof(seccomp_data, arch))),
                                   BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, kMachine, 1, 0),
                                   BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_KILL_PROCESS),
                                   BPF_STMT(BPF_LD | BPF_W | BPF_ABS, kCall)};
  const auto add = [&](std::initializer_list<sock_filter> steps) { program.insert(program.end(), steps); };
  const auto number = [](long call) { return static_cast<uint32_t>(call); };
  for (const long call : kAllowed)
    add({BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, number(call), 0, 1),
         BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW)});
  // Allows a call if the lower half of an argument, of which only some bits count, has a value.
  const auto addIf = [&](long call, size_t i, uint32_t bits, uint32_t value) {
    add({BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, number(call), 0, 5),
         BPF_STMT(BPF_LD | BPF_W | BPF_ABS, argument(i)), BPF_STMT(BPF_ALU | BPF_AND | BPF_K, bits),
         BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, value, 0, 1), BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW),
         BPF_STMT(BPF_RET | BPF_K, refuse)});
  };
  if (canOpen) addIf(SYS_openat, 2, O_ACCMODE | O_CREAT | O_TRUNC, O_RDONLY);
  const uint32_t ofOpenFile = canOpen ? 0 : AT_EMPTY_PATH;
  addIf(SYS_newfstatat, 3, ofOpenFile, ofOpenFile);
  addIf(SYS_prlimit64, 0, UINT32_MAX, 0);
  addIf(SYS_tgkill, 0, UINT32_MAX, static_cast<uint32_t>(getpid()));
  add({BPF_STMT(BPF_RET | BPF_K, refuse)});
  const sock_fprog filter{static_cast<unsigned short>(program.size()), program.data()};
  prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &filter);
}

}  // namespace

void confine(int file, const Confinement& limits) {
  constexpr rlim_t kMostFiles = 16;
  limitMemory(limits.memoryBytes);
  const rlimit time{limits.seconds, RLIM_INFINITY};
  setrlimit(RLIMIT_CPU, &time);
  limit(RLIMIT_CORE, 0);
  limit(RLIMIT_FSIZE, 0);
  limit(RLIMIT_NOFILE, kMostFiles);
  limit(RLIMIT_NPROC, 0);
  if (prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0) return;  // Neither of the following works without.
  restrictFiles(file);
  restrictCalls(limits.canOpen);
}

}  // namespace raymap
