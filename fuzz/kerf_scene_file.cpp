// The loader of .kerf files of scenes. As for those of hierarchies, checksums are corrected first, also those
// of the hierarchies inside. A file that loads must answer every kind of query.
#include "fuzz/forged_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::vector<std::uint8_t> file(data, data + size);
  const std::span<std::byte> bytes = std::as_writable_bytes(std::span(file));
  try {
    (void)kerf::Scene::load(bytes);
  } catch (const kerf::Error&) {  // of almost every file that is not signed
  }
  if (kerf::holds_scene(bytes)) {
    forged::sign_scene(bytes);
  } else {
    forged::sign(bytes);
  }
  try {
    const kerf::Scene scene = kerf::Scene::load(bytes);
    constexpr std::uint32_t max_instances = 1000;  // more take long, and show nothing new
    if (scene.instance_count() <= max_instances) forged::query(scene);
  } catch (const kerf::Error&) {
  }
  return 0;
}
