// .ply files.
#include "fuzz/scene_file.hpp"
#include "workbench/formats/read_ply.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  scene_file::check(data, size, workbench::read_ply);
  return 0;
}
