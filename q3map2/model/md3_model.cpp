// GPL-2.0-or-later. MD3 models with the vertices of the file, in its order.
#include "q3map2/model/md3_model.h"

#include "common/error.h"

#include <cmath>
#include <cstring>
#include <numbers>

namespace q3 {
namespace {

constexpr std::string_view kMd3Ident = "IDP3";
constexpr std::int32_t kMd3Version = 15;
constexpr float kMd3Unit = 1.0f / 64; ///< game units
constexpr std::size_t kMd3Name = 64;

struct Md3Header {
    std::array<char, 4> ident;
    std::int32_t version;
    std::array<char, kMd3Name> name;
    std::int32_t flags, frames, tags, surfaces, skins, frameOffset, tagOffset, surfaceOffset, end;
};
struct Md3Surface {
    std::array<char, 4> ident;
    std::array<char, kMd3Name> name;
    std::int32_t flags, frames, shaders, verts, triangles, triangleOffset, shaderOffset, stOffset, vertOffset, end;
};
struct Md3Vert {
    std::array<std::int16_t, 3> xyz;
    std::uint8_t zenith, azimuth; ///< of the normal, 256 steps a turn
};
struct Md3Shader {
    std::array<char, kMd3Name> name;
    std::int32_t index;
};
static_assert(sizeof(Md3Header) == 108 && sizeof(Md3Surface) == 108 && sizeof(Md3Vert) == 8 && sizeof(Md3Shader) == 68);

/// Reads records; errors where they are outside the file.
class Md3File {
  public:
    explicit Md3File(std::span<const std::byte> file) : file_(file) {}

    template <typename Record> std::vector<Record> Read(std::int64_t offset, std::int64_t count) const {
        const auto size = std::int64_t(file_.size());
        if (offset < 0 || count < 0 || offset > size || count > (size - offset) / std::int64_t(sizeof(Record)))
            throw Error("{} records of {} bytes at {} are not inside the {} bytes of the file", count, sizeof(Record),
                        offset, size);
        std::vector<Record> records(static_cast<std::size_t>(count));
        if (count > 0)
            std::memcpy(records.data(), file_.data() + offset, sizeof(Record) * records.size());
        return records;
    }

  private:
    std::span<const std::byte> file_;
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

ModelMesh Md3MeshOf(const Md3File &file, std::int64_t at, const Md3Surface &surface, std::string_view modelName,
                    int frame) {
    ModelMesh mesh;
    if (surface.shaders > 0) {
        const auto shader = file.Read<Md3Shader>(at + surface.shaderOffset, 1).front();
        const std::string_view name(shader.name.data(), kMd3Name);
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
    const Md3File file(bytes);
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
