// GPL-2.0-or-later. Model files as triangles in the map's axes, their skins, and MD3 models with the vertices of the
// file.
#include "q3map2/model/model_load.h"

#include "common/error.h"
#include "common/files/archive.h"
#include "common/platform/platform.h"
#include "common/platform/process_copy.h"
#include "common/text/text.h"
#include "common/text/text_scan.h"
#include "q3map2/bspfile/bsp_records.h"
#include "q3map2/bspfile/map_keys.h"
#include "q3map2/model/model_apart.h"
#include "q3map2/shader/shader_table.h"

#include <assimp/IOSystem.hpp>
#include <assimp/Importer.hpp>
#include <assimp/MemoryIOWrapper.h>
#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <new>
#include <numbers>
#include <optional>

namespace q3 {

// ---- Shader replacements of models: skin files and _remap keys ----

namespace {

using Replacement = ShaderRemap::Replacement;

bool Matches(const Replacement &remap, std::string_view shader) {
    return remap.from == "*" || EndsWithNoCase(shader, remap.from);
}

std::string_view Trimmed(std::string_view text) {
    while (!text.empty() && (unsigned char)(text.front()) <= ' ')
        text.remove_prefix(1);
    while (!text.empty() && (unsigned char)(text.back()) <= ' ')
        text.remove_suffix(1);
    return text;
}

/// A line "replace FROM TO" or "FROM,TO".
std::optional<Replacement> SkinLine(std::string_view line) {
    if (const std::size_t comma = line.find(','); comma != std::string_view::npos)
        return Replacement{WithoutExtension(PlainName(Trimmed(line.substr(0, comma)))),
                           WithoutExtension(PlainName(Trimmed(line.substr(comma + 1))))};
    TextScanner scanner{std::string(line), "skin"};
    std::string word, from, to;
    if (scanner.Next(word) && EqualNoCase(word, "replace") && scanner.Next(from) && scanner.Next(to))
        return Replacement{WithoutExtension(PlainName(from)), WithoutExtension(PlainName(to))};
    return {};
}

std::vector<Replacement> ReadSkin(std::string_view text) {
    std::vector<Replacement> skin;
    while (!text.empty()) {
        const std::size_t end = std::min(text.find('\n'), text.size());
        if (auto line = SkinLine(Trimmed(text.substr(0, end))); line && !line->from.empty())
            skin.push_back(std::move(*line));
        text.remove_prefix(std::min(end + 1, text.size()));
    }
    return skin;
}

/// The lines of the skin file of the entity: x.md3_1.skin for the skin 1 of x.md3, x_red.skin for the skin red. Nothing
/// without a skin; a file that cannot be read is a warning.
std::optional<std::vector<Replacement>> SkinOf(const Entity &entity, std::string_view who, std::string_view model,
                                               const VirtualFileSystem *vfs, Log &log) {
    const std::string_view skin = keys::kSkin.Text(entity);
    if (skin.empty())
        return {};
    const bool isNumber = std::all_of(skin.begin(), skin.end(), [](char c) { return c >= '0' && c <= '9'; });
    const std::string name =
        (isNumber ? std::string(model) : WithoutExtension(model)) + "_" + std::string(skin) + ".skin";
    const auto bytes = vfs == nullptr ? std::nullopt : vfs->Read(name);
    if (!bytes) {
        log.Warn("skin not found", "{}: the skin file {} cannot be read", who, name);
        return {};
    }
    return ReadSkin(AsText(*bytes));
}

/// The _remap keys of the entity as replacements: those with the longest `from` first, "*" last.
std::vector<Replacement> RemapsOf(const Entity &entity, std::string_view who, Log &log) {
    std::vector<Replacement> remaps;
    for (const auto &[key, value] : entity.pairs) {
        if (!StartsWithNoCase(key, keys::kRemapPrefix))
            continue;
        const std::size_t semicolon = value.find(';');
        Replacement remap;
        if (semicolon != std::string::npos)
            remap = {value.substr(0, semicolon), value.substr(semicolon + 1)};
        if (remap.from.empty() || remap.to.empty() || remap.to.size() > kMaxShaderName)
            log.Warn("bad remap", "{}: \"{}\" \"{}\" is ignored: expected FROM;TO, TO with at most {} characters", who,
                     key, value, kMaxShaderName);
        else
            remaps.push_back(std::move(remap));
    }
    std::stable_sort(remaps.begin(), remaps.end(), [](const Replacement &a, const Replacement &b) {
        return (a.from == "*" ? 0 : a.from.size()) > (b.from == "*" ? 0 : b.from.size());
    });
    return remaps;
}

} // namespace

ShaderRemap ShaderRemapOf(const Entity &entity, std::string_view who, std::string_view model,
                          const VirtualFileSystem *vfs, Log &log) {
    auto skin = SkinOf(entity, who, model, vfs, log);
    return {std::move(skin), RemapsOf(entity, who, log)};
}

std::string ShaderRemap::Skinned(std::string_view shader) const {
    if (!skin_)
        return std::string(shader);
    const auto line = std::ranges::find_if(*skin_, [&](const Replacement &r) { return EqualNoCase(r.from, shader); });
    return line == skin_->end() ? std::string() : line->to;
}

std::string ShaderRemap::operator()(std::string_view shader) const {
    std::string name = Skinned(shader);
    if (name.empty() && skin_)
        return name;
    for (const Replacement &remap : remaps_)
        if (Matches(remap, name))
            return WithoutExtension(remap.to);
    return name;
}

void ShaderRemap::WarnOfUnmatched(std::span<const std::string> shaders, std::string_view who, Log &log) const {
    std::vector<std::string> skinned;
    for (const std::string &shader : shaders)
        skinned.push_back(Skinned(shader));
    for (const Replacement &remap : remaps_)
        if (std::ranges::none_of(skinned, [&](const std::string &shader) { return Matches(remap, shader); }))
            log.Warn("remap without match",
                     "{}: _remap \"{};{}\" has no effect: no shader of the model ends with {}; it has {}", who,
                     remap.from, remap.to, remap.from, fmt::join(skinned, ", "));
}

// ---- Reads model files by assimp, from the game's folders and archives ----

namespace {

/// Larger meshes are split. Engines draw surfaces of less than SHADER_MAX_VERTEXES, 1000; the limit of triangles is
/// chosen.
constexpr unsigned kMaxMeshVerts = 999, kMaxMeshTriangles = 1 << 20;
constexpr bool kStreamOwnsBytes = true; ///< argument of assimp's stream: it frees the bytes itself

struct FileBytes {
    std::vector<std::byte> bytes;
};

/// A stream over a file in memory.
class FileStream : private FileBytes, public Assimp::MemoryIOStream {
  public:
    explicit FileStream(std::vector<std::byte> file)
        : FileBytes{std::move(file)},
          MemoryIOStream(reinterpret_cast<const std::uint8_t *>(bytes.data()), bytes.size(), !kStreamOwnsBytes) {}
};

/// The path as the game's files have it, without . and .. where that is possible.
std::string VfsName(std::string_view path) {
    return PlainName(PathOf(PlainName(path)).lexically_normal().generic_string());
}

/// The game's files for assimp, which may open others that a model names.
class GameFiles : public Assimp::IOSystem {
  public:
    explicit GameFiles(const ModelFiles &files) : files_(files) {}
    bool Exists(const char *name) const override { return files_.Exists(VfsName(name)); }
    char getOsSeparator() const override { return '/'; }
    Assimp::IOStream *Open(const char *name, const char *mode) override {
        if (std::string_view(mode).find_first_of("wa+") != std::string_view::npos)
            return nullptr;
        auto bytes = files_.Read(VfsName(name));
        return bytes ? new FileStream(std::move(*bytes)) : nullptr; // assimp passes it to Close
    }
    void Close(Assimp::IOStream *stream) override { delete stream; }
    bool ComparePaths(const char *a, const char *b) const override { return EqualNoCase(VfsName(a), VfsName(b)); }

