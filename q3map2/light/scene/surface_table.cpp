// GPL-2.0-or-later. Properties of draw surfaces that lighting needs beyond their .bsp records, and patches as meshes.
#include "q3map2/light/scene/surface_table.h"

#include "common/error.h"
#include "common/text/text.h"
#include "q3map2/bspfile/map_keys.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

namespace q3 {

// ---- Patches of a .bsp as meshes ----

Mesh TessellatePatch(const Bsp &bsp, const bspDrawSurface_t &surface, float longestCurve) {
    Mesh mesh{surface.patchWidth, surface.patchHeight, {}};
    for (int i = 0; i < surface.numVerts; ++i) {
        const bspDrawVert_t &v = bsp.drawVerts[std::size_t(surface.firstVert + i)];
        mesh.verts.push_back({Vec3f(v.xyz), Vec3f(v.normal), v.st});
    }
    return Tessellated(std::move(mesh), longestCurve);
}

float LargestHalvingMeasure(const Bsp &bsp, const bspDrawSurface_t &surface) {
    return LargestHalvingMeasure(surface.patchWidth, surface.patchHeight, bsp.drawVerts.data() + surface.firstVert);
}

// ---- Properties of draw surfaces that lighting needs beyond their .bsp records ----

namespace {

constexpr int kMaxSampleSize = 16384; ///< game units a luxel
/// Absurd numbers of a surface file are limited to this.
constexpr double kMaxNumber = 1e6;
/// Least cosine between all vertex normals of a patch and the axis that its lightmap is projected along.
constexpr float kAxisCone = 0.25f;
/// A component this much smaller than the largest may still be the major one: favors z, then x.
constexpr float kAxisSlack = 0.0001f;

/// One block of a surface file.
struct SurfaceExtra {
    std::string shader;
    int parent = -1, entity = 0;
    int castShadows = 1, receiveShadows = 1;
    int sampleSize = 16;
    Vec3f ambient, axis;
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

/// The value of the line "key ( x y z )"; missing numbers are 0.
Vec3f VectorFrom(const std::vector<std::string_view> &words) {
    Vec3f result;
    for (std::size_t i = 0; i < 3 && i + 2 < words.size(); ++i)
        result[i] = float(std::clamp(NumberFromText(words[i + 2]), -kMaxNumber, kMaxNumber));
    return result;
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
    else if (EqualNoCase(words[0], "receiveShadows"))
        extra.receiveShadows = IntegerFromText(words[1]);
    else if (EqualNoCase(words[0], "entity"))
        extra.entity = IntegerFromText(words[1]);
    else if (EqualNoCase(words[0], "sampleSize"))
        extra.sampleSize = std::clamp(IntegerFromText(words[1]), 0, kMaxSampleSize);
    else if (EqualNoCase(words[0], "ambientColor"))
        extra.ambient = VectorFrom(words);
    else if (EqualNoCase(words[0], "lightmapAxis"))
        extra.axis = VectorFrom(words);
    else if (EqualNoCase(words[0], "longestCurve"))
        extra.longestCurve = float(std::clamp(NumberFromText(words[1]), 0.0, kMaxNumber));
}

SurfaceExtras ParseSurfaceExtras(std::string_view text, std::string_view name, std::size_t surfaceCount) {
    SurfaceExtras extras;
    extras.surfaces.resize(surfaceCount);
    SurfaceExtra *header = nullptr, *open = nullptr; // block whose first line was read; the same after its {
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

/// Keys of an entity that concern the surfaces of its model.
struct ModelOwner {
    Vec3f origin;
    int entity = 0;
    int castShadows = 0, receiveShadows = 1;
    int sampleSize = 0;      // 0: unset
    float lightmapScale = 0; // 0: unset
};

/// castShadows: unless the entity has that key.
ModelOwner OwnerFrom(const std::vector<Entity> &entities, std::size_t number, int castShadows) {
    const Entity &entity = entities[number];
    return {number == 0 ? Vec3f{} : keys::kOrigin.Vector(entity).value_or(Vec3f{}),
            int(number),
            keys::kCastShadows.Integer(entity, castShadows),
            keys::kReceiveShadows.Integer(entity),
            keys::kSampleSize.Integer(entity),
            float(std::min(keys::kLightmapScale.Number(entity, 0), double(kMaxSampleSize)))};
}

/// Owner of each model: the first entity, and for inline models the entity with "model" "*n".
std::vector<ModelOwner> ModelOwners(const Bsp &bsp, const std::vector<Entity> &entities) {
    std::vector<ModelOwner> owners(bsp.models.size());
    if (!owners.empty()) {
        owners[0].castShadows = 1;
        if (!entities.empty())
            owners[0] = OwnerFrom(entities, 0, 1);
    }
    for (std::size_t i = 0; i < entities.size(); ++i)
        for (const std::string_view key : {"model", "model2"}) {
            const std::string_view model = entities[i].Value(key);
            if (!model.starts_with('*'))
                continue;
            const int number = IntegerFromText(model.substr(1));
            if (number >= 1 && std::size_t(number) < owners.size())
                owners[std::size_t(number)] = OwnerFrom(entities, i, 0);
        }
    return owners;
}

int DerivedSampleSize(const bspDrawSurface_t &surface, const ShaderInfo &shader, const ModelOwner &owner,
                      const SurfaceDefaults &defaults) {
    if (defaults.noLightmaps || (shader.compileFlags & C_VERTEXLIT) != 0 ||
        (surface.surfaceType != MST_PLANAR && surface.surfaceType != MST_PATCH))
        return 0;
    int size = shader.lightmap.sampleSize > 0 ? shader.lightmap.sampleSize
               : owner.sampleSize > 0         ? owner.sampleSize
                                              : defaults.sampleSize;
    if (owner.lightmapScale > 0)
        size = int(std::min(float(size) * owner.lightmapScale, float(kMaxSampleSize)));
    return std::clamp(size, std::clamp(defaults.minSampleSize, 1, kMaxSampleSize), kMaxSampleSize);
}

Vec3f DerivedAxis(const Bsp &bsp, const bspDrawSurface_t &surface, const ShaderInfo &shader) {
    if (shader.lightmap.axis != Vec3f{})
        return shader.lightmap.axis;
    if (const Vec3f normal(surface.lightmapVecs[2]); normal != Vec3f{})
        return MajorAxis(normal);
    const auto normalOf = [&](int i) { return Vec3f(bsp.drawVerts[std::size_t(surface.firstVert + i)].normal); };
    if (surface.surfaceType != MST_PATCH) {
        Vec3f sum;
        for (int i = 0; i < surface.numVerts; ++i)
            sum += normalOf(i);
        return MajorAxis(sum);
    }
    constexpr std::array<Vec3f, 6> kAxes{{{0, 0, -1}, {0, 0, 1}, {-1, 0, 0}, {1, 0, 0}, {0, -1, 0}, {0, 1, 0}}};
    for (const Vec3f &axis : kAxes) {
        bool withinCone = true;
        for (int i = 0; i < surface.numVerts && withinCone; ++i)
            withinCone = Dot(normalOf(i), axis) >= kAxisCone;
        if (withinCone)
            return axis;
    }
    return {};
}

/// Patches of one level-of-detail group share a box and are tessellated alike.
void DeriveLongestCurves(const Bsp &bsp, SurfaceTable &table) {
    std::map<std::array<Float3, 2>, float> groups;
    const auto group = [](const bspDrawSurface_t &s) { return std::array{s.lightmapVecs[0], s.lightmapVecs[1]}; };
    for (const bspDrawSurface_t &surface : bsp.drawSurfaces)
        if (surface.surfaceType == MST_PATCH) {
            float &longest = groups[group(surface)];
            longest = std::max(longest, LargestHalvingMeasure(bsp, surface));
        }
    for (std::size_t i = 0; i < table.size(); ++i)
        if (bsp.drawSurfaces[i].surfaceType == MST_PATCH)
            table[i].longestCurve = groups[group(bsp.drawSurfaces[i])];
}

void ApplyFile(const SurfaceExtras &extras, SurfaceTable &table) {
    for (std::size_t i = 0; i < table.size(); ++i) {
        const SurfaceExtra &extra = extras.At(i);
        SurfaceEntry &entry = table[i];
        entry.castShadows = extra.castShadows;
        entry.receiveShadows = extra.receiveShadows;
        entry.entity = extra.entity;
        entry.sampleSize = extra.sampleSize;
        // Zero also stands for a missing key: the world's ambient light.
        entry.ambient = extra.ambient == Vec3f{} ? extras.defaults.ambient : extra.ambient;
        entry.axis = extra.axis;
        entry.longestCurve = extra.longestCurve;
        entry.parent = std::size_t(extra.parent) < table.size() && extra.parent >= 0 ? extra.parent : -1;
        entry.skyBoxCopy = extra.parent >= 0;
    }
}

void Derive(const Bsp &bsp, const ModelOwner &owner, const SurfaceDefaults &defaults, std::size_t surface,
            SurfaceTable &table) {
    SurfaceEntry &entry = table[surface];
    entry.castShadows = owner.castShadows;
    entry.receiveShadows = owner.receiveShadows;
    entry.entity = owner.entity;
    entry.ambient = defaults.ambient;
    entry.sampleSize = DerivedSampleSize(bsp.drawSurfaces[surface], *entry.shader, owner, defaults);
    if (entry.sampleSize > 0)
        entry.axis = DerivedAxis(bsp, bsp.drawSurfaces[surface], *entry.shader);
}

} // namespace

Vec3f MajorAxis(const Vec3f &normal) {
    const Vec3f size{std::abs(normal.x), std::abs(normal.y), std::abs(normal.z)};
    const auto sign = [](float c) { return c < 0 ? -1.0f : 1.0f; };
    if (size.z > size.x - kAxisSlack && size.z > size.y - kAxisSlack)
        return {0, 0, sign(normal.z)};
    if (size.x > size.y - kAxisSlack && size.x > size.z - kAxisSlack)
        return {sign(normal.x), 0, 0};
    return {0, sign(normal.y), 0};
}

namespace {

/// The normal map of a shader, with a warning if it is missing.
NormalImage NormalsOf(const ShaderInfo &shader, ShaderLibrary &library, Log &log) {
    const bool ssbump = shader.lightmap.normalImage.empty();
    const std::string &name = ssbump ? shader.lightmap.ssbumpImage : shader.lightmap.normalImage;
    if (name.empty())
        return {nullptr, ssbump};
    auto image = library.LoadImage(name);
    if (!image)
        log.Warn("normal map",
                 "{}: {} {}: no image of that name can be read, its surfaces are lit without a normal map", shader.name,
                 ssbump ? "q3map_ssbumpImage" : "q3map_normalImage", name);
    return {std::move(image), ssbump};
}

/// The macro texture of a shader, or `otherwise` if it names none; null: none. A missing one of the shader is a
/// warning. Errors: a missing `otherwise`.
std::shared_ptr<const Image> MacroImageOf(const ShaderInfo &shader, const std::string &otherwise,
                                          ShaderLibrary &library, Log &log) {
    const std::string &shaderImage = shader.lightmap.macroImage;
    if (EqualNoCase(shaderImage, "none") || (shaderImage.empty() && otherwise.empty()))
        return nullptr;
    auto image = library.LoadImage(shaderImage.empty() ? otherwise : shaderImage);
    if (!image && shaderImage.empty())
        throw Error("macro texture {}: no such image among the game's files", otherwise);
    if (!image)
        log.Warn("macro texture", "{}: q3map_macroTexture {}: no such image", shader.name, shaderImage);
    return image;
}

/// The images of a shader that light on its surfaces needs.
struct ShaderImages {
    NormalImage normals;
    std::shared_ptr<const Image> macro;
};

} // namespace

SurfaceTable MakeSurfaceTable(const Bsp &bsp, const std::vector<Entity> &entities, std::string_view srfText,
                              std::string_view srfName, ShaderLibrary &library, Log &log,
                              const SurfaceDefaults &defaults) {
    SurfaceTable table(bsp.drawSurfaces.size());
    std::map<const ShaderInfo *, ShaderImages> imagesOf;
    const bool hasFile = !srfText.empty();
    const SurfaceExtras extras = ParseSurfaceExtras(srfText, srfName, table.size());
    for (std::size_t i = 0; i < table.size(); ++i) {
        const std::string &name = extras.At(i).shader;
        const bspShader_t &record = bsp.shaders[std::size_t(bsp.drawSurfaces[i].shaderNum)];
        table[i].shader = &library.Get(name.empty() ? FieldName(record.shader) : std::string_view(name));
        const auto [images, isNew] = imagesOf.try_emplace(table[i].shader);
        if (isNew) // so that a missing one is one warning
            images->second = {NormalsOf(*table[i].shader, library, log),
                              MacroImageOf(*table[i].shader, defaults.macroTexture, library, log)};
        table[i].normals = images->second.normals;
        table[i].macroImage = images->second.macro;
        table[i].normalMapped =
            defaults.normalMaps == NormalMaps::All ||
            (defaults.normalMaps == NormalMaps::OfShaders && library.HasNormalMap(table[i].shader->name));
    }
    if (hasFile)
        ApplyFile(extras, table);
    else {
        log.Verbose("{}: no surface file, its values are derived from the surfaces\n", srfName);
        DeriveLongestCurves(bsp, table);
    }
    const auto owners = ModelOwners(bsp, entities);
    for (std::size_t m = 0; m < bsp.models.size(); ++m)
        for (int k = 0; k < bsp.models[m].numBSPSurfaces; ++k) {
            const auto number = std::size_t(bsp.models[m].firstBSPSurface + k);
            table[number].origin = owners[m].origin;
            if (!hasFile)
                Derive(bsp, owners[m], defaults, number, table);
            else if (m > 0 && owners[m].castShadows == 0)
                table[number].castShadows = 0;
        }
    return table;
}

} // namespace q3
