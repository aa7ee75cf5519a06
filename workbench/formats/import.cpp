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

#include "workbench/base/raise.hpp"

namespace workbench {
namespace {

using kerf::Error;

// Serves the scene file from memory, where it lies unpacked and checked, and the files that it names from
// disk.
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

// Collects the triangles of all nodes.
class Collector {
 public:
  Collector(const std::filesystem::path& file, const aiScene& imported) : file_(file), imported_(imported) {}

  Scene collect() {
    append_node(*imported_.mRootNode, aiMatrix4x4());
    return std::move(scene_);
  }

 private:
  void append_node(const aiNode& node, const aiMatrix4x4& parent) {
    const aiMatrix4x4 transform = parent * node.mTransformation;
    for (unsigned i = 0; i < node.mNumMeshes; ++i)
      append_mesh(*imported_.mMeshes[node.mMeshes[i]], transform);
    for (unsigned i = 0; i < node.mNumChildren; ++i) append_node(*node.mChildren[i], transform);
  }

  void append_mesh(const aiMesh& mesh, const aiMatrix4x4& transform) {
    if (scene_.vertices.size() + mesh.mNumVertices > std::numeric_limits<std::uint32_t>::max()) {
      raise(Error::too_large, file_, "has 2^32 vertices or more");
    }
    const auto first = static_cast<std::uint32_t>(scene_.vertices.size());
    const bool stays =
        transform.IsIdentity();  // multiplying by it would turn an infinity into something else
    for (unsigned i = 0; i < mesh.mNumVertices; ++i) {
      const aiVector3D p = stays ? mesh.mVertices[i] : transform * mesh.mVertices[i];
      scene_.vertices.push_back({p.x, p.y, p.z});
    }
    for (unsigned i = 0; i < mesh.mNumFaces; ++i) {
      const aiFace& face = mesh.mFaces[i];
      if (face.mNumIndices != 3) continue;  // a point or a line: polygons have been triangulated
      scene_.triangles.push_back(
          {first + face.mIndices[0], first + face.mIndices[1], first + face.mIndices[2]});
    }
  }

  const std::filesystem::path& file_;
  const aiScene& imported_;
  Scene scene_;
};

// Leaves only the reader of `format`. With the others, assimp tries them on files that do not look like
// `format`.
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
  name.replace_extension(format);  // by which assimp chooses its reader
  Assimp::Importer importer;
  importer.SetIOHandler(new UnpackedFile(name.string(), bytes));  // the importer owns it from now on
  keep_one_reader(importer, std::string(format.substr(1)).c_str());
  const aiScene* imported = importer.ReadFile(name.string(), aiProcess_Triangulate);
  if (imported == nullptr || imported->mRootNode == nullptr) {
    std::string cause = importer.GetErrorString();
    std::replace(cause.begin(), cause.end(), '\n', ' ');
    raise(Error::bad_format, file, "{}", cause.empty() ? "cannot be read" : cause);
  }
  return Collector(file, *imported).collect();
}

}  // namespace workbench
