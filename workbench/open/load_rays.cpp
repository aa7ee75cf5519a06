#include "workbench/open/load_rays.hpp"

#include <array>
#include <cmath>
#include <cstddef>

#include "workbench/base/raise.hpp"
#include "workbench/formats/file_bytes.hpp"
#include "workbench/formats/numbers.hpp"
#include "workbench/formats/text.hpp"

namespace workbench {
namespace {

const char* skip_separators(const char* at, const char* end) {
  while (at != end && (is_blank(*at) || *at == ',')) ++at;
  return at;
}

}  // namespace

std::vector<kerf::Ray> load_rays(const std::filesystem::path& file) {
  const FileBytes bytes(file == "-" ? "/dev/stdin" : file);
  const std::string_view text = without_byte_order_mark(bytes.view());
  const char* const end = text.data() + text.size();
  std::vector<kerf::Ray> rays;
  std::size_t line = 1;
  for (const char* at = text.data(); at != end; ++line) {
    const char* const line_end = find_line_end(at, end);
    std::array<float, 8> numbers;
    std::size_t count = 0;
    for (at = skip_separators(at, line_end); at != line_end && *at != '#';
         at = skip_separators(at, line_end)) {
      const Real number = parse_real(at, line_end);
      const bool ends =
          number.end == line_end ||
          (number.end != nullptr && (is_blank(*number.end) || *number.end == ',' || *number.end == '#'));
      if (!ends)
        raise(kerf::Error::bad_format, file, "line {}: '{}' is no number", line,
              shown({at, static_cast<std::size_t>(skip_word(at, line_end) - at)}));
      if (std::isnan(number.nearest)) raise(kerf::Error::bad_format, file, "line {}: a number is nan", line);
      if (count == numbers.size())
        raise(kerf::Error::bad_format, file, "line {}: more than eight numbers", line);
      numbers[count++] = number.nearest;
      at = number.end;
    }
    if (count != 0) {
      if (count < 6)
        raise(kerf::Error::bad_format, file, "line {}: {} numbers, where a ray has six, origin and direction",
              line, count);
      kerf::Ray ray{{numbers[0], numbers[1], numbers[2]}, {numbers[3], numbers[4], numbers[5]}};
      if (count == 8) ray.t_min = numbers[6];
      if (count > 6) ray.t_max = numbers[count - 1];
      rays.push_back(ray);
    }
    at = skip_line_end(line_end, end);
  }
  if (rays.empty()) raise(kerf::Error::bad_format, file, "holds no rays");
  return rays;
}

}  // namespace workbench
