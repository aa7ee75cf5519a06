// kerf: split bounding volume hierarchies over triangle meshes. Include this and nothing else.
#pragma once

#include <kerf/build.hpp>
#include <kerf/bvh.hpp>
#include <kerf/error.hpp>
#include <kerf/mesh.hpp>
#include <kerf/ray.hpp>
#include <kerf/vec.hpp>
