// .obj files.
#include "fuzz/scene_file.hpp"
#include "workbench/formats/read_obj.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  scene_file::check(data, size, workbench::read_obj);
  return 0;
}
