// The JSON of a glTF file. Whatever is asked of it is either there, of the right kind, or named in an error.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "workbench/base/raise.hpp"

namespace workbench::gltf {

using Json = nlohmann::json;

/// An object of the JSON and how it is called in errors: "accessors[3].sparse".
struct Object {
  const Json* json;
  std::string name;
};

class Document {
 public:
  /// Parses `text`, the JSON of `file`, which must be glTF of version 2. Throws `kerf::Error::bad_format`
  /// with the line of what is wrong.
  Document(const std::filesystem::path& file, std::string_view text);

  const std::filesystem::path& file() const { return file_; }
  const Object& root() const { return root_; }

  /// How many items a list of the root has; none if the list is not there.
  std::uint64_t count(const char* list) const;

  /// Item `i` of a list of the root. `by` names who asks for it.
  Object item(const char* list, std::uint64_t i, std::string_view by) const;

  /// Members of `object`; nothing if they are not there, an error if they are of another kind.
  std::optional<std::uint64_t> find_whole(const Object& object, const char* key) const;
  std::optional<Object> find_object(const Object& object, const char* key) const;
  const std::string* find_text(const Object& object, const char* key) const;
  bool find_flag(const Object& object, const char* key, bool otherwise) const;
  /// An empty list if it is not there.
  const Json& list(const Object& object, const char* key) const;
  /// As many numbers as `count`; nothing if they are not there.
  template <std::size_t count>
  std::optional<std::array<double, count>> find_numbers(const Object& object, const char* key) const;

  /// Members that must be there.
  std::uint64_t whole(const Object& object, const char* key) const;
  Object object(const Object& object, const char* key) const;
  const std::string& text(const Object& object, const char* key) const;

  std::optional<Object> find_extension(const Object& object, const char* name) const;

  /// A number or an object in a list.
  std::uint64_t to_whole(const Json& value, std::string_view name) const;
  double to_number(const Json& value, std::string_view name) const;
  Object to_object(const Json& value, std::string name) const;

  template <class... Values>
  [[noreturn]] void raise(kerf::Error::Code code, fmt::format_string<const Values&...> format,
                          const Values&... values) const {
    workbench::raise(code, file_, format, values...);
  }
  template <class... Values>
  [[noreturn]] void raise(fmt::format_string<const Values&...> format, const Values&... values) const {
    workbench::raise(kerf::Error::bad_format, file_, format, values...);
  }

 private:
  const Json* find(const Object& object, const char* key) const;
  [[noreturn]] void raise_kind(std::string_view name, const Json& value, const char* wanted) const;

  const std::filesystem::path& file_;
  Json json_;
  Object root_;
};

template <std::size_t count>
std::optional<std::array<double, count>> Document::find_numbers(const Object& object, const char* key) const {
  const Json& values = list(object, key);
  if (find(object, key) == nullptr) return std::nullopt;
  if (values.size() != count) raise("{}.{}: {} numbers, not {}", object.name, key, values.size(), count);
  std::array<double, count> numbers;
  for (std::size_t i = 0; i < count; ++i) numbers[i] = to_number(values[i], object.name);
  return numbers;
}

}  // namespace workbench::gltf
