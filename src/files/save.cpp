#include <cstddef>
#include <span>
#include <vector>

#include <kerf/bvh.hpp>

#include "base/out_of_memory.hpp"
#include "files/file_image.hpp"
#include "files/name_file.hpp"
#include "files/system_file.hpp"
#include "structure.hpp"

namespace kerf {

void Bvh::save(const FileName& name) const {
  naming_file(
      name, [&](const std::filesystem::path& path) { replace_file(path, FileImage(*structure_).pieces()); });
}

std::vector<std::byte> Bvh::save() const {
  return report_out_of_memory([&] {
    const FileImage image(*structure_);
    return joined(image.pieces(), image.bytes());
  });
}

}  // namespace kerf
