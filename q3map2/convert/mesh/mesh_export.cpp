// GPL-2.0-or-later. Maps as model files: triangles with materials and lightmap images, written for Wavefront and 3D
// Studio Max.
#include "q3map2/convert/mesh/mesh_export.h"

#include "common/files/files.h"
#include "common/text/text.h"
#include "common/text/text_scan.h"
#include "q3map2/bspfile/entities.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <set>
#include <system_error>

namespace q3 {

// ---- Which lightmap image a surface shows ----

namespace {

constexpr std::string_view kImagePrefix = "/lm_", kImageExtension = ".tga";
constexpr int kMaxExternalImages = 100000; ///< files that are looked for

/// 12 from "maps/x/lm_0012.tga".
std::optional<int> ExternalImageNumber(std::string_view path) {
    const std::size_t at = path.rfind('/');
    if (at == std::string_view::npos || !StartsWithNoCase(path.substr(at), kImagePrefix))
        return std::nullopt;
    const std::string_view rest = path.substr(at + kImagePrefix.size());
    const std::size_t digits = std::min(rest.find_first_not_of("0123456789"), rest.size());
    if (digits == 0 || !EqualNoCase(rest.substr(digits), kImageExtension))
        return std::nullopt;
    return StrictInteger(rest.substr(0, digits));
}

} // namespace

std::string LightmapImage::Name() const {
    return fmt::format("{}_{:04}", place == Place::External ? "lm" : "lightmap", number);
}

MeshLightmaps::MeshLightmaps(const Bsp &bsp, const std::filesystem::path &bspPath, const std::filesystem::path &script)
    : internalCount_(int(bsp.LightmapPages())) {
    const auto folder = bspPath.parent_path() / bspPath.stem();
    std::error_code ignored;
    while (externalCount_ < kMaxExternalImages &&
           std::filesystem::exists(folder / (LightmapImage{externalCount_, LightmapImage::Place::External}.Name() +
                                             std::string(kImageExtension)),
                                   ignored))
        ++externalCount_;
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
    if (surface.lightmapNum[0] >= 0)
        return LightmapImage{surface.lightmapNum[0],
                             internalCount_ == 0 ? LightmapImage::Place::External : LightmapImage::Place::InBsp};
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
    return name.starts_with('*') ? StrictInteger(name.substr(1)) : std::nullopt;
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
        if (leftOutCount_ > 0)
            log_.Print("{:9} curves and flares left out: they have no triangles (curves of maps compiled with "
                       "-patchmeta do)\n",
                       leftOutCount_);
        return std::move(scene_);
    }

  private:
    bool WantsLightmaps() const { return options_.lightmapsAsTexCoord || options_.deluxemapsAsTexCoord; }

    void AddShaderMaterial(const bspShader_t &record) {
        const std::string_view name = FieldName(record.shader);
        MeshMaterial &material = scene_.materials.emplace_back();
        material.name = MeshName(name);
        material.color = library_.GetWithImage(name).color;
        material.isNamedByShader = options_.shadersAsBitmap;
        if (options_.shadersAsBitmap) {
            material.image = material.name;
        } else {
            const std::string file = library_.ImageFile(name);
            material.image = "../" + (file.empty() ? material.name + ".tga" : MeshName(file));
        }
    }

