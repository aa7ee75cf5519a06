// Two links whose boxes meet, one of each hierarchy.
#pragma once

#include <kerf/layout.hpp>
#include <kerf/vec.hpp>

namespace kerf {

/// What is left to search for triangles that touch. The box of the second is moved.
struct BoxPair {
  ChildLink first, second;
  Box3f first_box, second_box;
};

}  // namespace kerf
