// GPL-2.0-or-later. The drawn triangles of a map with their materials and lightmap images, ready to be written as a
// model file.
#include "q3map2/convert/mesh/mesh_scene.h"

#include "common/files/files.h"
#include "common/text/text.h"
#include "common/text/text_scan.h"
#include "q3map2/bspfile/entities.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <system_error>

namespace q3 {

// ---- Which lightmap image a surface shows ----

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
    return fmt::format("{}_{:04}", place == Place::External ? "lm" : "lightmap", number);
}

MeshLightmaps::MeshLightmaps(const Bsp &bsp, const std::filesystem::path &bspPath, const std::filesystem::path &script)
    : internal_(int(bsp.lightmaps.size() / kLightmapPageBytes)) {
    const auto folder = bspPath.parent_path() / bspPath.stem();
    std::error_code ignored;
    while (external_ < kMaxExternalImages &&
           std::filesystem::exists(folder / (LightmapImage{external_, LightmapImage::Place::External}.Name() +
                                             std::string(kImageExtension)),
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
        return LightmapImage{surface.lightmapNum,
                             internal_ == 0 ? LightmapImage::Place::External : LightmapImage::Place::InBsp};
    const auto found = byShader_.find(LowerCase(shader));
    if (found == byShader_.end())
        return std::nullopt;
    return LightmapImage{found->second, LightmapImage::Place::External};
}

// ---- The drawn triangles of a map with their materials ----

namespace {

constexpr std::string_view kNoLightmap = "no_lightmap";

/// The value with -0 and what is not finite as 0, for text.
float PrintableNumber(float value) {
    return std::isfinite(value) ? value + 0.0f : 0.0f;
}

/// Number of an inline model from "*12".
std::optional<int> InlineModel(std::string_view name) {
    return name.starts_with('*') ? WholeInteger(name.substr(1)) : std::nullopt;
}

class MeshSceneBuilder {
  public:
    MeshSceneBuilder(const Bsp &bsp, ShaderLibrary &library, const MeshExportOptions &options,
                     const std::filesystem::path &bspPath, Log &log)
        : bsp_(bsp), library_(library), options_(options), bspPath_(bspPath), log_(log) {}

    MeshScene Build() {
        scene_.name = bspPath_.stem().string();
        for (const bspShader_t &shader : bsp_.shaders)
            library_.SetDefaultFlags(FieldName(shader.shader), shader.surfaceFlags, shader.contentFlags);
        if (WantsLightmaps())
            FindLightmaps();
        else
            for (const bspShader_t &shader : bsp_.shaders)
                AddShaderMaterial(shader);
        AddModel(0, {});
        for (const Entity &entity : ParseEntities(bsp_.entities, bspPath_.string()))
            AddEntity(entity);
        if (withoutTriangles_ > 0)
            log_.Print("{:9} curves and flares left out: they have no triangles (curves of maps compiled with "
                       "-patchmeta do)\n",
                       withoutTriangles_);
        return std::move(scene_);
    }

  private:
    bool WantsLightmaps() const { return options_.lightmapsAsTexCoord || options_.deluxemapsAsTexCoord; }

    void AddShaderMaterial(const bspShader_t &record) {
        const std::string_view name = FieldName(record.shader);
        MeshMaterial &material = scene_.materials.emplace_back();
        material.name = MeshName(name);
        material.color = library_.GetWithImage(name).color;
        material.isShaderName = options_.shadersAsBitmap;
        if (options_.shadersAsBitmap) {
            material.image = material.name;
        } else {
            const std::string file = library_.ImageFile(name);
            material.image = "../" + (file.empty() ? material.name + ".tga" : MeshName(file));
        }
    }

    /// Materials of all lightmaps of the map, used or not.
    void FindLightmaps() {
        const auto script =
            bspPath_.parent_path().parent_path() / options_.shaderFolder / fmt::format("q3map2_{}.shader", scene_.name);
        lightmaps_.emplace(bsp_, bspPath_, script);
        for (int i = 0; i < lightmaps_->InternalCount(); ++i)
            LightmapMaterial({i, LightmapImage::Place::InBsp});
        for (int i = 0; i < lightmaps_->ExternalCount(); ++i)
            LightmapMaterial({i, LightmapImage::Place::External});
        if (lightmaps_->InternalCount() > 0)
            log_.Print("{:9} lightmaps in the file: -export writes their images {}/lightmap_NNNN.tga\n",
                       lightmaps_->InternalCount(), scene_.name);
    }

    /// Number of the material of that name, which is added if it is new.
    std::size_t MaterialOf(const std::string &name, const std::string &image) {
        const auto [slot, isNew] = lightmapMaterials_.try_emplace(name, scene_.materials.size());
        if (isNew)
            scene_.materials.push_back({.name = name, .image = image});
        return slot->second;
    }

    std::size_t LightmapMaterial(const LightmapImage &image) {
        const std::string path = fmt::format("{}/{}.tga", MeshName(scene_.name), image.Name());
        return MaterialOf(image.Name(), options_.shadersAsBitmap ? "maps/" + path : path);
    }

    std::size_t LightmapMaterialOf(const bspDrawSurface_t &surface) {
        auto image = lightmaps_->Of(surface, FieldName(bsp_.shaders[std::size_t(surface.shaderNum)].shader));
        if (!image)
            return MaterialOf(std::string(kNoLightmap), "");
        if (options_.deluxemapsAsTexCoord)
            ++image->number;
        if (!lightmaps_->Exists(*image))
            log_.Warn("lightmap out of range",
                      "{}: the map has {} lightmaps and {} external ones; exported all the same", image->Name(),
                      lightmaps_->InternalCount(), lightmaps_->ExternalCount());
        return LightmapMaterial(*image);
    }

    void AddEntity(const Entity &entity) {
        const std::string_view name = entity.Value("model");
        if (!name.starts_with('*'))
            return;
        const auto model = InlineModel(name);
        if (!model || *model < 1 || std::size_t(*model) >= bsp_.models.size()) {
            log_.Warn("entity without model", "{} with model {}: the map has models *1 to *{}; it is left out",
                      entity.ClassName(), name, bsp_.models.size() - 1);
            return;
        }
        AddModel(std::size_t(*model), entity.Vector({"origin"}).value_or(Vec3f{}));
    }

    void AddModel(std::size_t number, const Vec3f &origin) {
        const bspModel_t &model = bsp_.models[number];
        for (std::int32_t i = 0; i < model.numBSPSurfaces; ++i)
            AddSurface(int(number), model.firstBSPSurface + i, origin);
    }

    void AddSurface(int model, int number, const Vec3f &origin) {
        const bspDrawSurface_t &from = bsp_.drawSurfaces[std::size_t(number)];
        if (from.surfaceType != MST_PLANAR && from.surfaceType != MST_TRIANGLE_SOUP) {
            ++withoutTriangles_;
            return;
        }
        if (from.numIndexes < 3)
            return;
        MeshSurface &to = scene_.surfaces.emplace_back();
        to.shader = from.shaderNum, to.model = model, to.surface = number, to.type = from.surfaceType;
        to.material = WantsLightmaps() ? LightmapMaterialOf(from) : std::size_t(from.shaderNum);
        to.origin = origin;
        to.verts.reserve(std::size_t(from.numVerts));
        for (std::int32_t i = 0; i < from.numVerts; ++i)
            to.verts.push_back(Vertex(bsp_.drawVerts[std::size_t(from.firstVert + i)], origin));
        const std::int32_t *indexes = bsp_.drawIndexes.data() + from.firstIndex;
        for (std::int32_t i = 0; i + 2 < from.numIndexes; i += 3)
            to.triangles.push_back({indexes[i], indexes[i + 2], indexes[i + 1]});
    }

    MeshVertex Vertex(const bspDrawVert_t &from, const Vec3f &origin) const {
        const Vec3f xyz = Vec3f(from.xyz) + origin;
        const auto &st = WantsLightmaps() ? from.lightmap : from.st;
        return {{PrintableNumber(xyz.x), PrintableNumber(xyz.y), PrintableNumber(xyz.z)},
                {PrintableNumber(from.normal[0]), PrintableNumber(from.normal[1]), PrintableNumber(from.normal[2])},
                {PrintableNumber(st[0]), PrintableNumber(st[1])}};
    }

    const Bsp &bsp_;
    ShaderLibrary &library_;
    const MeshExportOptions &options_;
    const std::filesystem::path &bspPath_;
    Log &log_;
    std::optional<MeshLightmaps> lightmaps_;
    std::map<std::string, std::size_t> lightmapMaterials_; ///< number by name
    std::size_t withoutTriangles_ = 0;
    MeshScene scene_;
};

} // namespace

std::string MeshSurface::Name() const {
    return fmt::format("mat{}model{}surf{}", shader, model, surface);
}

std::string_view MeshSurface::TypeName() const {
    return type == MST_PLANAR ? "MST_PLANAR" : "MST_TRIANGLE_SOUP";
}

MeshScene MakeMeshScene(const Bsp &bsp, ShaderLibrary &library, const MeshExportOptions &options,
                        const std::filesystem::path &bspPath, Log &log) {
    return MeshSceneBuilder(bsp, library, options, bspPath, log).Build();
}

std::string MeshName(std::string_view text) {
    std::string name(text);
    std::ranges::replace_if(
        name, [](char c) { return static_cast<unsigned char>(c) < ' ' || c == '"' || c == '\x7F'; }, '_');
    return name;
}

} // namespace q3