    /// Finds the lightmaps of the map and adds a material for each, used or not.
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
            ++image->number; // the image of light directions follows that of the light
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
            ++leftOutCount_;
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
            to.triangles.push_back({indexes[i], indexes[i + 2], indexes[i + 1]}); // to counterclockwise
    }

    MeshVertex Vertex(const bspDrawVert_t &from, const Vec3f &origin) const {
        const Vec3f xyz = Vec3f(from.xyz) + origin;
        const auto &st = WantsLightmaps() ? from.lightmap[0] : from.st;
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
    std::size_t leftOutCount_ = 0;                         ///< surfaces without triangles
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

// ---- Maps as Wavefront models ----

namespace {

constexpr std::string_view kObjGenerator = "# Generated by q3map2 -convert -format obj";

/// Appends a line that ends with CR LF.
template <typename... Args> void ObjLine(std::string &text, fmt::format_string<Args...> format, Args &&...args) {
    fmt::format_to(std::back_inserter(text), format, std::forward<Args>(args)...);
    text += "\r\n";
}

/// `first`: number of its first vertex in the whole file, from 1.
void AppendObjSurface(std::string &text, const MeshSurface &surface, std::size_t first) {
    std::size_t number = first;
    for (const MeshVertex &v : surface.verts) {
        ObjLine(text, "# vertex {}", number++);
        // y up: a quarter turn around x. The 0 keeps "-0" out.
        ObjLine(text, "v {:f} {:f} {:f}", v.xyz.x, v.xyz.z, 0 - v.xyz.y);
        ObjLine(text, "vn {:f} {:f} {:f}", v.normal.x, v.normal.z, 0 - v.normal.y);
        ObjLine(text, "vt {:f} {:f}", v.st[0], 1 - v.st[1]);
    }
    for (const auto &[a, b, c] : surface.triangles) {
        const std::size_t i = first + std::size_t(a), j = first + std::size_t(b), k = first + std::size_t(c);
        ObjLine(text, "f {0}/{0}/{0} {1}/{1}/{1} {2}/{2}/{2}", i, j, k);
    }
}

} // namespace

std::string ObjText(const MeshScene &scene) {
    std::string text;
    ObjLine(text, "o {}", MeshName(scene.name));
    ObjLine(text, "{}", kObjGenerator);
    ObjLine(text, "mtllib {}.mtl", MeshName(scene.name));
    std::size_t first = 1;
    const std::string *material = nullptr;
    for (const MeshSurface &surface : scene.surfaces) {
        ObjLine(text, "g {}", surface.Name());
        ObjLine(text, "# SURFACETYPE {}", surface.TypeName());
        const std::string &name = scene.materials[surface.material].name;
        if (!material || *material != name)
            ObjLine(text, "usemtl {}", name);
        material = &name;
        AppendObjSurface(text, surface, first);
        first += surface.verts.size();
    }
    return text;
}

std::string MtlText(const MeshScene &scene) {
    std::string text;
    ObjLine(text, "{}", kObjGenerator);
    std::set<std::string_view> written;
    for (const MeshMaterial &material : scene.materials) {
        if (!written.insert(material.name).second)
            continue;
        ObjLine(text, "newmtl {}", material.name);
        ObjLine(text, "Kd {:f} {:f} {:f}", material.color.x, material.color.y, material.color.z);
        if (!material.image.empty())
            ObjLine(text, "map_Kd {}", material.image);
    }
    return text;
}

// ---- Maps in the ASCII scene format of 3D Studio Max ----

namespace {

/// Appends nested blocks, one tab of indent a level.
class AseWriter {
  public:
    template <typename... Args> void Line(fmt::format_string<Args...> format, Args &&...args) {
        text_.append(depth_, '\t');
        fmt::format_to(std::back_inserter(text_), format, std::forward<Args>(args)...);
        text_ += "\r\n";
    }
    /// A line and, in braces, what `body` appends.
    template <typename Body> void Block(std::string_view head, const Body &body) {
        Line("{} {{", head);
        ++depth_;
        body();
        --depth_;
        Line("}}");
    }
    std::string Take() { return std::move(text_); }

  private:
    std::string text_;
    std::size_t depth_ = 0;
};

std::string AseImage(const MeshMaterial &material) {
    std::string image = material.image;
    if (!material.isNamedByShader)
        std::ranges::replace(image, '/', '\\');
    return image;
}

void AppendAseHead(AseWriter &out, const MeshScene &scene) {
    out.Line("*3DSMAX_ASCIIEXPORT\t200");
    out.Line("*COMMENT\t\"Generated by q3map2 -convert -format ase\"");
    out.Block("*SCENE", [&] {
        out.Line("*SCENE_FILENAME\t\"{}.bsp\"", MeshName(scene.name));
        out.Line("*SCENE_FIRSTFRAME\t0");
        out.Line("*SCENE_LASTFRAME\t100");
        out.Line("*SCENE_FRAMESPEED\t30");
        out.Line("*SCENE_TICKSPERFRAME\t160");
        out.Line("*SCENE_BACKGROUND_STATIC\t0.0000\t0.0000\t0.0000");
        out.Line("*SCENE_AMBIENT_STATIC\t0.0000\t0.0000\t0.0000");
    });
}

void AppendAseMaterial(AseWriter &out, const MeshMaterial &material) {
    out.Line("*MATERIAL_NAME\t\"{}\"", material.name);
    out.Line("*MATERIAL_CLASS\t\"Standard\"");
    out.Line("*MATERIAL_DIFFUSE\t{:f}\t{:f}\t{:f}", material.color.x, material.color.y, material.color.z);
    out.Line("*MATERIAL_SHADING Phong");
    if (material.image.empty())
        return;
    out.Block("*MAP_DIFFUSE", [&] {
        out.Line("*MAP_NAME\t\"{}\"", material.name);
        out.Line("*MAP_CLASS\t\"Bitmap\"");
        out.Line("*MAP_SUBNO\t1");
        out.Line("*MAP_AMOUNT\t1.0");
        out.Line("*MAP_TYPE\tScreen");
        out.Line("*BITMAP\t\"{}\"", AseImage(material));
        out.Line("*BITMAP_FILTER\tPyramidal");
    });
}

void AppendAseNode(AseWriter &out, const MeshSurface &surface) {
    out.Block("*NODE_TM", [&] {
        out.Line("*NODE_NAME\t\"{}\"", surface.Name());
        for (const std::string_view part : {"POS", "ROT", "SCL"})
            out.Line("*INHERIT_{}\t0\t0\t0", part);
        out.Line("*TM_ROW0\t1.0\t0\t0");
        out.Line("*TM_ROW1\t0\t1.0\t0");
        out.Line("*TM_ROW2\t0\t0\t1.0");
        const Vec3f &o = surface.origin;
        out.Line("*TM_ROW3\t{:f}\t{:f}\t{:f}", o.x, o.y, o.z);
        out.Line("*TM_POS\t{:f}\t{:f}\t{:f}", o.x, o.y, o.z);
    });
}

void AppendAseNormals(AseWriter &out, const MeshSurface &surface) {
    std::size_t face = 0;
    for (const std::array<int, 3> &triangle : surface.triangles) {
        Vec3f sum;
        for (const int corner : triangle)
            sum += surface.verts[std::size_t(corner)].normal;
        const Vec3f mean = Normalize(sum);
        out.Line("*MESH_FACENORMAL\t{}\t{:f}\t{:f}\t{:f}", face++, mean.x, mean.y, mean.z);
        for (const int corner : triangle) {
            const Vec3f &n = surface.verts[std::size_t(corner)].normal;
            out.Line("*MESH_VERTEXNORMAL\t{}\t{:f}\t{:f}\t{:f}", corner, n.x, n.y, n.z);
        }
    }
}

void AppendAseMesh(AseWriter &out, const MeshSurface &surface) {
    out.Line("*TIMEVALUE\t0");
    out.Line("*MESH_NUMVERTEX\t{}", surface.verts.size());
    out.Line("*MESH_NUMFACES\t{}", surface.triangles.size());
    out.Line("*COMMENT\t\"SURFACETYPE\t{}\"", surface.TypeName());
    std::size_t number = 0;
    out.Block("*MESH_VERTEX_LIST", [&] {
        for (const MeshVertex &v : surface.verts)
            out.Line("*MESH_VERTEX\t{}\t{:f}\t{:f}\t{:f}", number++, v.xyz.x, v.xyz.y, v.xyz.z);
    });
    number = 0;
    out.Block("*MESH_FACE_LIST", [&] {
        for (const auto &[a, b, c] : surface.triangles)
            out.Line(
                "*MESH_FACE\t{}:\tA:\t{}\tB:\t{}\tC:\t{}\tAB:\t1\tBC:\t1\tCA:\t1\t*MESH_SMOOTHING\t0\t*MESH_MTLID\t0",
                number++, a, b, c);
    });
    number = 0;
    out.Line("*MESH_NUMTVERTEX\t{}", surface.verts.size());
    out.Block("*MESH_TVERTLIST", [&] {
        for (const MeshVertex &v : surface.verts)
            out.Line("*MESH_TVERT\t{}\t{:f}\t{:f}\t1.0", number++, v.st[0], 1 - v.st[1]);
    });
    number = 0;
    out.Line("*MESH_NUMTVFACES\t{}", surface.triangles.size());
    out.Block("*MESH_TFACELIST", [&] {
        for (const auto &[a, b, c] : surface.triangles)
            out.Line("*MESH_TFACE\t{}\t{}\t{}\t{}", number++, a, b, c);
    });
    out.Block("*MESH_NORMALS", [&] { AppendAseNormals(out, surface); });
}

} // namespace

std::string AseText(const MeshScene &scene) {
    AseWriter out;
    AppendAseHead(out, scene);
    out.Block("*MATERIAL_LIST", [&] {
        out.Line("*MATERIAL_COUNT\t{}", scene.materials.size());
        std::size_t number = 0;
        for (const MeshMaterial &material : scene.materials)
            out.Block(fmt::format("*MATERIAL\t{}", number++), [&] { AppendAseMaterial(out, material); });
    });
    for (const MeshSurface &surface : scene.surfaces)
        out.Block("*GEOMOBJECT", [&] {
            out.Line("*NODE_NAME\t\"{}\"", surface.Name());
            AppendAseNode(out, surface);
            out.Block("*MESH", [&] { AppendAseMesh(out, surface); });
            out.Line("*PROP_MOTIONBLUR\t0");
            out.Line("*PROP_CASTSHADOW\t1");
            out.Line("*PROP_RECVSHADOW\t1");
            out.Line("*MATERIAL_REF\t{}", surface.material);
        });
    return out.Take();
}

// ---- Files ----

namespace {

void PrintMeshCounts(const MeshScene &scene, Log &log) {
    std::size_t verts = 0, triangles = 0;
    for (const MeshSurface &surface : scene.surfaces)
        verts += surface.verts.size(), triangles += surface.triangles.size();
    log.Count(scene.materials.size(), "materials");
    log.Count(scene.surfaces.size(), "surfaces");
    log.Count(verts, "vertices");
    log.Count(triangles, "triangles");
}

void AddText(FileSet &files, const std::filesystem::path &path, const std::string &text, Log &log) {
    log.Print("Writing {}\n", path.string());
    files.AddText(path, text);
}

} // namespace

void WriteAse(const Bsp &bsp, ShaderLibrary &library, const MeshExportOptions &options,
              const std::filesystem::path &output, Log &log) {
    log.Section("Convert BSP to ASE");
    const MeshScene scene = MakeMeshScene(bsp, library, options, output, log);
    PrintMeshCounts(scene, log);
    FileSet files;
    AddText(files, output, AseText(scene), log);
    files.Commit();
}

void WriteObj(const Bsp &bsp, ShaderLibrary &library, const MeshExportOptions &options,
              const std::filesystem::path &output, Log &log) {
    log.Section("Convert BSP to OBJ");
    const MeshScene scene = MakeMeshScene(bsp, library, options, output, log);
    PrintMeshCounts(scene, log);
    FileSet files;
    AddText(files, output, ObjText(scene), log);
    auto materials = output;
    materials.replace_extension(".mtl");
    AddText(files, materials, MtlText(scene), log);
    files.Commit();
}

} // namespace q3
