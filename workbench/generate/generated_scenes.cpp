#include "workbench/generate/generated_scenes.hpp"

#include "workbench/generate/generate.hpp"

namespace workbench {
namespace {

constexpr GeneratedScene scenes[] = {
    {"atrium", "a court with arcades: long plain walls beside fine columns, arches and ornaments", 277274,
     generate_atrium},
    {"conference", "a meeting room: thin chair legs, table edges, slats and trusses along no axis", 134132,
     generate_conference},
    {"hairball", "long thin strands that curl out of a ball", 259200, generate_hairball},
    {"city", "streets of boxes on rolling ground, cables from roof to roof", 293520, generate_city},
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
