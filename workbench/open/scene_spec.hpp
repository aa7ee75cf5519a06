// What a user writes to name a scene.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace workbench {

/// The parts of `NAME_OR_FILE[:key=value,...]`.
struct SceneSpec {
  std::string source;            ///< a file, or the name of a generated scene
  double rotate = 0.0;           ///< degrees, about z, then y, then x
  std::optional<double> detail;  ///< factor on a generated scene's number of triangles
};

/// The options are what follows the last colon, if that can be options: names of files may contain colons.
/// Throws `kerf::Error::invalid_argument` with a line that names the wrong key or value.
SceneSpec parse_scene_spec(std::string_view spec);

}  // namespace workbench
