// GPL-2.0-or-later. Light of static props as files beside the map.
#include "q3map2/lightmap/props/prop_files.h"

#include "common/files/files.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace q3 {

namespace {

constexpr std::int32_t kVhvVersion = 2;
constexpr std::int32_t kVhvColors = 4; ///< vertices have a color of that many bytes; the flag of that too
constexpr std::size_t kVhvAlignment = 512;
constexpr std::size_t kVhvHead = 40, kVhvMesh = 28;
/// Light 1 is half of the range.
constexpr double kVhvGamma = 2.2, kVhvFull = 127.5;
constexpr std::string_view kPropLightFile = "proplight.raw";

void AppendInt(std::int32_t value, std::vector<std::byte> &bytes) {
    const auto *from = reinterpret_cast<const std::byte *>(&value);
    bytes.insert(bytes.end(), from, from + sizeof value);
}

std::byte VhvByte(float light) {
    const double byte = kVhvFull * std::pow(std::max(double(light), 0.0), 1 / kVhvGamma);
    return std::byte(std::lround(std::min(byte, 255.0)));
}

} // namespace

std::vector<std::byte> EncodeVhv(const PropVertexLight &light) {
    std::int32_t vertices = 0;
    for (const auto &mesh : light.meshes)
        vertices += std::int32_t(mesh.size());
    std::vector<std::byte> file;
    const auto zeros = [&](int count) {
        for (int i = 0; i < count; ++i)
            AppendInt(0, file);
    };
    const std::size_t heads = kVhvHead + kVhvMesh * light.meshes.size();
    std::size_t at = (heads + kVhvAlignment - 1) / kVhvAlignment * kVhvAlignment;
    for (const std::int32_t value : {kVhvVersion, std::int32_t(light.modelCrc), kVhvColors, kVhvColors, vertices,
                                     std::int32_t(light.meshes.size())})
        AppendInt(value, file);
    zeros(4);
    const std::size_t data = at;
    for (const auto &mesh : light.meshes) {
        for (const std::int32_t value : {0, std::int32_t(mesh.size()), std::int32_t(at)})
            AppendInt(value, file);
        zeros(4);
        at += 4 * mesh.size();
    }
    file.resize(data);
    for (const auto &mesh : light.meshes)
        for (const Vec3f &color : mesh)
            for (const std::byte byte : {VhvByte(color.z), VhvByte(color.y), VhvByte(color.x), std::byte(255)})
                file.push_back(byte);
    return file;
}

void WritePropFiles(const std::filesystem::path &folder, const std::vector<PropVertexLight> &light, Log &log) {
    if (light.empty())
        return;
    MakeFolder(folder);
    std::vector<std::byte> raw;
    for (std::size_t i = 0; i < light.size(); ++i) {
        ReplaceFile(folder / fmt::format("sp_{}.vhv", i), EncodeVhv(light[i]));
        for (const auto &mesh : light[i].meshes)
            for (const Vec3f &color : mesh)
                for (const float channel : {color.x, color.y, color.z}) {
                    const auto *from = reinterpret_cast<const std::byte *>(&channel);
                    raw.insert(raw.end(), from, from + sizeof channel);
                }
    }
    ReplaceFile(folder / kPropLightFile, raw);
    log.Print("Wrote {} files of prop light to {}\n", light.size() + 1, folder.string());
}

} // namespace q3
