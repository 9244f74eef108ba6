// GPL-2.0-or-later. Maps made larger or smaller.
#include "q3map2/edit/scale_map.h"

#include "common/error.h"
#include "q3map2/bspfile/entities.h"
#include "q3map2/edit/edit_grids.h"
#include "q3map2/edit/edit_text.h"

#include <cmath>
#include <numbers>

namespace q3 {

namespace {

constexpr double kFlatTriangle = 1e-9; ///< determinant over the product of squared edges
constexpr double kMostFactor = 65536;

class Scaler {
  public:
    Scaler(Bsp &bsp, const ScaleOptions &options) : bsp_(bsp), options_(options), factors_(options.factors) {}

    void Run(std::string_view name) {
        ScaleEntities(name);
        for (bspModel_t &model : bsp_.models)
            model.mins = Position(model.mins), model.maxs = Position(model.maxs);
        for (bspNode_t &node : bsp_.nodes)
            ScaleBox(node.mins, node.maxs);
        for (bspLeaf_t &leaf : bsp_.leafs)
            ScaleBox(leaf.mins, leaf.maxs);
        if (options_.projectTextures)
            ProjectTextures();
        for (bspDrawVert_t &vert : bsp_.drawVerts)
            vert.xyz = Position(vert.xyz), vert.normal = Normal(vert.normal);
        for (bspDrawSurface_t &surface : bsp_.drawSurfaces)
            ScaleVectors(surface);
        for (bspPlane_t &plane : bsp_.planes)
            ScalePlane(plane);
        for (bspAdvertisement_t &advertisement : bsp_.advertisements) {
            advertisement.normal = Normal(advertisement.normal);
            for (Float3 &corner : advertisement.rect)
                corner = Position(corner);
        }
    }

  private:
    Float3 Position(const Float3 &p) const { return Vec3f(Vec3d(p) * factors_).Array(); }
    /// Of a surface that is scaled: perpendicular to it again.
    Float3 Normal(const Float3 &normal) const {
        if (IsUniform())
            return normal;
        const Vec3d n(normal);
        return Vec3f(Normalize(Vec3d{n.x / factors_.x, n.y / factors_.y, n.z / factors_.z})).Array();
    }
    bool IsUniform() const { return factors_.x == factors_.y && factors_.y == factors_.z; }

    void ScaleBox(Int3 &mins, Int3 &maxs) const {
        for (std::size_t i = 0; i < 3 && mins[i] <= maxs[i]; ++i) { // a box may be empty
            mins[i] = WholeBound(std::floor(mins[i] * factors_[i]));
            maxs[i] = WholeBound(std::ceil(maxs[i] * factors_[i]));
        }
    }

    void ScalePlane(bspPlane_t &plane) const {
        if (IsUniform()) {
            plane.dist = float(double(plane.dist) * factors_.x);
            return;
        }
        const Vec3d n(plane.normal);
        const Vec3d scaled{n.x / factors_.x, n.y / factors_.y, n.z / factors_.z};
        const double length = Length(scaled);
        plane.normal = Vec3f(scaled / length).Array();
        plane.dist = float(double(plane.dist) / length);
    }

    void ScaleVectors(bspDrawSurface_t &surface) const {
        surface.lightmapOrigin = Position(surface.lightmapOrigin);
        surface.lightmapVecs[2] = Normal(surface.lightmapVecs[2]);
        if (surface.surfaceType == MST_FLARE) // [0] is its color
            return;
        surface.lightmapVecs[0] = Position(surface.lightmapVecs[0]);
        surface.lightmapVecs[1] = Position(surface.lightmapVecs[1]);
    }

    void ScaleEntities(std::string_view name) const;
    void ScaleLip(Entity &entity) const;
    void ProjectTextures();
    void ProjectTriangle(const std::array<std::size_t, 3> &corners, const std::vector<bspDrawVert_t> &old);

