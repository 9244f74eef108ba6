// GPL-2.0-or-later. Maps scaled or moved as a whole, and the options of -scale, -shift and -mergebsp.
#include "q3map2/edit/scale_shift.h"

#include "common/error.h"
#include "common/text/text.h"
#include "q3map2/bspfile/entities.h"
#include "q3map2/edit/edit_lumps.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

namespace q3 {

// ---- Options of -scale, -shift and -mergebsp ----

std::vector<SettingGroup<ScaleOptions>> ScaleSettings() {
    return {{"Scaling",
             "One to three factors come before the file. One factor counts for all axes. Of two factors, the first "
             "counts for x and y, and the second for z. Three factors count for x, y and z.",
             {{{.name = "-tex",
                .help = "Keeps the size of textures in the world instead of stretching them with the faces",
                .since = "q3map2"},
               &ScaleOptions::projectTextures},
              {{.name = "-spawn_ref",
                .values = "F",
                .unit = "game units",
                .help = "Sets minus the height of info_player_ entities over the floor, which is not scaled",
                .details = "In Quake III it is -24, since the origin of a player is 24 game units above the floor.",
                .since = "q3map2",
                .example = "-24"},
               &ScaleOptions::spawnReference}}}};
}

std::vector<SettingGroup<MergeOptions>> MergeSettings() {
    return {{"Merging",
             "",
             {{{.name = "-fixnames",
                .help = "Renames targets of the second map that the first one has too",
                .details = "Targets and targetnames get a number.",
                .since = "q3map2"},
               &MergeOptions::fixNames},
              {{.name = "-world",
                .help = "Merges the world of the second map too, and not only its entities",
                .since = "q3map2"},
               &MergeOptions::world}}}};
}

Vec3d TakeAxisValues(Arguments &arguments, std::string_view stage) {
    std::vector<double> values;
    for (std::size_t i = 0; i < arguments.Rest().size() && arguments.Rest().size() > 1;) {
        const auto number = StrictNumber(arguments.Rest()[i]);
        if (number) {
            values.push_back(*number);
            arguments.TakeAt(i);
        } else {
            ++i;
        }
    }
    if (values.empty() || values.size() > 3)
        throw Error("{}: {} numbers, expected 1 to 3 before the file: S, or SXY SZ, or SX SY SZ", stage, values.size());
    const std::size_t last = values.size() - 1;
    return {values[0], values[last == 2 ? 1 : 0], values[last]};
}

// ---- Maps made larger or smaller ----

namespace {

/// A triangle of edges u and v is flat up to this (u.u v.v - (u.v)^2) / (u.u v.v), the squared sine of their angle.
constexpr double kFlatTriangle = 1e-9;
constexpr double kMostFactor = 65536; ///< limit of this program, chosen
/// Values of the key `angle` for movers that go up or down.
constexpr double kUp = -1, kDown = -2;

class Scaler {
  public:
    Scaler(Bsp &bsp, const ScaleOptions &options)
        : bsp_(bsp), options_(options), factors_(options.factors), transform_{options.factors, {}} {}

