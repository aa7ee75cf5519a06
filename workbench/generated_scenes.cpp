#include "workbench/generated_scenes.hpp"

#include "workbench/generate/generate.hpp"

namespace workbench {
namespace {

constexpr GeneratedScene scenes[] = {
    {"terrain", "a mountain valley, evenly tessellated: splits must not hurt", 204800, generate_terrain},
    {"sticks", "random long thin triangles in a ball", 60000, generate_sticks},
};

}  // namespace

std::span<const GeneratedScene> generated_scenes() {
  return scenes;
}

const GeneratedScene* find_generated_scene(std::string_view name) {
  for (const GeneratedScene& scene : scenes) {
    if (scene.name == name) return &scene;
  }
  return nullptr;
}

}  // namespace workbench
