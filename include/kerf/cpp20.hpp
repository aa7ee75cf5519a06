// Every other header of kerf includes this one first. A compiler of older C++ so says one thing, what to do,
// and not hundreds: the rest of a header is for `KERF_HAS_CPP20` alone.
#pragma once

#if __cplusplus > 201703L || (defined(_MSVC_LANG) && _MSVC_LANG > 201703L)
#define KERF_HAS_CPP20 1
#else
#error "kerf needs C++20: compile with -std=c++20, or write set(CMAKE_CXX_STANDARD 20) in CMakeLists.txt"
#endif