    Bsp &bsp_;
    const ScaleOptions &options_;
    Vec3d factors_;
};

/// The part of a mover that stays visible, measured along its direction.
void Scaler::ScaleLip(Entity &entity) const {
    if (!entity.Has("lip"))
        return;
    const double angle = entity.Number({"angle"});
    const bool isUpOrDown = angle == -1 || angle == -2;
    const bool isAlongX = std::abs(std::sin(angle * std::numbers::pi / 180)) < std::numbers::sqrt2 / 2;
    entity.Set("lip", NumberText(entity.Number({"lip"}) * factors_[isUpOrDown ? 2 : isAlongX ? 0 : 1]));
}

void Scaler::ScaleEntities(std::string_view name) const {
    std::vector<Entity> entities = StoredEntities(bsp_.entities, name);
    for (Entity &entity : entities) {
        if (const auto origin = entity.Vector({"origin"})) {
            const double above =
                StartsWithNoCase(entity.ClassName(), "info_player_") ? double(options_.spawnReference) : 0;
            const Vec3d lift{0, 0, above};
            entity.Set("origin", VectorText((Vec3d(*origin) + lift) * factors_ - lift));
        }
        ScaleLip(entity);
        if (entity.Has("height"))
            entity.Set("height", NumberText(entity.Number({"height"}) * factors_.z));
    }
    Entity &world = entities.front();
    world.Set("gridsize", VectorText(Vec3d(GridCellOf(world)) * factors_));
    bsp_.entities = FormatEntities(entities);
}

/// Texture coordinates as functions of the position, constant along the normal, from the old corners; taken at the
/// scaled ones.
void Scaler::ProjectTriangle(const std::array<std::size_t, 3> &corners, const std::vector<bspDrawVert_t> &old) {
    const bspDrawVert_t &a = old[corners[0]], &b = old[corners[1]], &c = old[corners[2]];
    const Vec3d u = Vec3d(b.xyz) - Vec3d(a.xyz), v = Vec3d(c.xyz) - Vec3d(a.xyz);
    const double uu = Dot(u, u), uv = Dot(u, v), vv = Dot(v, v), determinant = uu * vv - uv * uv;
    if (determinant <= kFlatTriangle * uu * vv)
        return;
    for (std::size_t axis = 0; axis < 2; ++axis) {
        const double alongU = double(b.st[axis]) - double(a.st[axis]), alongV = double(c.st[axis]) - double(a.st[axis]);
        const Vec3d gradient =
            u * ((alongU * vv - alongV * uv) / determinant) + v * ((alongV * uu - alongU * uv) / determinant);
        for (const std::size_t corner : corners) {
            const Vec3d position(old[corner].xyz);
            bsp_.drawVerts[corner].st[axis] =
                float(double(a.st[axis]) + Dot(gradient, position * factors_ - Vec3d(a.xyz)));
        }
    }
}

void Scaler::ProjectTextures() {
    const std::vector<bspDrawVert_t> old = bsp_.drawVerts;
    for (const bspDrawSurface_t &surface : bsp_.drawSurfaces) {
        if (surface.surfaceType != MST_PLANAR)
            continue;
        for (int i = 0; i + 2 < surface.numIndexes; i += 3) {
            std::array<std::size_t, 3> corners{};
            for (std::size_t k = 0; k < 3; ++k)
                corners[k] = std::size_t(surface.firstVert + bsp_.drawIndexes[std::size_t(surface.firstIndex + i) + k]);
            ProjectTriangle(corners, old);
        }
    }
}

} // namespace

void ScaleMap(Bsp &bsp, const ScaleOptions &options, std::string_view name, Log &log) {
    for (const double factor : options.factors.Array())
        if (!(factor > 0 && factor <= kMostFactor))
            throw Error("-scale: the factor is {:g}, expected a number over 0, up to {:g}", factor, kMostFactor);
    const Bsp before = bsp;
    Scaler(bsp, options).Run(name);
    const bool isUniform = options.factors.x == options.factors.y && options.factors.y == options.factors.z;
    if (!isUniform && (bsp.gridSH || bsp.sparseGridSH || bsp.ambientCubes || !bsp.gridPoints.empty()))
        log.Warn("light of another shape",
                 "factors differ, and directions of the light grids are those of the old shape: light the map again");
    TransformGrids(before, {options.factors, {}}, bsp, log);
    ValidateBsp(bsp, name, log);
}

} // namespace q3
