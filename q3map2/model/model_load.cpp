// GPL-2.0-or-later. Reads model files by assimp, from the game's folders and archives.
#include "q3map2/model/model_load.h"

#include "common/error.h"
#include "common/files/archive.h"
#include "common/platform/platform.h"
#include "common/text/text.h"
#include "q3map2/shader/shader_table.h"

#include <assimp/IOSystem.hpp>
#include <assimp/Importer.hpp>
#include <assimp/MemoryIOWrapper.h>
#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>

namespace q3 {
namespace {

constexpr unsigned kMaxMeshVerts = 999;

struct FileBytes {
    std::vector<std::byte> bytes;
};

/// A stream over a file in memory.
class FileStream : private FileBytes, public Assimp::MemoryIOStream {
  public:
    explicit FileStream(std::vector<std::byte> file)
        : FileBytes{std::move(file)},
          MemoryIOStream(reinterpret_cast<const std::uint8_t *>(bytes.data()), bytes.size(), false) {}
};

std::string VfsName(std::string_view path) {
    return PlainName(PathOf(PlainName(path)).lexically_normal().generic_string());
}

class GameFiles : public Assimp::IOSystem {
  public:
    explicit GameFiles(const VirtualFileSystem &vfs) : vfs_(vfs) {}
    bool Exists(const char *name) const override { return vfs_.Exists(VfsName(name)); }
    char getOsSeparator() const override { return '/'; }
    Assimp::IOStream *Open(const char *name, const char *mode) override {
        if (std::string_view(mode).find_first_of("wa+") != std::string_view::npos)
            return nullptr;
        auto bytes = vfs_.Read(VfsName(name));
        return bytes ? new FileStream(std::move(*bytes)) : nullptr; // assimp passes it to Close
    }
    void Close(Assimp::IOStream *stream) override { delete stream; }
    bool ComparePaths(const char *a, const char *b) const override { return EqualNoCase(VfsName(a), VfsName(b)); }

