#include "workbench/formats/gltf/extensions.hpp"

#include <algorithm>
#include <iterator>

namespace workbench::gltf {
namespace {

constexpr std::string_view of_triangles[] = {"EXT_mesh_gpu_instancing",    "EXT_meshopt_compression",
                                             "KHR_draco_mesh_compression", "KHR_mesh_quantization",
                                             "KHR_meshopt_compression",    "KHR_node_visibility"};

/// Materials, pictures, lights, animations and data about data.
constexpr std::string_view of_other_things[] = {"CESIUM_primitive_outline", "EXT_feature_metadata",
                                                "EXT_instance_features",    "EXT_mesh_features",
                                                "EXT_structural_metadata",  "KHR_animation_pointer",
                                                "KHR_node_selectability",   "KHR_technique_webgl",
                                                "KHR_techniques_webgl",     "KHR_xmp",
                                                "KHR_xmp_json_ld",          "MSFT_lod"};
constexpr std::string_view prefixes_of_other_things[] = {
    "ADOBE_materials_", "EXT_lights_",  "EXT_materials_", "EXT_texture_", "KHR_lights_",
    "KHR_materials_",   "KHR_texture_", "MSFT_packing_",  "MSFT_texture_"};

}  // namespace

bool is_understood(std::string_view extension) {
  const auto has = [&](const auto& names) {
    return std::find(std::begin(names), std::end(names), extension) != std::end(names);
  };
  return has(of_triangles) || has(of_other_things) ||
         std::any_of(std::begin(prefixes_of_other_things), std::end(prefixes_of_other_things),
                     [&](std::string_view prefix) { return extension.starts_with(prefix); });
}

}  // namespace workbench::gltf
