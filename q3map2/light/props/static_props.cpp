// GPL-2.0-or-later. Static props: models placed by entities, which the game draws and the light stage lights.
#include "q3map2/light/props/static_props.h"

#include "common/error.h"
#include "common/platform/process_copy.h"
#include "common/text/text.h"
#include "libs/math/winding.h"
#include "q3map2/bspfile/map_keys.h"
#include "q3map2/bspfile/prop_light.h"
#include "q3map2/model/model_load.h"

#include <algorithm>
#include <cmath>
#include <new>
#include <tuple>

namespace q3 {

// ---- Models of static props, prepared for lighting at vertices ----

namespace {

/// Position and normal of a vertex: vertices with the same key are welded.
using WeldKey = std::tuple<float, float, float, float, float, float>;

WeldKey WeldKeyOf(const DrawVert &v) {
    const auto plain = [](float x) { return x + 0.0f; }; // turns -0 into 0
    return {plain(v.xyz.x), plain(v.xyz.y), plain(v.xyz.z), plain(v.normal.x), plain(v.normal.y), plain(v.normal.z)};
}

} // namespace

PropModel::PropModel(Model model) : meshes(std::move(model.meshes)) {
    std::map<WeldKey, std::uint32_t> welded;
    std::vector<std::uint32_t> cornerPoints;
    for (std::size_t m = 0; m < meshes.size(); ++m) {
        std::vector<std::uint32_t> &numbers = pointOf.emplace_back();
        for (const DrawVert &vert : meshes[m].verts) {
            const auto [at, added] = welded.try_emplace(WeldKeyOf(vert), std::uint32_t(points.size()));
            if (added)
                points.push_back({vert.xyz, vert.normal, std::uint32_t(m)});
            numbers.push_back(at->second);
            bounds.Add(vert.xyz);
        }
        for (const auto &triangle : meshes[m].triangles)
            for (const int corner : triangle) {
                corners.push_back(meshes[m].verts[std::size_t(corner)].xyz);
                cornerPoints.push_back(numbers[std::size_t(corner)]);
            }
    }
    firstCorner.resize(points.size() + 1);
    for (const std::uint32_t point : cornerPoints)
        ++firstCorner[point + 1];
    for (std::size_t i = 1; i < firstCorner.size(); ++i)
        firstCorner[i] += firstCorner[i - 1];
    cornersAt.resize(cornerPoints.size());
    std::vector<std::uint32_t> next = firstCorner;
    for (std::size_t c = 0; c < cornerPoints.size(); ++c)
        cornersAt[next[cornerPoints[c]]++] = std::uint32_t(c);
}

std::unique_ptr<PropModel> PropModels::Read(const std::string &name, int frame) {
    const auto bytes = vfs_ == nullptr ? std::nullopt : vfs_->Read(name);
    if (!bytes)
        throw Error("there is no such file");
    std::unique_ptr<PropModel> model;
    if (IsMd3(*bytes)) {
        model = std::make_unique<PropModel>(ReadMd3(*bytes, name, frame));
    } else {
        std::string problem;
        const Model *read = library_.Get(name, frame, problem);
        if (read == nullptr)
            throw Error("{}", problem);
        model = std::make_unique<PropModel>(*read);
    }
    model->crc = Crc32(*bytes);
    return model;
}

const PropModel *PropModels::Get(std::string_view name, int frame, std::string &problem) {
    std::string path(name);
    std::replace(path.begin(), path.end(), '\\', '/');
    const auto [at, added] = entries_.try_emplace({LowerCase(path), frame});
    Entry &entry = at->second;
    if (added) {
        try {
            entry.model = Read(path, frame);
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

// ---- Static props of the entities of a map, and their shadow casters ----

namespace {

constexpr std::string_view kSourceProp = "prop_static"; ///< classname in the Source engine

/// Triangles of the faces of a box. A corner is a number whose bit i is set if the corner is at the maximum of axis i.
constexpr std::array<std::array<int, 3>, 12> kBoxTriangles{{{0, 1, 3},
                                                            {0, 3, 2},
                                                            {4, 7, 5},
                                                            {4, 6, 7},
                                                            {0, 5, 1},
                                                            {0, 4, 5},
                                                            {2, 3, 7},
                                                            {2, 7, 6},
                                                            {0, 2, 6},
                                                            {0, 6, 4},
                                                            {1, 5, 7},
                                                            {1, 7, 3}}};

/// Loads props one by one.
class PropLoader {
  public:
    PropLoader(std::span<const Entity> entities, const VirtualFileSystem *vfs, int drawSurfaces,
               const ModelTest &textureShadows, const LightOptions &options, ShaderLibrary &library, Log &log)
        : entities_(entities), vfs_(vfs), drawSurfaces_(drawSurfaces), textureShadows_(textureShadows),
          options_(options), library_(library), log_(log) {
        result_.models = std::make_shared<PropModels>(vfs);
        result_.masked = std::make_shared<std::deque<ShaderInfo>>();
    }

    StaticProps Run() {
        for (std::size_t i = 0; i < entities_.size(); ++i)
            if (IsStaticProp(entities_[i]))
                Load(i);
        return std::move(result_);
    }

  private:
    void Load(std::size_t number);
    void ReadKeys(const Entity &entity, StaticProp &prop);
    void FindLightingOrigin(const Entity &entity, StaticProp &prop);
    void FindShaders(const Entity &entity, StaticProp &prop);
    bool InsideWorld(StaticProp &prop) const;
    const ShaderInfo *Masked(const ShaderInfo &shader);
    void AddCasters(StaticProp &prop, int castShadows);
    void AddMesh(StaticProp &prop, std::size_t mesh, int castShadows);
    void AddBox(StaticProp &prop, int castShadows);
    PropCaster &NewCaster(StaticProp &prop, int castShadows);

    std::span<const Entity> entities_;
    const VirtualFileSystem *vfs_;
    int drawSurfaces_;
    const ModelTest &textureShadows_;
    const LightOptions &options_;
    ShaderLibrary &library_;
    Log &log_;
    std::string who_; ///< the entity, for messages
    StaticProps result_;
};

void PropLoader::Load(std::size_t number) {
    const Entity &entity = entities_[number];
    who_ = fmt::format("Entity {}", number);
    StaticProp prop;
    prop.entity = number;
    prop.name = keys::kModel.Text(entity);
    if (prop.name.empty())
        return log_.Warn("prop without model", "{}: {} without a \"model\" key", who_, entity.ClassName());
    WarnOfBadKeys(entity, number, keys::kPropKeys, log_);
    std::string problem;
    prop.model = result_.models->Get(prop.name, keys::kFrame.Integer(entity), problem);
    if (prop.model == nullptr)
        return log_.Warn("prop cannot be read", "{}: the model {} cannot be read and gets no light: {}", who_,
                         prop.name, problem);
    ReadKeys(entity, prop);
    if (!InsideWorld(prop))
        return log_.Warn("prop outside the world", "{}: the model {} leaves the world and gets no light", who_,
                         prop.name);
    FindShaders(entity, prop);
    AddCasters(prop, keys::kPropNoShadows.Flag(entity) ? 0 : keys::kCastShadows.Integer(entity, 1));
    if (prop.vertexLight)
        result_.shadows.receiveShadows.push_back(prop.receiveShadows);
    result_.props.push_back(std::move(prop));
}

void PropLoader::ReadKeys(const Entity &entity, StaticProp &prop) {
    const Vec3d origin(entity.Vector({"origin"}).value_or(Vec3f{}));
    prop.transform = MakeModelTransform(ModelScaleOf(entity), AnglesOf(entity), origin);
    prop.selfShadows = !keys::kPropNoSelfShadows.Flag(entity);
    prop.vertexLight = !keys::kPropNoVertexLight.Flag(entity) && options_.staticPropLighting;
    prop.ignoresNormals = keys::kPropIgnoreNormals.Flag(entity);
    prop.receiveShadows = keys::kReceiveShadows.Integer(entity, 1);
    if (keys::kPropLightmaps.Flag(entity))
        log_.Warn("prop lightmaps", "{}: generatelightmaps: props get light at their vertices, but no lightmaps", who_);
    FindLightingOrigin(entity, prop);
}

void PropLoader::FindLightingOrigin(const Entity &entity, StaticProp &prop) {
    const std::string_view name = keys::kPropLightingOrigin.Text(entity);
    if (name.empty())
        return;
    for (const Entity &other : entities_)
        if (!prop.lightingOrigin && EqualNoCase(keys::kTargetName.Text(other), name))
            prop.lightingOrigin = other.Vector({"origin"});
    if (!prop.lightingOrigin)
        log_.Warn("lighting origin", "{}: no entity with an origin has the targetname '{}' of its lightingorigin", who_,
                  name);
}

void PropLoader::FindShaders(const Entity &entity, StaticProp &prop) {
    Entity skinned = entity;
    if (EqualNoCase(entity.ClassName(), kSourceProp) && keys::kSkin.Text(entity) == "0")
        skinned.Erase("skin"); // 0: the model's own skin
    const ShaderRemap remap = ShaderRemapOf(skinned, who_, prop.name, vfs_, log_);
    std::vector<std::string> shaders;
    for (const ModelMesh &mesh : prop.model->meshes)
        shaders.push_back(mesh.shader);
    remap.WarnOfUnmatched(shaders, who_, log_);
    for (const std::string &shader : shaders) {
        const std::string name = remap(shader);
        prop.shaders.push_back(name.empty() ? nullptr : &library_.Get(name));
    }
}

/// Also sets the bounds of the prop, if true.
bool PropLoader::InsideWorld(StaticProp &prop) const {
    for (const PropModel::Point &point : prop.model->points) {
        const Vec3f p(prop.transform.Point(Vec3d(point.xyz)));
        if (!IsFinite(p) || std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}) > float(kMaxWorldCoord))
            return false;
        prop.bounds.Add(p);
    }
    return true;
}

/// A copy of the shader that blocks light by the alpha of its image; null if the shader does not use that alpha.
const ShaderInfo *PropLoader::Masked(const ShaderInfo &shader) {
    const bool filters = (shader.compileFlags & (C_ALPHASHADOW | C_LIGHTFILTER)) != 0;
    const bool tested = LowerCase(shader.scriptText).find("alphafunc") != std::string::npos;
    if (!filters && !tested && shader.implicitMask.empty())
        return nullptr;
    for (const ShaderInfo &one : *result_.masked)
        if (one.name == shader.name)
            return &one;
    ShaderInfo copy = library_.GetWithImage(shader.name);
    if (!copy.imageFound)
        return nullptr;
    if (!filters)
        copy.compileFlags |= C_ALPHASHADOW;
    result_.masked->push_back(std::move(copy));
    return &result_.masked->back();
}

PropCaster &PropLoader::NewCaster(StaticProp &prop, int castShadows) {
    prop.surfaces.push_back(drawSurfaces_ + int(result_.shadows.casters.size()));
    PropCaster &caster = result_.shadows.casters.emplace_back();
    caster.prop = int(result_.props.size());
    caster.castShadows = castShadows;
    return caster;
}

void PropLoader::AddCasters(StaticProp &prop, int castShadows) {
    if (castShadows == 0 || options_.structuralShadowsOnly || prop.model->corners.empty())
        return;
    if (!options_.staticPropPolys)
        return AddBox(prop, castShadows);
    for (std::size_t mesh = 0; mesh < prop.model->meshes.size(); ++mesh)
        if (prop.shaders[mesh] != nullptr)
            AddMesh(prop, mesh, castShadows);
}

void PropLoader::AddMesh(StaticProp &prop, std::size_t number, int castShadows) {
    const ShaderInfo &shader = *prop.shaders[number];
    const bool byTexture = options_.textureShadows || textureShadows_(prop.name);
    const ShaderInfo *masked = byTexture ? Masked(shader) : nullptr;
    if ((shader.compileFlags & (C_NODRAW | C_SKY)) != 0 || ((shader.compileFlags & C_TRANSLUCENT) != 0 && !masked))
        return;
    PropCaster &caster = NewCaster(prop, castShadows);
    caster.seeThrough = masked != nullptr;
    caster.shader = masked != nullptr ? masked : &shader;
    const ModelMesh &mesh = prop.model->meshes[number];
    for (const auto &triangle : mesh.triangles) {
        std::array<Vec3f, 3> corners;
        std::array<float, 6> st{};
        for (std::size_t k = 0; k < 3; ++k) {
            const DrawVert &vert = mesh.verts[std::size_t(triangle[k])];
            corners[k] = Vec3f(prop.transform.Point(Vec3d(vert.xyz)));
            st[2 * k] = vert.st[0], st[2 * k + 1] = vert.st[1];
        }
        caster.corners.push_back(corners);
        caster.st.push_back(st);
    }
}

void PropLoader::AddBox(StaticProp &prop, int castShadows) {
    const Boundsf &box = prop.model->bounds;
    std::array<Vec3f, 8> corners;
    for (std::size_t i = 0; i < 8; ++i)
        corners[i] = Vec3f(prop.transform.Point({double((i & 1) != 0 ? box.maxs.x : box.mins.x),
                                                 double((i & 2) != 0 ? box.maxs.y : box.mins.y),
                                                 double((i & 4) != 0 ? box.maxs.z : box.mins.z)}));
    PropCaster &caster = NewCaster(prop, castShadows);
    for (const auto &[a, b, c] : kBoxTriangles) {
        caster.corners.push_back({corners[std::size_t(a)], corners[std::size_t(b)], corners[std::size_t(c)]});
        caster.st.emplace_back();
    }
}

} // namespace

bool IsStaticProp(const Entity &entity) {
    const std::string_view name = entity.ClassName();
    return EqualNoCase(name, "misc_model_static") || EqualNoCase(name, kSourceProp) ||
           (EqualNoCase(name, "misc_model") && keys::kStaticProp.Flag(entity));
}

StaticProps LoadStaticProps(std::span<const Entity> entities, const VirtualFileSystem *vfs, int drawSurfaces,
                            const ModelTest &textureShadows, const LightOptions &options, ShaderLibrary &library,
                            Log &log) {
    if (!options.staticPropLighting && !options.staticPropPolys)
        return {};
    return PropLoader(entities, vfs, drawSurfaces, textureShadows, options, library, log).Run();
}

} // namespace q3