    void Run(std::string_view name) {
        ScaleEntities(name);
        for (bspModel_t &model : bsp_.models)
            model.mins = Position(model.mins), model.maxs = Position(model.maxs);
        for (bspNode_t &node : bsp_.nodes)
            TransformBox(transform_, node.mins, node.maxs);
        for (bspLeaf_t &leaf : bsp_.leafs)
            TransformBox(transform_, leaf.mins, leaf.maxs);
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
    /// A normal transforms by the inverse transpose of the scaling matrix: n / factors, whose length is not 1.
    Vec3d ScaledNormal(const Float3 &normal) const {
        const Vec3d n(normal);
        return {n.x / factors_.x, n.y / factors_.y, n.z / factors_.z};
    }
    /// The unit normal of the scaled surface.
    Float3 Normal(const Float3 &normal) const {
        return transform_.IsUniform() ? normal : Vec3f(Normalize(ScaledNormal(normal))).Array();
    }

    /// n . p = d becomes (n / factors) . (p factors) = d; both sides are then divided by the length of n / factors.
    void ScalePlane(bspPlane_t &plane) const {
        if (transform_.IsUniform()) {
            plane.dist = float(double(plane.dist) * factors_.x);
            return;
        }
        const Vec3d scaled = ScaledNormal(plane.normal);
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
    AxisTransform transform_; ///< by the same factors
};

/// Scales `lip`, the part of a mover that stays visible, by the factor of the axis nearest to the mover's direction.
void Scaler::ScaleLip(Entity &entity) const {
    if (!entity.Has("lip"))
        return;
    const double angle = entity.Number({"angle"});
    const bool isUpOrDown = angle == kUp || angle == kDown;
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

/// Gives the scaled corners the texture coordinates that the old triangle's plane has at their positions, projected
/// onto it: s(p) = s(a) + g . (p - a). The gradient g lies in the plane of the edges u and v; g . u and g . v are the
/// differences of s along them (Cramer's rule).
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
    const AxisTransform transform{options.factors, {}};
    if (!transform.IsUniform() && (IsSpoiledByUnevenScaling(bsp) || !bsp.gridPoints.empty()))
        log.Warn("light of another shape",
                 "factors differ, and directions of the light grids are those of the old shape: light the map again");
    TransformLumps(before, transform, bsp, log);
    ValidateBsp(bsp, name, log);
}

// ---- Maps moved as a whole ----

namespace {

constexpr double kMostShift = 1 << 24; ///< game units: floats hold all whole numbers up to it

class Shifter {
  public:
    Shifter(Bsp &bsp, const Vec3d &shift)
        : bsp_(bsp), shift_(shift), transform_{.shift = shift}, modelStays_(bsp.models.size()),
          surfaceStays_(bsp.drawSurfaces.size()), brushStays_(bsp.brushes.size()) {}

    void Run(std::string_view name) {
        ShiftEntities(name);
        for (std::size_t i = 0; i < bsp_.models.size(); ++i)
            if (!modelStays_[i])
                bsp_.models[i].mins = Moved(bsp_.models[i].mins), bsp_.models[i].maxs = Moved(bsp_.models[i].maxs);
        for (bspNode_t &node : bsp_.nodes)
            TransformBox(transform_, node.mins, node.maxs);
        for (bspLeaf_t &leaf : bsp_.leafs)
            if (!Stays(leaf))
                TransformBox(transform_, leaf.mins, leaf.maxs);
        ShiftVerts();
        for (std::size_t i = 0; i < bsp_.drawSurfaces.size(); ++i)
            if (!surfaceStays_[i])
                ShiftVectors(bsp_.drawSurfaces[i]);
        ShiftPlanes();
        for (bspAdvertisement_t &advertisement : bsp_.advertisements)
            for (Float3 &corner : advertisement.rect)
                corner = Moved(corner);
    }

  private:
    Float3 Moved(const Float3 &p) const { return Vec3f(Vec3d(p) + shift_).Array(); }

    /// Whether the leaf belongs to a model that stays.
    bool Stays(const bspLeaf_t &leaf) const {
        if (leaf.numBSPLeafSurfaces > 0)
            return surfaceStays_[std::size_t(bsp_.leafSurfaces[std::size_t(leaf.firstBSPLeafSurface)])];
        return leaf.numBSPLeafBrushes > 0 &&
               brushStays_[std::size_t(bsp_.leafBrushes[std::size_t(leaf.firstBSPLeafBrush)])];
    }

    void ShiftVectors(bspDrawSurface_t &surface) const {
        if (surface.surfaceType == MST_PATCH) { // [0] and [1] are a box
            surface.lightmapVecs[0] = Moved(surface.lightmapVecs[0]);
            surface.lightmapVecs[1] = Moved(surface.lightmapVecs[1]);
        } else if (surface.surfaceType == MST_PLANAR || surface.surfaceType == MST_FLARE) {
            surface.lightmapOrigin = Moved(surface.lightmapOrigin);
        }
    }

    std::size_t ModelOf(const Entity &entity) const;
    void MarkAsStaying(std::size_t number);
    void ShiftEntities(std::string_view name);
    void ShiftVerts();
    void ShiftPlanes();
    std::vector<bool> PlanePairsThatMove() const;
    int CopyOfPlane(int plane);

    Bsp &bsp_;
    Vec3d shift_;
    AxisTransform transform_; ///< by the same vector
    /// Models of entities with an origin, relative to which they are, and the surfaces and brushes of these models.
    std::vector<bool> modelStays_, surfaceStays_, brushStays_;
    std::map<int, int> planeCopies_; ///< first plane of a pair's copy, by the first plane of the pair
};

/// Number of the inline model of an entity; 0: it has none.
std::size_t Shifter::ModelOf(const Entity &entity) const {
    const std::string_view model = entity.Value("model");
    const int number = model.starts_with('*') ? IntegerFromText(model.substr(1)) : 0;
    return number > 0 && std::size_t(number) < bsp_.models.size() ? std::size_t(number) : 0;
}

void Shifter::MarkAsStaying(std::size_t number) {
    const bspModel_t &model = bsp_.models[number];
    modelStays_[number] = true;
    std::fill_n(surfaceStays_.begin() + model.firstBSPSurface, model.numBSPSurfaces, true);
    std::fill_n(brushStays_.begin() + model.firstBSPBrush, model.numBSPBrushes, true);
}

void Shifter::ShiftEntities(std::string_view name) {
    std::vector<Entity> entities = StoredEntities(bsp_.entities, name);
    for (const Entity &entity : entities)
        if (const std::size_t model = ModelOf(entity); model > 0 && entity.Vector({"origin"}))
            MarkAsStaying(model);
    for (std::size_t i = 1; i < entities.size(); ++i) {
        Entity &entity = entities[i];
        const auto origin = entity.Vector({"origin"});
        // Another entity may share a model that stays, and have no origin yet.
        if (origin || modelStays_[ModelOf(entity)])
            entity.Set("origin", VectorText(Vec3d(origin.value_or(Vec3f{})) + shift_));
    }
    bsp_.entities = FormatEntities(entities);
}

void Shifter::ShiftVerts() {
    // By vertex; one that surfaces share may be both. Those of a surface that stays are then copied.
    std::vector<bool> stays(bsp_.drawVerts.size()), moves(bsp_.drawVerts.size());
    const auto mark = [](std::vector<bool> &marks, int first, int count) {
        std::fill_n(marks.begin() + first, count, true);
    };
    for (std::size_t i = 0; i < bsp_.drawSurfaces.size(); ++i) {
        const bspDrawSurface_t &surface = bsp_.drawSurfaces[i];
        // The mesh of foliage is relative to its instances, whose places follow.
        const bool isFoliage = surface.surfaceType == MST_FOLIAGE;
        const int relative = surfaceStays_[i] ? surface.numVerts
                             : isFoliage      ? std::clamp(surface.patchHeight, 0, surface.numVerts)
                                              : 0;
        mark(stays, surface.firstVert, relative);
        mark(moves, surface.firstVert + relative, surface.numVerts - relative);
    }
    for (std::size_t i = 0; i < bsp_.drawSurfaces.size(); ++i) {
        bspDrawSurface_t &surface = bsp_.drawSurfaces[i];
        const auto first = moves.begin() + surface.firstVert, end = first + surface.numVerts;
        const bool sharesVerts = std::find(first, end, true) != end;
        if (!surfaceStays_[i] || !sharesVerts)
            continue;
        const auto copied = std::vector<bspDrawVert_t>(bsp_.drawVerts.begin() + surface.firstVert,
                                                       bsp_.drawVerts.begin() + surface.firstVert + surface.numVerts);
        surface.firstVert = int(bsp_.drawVerts.size());
        bsp_.drawVerts.insert(bsp_.drawVerts.end(), copied.begin(), copied.end());
        moves.resize(bsp_.drawVerts.size()), stays.resize(bsp_.drawVerts.size());
        mark(stays, surface.firstVert, surface.numVerts);
    }
    for (std::size_t i = 0; i < bsp_.drawVerts.size(); ++i)
        if (moves[i] || !stays[i])
            bsp_.drawVerts[i].xyz = Moved(bsp_.drawVerts[i].xyz);
}

/// Which pairs of opposite planes move: those of nodes and of moved brushes, and those that nothing uses.
std::vector<bool> Shifter::PlanePairsThatMove() const {
    std::vector<bool> moves((bsp_.planes.size() + 1) / 2), stays(moves.size());
    for (const bspNode_t &node : bsp_.nodes)
        moves[std::size_t(node.planeNum / 2)] = true;
    for (std::size_t i = 0; i < bsp_.brushes.size(); ++i)
        for (int side = 0; side < bsp_.brushes[i].numSides; ++side) {
            const int plane = bsp_.brushSides[std::size_t(bsp_.brushes[i].firstSide + side)].planeNum;
            (brushStays_[i] ? stays : moves)[std::size_t(plane / 2)] = true;
        }
    for (std::size_t i = 0; i < moves.size(); ++i)
        moves[i] = moves[i] || !stays[i];
    return moves;
}

/// The plane of the same place in a copy of its pair, which does not move.
int Shifter::CopyOfPlane(int plane) {
    const int first = plane & ~1;
    const auto [at, isNew] = planeCopies_.try_emplace(first, 0);
    if (isNew) {
        if (bsp_.planes.size() % 2 == 1)
            bsp_.planes.push_back(bsp_.planes.back());
        at->second = int(bsp_.planes.size());
        for (const int i : {first, std::min(first + 1, at->second - 1)}) {
            const bspPlane_t copy = bsp_.planes[std::size_t(i)];
            bsp_.planes.push_back(copy);
        }
    }
    return at->second + (plane & 1);
}

void Shifter::ShiftPlanes() {
    const std::vector<bool> moves = PlanePairsThatMove();
    const std::size_t count = bsp_.planes.size();
    for (std::size_t i = 0; i < bsp_.brushes.size(); ++i)
        for (int side = 0; brushStays_[i] && side < bsp_.brushes[i].numSides; ++side) {
            std::int32_t &plane = bsp_.brushSides[std::size_t(bsp_.brushes[i].firstSide + side)].planeNum;
            if (std::size_t(plane) < count && moves[std::size_t(plane / 2)])
                plane = CopyOfPlane(plane);
        }
    for (std::size_t i = 0; i < count; ++i)
        if (moves[i / 2]) {
            bspPlane_t &plane = bsp_.planes[i];
            plane.dist = float(double(plane.dist) + Dot(Vec3d(plane.normal), shift_));
        }
}

} // namespace

void ShiftMap(Bsp &bsp, const Vec3d &shift, std::string_view name, Log &log) {
    for (const double by : shift.Array())
        if (!(std::abs(by) <= kMostShift))
            throw Error("-shift: the distance is {:g}, expected at most {:g}", by, kMostShift);
    const Bsp before = bsp;
    Shifter(bsp, shift).Run(name);
    TransformLumps(before, {.shift = shift}, bsp, log);
    ValidateBsp(bsp, name, log);
}

} // namespace q3