  private:
    const VirtualFileSystem &vfs_;
};

/// assimp converts all formats to y up; maps have z up.
Vec3f ToMapAxes(const aiVector3D &v) {
    return {v.x, -v.z, v.y};
}

std::uint8_t ColorByte(float c) {
    return c > 0 ? std::uint8_t(std::lround(std::min(c, 1.f) * 255)) : std::uint8_t(0); // NaN becomes 0
}

DrawVert VertOf(const aiMesh &mesh, unsigned i) {
    DrawVert vert;
    vert.xyz = ToMapAxes(mesh.mVertices[i]);
    if (mesh.HasNormals())
        vert.normal = Normalize(ToMapAxes(mesh.mNormals[i]));
    if (mesh.HasTextureCoords(0))
        vert.st = {mesh.mTextureCoords[0][i].x, mesh.mTextureCoords[0][i].y};
    if (mesh.HasVertexColors(0)) {
        const aiColor4D &c = mesh.mColors[0][i];
        vert.color = {ColorByte(c.r), ColorByte(c.g), ColorByte(c.b), ColorByte(c.a)};
    }
    if (!IsFinite(vert.xyz))
        throw Error("a vertex that is not a number");
    for (float &c : vert.st)
        c = std::isfinite(c) ? c : 0;
    if (!IsFinite(vert.normal))
        vert.normal = {0, 0, 1};
    return vert;
}

/// The image of a material. Assimp calls an image embedded in the model *N; `name` is then the file name that the
/// exporter stored, if any.
struct MaterialImage {
    std::string name;
    bool embedded = false;
};

MaterialImage ImageOf(const aiMaterial &material, const aiScene &scene) {
    constexpr char kEmbedded = '*';
    aiString texture;
    if (material.GetTexture(aiTextureType_DIFFUSE, 0, &texture) != aiReturn_SUCCESS)
        return {};
    MaterialImage image{texture.C_Str(), false};
    const aiTexture *inside = scene.GetEmbeddedTexture(texture.C_Str());
    image.embedded = image.name.starts_with(kEmbedded);
    if (image.embedded)
        image.name = inside == nullptr ? "" : inside->mFilename.C_Str();
    if (image.embedded && image.name.starts_with(kEmbedded))
        image.name.clear();
    return image;
}

/// The material's own name if it looks like that of a shader, else the name of its image. An embedded image is not a
/// file of the game, so the material's name comes first there. Empty: neither has a name.
std::string MaterialName(const aiMaterial &material, const aiScene &scene) {
    aiString given;
    material.Get(AI_MATKEY_NAME, given);
    const std::string name = given.C_Str();
    if (StartsWithNoCase(name, "textures/") || StartsWithNoCase(name, "models/"))
        return name;
    const MaterialImage image = ImageOf(material, scene);
    return image.name.empty() || (image.embedded && !name.empty()) ? name : image.name;
}

ModelMesh MeshOf(const aiMesh &source, const aiScene &scene, std::string_view modelName) {
    ModelMesh mesh;
    mesh.shader = ShaderOfMaterial(MaterialName(*scene.mMaterials[source.mMaterialIndex], scene), modelName);
    for (unsigned i = 0; i < source.mNumVertices; ++i)
        mesh.verts.push_back(VertOf(source, i));
    for (unsigned i = 0; i < source.mNumFaces; ++i) {
        const aiFace &face = source.mFaces[i];
        if (face.mNumIndices == 3)
            mesh.triangles.push_back({int(face.mIndices[0]), int(face.mIndices[1]), int(face.mIndices[2])});
    }
    return mesh;
}

Model ReadModel(const VirtualFileSystem &vfs, const std::string &name, int frame) {
    Assimp::Importer importer;
    importer.SetIOHandler(new GameFiles(vfs)); // the importer owns it
    importer.SetPropertyBool(AI_CONFIG_IMPORT_MD3_HANDLE_MULTIPART, false);
    importer.SetPropertyBool(AI_CONFIG_IMPORT_MD3_LOAD_SHADERS, false);
    importer.SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE, aiPrimitiveType_POINT | aiPrimitiveType_LINE);
    importer.SetPropertyBool(AI_CONFIG_PP_FD_REMOVE, true);
    importer.SetPropertyInteger(AI_CONFIG_PP_SLM_VERTEX_LIMIT, kMaxMeshVerts);
    importer.SetPropertyInteger(AI_CONFIG_PP_SLM_TRIANGLE_LIMIT, 1 << 20);
    importer.SetPropertyInteger(AI_CONFIG_IMPORT_GLOBAL_KEYFRAME, frame);
    const unsigned steps = aiProcess_GenNormals | aiProcess_GenUVCoords | aiProcess_JoinIdenticalVertices |
                           aiProcess_Triangulate | aiProcess_SortByPType | aiProcess_FindDegenerates |
                           aiProcess_FlipUVs | aiProcess_FlipWindingOrder | aiProcess_PreTransformVertices |
                           aiProcess_SplitLargeMeshes;
    const aiScene *scene = importer.ReadFile(name, steps);
    if (scene == nullptr || scene->mNumMeshes == 0)
        throw Error("{}", scene == nullptr ? importer.GetErrorString() : "no triangles");
    Model model;
    for (unsigned i = 0; i < scene->mNumMeshes; ++i)
        model.meshes.push_back(MeshOf(*scene->mMeshes[i], *scene, name));
    return model;
}

} // namespace

const Model *ModelLibrary::Get(std::string_view name, int frame, std::string &problem) {
    const auto [at, added] = entries_.try_emplace({LowerCase(VfsName(name)), frame});
    Entry &entry = at->second;
    if (added) {
        try {
            const std::string path = VfsName(name);
            if (vfs_ == nullptr || !vfs_->Exists(path))
                throw Error("there is no such file");
            entry.model = std::make_unique<Model>(ReadModel(*vfs_, path, frame));
        } catch (const std::exception &error) {
            entry.problem = error.what();
        }
    }
    problem = entry.problem;
    return entry.model.get();
}

std::string ShaderOfMaterial(std::string_view material, std::string_view modelName) {
    if (material.empty())
        return WithoutExtension(modelName);
    std::string name(material);
    std::replace(name.begin(), name.end(), '\\', '/');
    const std::size_t slash = name.rfind('/'), dot = name.rfind('.');
    if (dot != std::string::npos && (slash == std::string::npos || dot > slash))
        name.resize(dot);
    const std::string folder(modelName.substr(0, modelName.rfind('/') + 1));
    if (slash == std::string::npos)
        return folder + name;
    const bool foreign = name[0] == '/' || name.find(':') != std::string::npos || name.find("..") != std::string::npos;
    if (!foreign)
        return PlainName(name);
    const std::string lower = LowerCase(name);
    for (const std::string_view root : {"/models/", "/textures/"})
        if (const std::size_t at = lower.find(root); at != std::string::npos)
            return name.substr(at + 1);
    return folder + name.substr(slash + 1);
}

} // namespace q3
