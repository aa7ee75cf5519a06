// The few pieces of text that HTML is made of.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace workbench {

/// `text` as it may stand between tags and in quoted attributes.
std::string escape_html(std::string_view text);

/// JSON as it may stand inside a script element, which would end at the first `</script`.
std::string escape_script(std::string_view json);

/// RFC 4648, section 4.
std::string base64(std::span<const std::uint8_t> bytes);

}  // namespace workbench
