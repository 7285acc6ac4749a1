#include "io/3mf/zip_parts.h"

#include <cctype>
#include <vector>

#include "base/text.h"

namespace raymap {

namespace {

/// Returns the key of a part's name: in lower case and without the slash that absolute names begin with.
std::string keyOf(std::string_view name) {
  if (name.starts_with('/')) name.remove_prefix(1);
  std::string key(name);
  for (char& c : key) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return key;
}

}  // namespace

ZipParts::ZipParts(const MeshFile& file) : file_(file), zip_(file.bytes, file.path) {
  for (size_t i = 0; i < zip_.entries().size(); ++i) {
    const std::string& name = zip_.entries()[i].name;
    if (!indices_.emplace(keyOf(name), i).second)
      file.fail("it has the part " + excerpt(name, kLongestName) + " twice");
  }
}

bool ZipParts::has(std::string_view name) const {
  return indices_.contains(keyOf(name));
}

void ZipParts::read(std::string_view name, const std::function<void(std::string_view piece)>& take) {
  const auto found = indices_.find(keyOf(name));
  if (found == indices_.end()) file_.fail("it has no part " + excerpt(name, kLongestName));
  ZipContent content = zip_.open(found->second);

  // Meshes deflate to a tenth, and at best to a fiftieth.
  constexpr uint64_t kMostRatio = 200, kSlack = 1 << 20;
  const uint64_t most = kSlack + kMostRatio * file_.bytes.size();
  std::vector<char> buffer(size_t{1} << 16);
  while (const size_t count = content.read(buffer.data(), buffer.size())) {
    inflated_ += count;
    if (inflated_ > most)
      file_.fail("its part " + excerpt(name, kLongestName) + " inflates to more than " +
                 std::to_string(kMostRatio) + " times the size of the file, as no model does");
    take({buffer.data(), count});
  }
}

}  // namespace raymap
