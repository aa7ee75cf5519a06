// Errors with a sentence made from values.
#pragma once

#include <kerf/error.hpp>

namespace kerf {

/// Throws an `Error` with this code. Its sentence is made from `format` and the values behind it as
/// `std::printf` makes text; what is longer than an `Error` can hold is cut off. Needs no memory.
[[noreturn]] __attribute__((format(printf, 2, 3))) void raise(Error::Code code, const char* format, ...);

}  // namespace kerf
