// GPL-2.0-or-later. What lighting needs to know of each draw surface.
#include "q3map2/light/surface_table.h"

#include "common/error.h"
#include "common/text.h"
#include "q3map2/light/light_patch.h"

#include <algorithm>
#include <array>
#include <map>
#include <optional>

namespace q3 {

namespace {

/// One block of a surface file.
struct SurfaceExtra {
    std::string shader;
    int parent = -1;
    int castShadows = 1;
    float longestCurve = 0;
};

struct SurfaceExtras {
    SurfaceExtra defaults;
    std::vector<std::optional<SurfaceExtra>> surfaces;
    const SurfaceExtra &At(std::size_t i) const { return surfaces[i] ? *surfaces[i] : defaults; }
};

/// Words of one line up to a comment.
std::vector<std::string_view> Words(std::string_view line) {
    line = line.substr(0, line.find("//"));
    std::vector<std::string_view> words;
    constexpr std::string_view kBlank = " \t\r";
    for (std::size_t at = line.find_first_not_of(kBlank); at != std::string_view::npos;
         at = line.find_first_not_of(kBlank, at)) {
        const std::size_t end = std::min(line.find_first_of(kBlank, at), line.size());
        words.push_back(line.substr(at, end - at));
        at = end;
    }
    return words;
}

void ReadKey(const std::vector<std::string_view> &words, SurfaceExtra &extra) {
    if (words.size() < 2)
        return;
    if (EqualNoCase(words[0], "shader"))
        extra.shader = std::string(words[1]);
    else if (EqualNoCase(words[0], "parent"))
        extra.parent = IntegerFromText(words[1]);
    else if (EqualNoCase(words[0], "castShadows"))
        extra.castShadows = IntegerFromText(words[1]);
    else if (EqualNoCase(words[0], "longestCurve"))
        extra.longestCurve = float(std::clamp(NumberFromText(words[1]), 0.0, 1e6));
}

SurfaceExtras ParseSurfaceExtras(std::string_view text, std::string_view name, std::size_t surfaceCount) {
    SurfaceExtras extras;
    extras.surfaces.resize(surfaceCount);
    SurfaceExtra *header = nullptr, *open = nullptr;
    int lineNumber = 0;
    const auto fail = [&](std::string_view what) { throw Error("{}:{}: {}", name, lineNumber, what); };
    while (!text.empty()) {
        const std::size_t end = std::min(text.find('\n'), text.size());
        const auto words = Words(text.substr(0, end));
        text.remove_prefix(std::min(end + 1, text.size()));
        ++lineNumber;
        if (words.empty())
            continue;
        if (open && words[0] == "}")
            open = header = nullptr;
        else if (open)
            ReadKey(words, *open);
        else if (header && words[0] == "{")
            open = header;
        else if (header)
            fail("expected {");
        else if (EqualNoCase(words[0], "default"))
            header = &extras.defaults;
        else {
            const int index = IntegerFromText(words[0]);
            if (words[0].find_first_not_of("0123456789") != std::string_view::npos ||
                std::size_t(index) >= surfaceCount)
                fail(fmt::format("\"{}\" is not one of the map's {} surfaces; does the file belong to this map?",
                                 words[0], surfaceCount));
            auto &extra = extras.surfaces[std::size_t(index)];
            if (!extra)
                extra = extras.defaults;
            header = &*extra;
        }
    }
    if (header)
        fail("the file ends inside a block");
    return extras;
}

struct ModelOwner {
    Vec3f origin;
    int castShadows = 0;
};

/// Owner of each inline model: the entity with "model" "*n".
std::vector<ModelOwner> ModelOwners(const Bsp &bsp, const std::vector<Entity> &entities) {
    std::vector<ModelOwner> owners(bsp.models.size());
    for (const Entity &entity : entities)
        for (const std::string_view key : {"model", "model2"}) {
            const std::string_view model = entity.Value(key);
            if (!model.starts_with('*'))
                continue;
            const int number = IntegerFromText(model.substr(1));
            if (number < 1 || std::size_t(number) >= owners.size())
                continue;
            owners[std::size_t(number)] = {entity.Vector({"origin"}).value_or(Vec3f{}),
                                           int(entity.Number({"_castShadows", "_cs"}))};
        }
    return owners;
}

/// Patches of one level-of-detail group share a box and are tessellated alike.
void DeriveLongestCurves(const Bsp &bsp, SurfaceTable &table) {
    std::map<std::array<Float3, 2>, float> groups;
    const auto group = [](const bspDrawSurface_t &s) { return std::array{s.lightmapVecs[0], s.lightmapVecs[1]}; };
    for (const bspDrawSurface_t &surface : bsp.drawSurfaces)
        if (surface.surfaceType == MST_PATCH) {
            float &longest = groups[group(surface)];
            longest = std::max(longest, LongestCurve(bsp, surface));
        }
    for (std::size_t i = 0; i < table.size(); ++i)
        if (bsp.drawSurfaces[i].surfaceType == MST_PATCH)
            table[i].longestCurve = groups[group(bsp.drawSurfaces[i])];
}

} // namespace

SurfaceTable MakeSurfaceTable(const Bsp &bsp, const std::vector<Entity> &entities, std::string_view srfText,
                              std::string_view srfName, ShaderLibrary &library, Log &log) {
    SurfaceTable table(bsp.drawSurfaces.size());
    const bool hasFile = !srfText.empty();
    const SurfaceExtras extras = ParseSurfaceExtras(srfText, srfName, table.size());
    for (std::size_t i = 0; i < table.size(); ++i) {
        const SurfaceExtra &extra = extras.At(i);
        const bspShader_t &record = bsp.shaders[std::size_t(bsp.drawSurfaces[i].shaderNum)];
        table[i].shader =
            &library.Get(extra.shader.empty() ? FieldName(record.shader) : std::string_view(extra.shader));
        table[i].castShadows = extra.castShadows;
        table[i].longestCurve = extra.longestCurve;
        table[i].skyBoxCopy = extra.parent >= 0;
    }
    if (!hasFile) {
        log.Verbose("{}: no surface file, its values are derived from the surfaces\n", srfName);
        DeriveLongestCurves(bsp, table);
    }
    const auto owners = ModelOwners(bsp, entities);
    for (std::size_t m = 1; m < bsp.models.size(); ++m)
        for (int k = 0; k < bsp.models[m].numBSPSurfaces; ++k) {
            SurfaceEntry &entry = table[std::size_t(bsp.models[m].firstBSPSurface + k)];
            entry.origin = owners[m].origin;
            if (!hasFile || owners[m].castShadows == 0)
                entry.castShadows = owners[m].castShadows;
        }
    return table;
}

} // namespace q3
