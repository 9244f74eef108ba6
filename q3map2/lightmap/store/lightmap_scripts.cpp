// GPL-2.0-or-later. Shaders generated for surfaces with several light styles or with a page outside the file.
#include "q3map2/lightmap/store/lightmap_scripts.h"

#include "common/text/text.h"
#include "q3map2/bspfile/bsp_records.h"
#include "q3map2/bspfile/entity_key.h"
#include "q3map2/light/sources/light_styles.h"

#include <algorithm>
#include <cctype>
#include <map>

#include <glib.h>

namespace q3 {

namespace {

constexpr std::size_t kChecksumDigits = 32;
/// Largest numbers of images in an animMap and of stages in a shader that engines take.
constexpr std::size_t kMaxFrames = 8, kMaxStages = 8;
/// rgbGen of styles that no key describes.
constexpr std::string_view kDefaultWave = "wave noise 0.5 1 0 5.37";

/// Offset of the first occurrence of `word` as a whole word, ignoring case; npos: none.
std::size_t FindWord(std::string_view text, std::string_view word) {
    const auto isWordPart = [](char c) {
        return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '$';
    };
    for (std::size_t at = 0; at + word.size() <= text.size(); ++at) {
        const std::size_t end = at + word.size();
        if (EqualNoCase(text.substr(at, word.size()), word) && (at == 0 || !isWordPart(text[at - 1])) &&
            (end == text.size() || !isWordPart(text[end])))
            return at;
    }
    return std::string_view::npos;
}

std::string Replaced(std::string_view text, std::size_t at, std::size_t length, std::string_view with) {
    return fmt::format("{}{}{}", text.substr(0, at), with, text.substr(at + length));
}

/// Script of a shader that has none: the lightmap, multiplied by the image.
std::string DefaultText(const ShaderInfo &shader) {
    constexpr std::string_view kLight = "\t{{\n\t\tmap $lightmap\n\t\trgbGen identity\n{}\t}}\n";
    constexpr std::string_view kImage =
        "\t{{\n\t\tmap {}.tga\n\t\tblendFunc GL_DST_COLOR GL_ZERO\n\t\trgbGen identity\n{}\t}}\n";
    constexpr std::string_view kEqual = "\t\tdepthFunc equal\n";
    if (!shader.implicitMask.empty()) {
        // Depth of the masked image first, so that later stages are drawn only there.
        const std::string mask = fmt::format("\tcull none\n\t{{\n\t\tmap {}.tga\n\t\talphaFunc GE128\n\t\tdepthWrite\n"
                                             "\t\trgbGen const ( 0 0 0 )\n\t}}\n",
                                             shader.implicitMask);
        return "{\n" + mask + fmt::format(fmt::runtime(kLight), kEqual) + "\tq3map_styleMarker2\n" +
               fmt::format(fmt::runtime(kImage), shader.implicitMask, kEqual) + "}\n";
    }
    const std::string &image = shader.implicitMap.empty() ? shader.name : shader.implicitMap;
    return "{\n" + fmt::format(fmt::runtime(kLight), "") + "\tq3map_styleMarker\n" +
           fmt::format(fmt::runtime(kImage), image, "") + "}\n";
}

std::string TextOf(const ShaderInfo &shader) {
    return shader.scriptText.empty() ? DefaultText(shader) : shader.scriptText;
}

/// The rgbGen of a stage: as the world says, else what its pattern or its switch asks for.
std::string RgbGenOf(int style, const Entity &world) {
    if (const std::string key = fmt::format("_style{}rgbgen", style); world.Has(key))
        return std::string(world.Value(key));
    if (world.Has(PatternKey(style)))
        return FitWave(world.Value(PatternKey(style))).ShaderText();
    if (!world.Has(SwitchKey(style)))
        return std::string(kDefaultWave);
    return world.Flag(DarkKey(style)) ? "const ( 0 0 0 )" : "const ( 1 1 1 )";
}

std::string StageText(const StyleStage &stage, bool depthEqual, const Entity &world, std::string_view mapName) {
    const std::string alphaKey = fmt::format("_style{}alphagen", stage.style);
    std::string text = "{\n";
    const auto line = [&](std::string_view words) { text += fmt::format("\t\t{}\n", words); };
    line(stage.file < 0 ? "map $lightmap" : "map " + PagePath(mapName, stage.file));
    line("blendFunc GL_SRC_ALPHA GL_ONE");
    if (depthEqual)
        line("depthFunc equal");
    line("rgbGen " + RgbGenOf(stage.style, world));
    if (world.Has(alphaKey))
        line(fmt::format("alphaGen {}", world.Value(alphaKey)));
    line("tcGen lightmap");
    if (stage.offset[0] != 0 || stage.offset[1] != 0)
        line(fmt::format("tcMod transform 1 0 0 1 {:.5f} {:.5f}", stage.offset[0], stage.offset[1]));
    return text + "\t}";
}

/// Path of a file or shader of the map, as the game names it.
std::string MapPath(std::string_view mapName, std::string_view name) {
    return fmt::format("maps/{}/{}", mapName, name);
}

/// Mipmap hints are surfaces that are never drawn: their shaders name pages under `nomipmaps`, so that engines load
/// these without mipmaps. Their shaders are named by this and a number. Long names of maps are cut, so that shader
/// records hold it.
std::string HintPrefix(std::string_view mapName) {
    constexpr std::size_t kRest = std::string_view("maps//nomipmaps000").size();
    return MapPath(mapName.substr(0, kMaxShaderName - kRest), "nomipmaps");
}

/// Names of generated shaders begin with this; the checksum follows.
std::string GeneratedPrefix(std::string_view mapName) {
    return fmt::format("{}/", mapName.substr(0, kMaxShaderName - kChecksumDigits - 1));
}

/// Number of mipmap hints at the start of the draw surfaces.
std::size_t CountHints(std::string_view mapName, const Bsp &bsp) {
    const std::string prefix = HintPrefix(mapName);
    std::size_t count = 0;
    while (count < bsp.drawSurfaces.size()) {
        const bspDrawSurface_t &surface = bsp.drawSurfaces[count];
        const std::string_view name = FieldName(bsp.shaders[std::size_t(surface.shaderNum)].shader);
        if (surface.surfaceType != MST_FLARE || surface.numVerts != 0 || !StartsWithNoCase(name, prefix))
            break;
        ++count;
    }
    return count;
}

void MoveSurfaceNumbers(Bsp &bsp, int by) {
    for (std::int32_t &surface : bsp.leafSurfaces)
        surface += by;
    for (bspModel_t &model : bsp.models)
        model.firstBSPSurface += by;
    for (bspBrushSide_t &side : bsp.brushSides)
        side.surfaceNum += side.surfaceNum >= 0 ? by : 0;
}

} // namespace

std::string PagePath(std::string_view mapName, int file) {
    return MapPath(mapName, PageImageName(file) + ".tga");
}

std::string StyledText(const ShaderInfo &shader, std::span<const StyleStage> stages, const Entity &world,
                       std::string_view mapName) {
    const std::string text = TextOf(shader);
    std::string_view marker = "q3map_styleMarker2";
    std::size_t at = FindWord(text, marker);
    const bool depthEqual = at != std::string::npos; // the marker of masked shaders
    if (!depthEqual) {
        marker = "q3map_styleMarker";
        at = FindWord(text, marker);
    }
    if (at == std::string::npos)
        return {};
    std::string stageTexts;
    for (const StyleStage &stage : stages)
        stageTexts += (stageTexts.empty() ? "" : "\n\t") + StageText(stage, depthEqual, world, mapName);
    return Replaced(text, at, marker.size(), stageTexts);
}

std::string ImageText(const ShaderInfo &shader, std::string text, int file, std::string_view mapName) {
    if (text.empty()) {
        text = TextOf(shader);
        for (const std::string_view marker : {"\tq3map_styleMarker\n", "\tq3map_styleMarker2\n"})
            if (const std::size_t line = text.find(marker); line != std::string::npos)
                text.erase(line, marker.size());
    }
    constexpr std::string_view kLightmap = "$lightmap";
    const std::size_t at = FindWord(text, kLightmap);
    if (at == std::string::npos)
        return {};
    return Replaced(text, at, kLightmap.size(), PagePath(mapName, file) + "\n\t\ttcGen lightmap");
}

std::string WithBasisMaps(std::string text, std::string_view mapName, int file, bool rescaled) {
    std::string line = "\n\tq3map_rnmMaps";
    for (std::size_t basis = 0; basis < DirectionalChannels::kBasis; ++basis)
        line += " " + MapPath(mapName, BasisImageName(file, basis));
    line += rescaled ? " rescaled" : " raw";
    return text.insert(text.find('{') + 1, line);
}

std::string ShaderNameFor(std::string_view text, std::string_view mapName) {
    gchar *digits = g_compute_checksum_for_string(G_CHECKSUM_MD5, text.data(), gssize(text.size()));
    std::string checksum(digits);
    g_free(digits);
    for (char &c : checksum)
        c = char(std::toupper(static_cast<unsigned char>(c)));
    return GeneratedPrefix(mapName) + checksum;
}

bool IsGeneratedName(std::string_view shader, std::string_view mapName) {
    const std::string prefix = GeneratedPrefix(mapName);
    return StartsWithNoCase(shader, prefix) && shader.size() == prefix.size() + kChecksumDigits &&
           std::all_of(shader.begin() + std::ptrdiff_t(prefix.size()), shader.end(),
                       [](char c) { return std::isxdigit(static_cast<unsigned char>(c)) != 0; });
}

int ShaderNumber(Bsp &bsp, std::string_view name, std::uint32_t surfaceFlags, std::uint32_t contentFlags) {
    for (std::size_t i = 0; i < bsp.shaders.size(); ++i)
        if (const bspShader_t &shader = bsp.shaders[i]; EqualNoCase(FieldName(shader.shader), name) &&
                                                        shader.surfaceFlags == surfaceFlags &&
                                                        shader.contentFlags == contentFlags)
            return int(i);
    bspShader_t shader{{}, surfaceFlags, contentFlags};
    std::copy_n(name.begin(), std::min(name.size(), kMaxShaderName), shader.shader.begin());
    bsp.shaders.push_back(shader);
    return int(bsp.shaders.size()) - 1;
}

void RemoveMipmapHints(std::string_view mapName, Bsp &bsp) {
    const std::size_t count = CountHints(mapName, bsp);
    const auto isHint = [&](int surface) { return surface >= 0 && std::size_t(surface) < count; };
    // They stay if another tool has put them into a model or a leaf.
    for (const bspModel_t &model : bsp.models)
        if (model.numBSPSurfaces > 0 && isHint(model.firstBSPSurface))
            return;
    if (count == 0 || std::any_of(bsp.leafSurfaces.begin(), bsp.leafSurfaces.end(), isHint))
        return;
    bsp.drawSurfaces.erase(bsp.drawSurfaces.begin(), bsp.drawSurfaces.begin() + std::ptrdiff_t(count));
    for (bspModel_t &model : bsp.models)
        model.firstBSPSurface = std::max(model.firstBSPSurface, std::int32_t(count));
    MoveSurfaceNumbers(bsp, -int(count));
}

namespace {

/// Adds the mipmap hints that FinishForFile describes.
void AddMipmapHints(std::string_view mapName, StoredLightmaps &stored, Bsp &bsp) {
    std::vector<int> files;
    for (const LightmapPage &page : stored.pages) {
        const std::string path = PagePath(mapName, page.file);
        const auto names = [&](const auto &script) { return script.text.find(path) != std::string::npos; };
        if (page.needsImage && std::any_of(stored.scripts.begin(), stored.scripts.end(), names))
            files.push_back(page.file);
    }
    std::vector<bspDrawSurface_t> hints;
    constexpr std::string_view kStage = "\t{\n\t\tanimMap .0042"; // frames per second; the hint is never drawn
    for (std::size_t at = 0; at < files.size(); at += kMaxFrames * kMaxStages) {
        std::string text = "{\n\tnomipmaps\n";
        for (std::size_t i = at; i < std::min(files.size(), at + kMaxFrames * kMaxStages); ++i) {
            if ((i - at) % kMaxFrames == 0)
                text += fmt::format("{}{}", i == at ? "" : "\n\t}\n", kStage);
            text += " " + PagePath(mapName, files[i]);
        }
        text += "\n\t}\n}\n";
        const std::string name = fmt::format("{}{}", HintPrefix(mapName), hints.size());
        stored.scripts.push_back({name, text});
        bspDrawSurface_t surface{};
        surface.shaderNum = ShaderNumber(bsp, name, 0, 0);
        surface.fogNum = -1;
        surface.surfaceType = MST_FLARE;
        hints.push_back(surface);
    }
    bsp.drawSurfaces.insert(bsp.drawSurfaces.begin(), hints.begin(), hints.end());
    MoveSurfaceNumbers(bsp, int(hints.size()));
    for (LightmassPlace &place : stored.lightmass.places)
        for (int &surface : place.surfaces)
            surface += int(hints.size());
}

} // namespace

void FinishForFile(const LightmapOptions &options, std::string_view mapName, StoredLightmaps &stored, Bsp &bsp) {
    // With -external engines load the pages themselves.
    if (!options.external)
        AddMipmapHints(mapName, stored, bsp);
    if (!options.triangleSoup)
        return;
    for (bspDrawSurface_t &surface : bsp.drawSurfaces)
        if (surface.surfaceType == MST_PLANAR) {
            surface.surfaceType = MST_TRIANGLE_SOUP;
            surface.lightmapNum.fill(kLightmapByVertex);
        }
}

} // namespace q3
