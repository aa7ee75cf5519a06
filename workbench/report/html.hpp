// Escapes and encodings of HTML.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace workbench {

/// `text` for use between tags and in quoted attributes.
std::string escape_html(std::string_view text);

/// JSON for use in a script element, which would end at the first `</script`.
std::string escape_script(std::string_view json);

/// The Base64 encoding (RFC 4648, section 4).
std::string base64(std::span<const std::uint8_t> bytes);

}  // namespace workbench
