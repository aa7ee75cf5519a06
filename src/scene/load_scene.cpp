// Scenes come back from files: their hierarchies as they lie there, their top levels built anew.
#include <algorithm>
#include <array>
#include <cstring>
#include <utility>
#include <vector>

#include <kerf/scene.hpp>

#include "base/aligned_array.hpp"
#include "base/out_of_memory.hpp"
#include "base/parallel.hpp"
#include "base/raise.hpp"
#include "files/file_header.hpp"
#include "files/name_file.hpp"
#include "files/read_image.hpp"
#include "files/scene_header.hpp"
#include "files/system_file.hpp"
#include "scene/places.hpp"

namespace kerf {
namespace {

// Checks what the first bytes tell, so that memory can be taken for the rest.
void check_header(std::span<const std::byte> bytes, std::uint64_t file_bytes) {
  if (holds_scene(bytes)) {
    read_scene_header(bytes, file_bytes);
  } else {
    read_header(bytes, file_bytes);
  }
}
void check_header(const InputFile& file) {
  std::array<std::byte, sizeof(FileHeader)> bytes;
  const auto count = static_cast<std::size_t>(std::min<std::uint64_t>(file.size(), bytes.size()));
  file.read(std::span(bytes).first(count), 0);
  check_header(std::span(bytes).first(count), file.size());
}

// Adds to an error what it is about.
template <class Work>
auto naming(const char* what, std::size_t number, const Work& work) {
  try {
    return work();
  } catch (const Error& error) {
    if (error.code() == Error::out_of_memory) throw;
    raise(Error::bad_format, "%s %zu: %s", what, number, error.what());
  }
}

// The scene in a whole file at an address that is a multiple of 64, whose memory `owner` keeps. The file of a
// hierarchy is a scene of that alone.
Scene read_scene(std::span<const std::byte> image, const std::shared_ptr<const void>& owner,
                 OtherWidth other_width) {
  if (!holds_scene(image)) {
    const Instance alone{.object = Structure::share(read_image(image, owner, other_width))};
    return build(std::span(&alone, 1));
  }
  const SceneFileHeader header = read_scene_header(image, image.size());
  const SceneTables tables = read_tables(image, header);
  std::vector<Bvh> objects;
  objects.reserve(tables.object_bytes.size());
  std::size_t at = static_cast<std::size_t>(SceneLayout(header).objects_at);
  for (const std::uint64_t bytes : tables.object_bytes) {
    const auto file = image.subspan(at, static_cast<std::size_t>(bytes));
    at += file.size();
    objects.push_back(naming("hierarchy", objects.size(),
                             [&] { return Structure::share(read_image(file, owner, other_width)); }));
  }
  std::vector<Scene> scenes;
  scenes.reserve(tables.instance_counts.size());
  const FileInstance* saved = tables.instances.data();
  for (const std::uint64_t count : tables.instance_counts) {
    std::vector<Instance> instances(static_cast<std::size_t>(count));
    for (Instance& instance : instances) {
      if ((saved->what & FileInstance::scene_bit) != 0) {
        instance.scene = scenes[saved->what & ~FileInstance::scene_bit];
      } else {
        instance.object = objects[saved->what];
      }
      std::memcpy(instance.transform.rows, saved->transform, sizeof saved->transform);
      instance.mask = {saved->mask};
      instance.number = saved->number;
      ++saved;
    }
    scenes.push_back(naming("scene", scenes.size(), [&] { return build(instances); }));
  }
  return scenes.back();
}

}  // namespace

Scene Scene::load(const FileName& name) {
  return naming_file(name, [&](const std::filesystem::path& path) {
    const InputFile file(path);
    check_header(file);
    const AlignedArray<std::byte> image(static_cast<std::size_t>(file.size()));
    file.read({image.data(), image.size()}, 0);
    return read_scene({image.data(), image.size()}, image.owner(), OtherWidth::convert);
  });
}

Scene Scene::load(std::span<const std::byte> bytes) {
  return report_out_of_memory([&] {
    return isolated([&] {
      check_header(bytes.first(std::min(bytes.size(), sizeof(FileHeader))), bytes.size());
      const AlignedArray<std::byte> image(bytes.size());
      std::copy(bytes.begin(), bytes.end(), image.data());
      return read_scene({image.data(), image.size()}, image.owner(), OtherWidth::convert);
    });
  });
}

Scene Scene::map(const FileName& name) {
  return naming_file(name, [&](const std::filesystem::path& path) {
    const InputFile file(path);
    check_header(file);
    const std::shared_ptr<const std::byte> memory = file.map();
    const std::span image(memory.get(), static_cast<std::size_t>(file.size()));
    return read_scene(image, memory, OtherWidth::refuse);
  });
}

}  // namespace kerf
