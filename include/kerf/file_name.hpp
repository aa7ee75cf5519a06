// The name of a file, from whatever a program keeps such names in.
#pragma once

#include <kerf/cpp20.hpp>
#ifdef KERF_HAS_CPP20

#include <concepts>
#include <cstddef>

namespace kerf {

/// A view of a file's name: of a `std::filesystem::path`, a `std::string`, a `std::string_view` or a C
/// string. The header of paths is not included, because it takes longer to compile than all of kerf's
/// headers. Bytes are taken as `std::filesystem::path` takes them. Nothing is copied: it stands for the
/// argument of a call.
class FileName {
 public:
  /// A name that ends with a zero.
  FileName(const char* name) : narrow_(name) {  // NOLINT: implicit, as for std::filesystem::path
    while (name[size_] != '\0') ++size_;
  }

  /// A `std::string` or a `std::string_view`.
  template <class Text>
  requires requires(const Text& text) {
    { text.data() } -> std::same_as<const char*>;
    { text.size() } -> std::convertible_to<std::size_t>;
    text.substr(0);
  }
  FileName(const Text& text) : narrow_(text.data()), size_(text.size()) {}  // NOLINT: as above

  /// A `std::filesystem::path`, which holds wide characters on Windows.
  template <class Path>
  requires requires(const Path& path) {
    path.native().data();
    path.native().size();
  }
  FileName(const Path& path) : size_(path.native().size()) {  // NOLINT: as above
    if constexpr (std::same_as<typename Path::value_type, char>) {
      narrow_ = path.native().data();
    } else {
      wide_ = path.native().data();
    }
  }

  const char* narrow() const { return narrow_; }  ///< the first character; null if the name is of wide ones
  const wchar_t* wide() const { return wide_; }   ///< the first wide character; else null
  std::size_t size() const { return size_; }      ///< number of characters

 private:
  const char* narrow_ = nullptr;
  const wchar_t* wide_ = nullptr;
  std::size_t size_ = 0;
};

}  // namespace kerf

#endif  // KERF_HAS_CPP20