  private:
    const ModelFiles &files_;
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
    bool isEmbedded = false;
};

MaterialImage ImageOf(const aiMaterial &material, const aiScene &scene) {
    constexpr char kEmbedded = '*';
    aiString texture;
    if (material.GetTexture(aiTextureType_DIFFUSE, 0, &texture) != aiReturn_SUCCESS)
        return {};
    MaterialImage image{.name = texture.C_Str()};
    const aiTexture *inside = scene.GetEmbeddedTexture(texture.C_Str());
    image.isEmbedded = image.name.starts_with(kEmbedded);
    if (image.isEmbedded)
        image.name = inside == nullptr ? "" : inside->mFilename.C_Str();
    if (image.isEmbedded && image.name.starts_with(kEmbedded))
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
    return image.name.empty() || (image.isEmbedded && !name.empty()) ? name : image.name;
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

Model ReadModel(const ModelFiles &files, const std::string &name, int frame) {
    Assimp::Importer importer;
    importer.SetIOHandler(new GameFiles(files)); // the importer owns it
    importer.SetPropertyBool(AI_CONFIG_IMPORT_MD3_HANDLE_MULTIPART, false);
    importer.SetPropertyBool(AI_CONFIG_IMPORT_MD3_LOAD_SHADERS, false);
    importer.SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE, aiPrimitiveType_POINT | aiPrimitiveType_LINE);
    importer.SetPropertyBool(AI_CONFIG_PP_FD_REMOVE, true);
    importer.SetPropertyInteger(AI_CONFIG_PP_SLM_VERTEX_LIMIT, kMaxMeshVerts);
    importer.SetPropertyInteger(AI_CONFIG_PP_SLM_TRIANGLE_LIMIT, kMaxMeshTriangles);
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
            entry.model = std::make_unique<Model>(
                ReadModelApart(*vfs_, [&](const ModelFiles &files) { return ReadModel(files, path, frame); }));
        } catch (const std::bad_alloc &) {
            throw;
        } catch (const ProcessCopyError &) { // not a fault of the file
            throw;
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
    const bool isOutsideGame =
        name[0] == '/' || name.find(':') != std::string::npos || name.find("..") != std::string::npos;
    if (!isOutsideGame)
        return PlainName(name);
    const std::string lower = LowerCase(name);
    for (const std::string_view root : {"/models/", "/textures/"})
        if (const std::size_t at = lower.find(root); at != std::string::npos)
            return name.substr(at + 1);
    return folder + name.substr(slash + 1);
}

// ---- Affine transforms of placed models ----

namespace {

constexpr double kRadiansPerDegree = std::numbers::pi / 180;

} // namespace

Vec3d ModelTransform::Point(const Vec3d &p) const {
    return Vec3d{Dot(rows[0], p), Dot(rows[1], p), Dot(rows[2], p)} + origin;
}

double ModelTransform::Determinant() const {
    return Dot(rows[0], Cross(rows[1], rows[2]));
}

Vec3d ModelTransform::Normal(const Vec3d &n) const {
    // The cofactor matrix = determinant * inverse transpose; it exists for singular transforms too.
    const Vec3d turned{Dot(Cross(rows[1], rows[2]), n), Dot(Cross(rows[2], rows[0]), n),
                       Dot(Cross(rows[0], rows[1]), n)};
    const Vec3d unit = Normalize(Determinant() < 0 ? -turned : turned);
    return unit == Vec3d{} ? n : unit;
}

ModelTransform MakeModelTransform(const Vec3d &scale, const Vec3d &pitchYawRoll, const Vec3d &origin) {
    const Vec3d angles = pitchYawRoll * kRadiansPerDegree;
    // Rows of Rz(yaw) Ry(pitch) Rx(roll) diag(scale); s and c: sine and cosine.
    const double sp = std::sin(angles.x), cp = std::cos(angles.x);
    const double sy = std::sin(angles.y), cy = std::cos(angles.y);
    const double sr = std::sin(angles.z), cr = std::cos(angles.z);
    ModelTransform transform;
    transform.rows[0] = Vec3d{cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr} * scale;
    transform.rows[1] = Vec3d{sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr} * scale;
    transform.rows[2] = Vec3d{-sp, cp * sr, cp * cr} * scale;
    transform.origin = origin;
    return transform;
}

Vec3d ModelScaleOf(const Entity &entity) {
    if (const auto scale = keys::kModelScaleVec.Vector(entity))
        return Vec3d(*scale);
    const double scale = keys::kModelScale.Number(entity);
    return scale == 0 ? Vec3d{1, 1, 1} : Vec3d{scale, scale, scale};
}

Vec3d AnglesOf(const Entity &entity) {
    if (const auto angles = keys::kAngles.Vector(entity))
        return Vec3d(*angles);
    return {0, keys::kAngle.Number(entity), 0};
}

// ---- MD3 models with the vertices of the file, in its order ----

namespace {

constexpr std::string_view kMd3Ident = "IDP3";
constexpr std::int32_t kMd3Version = 15;
constexpr float kMd3Unit = 1.0f / 64;     ///< game units of a step of coordinates
constexpr std::size_t kMd3NameBytes = 64; ///< filled with NULs

// The records, in the order of MD3 files. Offsets are in bytes: those of the header from the start of the file, those
// of a surface from its own start.

struct Md3Header {
    std::array<char, 4> ident;
    std::int32_t version;
    std::array<char, kMd3NameBytes> name;
    std::int32_t flags, frames, tags, surfaces, skins, frameOffset, tagOffset, surfaceOffset, end;
};
struct Md3Surface {
    std::array<char, 4> ident;
    std::array<char, kMd3NameBytes> name;
    std::int32_t flags, frames, shaders, verts, triangles, triangleOffset, shaderOffset, stOffset, vertOffset, end;
};
struct Md3Vert {
    std::array<std::int16_t, 3> xyz;
    std::uint8_t zenith, azimuth; ///< angles of the normal from +z and around it from +x; 256 steps are a turn
};
struct Md3Shader {
    std::array<char, kMd3NameBytes> name;
    std::int32_t index;
};
static_assert(sizeof(Md3Header) == 108 && sizeof(Md3Surface) == 108 && sizeof(Md3Vert) == 8 && sizeof(Md3Shader) == 68);

/// Reads records; errors where they are outside the file, or have more bytes together than the file.
class Md3File {
  public:
    explicit Md3File(std::span<const std::byte> file) : file_(file), unread_(std::int64_t(file.size())) {}

