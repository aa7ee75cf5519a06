#include "workbench/scene.hpp"

namespace workbench {

Scene load_scene(std::string_view spec) {
  Scene scene{.name = std::string(spec), .vertices = {}, .triangles = {}, .viewpoints = {}};
  return scene;
}

}  // namespace workbench
