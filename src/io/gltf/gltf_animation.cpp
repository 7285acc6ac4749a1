// glTF 2.0, §3.11: animations.

#include "io/gltf/gltf_animation.h"

#include <raymap/error.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>

#include "base/text.h"

namespace raymap {

namespace {

using Json = GltfDocument::Json;
using Track = AnimatedMesh::Track;

std::string stringOf(const Json& json, const char* key, const char* missing) {
  const auto found = json.find(key);
  return found != json.end() && found->is_string() ? found->get<std::string>() : missing;
}

class TrackReader {
 public:
  TrackReader(const MeshFile& file, const GltfScene& scene, uint64_t animation)
      : file_(file), document_(scene.document()), animation_(document_.element("animations", animation)) {
    what_ = "animations[" + std::to_string(animation) + "]";
  }

  std::vector<Track> read(std::span<const int> places, std::span<const IndexRange> morphs) {
    std::vector<Track> tracks;
    const Json& channels = list("channels");
    for (const Json& channel : channels) {
      const Json& target = object(channel, "target");
      // A channel without a node, or for a node outside the scene, has no visible effect.
      if (!target.contains("node")) continue;
      const uint64_t node = document_.number(target, "node");
      document_.element("nodes", node);
      const std::optional<Track::Target> path = targetOf(target);
      if (!path || places[node] < 0) continue;
      const uint64_t sampler = document_.number(channel, "sampler");
      if (*path == Track::Target::Weight)
        readWeights(sampler, morphs[static_cast<size_t>(places[node])], tracks);
      else
        tracks.push_back(readTrack(sampler, *path, static_cast<uint32_t>(places[node]), 1));
    }
    if (others_ > 0)
      file_.warnThat(counted(others_, "channel") +
                     " of extensions, or of morphs that the node lacks, ignored");
    return tracks;
  }

 private:
  const Json& list(const char* key) const {
    const auto found = animation_.find(key);
    if (found == animation_.end() || !found->is_array()) file_.fail(what_ + " has no list of " + key);
    return *found;
  }

  const Json& object(const Json& parent, const char* key) const {
    if (!parent.is_object() || !parent.contains(key) || !parent[key].is_object())
      file_.fail(what_ + ": a channel has no " + key);
    return parent[key];
  }

  std::optional<Track::Target> targetOf(const Json& target) {
    const std::string path = stringOf(target, "path", "");
    if (path == "translation") return Track::Target::Translation;
    if (path == "rotation") return Track::Target::Rotation;
    if (path == "scale") return Track::Target::Scale;
    if (path == "weights") return Track::Target::Weight;
    ++others_;
    return std::nullopt;
  }

  Track::Interpolation interpolationOf(const Json& sampler, const std::string& what) const {
    const std::string name = stringOf(sampler, "interpolation", "LINEAR");
    if (name == "STEP") return Track::Interpolation::Step;
    if (name == "LINEAR") return Track::Interpolation::Linear;
    if (name != "CUBICSPLINE") file_.fail(what + " has unknown interpolation " + shortText(name));
    return Track::Interpolation::CubicSpline;
  }

  /// Appends a track for each morph. The file holds the numbers of all of them for one time after the other.
  void readWeights(uint64_t sampler, IndexRange morphs, std::vector<Track>& tracks) {
    if (morphs.count == 0) {
      ++others_;
      return;
    }
    const Track all = readTrack(sampler, Track::Target::Weight, morphs.first, morphs.count);
    for (uint32_t m = 0; m < morphs.count; ++m) {
      Track& track = tracks.emplace_back(Track{.node = morphs.first + m,
                                               .target = all.target,
                                               .interpolation = all.interpolation,
                                               .times = all.times});
      for (size_t i = m; i < all.values.size(); i += morphs.count) track.values.push_back(all.values[i]);
    }
  }

