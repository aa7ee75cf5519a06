// kerf: split bounding volume hierarchies over triangle meshes. Programs that build and query include this
// header alone. <kerf/inspect.hpp> and <kerf/layout.hpp> are for tools and for traversals of one's own.
#pragma once

#include <kerf/build.hpp>
#include <kerf/bvh.hpp>
#include <kerf/convert.hpp>
#include <kerf/error.hpp>
#include <kerf/mesh.hpp>
#include <kerf/ray.hpp>
#include <kerf/vec.hpp>
