// kerf: split bounding volume hierarchies over triangle meshes. Programs that build and query include this
// header alone. <kerf/inspect.hpp> and <kerf/layout.hpp> are for tools and for traversals of one's own.
#pragma once

#if __cplusplus <= 201703L && (!defined(_MSVC_LANG) || _MSVC_LANG <= 201703L)
#error "kerf needs C++20: compile with -std=c++20, or write set(CMAKE_CXX_STANDARD 20) in CMakeLists.txt"
#else
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
