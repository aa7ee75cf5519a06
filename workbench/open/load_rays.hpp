// Rays from files.
#pragma once

#include <filesystem>
#include <vector>

#include <kerf/ray.hpp>

namespace workbench {

/// The rays of a text file, gzipped or not: on each line six numbers, origin and direction, or seven with
/// t_max, or eight with t_min before it; blanks or commas between them. What follows a `#` is a comment. `-`
/// is standard input. Throws `kerf::Error` with one line that names the file, the line and what is wrong:
/// `io`, or `bad_format`.
std::vector<kerf::Ray> load_rays(const std::filesystem::path& file);

}  // namespace workbench
