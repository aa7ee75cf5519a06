// Scenes become files: each hierarchy and each scene in them once, however often it stands somewhere.
#include <cstring>
#include <memory>
#include <unordered_map>
#include <utility>
#include <vector>

#include <kerf/scene.hpp>

#include "base/out_of_memory.hpp"
#include "files/file_image.hpp"
#include "files/name_file.hpp"
#include "files/scene_header.hpp"
#include "files/system_file.hpp"
#include "scene/places.hpp"

namespace kerf {
namespace {

// Numbers what stands in a scene, the inner before the outer, in the order in which it is met.
class SceneImage {
 public:
  explicit SceneImage(const SceneStructure& scene) {
    add(scene);
    header_ = make_header(tables_);
    const SceneLayout layout(header_);
    pieces_.push_back(std::as_bytes(std::span(&header_, 1)));
    for (const auto& piece : tables_.pieces()) pieces_.push_back(piece);
    pieces_.push_back(zeros(layout.objects_at - layout.tables_at - layout.tables_bytes));
    for (const auto& object : objects_)
      pieces_.insert(pieces_.end(), object->pieces().begin(), object->pieces().end());
  }

  std::span<const std::span<const std::byte>> pieces() const { return pieces_; }
  std::uint64_t bytes() const { return header_.file_bytes; }

 private:
  std::uint32_t number_of(const Structure& object) {
    const auto [found, is_new] = numbers_.try_emplace(&object, static_cast<std::uint32_t>(objects_.size()));
    if (is_new) {
      objects_.push_back(std::make_unique<FileImage>(object));
      tables_.object_bytes.push_back(objects_.back()->bytes());
    }
    return found->second;
  }

  std::uint32_t number_of(const SceneStructure& scene) {
    const auto found = numbers_.find(&scene);
    return found != numbers_.end() ? found->second : add(scene);
  }

  std::uint32_t add(const SceneStructure& scene) {
    std::vector<FileInstance> own;
    own.reserve(scene.instances.size());
    for (const Instance& instance : scene.instances) {
      FileInstance saved{};
      std::memcpy(saved.transform, instance.transform.rows, sizeof saved.transform);
      saved.what = instance.scene.instances().empty()
                       ? number_of(Structure::of(instance.object))
                       : number_of(SceneStructure::of(instance.scene)) | FileInstance::scene_bit;
      saved.mask = instance.mask.bits;
      saved.number = instance.number;
      own.push_back(saved);
    }
    const auto number = static_cast<std::uint32_t>(tables_.instance_counts.size());
    tables_.instance_counts.push_back(own.size());
    tables_.instances.insert(tables_.instances.end(), own.begin(), own.end());
    numbers_.emplace(&scene, number);
    return number;
  }

  SceneFileHeader header_;
  SceneTables tables_;
  std::vector<std::unique_ptr<FileImage>> objects_;
  std::unordered_map<const void*, std::uint32_t> numbers_;  // of hierarchies and of scenes
  std::vector<std::span<const std::byte>> pieces_;
};

}  // namespace

void Scene::save(const FileName& name) const {
  naming_file(
      name, [&](const std::filesystem::path& path) { replace_file(path, SceneImage(*structure_).pieces()); });
}

std::vector<std::byte> Scene::save() const {
  return report_out_of_memory([&] {
    const SceneImage image(*structure_);
    return joined(image.pieces(), image.bytes());
  });
}

}  // namespace kerf
