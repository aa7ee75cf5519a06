// The generators, one per file. Each makes about `detail` times its default number of triangles, the same on
// every machine, with the y axis up and lengths in metres.
#pragma once

#include "workbench/scene/scene.hpp"

namespace workbench {

Scene generate_atrium(double detail);
Scene generate_conference(double detail);
Scene generate_hairball(double detail);
Scene generate_city(double detail);
Scene generate_terrain(double detail);
Scene generate_sticks(double detail);

}  // namespace workbench
