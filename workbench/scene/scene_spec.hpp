// What a user writes to name a scene.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace workbench {

/// `NAME_OR_FILE[:key=value,...]`, taken apart.
struct SceneSpec {
  std::string source;            ///< a file, or the name of a generated scene
  double rotate = 0.0;           ///< degrees, about z, then y, then x
  std::optional<double> detail;  ///< factor on a generated scene's number of triangles
};

/// The options stand behind the last colon, unless what stands there cannot be options: file names may have
/// colons. Throws `kerf::Error::invalid_argument` with a line that names the key or value that is wrong.
SceneSpec parse_scene_spec(std::string_view spec);

}  // namespace workbench
