// kerf: split bounding volume hierarchies over triangle meshes. Programs that build and query include this
// header alone. <kerf/inspect.hpp> and <kerf/layout.hpp> are for tools and for traversals of one's own.
#pragma once

#include <kerf/cpp20.hpp>
#ifdef KERF_HAS_CPP20
#include <kerf/build.hpp>
#include <kerf/bvh.hpp>
#include <kerf/convert.hpp>
#include <kerf/error.hpp>
#include <kerf/mesh.hpp>
#include <kerf/ray.hpp>
#include <kerf/refit.hpp>
#include <kerf/vec.hpp>
#include <kerf/version.hpp>
#endif
