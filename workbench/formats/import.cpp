#include "workbench/formats/import.hpp"

#include <algorithm>
#include <exception>
#include <limits>
#include <set>

#include <assimp/BaseImporter.h>
#include <assimp/DefaultIOSystem.h>
#include <assimp/Importer.hpp>
#include <assimp/MemoryIOWrapper.h>
#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <fmt/format.h>
#include <kerf/error.hpp>

namespace workbench {
namespace {

using kerf::Error;

// Serves the scene file from memory, where it lies unpacked and checked, and its companions from disk.
class UnpackedFile : public Assimp::DefaultIOSystem {
 public:
  UnpackedFile(std::string name, const std::string& bytes) : name_(std::move(name)), bytes_(bytes) {}

  bool Exists(const char* name) const override {
    return name == name_ || Assimp::DefaultIOSystem::Exists(name);
  }

  Assimp::IOStream* Open(const char* name, const char* mode) override {
    if (name != name_) return Assimp::DefaultIOSystem::Open(name, mode);
    return new Assimp::MemoryIOStream(reinterpret_cast<const std::uint8_t*>(bytes_.data()), bytes_.size());
  }

 private:
  std::string name_;
  const std::string& bytes_;
};

void append_mesh(Scene& scene, const aiMesh& mesh, const aiMatrix4x4& transform) {
  if (scene.vertices.size() + mesh.mNumVertices > std::numeric_limits<std::uint32_t>::max()) {
    throw Error(Error::too_large, fmt::format("{}: has 2^32 vertices or more", scene.name));
  }
  const auto first = static_cast<std::uint32_t>(scene.vertices.size());
  const bool stays =
      transform.IsIdentity();  // and is not rounded, nor an infinity turned into something else
  for (unsigned i = 0; i < mesh.mNumVertices; ++i) {
    const aiVector3D p = stays ? mesh.mVertices[i] : transform * mesh.mVertices[i];
    scene.vertices.push_back({p.x, p.y, p.z});
  }
  for (unsigned i = 0; i < mesh.mNumFaces; ++i) {
    const aiFace& face = mesh.mFaces[i];
    if (face.mNumIndices != 3) continue;  // a point or a line: polygons have been triangulated
    scene.triangles.push_back({first + face.mIndices[0], first + face.mIndices[1], first + face.mIndices[2]});
  }
}

void append_node(Scene& scene, const aiScene& imported, const aiNode& node, const aiMatrix4x4& parent) {
  const aiMatrix4x4 transform = parent * node.mTransformation;
  for (unsigned i = 0; i < node.mNumMeshes; ++i) {
    append_mesh(scene, *imported.mMeshes[node.mMeshes[i]], transform);
  }
  for (unsigned i = 0; i < node.mNumChildren; ++i)
    append_node(scene, imported, *node.mChildren[i], transform);
}

// Leaves only the reader of `format`: assimp would try others on what does not look like it.
void keep_one_reader(Assimp::Importer& importer, const char* format) {
  for (std::size_t i = importer.GetImporterCount(); i-- > 0;) {
    Assimp::BaseImporter* reader = importer.GetImporter(i);
    std::set<std::string> extensions;
    reader->GetExtensionList(extensions);
    if (extensions.contains(format)) continue;
    importer.UnregisterLoader(reader);
    delete reader;
  }
}

}  // namespace

Scene import(const std::filesystem::path& file, std::string_view format, const std::string& bytes) {
  std::filesystem::path name = file;
  name.replace_extension(format);  // assimp chooses its reader by it
  Assimp::Importer importer;
  importer.SetIOHandler(new UnpackedFile(name.string(), bytes));  // which owns it from now on
  keep_one_reader(importer, std::string(format.substr(1)).c_str());
  const aiScene* imported = importer.ReadFile(name.string(), aiProcess_Triangulate);
  if (imported == nullptr || imported->mRootNode == nullptr) {
    std::string cause = importer.GetErrorString();
    std::replace(cause.begin(), cause.end(), '\n', ' ');
    throw Error(Error::bad_format,
                fmt::format("{}: {}", file.string(), cause.empty() ? "cannot be read" : cause));
  }
  Scene scene;
  append_node(scene, *imported, *imported->mRootNode, aiMatrix4x4());
  return scene;
}

}  // namespace workbench
