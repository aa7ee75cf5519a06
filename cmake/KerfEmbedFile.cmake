# Writes SOURCE, in which `embedded::NAME()` is the bytes of FILE.
file(READ ${FILE} hex HEX)
string(REGEX REPLACE "(................................)" "\\1\n" hex "${hex}")
string(REGEX REPLACE "([0-9a-f][0-9a-f])" "0x\\1," bytes "${hex}")
file(WRITE ${SOURCE} "#include <string_view>

namespace embedded {
namespace {
constexpr unsigned char bytes[] = {
${bytes}0x00};
}
std::string_view ${NAME}();
std::string_view ${NAME}() { return {reinterpret_cast<const char*>(bytes), sizeof(bytes) - 1}; }
}
")
