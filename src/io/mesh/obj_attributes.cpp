#include "io/mesh/obj_attributes.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <system_error>

namespace raymap {

namespace {

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kBlanks = " \t";
  const size_t begin = text.find_first_not_of(kBlanks);
  return begin == text.npos ? "" : text.substr(begin, text.find_last_not_of(kBlanks) + 1 - begin);
}

bool isAnySet(const std::vector<uint32_t>& values) {
  return std::ranges::any_of(values, [](uint32_t value) { return value != kNoAttribute; });
}

}  // namespace

/// Returns the numbers on the rest of a line, up to the first word that is none.
std::vector<float> ObjAttributes::numbers(TextScanner& text) {
  std::vector<float> found;
  while (text.moreOnLine()) {
    const std::string_view word = text.word();
    float value = 0.0F;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc() || end != word.data() + word.size() || !std::isfinite(value)) break;
    found.push_back(value);
  }
  return found;
}

void ObjAttributes::read(std::string_view keyword, TextScanner& text) {
  if (keyword == "vt") {
    const std::vector<float> uv = numbers(text);
    malformed_ += uv.empty() ? 1 : 0;
    found_.uvs.values.emplace_back(uv.empty() ? 0.0F : uv[0], uv.size() < 2 ? 0.0F : uv[1]);
    return;
  }
  if (keyword != "o" && keyword != "g" && keyword != "usemtl" && keyword != "mtllib") return;
  const std::string name(trimmed(text.restOfLine()));
  if (keyword == "mtllib") return addLibraries(name);
  if (keyword == "usemtl") {
    const auto number = uint32_t(found_.materials.size());
    material_ = name.empty() ? kNoAttribute : materials_.try_emplace(name, number).first->second;
    if (material_ == number) found_.materials.push_back(name);
  } else {
    (keyword == "o" ? part_.object : part_.group) = name;
  }
  isNewRun_ = true;
}

void ObjAttributes::startRun() {
  const auto number = uint32_t(found_.parts.size());
  const uint32_t part = part_ == MeshPart{}
                            ? kNoAttribute
                            : parts_.try_emplace({part_.object, part_.group}, number).first->second;
  if (part == number) found_.parts.push_back(part_);
  runs_.push_back({uvOfCorner_.size(), part, material_});
  isNewRun_ = false;
}

void ObjAttributes::addLibraries(std::string_view names) {
  std::error_code error;
  if (names.empty()) return;
  if (std::filesystem::exists(file_.folder / names, error)) {
    found_.libraries.push_back(file_.folder / names);  // Its name may have blanks.
    return;
  }
  for (; !names.empty(); names = trimmed(names)) {
    const std::string_view name = names.substr(0, names.find_first_of(" \t"));
    found_.libraries.push_back(file_.folder / name);
    names.remove_prefix(name.size());
  }
}

void ObjAttributes::readColour(TextScanner& text, size_t vertex) {
  if (!text.moreOnLine()) return;
  const std::vector<float> colour = numbers(text);
  if (colour.size() != 3) return;  // A weight, or none that is known.
  colourOfVertex_.resize(vertex + 1, kNoAttribute);
  colourOfVertex_[vertex] = uint32_t(found_.colours.values.size());
  found_.colours.values.emplace_back(colour[0], colour[1], colour[2], 1.0F);
}

void ObjAttributes::addCorner(std::string_view rest) {
  if (isNewRun_) startRun();
  int64_t index = 0;
  uint32_t uv = kNoAttribute;
  if (rest.starts_with('/') && !rest.starts_with("//")) {
    const char* const last = rest.data() + rest.size();
    const auto [end, error] = std::from_chars(rest.data() + 1, last, index);
    if (index < 0) index += int64_t(found_.uvs.values.size()) + 1;
    const bool isIndex =
        error == std::errc() && (end == last || *end == '/') && index > 0 && index < kNoAttribute;
    uv = isIndex ? uint32_t(index - 1) : kNoAttribute;
    malformed_ += isIndex ? 0 : 1;
  }
  uvOfCorner_.push_back(uv);
}

void ObjAttributes::finishUvs(const Polygons& polygons) {
  for (uint32_t& uv : uvOfCorner_)
    if (uv != kNoAttribute && uv >= found_.uvs.values.size()) uv = kNoAttribute, ++malformed_;
  if (malformed_ > 0)
    file_.warnThat(counted(malformed_, "texture coordinate") + " missing or malformed, and left out");
  if (!isAnySet(uvOfCorner_)) return found_.uvs.values.clear();
  for (const glm::uvec3& t : polygons.cornerNumbers)
    found_.uvs.corners.emplace_back(uvOfCorner_[t.x], uvOfCorner_[t.y], uvOfCorner_[t.z]);
}

void ObjAttributes::finishColours(const Polygons& polygons) {
  if (colourOfVertex_.empty()) return;
  const auto at = [&](uint32_t vertex) {
    return vertex < colourOfVertex_.size() ? colourOfVertex_[vertex] : kNoAttribute;
  };
  for (const glm::uvec3& t : polygons.triangles)
    found_.colours.corners.emplace_back(at(t.x), at(t.y), at(t.z));
}

void ObjAttributes::finish(const Polygons& polygons) {
  finishUvs(polygons);
  finishColours(polygons);
  auto run = runs_.begin();
  for (const glm::uvec3& t : polygons.cornerNumbers) {
    while (run != runs_.end() && run->corner <= t.x) ++run;
    found_.partOf.push_back(run == runs_.begin() ? kNoAttribute : run[-1].part);
    found_.materialOf.push_back(run == runs_.begin() ? kNoAttribute : run[-1].material);
  }
  if (!isAnySet(found_.partOf)) found_.partOf.clear();
  if (!isAnySet(found_.materialOf)) found_.materialOf.clear();
  *file_.attributes = std::move(found_);
}

}  // namespace raymap
