// GPL-2.0-or-later. Which lightmap image a surface shows.
#include "q3map2/convert/mesh/mesh_lightmaps.h"

#include "common/files/files.h"
#include "common/text/text_scan.h"

#include <fmt/format.h>

#include <algorithm>
#include <system_error>

namespace q3 {

namespace {

constexpr std::string_view kImagePrefix = "/lm_", kImageExtension = ".tga";
constexpr int kMaxExternalImages = 100000;

/// 12 from "maps/x/lm_0012.tga".
std::optional<int> ExternalImageNumber(std::string_view path) {
    const std::size_t at = path.rfind('/');
    if (at == std::string_view::npos || !StartsWithNoCase(path.substr(at), kImagePrefix))
        return std::nullopt;
    const std::string_view rest = path.substr(at + kImagePrefix.size());
    const std::size_t digits = std::min(rest.find_first_not_of("0123456789"), rest.size());
    if (digits == 0 || !EqualNoCase(rest.substr(digits), kImageExtension))
        return std::nullopt;
    return WholeInteger(rest.substr(0, digits));
}

} // namespace

std::string LightmapImage::Name() const {
    return fmt::format("{}_{:04}", external ? "lm" : "lightmap", number);
}

MeshLightmaps::MeshLightmaps(const Bsp &bsp, const std::filesystem::path &bspPath, const std::filesystem::path &script)
    : internal_(int(bsp.lightmaps.size() / kLightmapPageBytes)) {
    const auto folder = bspPath.parent_path() / bspPath.stem();
    std::error_code ignored;
    while (external_ < kMaxExternalImages &&
           std::filesystem::exists(folder / (LightmapImage{external_, true}.Name() + std::string(kImageExtension)),
                                   ignored))
        ++external_;
    if (std::filesystem::exists(script, ignored))
        ReadScript(script);
}

/// Of several lightmap images in a shader the first counts: later ones are of light styles.
void MeshLightmaps::ReadScript(const std::filesystem::path &script) {
    TextScanner scanner(ReadTextFile(script), script.string());
    int depth = 0;
    std::string shader;
    for (std::string word; scanner.Next(word);) {
        if (word == "{")
            ++depth;
        else if (word == "}")
            depth = std::max(depth - 1, 0);
        else if (depth == 0)
            shader = LowerCase(word);
        else if (EqualNoCase(word, "map") && scanner.NextOnLine(word))
            if (const auto number = ExternalImageNumber(word))
                byShader_.try_emplace(shader, *number);
    }
}

std::optional<LightmapImage> MeshLightmaps::Of(const bspDrawSurface_t &surface, std::string_view shader) const {
    if (surface.lightmapNum >= 0)
        return LightmapImage{surface.lightmapNum, internal_ == 0};
    const auto found = byShader_.find(LowerCase(shader));
    if (found == byShader_.end())
        return std::nullopt;
    return LightmapImage{found->second, true};
}

} // namespace q3