    template <typename Record> std::vector<Record> Read(std::int64_t offset, std::int64_t count) {
        const auto size = std::int64_t(file_.size());
        if (offset < 0 || count < 0 || offset > size || count > (size - offset) / std::int64_t(sizeof(Record)))
            throw Error("{} records of {} bytes at {} are not inside the {} bytes of the file", count, sizeof(Record),
                        offset, size);
        unread_ -= count * std::int64_t(sizeof(Record));
        if (unread_ < 0)
            throw Error("its surfaces overlap: together they are larger than the {} bytes of the file", size);
        std::vector<Record> records(static_cast<std::size_t>(count));
        if (count > 0)
            std::memcpy(records.data(), file_.data() + offset, sizeof(Record) * records.size());
        return records;
    }

  private:
    std::span<const std::byte> file_;
    std::int64_t unread_; ///< bytes of the file, less those of all records so far
};

DrawVert Md3VertOf(const Md3Vert &from, const std::array<float, 2> &st) {
    DrawVert vert;
    vert.xyz = Vec3f{float(from.xyz[0]), float(from.xyz[1]), float(from.xyz[2])} * kMd3Unit;
    const double step = 2 * std::numbers::pi / 256, zenith = from.zenith * step, azimuth = from.azimuth * step;
    vert.normal = Vec3f(
        Normalize(Vec3d{std::cos(azimuth) * std::sin(zenith), std::sin(azimuth) * std::sin(zenith), std::cos(zenith)}));
    for (std::size_t axis = 0; axis < 2; ++axis)
        vert.st[axis] = std::isfinite(st[axis]) ? st[axis] : 0;
    return vert;
}

ModelMesh Md3MeshOf(Md3File &file, std::int64_t at, const Md3Surface &surface, std::string_view modelName, int frame) {
    ModelMesh mesh;
    if (surface.shaders > 0) {
        const auto shader = file.Read<Md3Shader>(at + surface.shaderOffset, 1).front();
        const std::string_view name(shader.name.data(), kMd3NameBytes);
        mesh.shader = ShaderOfMaterial(name.substr(0, name.find('\0')), modelName);
    }
    const auto verts = file.Read<Md3Vert>(
        at + surface.vertOffset + std::int64_t(frame) * surface.verts * std::int64_t(sizeof(Md3Vert)), surface.verts);
    const auto st = file.Read<std::array<float, 2>>(at + surface.stOffset, surface.verts);
    for (std::size_t i = 0; i < verts.size(); ++i)
        mesh.verts.push_back(Md3VertOf(verts[i], st[i]));
    for (const auto &triangle :
         file.Read<std::array<std::int32_t, 3>>(at + surface.triangleOffset, surface.triangles)) {
        for (const std::int32_t corner : triangle)
            if (corner < 0 || corner >= surface.verts)
                throw Error("a triangle names vertex {} of {}", corner, surface.verts);
        mesh.triangles.push_back({triangle[0], triangle[1], triangle[2]});
    }
    return mesh;
}

} // namespace

bool IsMd3(std::span<const std::byte> file) {
    return file.size() >= kMd3Ident.size() && std::memcmp(file.data(), kMd3Ident.data(), kMd3Ident.size()) == 0;
}

Model ReadMd3(std::span<const std::byte> bytes, std::string_view modelName, int frame) {
    Md3File file(bytes);
    const auto header = file.Read<Md3Header>(0, 1).front();
    if (!IsMd3(bytes) || header.version != kMd3Version)
        throw Error("version {}, expected an MD3 model of version {}", header.version, kMd3Version);
    Model model;
    std::int64_t at = header.surfaceOffset;
    for (std::int32_t i = 0; i < header.surfaces; ++i) {
        const auto surface = file.Read<Md3Surface>(at, 1).front();
        if (frame < 0 || frame >= surface.frames)
            throw Error("there is no frame {}: the model has {}", frame, surface.frames);
        model.meshes.push_back(Md3MeshOf(file, at, surface, modelName, frame));
        if (surface.end <= 0)
            throw Error("surface {} ends {} bytes after its start", i, surface.end);
        at += surface.end;
    }
    if (model.meshes.empty())
        throw Error("no triangles");
    return model;
}

} // namespace q3