  /// Reads a track with `count` numbers or vectors for each time.
  Track readTrack(uint64_t sampler, Track::Target target, uint32_t place, size_t count) {
    const Json& samplers = list("samplers");
    const std::string what = what_ + ".samplers[" + std::to_string(sampler) + "]";
    if (sampler >= samplers.size() || !samplers[sampler].is_object()) file_.fail(what + " does not exist");
    const Json& json = samplers[sampler];
    Track track{.node = place, .target = target, .interpolation = interpolationOf(json, what)};
    const uint64_t input = document_.number(json, "input"), output = document_.number(json, "output");
    // Samplers may share accessors, so a small file could request any amount of memory.
    bytes_ += document_.accessorCount(input) * sizeof(double) +
              2 * document_.accessorCount(output) * sizeof(glm::dvec4);
    checkMemory(file_, bytes_);
    track.times = document_.reals(input, "SCALAR", 1);
    readValues(track, output);
    check(track, count, what);
    return track;
  }

  void readValues(Track& track, uint64_t accessor) const {
    const bool isWeight = track.target == Track::Target::Weight;
    const uint64_t components = isWeight ? 1 : track.target == Track::Target::Rotation ? 4 : 3;
    const char* const type = components == 1 ? "SCALAR" : components == 4 ? "VEC4" : "VEC3";
    const std::vector<double> numbers = document_.reals(accessor, type, components);
    track.values.resize(numbers.size() / components, glm::dvec4(0.0));
    for (size_t i = 0; i < numbers.size(); ++i)
      track.values[i / components][static_cast<int>(i % components)] = numbers[i];
  }

  void check(const Track& track, size_t count, const std::string& what) const {
    const size_t each = count * (track.interpolation == Track::Interpolation::CubicSpline ? 3 : 1);
    if (track.times.empty()) file_.fail(what + " has no times; a track needs a key");
    if (track.values.size() != each * track.times.size())
      file_.fail(what + " has " + counted(track.values.size(), "value") + " for " +
                 counted(track.times.size(), "time"));
    for (size_t i = 0; i < track.times.size(); ++i)
      if (!std::isfinite(track.times[i]) || (i > 0 && track.times[i] < track.times[i - 1]))
        file_.fail(what + ": time " + std::to_string(i) + " is " + numberText(track.times[i]) +
                   "; times must be finite and ascend");
    for (size_t i = 0; i < track.values.size(); ++i)
      for (int c = 0; c < 4; ++c)
        if (const double number = track.values[i][c]; !std::isfinite(number))
          file_.fail(what + ": value " + std::to_string(i) + " holds " + numberText(number) +
                     "; values must be finite");
  }

  const MeshFile& file_;
  const GltfDocument& document_;
  const Json& animation_;
  std::string what_;
  uint64_t others_ = 0;
  uint64_t bytes_ = 0;
};

}  // namespace

std::vector<Track> readTracks(const MeshFile& file, const GltfScene& scene, uint64_t animation,
                              std::span<const int> places, std::span<const IndexRange> morphs) {
  const uint64_t count = scene.document().size("animations");
  if (count == 0 && animation == 0) {
    file.warnThat("it has no animation: the mesh stands still");
    return {};
  }
  if (animation >= count)
    throw Error(ErrorCode::Usage, file.path.string() + ": there is no animation " +
                                      std::to_string(animation) + ": it has " + counted(count, "animation"));
  return TrackReader(file, scene, animation).read(places, morphs);
}

std::vector<std::string> animationNames(const GltfDocument& document) {
  std::vector<std::string> names;
  for (uint64_t a = 0; a < document.size("animations"); ++a)
    names.push_back(stringOf(document.element("animations", a), "name", std::to_string(a).c_str()));
  return names;
}

uint64_t animationNamed(const MeshFile& file, const GltfDocument& document, const std::string& clip) {
  const uint64_t count = document.size("animations");
  if (count == 0) file.fail("it has no animation; read it as a mesh at rest");
  std::string all;
  for (uint64_t a = 0; a < count; ++a) {
    const std::string name = stringOf(document.element("animations", a), "name", "");
    if (!clip.empty() && name == clip) return a;
    all += (a == 0 ? "" : ", ") + std::to_string(a) + (name.empty() ? "" : " " + excerpt(name, kLongestName));
  }
  if (clip.empty()) {
    if (count > 1) file.warnThat("it has the animations " + all + "; the first is taken");
    return 0;
  }
  uint64_t index = count;
  const auto [end, error] = std::from_chars(clip.data(), clip.data() + clip.size(), index);
  if (error == std::errc() && end == clip.data() + clip.size() && index < count) return index;
  throw Error(ErrorCode::Usage, file.path.string() + ": there is no animation '" + clip + "'; it has " + all);
}

}  // namespace raymap
