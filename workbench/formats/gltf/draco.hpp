// Primitives packed by Draco.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "workbench/formats/gltf/accessors.hpp"

namespace workbench::gltf {

/// A mesh as Draco unpacks it.
class DracoMesh {
 public:
  /// Unpacks `packed`, which errors call `name`.
  DracoMesh(const Document& document, std::string_view packed, std::string_view name);
  ~DracoMesh();
  DracoMesh(const DracoMesh&) = delete;
  DracoMesh& operator=(const DracoMesh&) = delete;

  /// Three indices a triangle, all of vertices that there are.
  const std::vector<std::uint32_t>& indices() const { return indices_; }

  /// The attribute of that number, as the accessor `declared` says what its numbers mean.
  Elements attribute(std::uint64_t number, const Elements& declared) const;

 private:
  struct Unpacked;
  const Document& document_;
  std::string name_;
  std::unique_ptr<Unpacked> unpacked_;
  std::vector<std::uint32_t> indices_;
};

}  // namespace workbench::gltf
