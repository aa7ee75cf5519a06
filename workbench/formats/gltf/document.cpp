#include "workbench/formats/gltf/document.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

namespace workbench::gltf {
namespace {

using kerf::Error;

/// glTF nests a dozen levels deep. A file of nothing but brackets must not fill the memory.
constexpr int max_nesting = 64;

Json parse(const std::filesystem::path& file, std::string_view text) {
  // Of two members of one name, one reader takes the first and another the last.
  std::vector<std::set<std::string>> members;
  const auto watch = [&](int depth, Json::parse_event_t event, Json& value) {
    if (depth > max_nesting) raise(Error::bad_format, file, "is nested too deeply");
    if (event == Json::parse_event_t::object_start) members.emplace_back();
    if (event == Json::parse_event_t::object_end) members.pop_back();
    if (event == Json::parse_event_t::key &&
        !members.back().insert(value.get_ref<const std::string&>()).second)
      raise(Error::bad_format, file, "has two members {} in one object",
            value.dump(-1, ' ', true, Json::error_handler_t::replace).substr(0, 60));
    return true;
  };
  try {
    return Json::parse(text.begin(), text.end(), watch);
  } catch (const Json::exception& e) {
    const std::string_view what = e.what();  // begins with the name of the exception in brackets
    raise(Error::bad_format, file, "not a valid glTF file: {}",
          what.substr(std::min(what.size(), what.find("] ") + 2)).substr(0, 200));
  }
}

}  // namespace

Document::Document(const std::filesystem::path& file, std::string_view text)
    : file_(file), json_(parse(file, text)), root_{&json_, "the file"} {
  if (!json_.is_object()) raise("is not a JSON object");
  if (const auto buffers = json_.find("buffers"); buffers != json_.end() && buffers->is_object())
    raise("is glTF of version 1.0, which had objects in place of lists; only version 2 is known");
  const std::string& version = this->text(object(root_, "asset"), "version");
  if (!version.starts_with("2."))
    raise("is glTF of version {}; only version 2 is known", version.substr(0, 40));
}

void Document::raise_kind(std::string_view name, const Json& value, const char* wanted) const {
  raise("{}: {} stands where {} should", name,
        value.dump(-1, ' ', true, Json::error_handler_t::replace).substr(0, 60), wanted);
}

const Json* Document::find(const Object& object, const char* key) const {
  const auto found = object.json->find(key);
  return found == object.json->end() ? nullptr : &*found;
}

std::uint64_t Document::count(const char* name) const {
  return list(root_, name).size();
}

Object Document::item(const char* name, std::uint64_t i, std::string_view by) const {
  const Json& items = list(root_, name);
  if (i >= items.size()) raise("{}: there is no {}[{}]: {} has {} items", by, name, i, name, items.size());
  return to_object(items[i], fmt::format("{}[{}]", name, i));
}

std::optional<std::uint64_t> Document::find_whole(const Object& object, const char* key) const {
  const Json* const value = find(object, key);
  if (value == nullptr) return std::nullopt;
  if (value->is_number_unsigned()) return value->get<std::uint64_t>();
  return to_whole(*value, fmt::format("{}.{}", object.name, key));
}

std::optional<Object> Document::find_object(const Object& object, const char* key) const {
  const Json* const value = find(object, key);
  if (value == nullptr) return std::nullopt;
  return to_object(*value, fmt::format("{}.{}", object.name, key));
}

const std::string* Document::find_text(const Object& object, const char* key) const {
  const Json* const value = find(object, key);
  if (value == nullptr) return nullptr;
  if (!value->is_string()) raise_kind(fmt::format("{}.{}", object.name, key), *value, "a text");
  return value->get_ptr<const std::string*>();
}

bool Document::find_flag(const Object& object, const char* key, bool otherwise) const {
  const Json* const value = find(object, key);
  if (value == nullptr) return otherwise;
  if (!value->is_boolean()) raise_kind(fmt::format("{}.{}", object.name, key), *value, "true or false");
  return value->get<bool>();
}

const Json& Document::list(const Object& object, const char* key) const {
  static const Json empty = Json::array();
  const Json* const value = find(object, key);
  if (value == nullptr) return empty;
  if (!value->is_array()) raise_kind(fmt::format("{}.{}", object.name, key), *value, "a list");
  return *value;
}

std::uint64_t Document::whole(const Object& object, const char* key) const {
  if (const auto value = find_whole(object, key)) return *value;
  raise("{} has no {}", object.name, key);
}

Object Document::object(const Object& object, const char* key) const {
  if (auto value = find_object(object, key)) return std::move(*value);
  raise("{} has no {}", object.name, key);
}

const std::string& Document::text(const Object& object, const char* key) const {
  if (const std::string* const value = find_text(object, key)) return *value;
  raise("{} has no {}", object.name, key);
}

std::optional<Object> Document::find_extension(const Object& object, const char* name) const {
  const auto extensions = find_object(object, "extensions");
  return extensions ? find_object(*extensions, name) : std::nullopt;
}

std::uint64_t Document::to_whole(const Json& value, std::string_view name) const {
  if (value.is_number_unsigned()) return value.get<std::uint64_t>();
  if (value.is_number_float()) {  // 3.0 is a whole number, too
    const auto number = value.get<double>();
    constexpr double limit = 0x1p53;
    if (number >= 0.0 && number < limit && std::floor(number) == number)
      return static_cast<std::uint64_t>(number);
  }
  raise_kind(name, value, "a whole number");
}

double Document::to_number(const Json& value, std::string_view name) const {
  if (!value.is_number()) raise_kind(name, value, "a number");
  return value.get<double>();
}

Object Document::to_object(const Json& value, std::string name) const {
  if (!value.is_object()) raise_kind(name, value, "an object");
  return {&value, std::move(name)};
}

}  // namespace workbench::gltf
