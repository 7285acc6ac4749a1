#include "io/import/companion.h"

#include <dlfcn.h>

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <iterator>
#include <string>
#include <vector>

namespace raymap {

namespace {

/// The file of the program or library that holds this code, as the dynamic loader names it; empty if it has
/// no name.
std::string ownFile() {
  Dl_info here{};
  const bool isKnown = dladdr(reinterpret_cast<const void*>(&ownFile), &here) != 0 && here.dli_fname;
  return isKnown ? here.dli_fname : "";
}

/// Returns the folders in which the dynamic loader looks for libraries of the program or library that holds
/// this code. Its run path is among them. Programs that link the static raymap::io have the folder of
/// `raymap-import` there, as src/io/CMakeLists.txt and raymap.pc ask.
std::vector<std::filesystem::path> loaderFolders() {
  std::vector<std::filesystem::path> folders;
#ifdef __GLIBC__
  void* own = dlopen(ownFile().c_str(), RTLD_LAZY | RTLD_NOLOAD);
  if (!own) own = dlopen(nullptr, RTLD_LAZY);  // A program has no name for dlopen.
  Dl_serinfo size{};
  if (own && dlinfo(own, RTLD_DI_SERINFOSIZE, &size) == 0) {
    std::vector<std::max_align_t> memory(size.dls_size / sizeof(std::max_align_t) + 1);
    auto* info = reinterpret_cast<Dl_serinfo*>(memory.data());
    if (dlinfo(own, RTLD_DI_SERINFOSIZE, info) == 0 && dlinfo(own, RTLD_DI_SERINFO, info) == 0)
      for (unsigned i = 0; i < info->dls_cnt; ++i) folders.emplace_back(info->dls_serpath[i].dls_name);
  }
  if (own) dlclose(own);
#endif
  return folders;
}

}  // namespace

std::optional<std::filesystem::path> findCompanion(const char* name) {
  std::error_code error;
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", error).parent_path();
  const std::filesystem::path own = std::filesystem::absolute(ownFile(), error).parent_path();
  std::vector<std::filesystem::path> folders{program, own, program / RAYMAP_LIBEXEC_FROM_PROGRAMS,
                                             own / RAYMAP_LIBEXEC_FROM_LIBRARIES,
                                             program / "../raymap"};  // The package of a wheel.
  std::ranges::copy(loaderFolders(), std::back_inserter(folders));
  folders.emplace_back(RAYMAP_LIBEXEC);
  if (const char* importer = std::getenv("RAYMAP_IMPORT"))
    folders.emplace_back(std::filesystem::path(importer).parent_path());
  for (const std::filesystem::path& folder : folders)
    if (std::filesystem::exists(folder / name, error)) return folder / name;
  return std::nullopt;
}

}  // namespace raymap
