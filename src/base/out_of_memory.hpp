// Failed allocations become errors at the public API.
#pragma once

#include <new>
#include <stdexcept>
#include <utility>

#include <kerf/error.hpp>

namespace kerf {

/// Calls `work` and returns what it returns. A `std::bad_alloc` becomes `Error::out_of_memory`, and so does
/// what a vector says to more elements than can be addressed.
template <class Work>
decltype(auto) report_out_of_memory(Work&& work) {
  try {
    return std::forward<Work>(work)();
  } catch (const std::bad_alloc&) {
    throw Error(Error::out_of_memory, "not enough memory");
  } catch (const std::length_error&) {
    throw Error(Error::out_of_memory, "not enough memory");
  }
}

}  // namespace kerf
