// Errors name the file that they are about.
#pragma once

#include <filesystem>

#include "base/out_of_memory.hpp"
#include "base/parallel.hpp"
#include "base/raise.hpp"
#include "files/paths.hpp"

namespace kerf {

/// Calls `work` and returns what it returns. The sentence of an `Error` that it throws gets the name of the
/// file in front.
template <class Work>
decltype(auto) naming_file(const std::filesystem::path& path, const Work& work) {
  try {
    return report_out_of_memory([&] { return isolated(work); });
  } catch (const Error& error) {
    if (error.code() == Error::io) throw;  // these have the name already
    raise(error.code(), "%s: %s", text_of(path).c_str(), error.what());
  }
}

}  // namespace kerf
