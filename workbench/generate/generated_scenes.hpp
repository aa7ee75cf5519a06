// The list of the scenes that need no file.
#pragma once

#include <cstddef>
#include <span>
#include <string_view>

#include "workbench/scene/scene.hpp"

namespace workbench {

struct GeneratedScene {
  std::string_view name;
  std::string_view description;      ///< one line
  std::size_t default_triangles;     ///< at detail 1
  Scene (*generate)(double detail);  ///< about `detail` times as many triangles; the same on every machine
};

/// All generated scenes, in the order in which lists show them.
std::span<const GeneratedScene> generated_scenes();

/// The generated scene of that name, or null.
const GeneratedScene* find_generated_scene(std::string_view name);

}  // namespace workbench
