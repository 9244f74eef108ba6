// GPL-2.0-or-later. Maps moved as a whole.
#include "q3map2/edit/shift_map.h"

#include "common/error.h"
#include "q3map2/bspfile/entities.h"
#include "q3map2/edit/edit_grids.h"
#include "q3map2/edit/edit_text.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace q3 {

namespace {

constexpr double kMostShift = 1 << 24;

class Shifter {
  public:
    Shifter(Bsp &bsp, const Vec3d &shift)
        : bsp_(bsp), shift_(shift), staysModel_(bsp.models.size()), staysSurface_(bsp.drawSurfaces.size()),
          staysBrush_(bsp.brushes.size()) {}

    void Run(std::string_view name) {
        ShiftEntities(name);
        for (std::size_t i = 0; i < bsp_.models.size(); ++i)
            if (!staysModel_[i])
                bsp_.models[i].mins = Moved(bsp_.models[i].mins), bsp_.models[i].maxs = Moved(bsp_.models[i].maxs);
        for (bspNode_t &node : bsp_.nodes)
            ShiftBox(node.mins, node.maxs);
        for (bspLeaf_t &leaf : bsp_.leafs)
            if (!Stays(leaf))
                ShiftBox(leaf.mins, leaf.maxs);
        ShiftVerts();
        for (std::size_t i = 0; i < bsp_.drawSurfaces.size(); ++i)
            if (!staysSurface_[i])
                ShiftVectors(bsp_.drawSurfaces[i]);
        ShiftPlanes();
        for (bspAdvertisement_t &advertisement : bsp_.advertisements)
            for (Float3 &corner : advertisement.rect)
                corner = Moved(corner);
    }

  private:
    Float3 Moved(const Float3 &p) const { return Vec3f(Vec3d(p) + shift_).Array(); }

    void ShiftBox(Int3 &mins, Int3 &maxs) const {
        for (std::size_t i = 0; i < 3 && mins[i] <= maxs[i]; ++i) { // a box may be empty
            mins[i] = WholeBound(std::floor(mins[i] + shift_[i]));
            maxs[i] = WholeBound(std::ceil(maxs[i] + shift_[i]));
        }
    }

    /// Whether the leaf belongs to a model that stays.
    bool Stays(const bspLeaf_t &leaf) const {
        if (leaf.numBSPLeafSurfaces > 0)
            return staysSurface_[std::size_t(bsp_.leafSurfaces[std::size_t(leaf.firstBSPLeafSurface)])];
        return leaf.numBSPLeafBrushes > 0 &&
               staysBrush_[std::size_t(bsp_.leafBrushes[std::size_t(leaf.firstBSPLeafBrush)])];
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
    void KeepModel(std::size_t model);
    void ShiftEntities(std::string_view name);
    void ShiftVerts();
    void ShiftPlanes();
    std::vector<bool> PlanePairsThatMove() const;
    int CopyOfPlane(int plane);

    Bsp &bsp_;
    Vec3d shift_;
    std::vector<bool> staysModel_, staysSurface_, staysBrush_;
    std::map<int, int> planeCopies_; ///< by the first plane of a pair
};

/// 0: it has no inline model.
std::size_t Shifter::ModelOf(const Entity &entity) const {
    const std::string_view model = entity.Value("model");
    const int number = model.starts_with('*') ? IntegerFromText(model.substr(1)) : 0;
    return number > 0 && std::size_t(number) < bsp_.models.size() ? std::size_t(number) : 0;
}

void Shifter::KeepModel(std::size_t number) {
    const bspModel_t &model = bsp_.models[number];
    staysModel_[number] = true;
    std::fill_n(staysSurface_.begin() + model.firstBSPSurface, model.numBSPSurfaces, true);
    std::fill_n(staysBrush_.begin() + model.firstBSPBrush, model.numBSPBrushes, true);
}

void Shifter::ShiftEntities(std::string_view name) {
    std::vector<Entity> entities = StoredEntities(bsp_.entities, name);
    for (const Entity &entity : entities)
        if (const std::size_t model = ModelOf(entity); model > 0 && entity.Vector({"origin"}))
            KeepModel(model);
    for (std::size_t i = 1; i < entities.size(); ++i) {
        Entity &entity = entities[i];
        const auto origin = entity.Vector({"origin"});
        // Another entity may share a model that stays, and have no origin yet.
        if (origin || staysModel_[ModelOf(entity)])
            entity.Set("origin", VectorText(Vec3d(origin.value_or(Vec3f{})) + shift_));
    }
    bsp_.entities = FormatEntities(entities);
}

void Shifter::ShiftVerts() {
    std::vector<bool> stays(bsp_.drawVerts.size()), moves(bsp_.drawVerts.size());
    const auto mark = [&](std::vector<bool> &marks, int first, int count) {
        std::fill_n(marks.begin() + first, count, true);
    };
    for (std::size_t i = 0; i < bsp_.drawSurfaces.size(); ++i) {
        const bspDrawSurface_t &surface = bsp_.drawSurfaces[i];
        // The mesh of foliage is relative to its instances, whose places follow.
        const bool isFoliage = surface.surfaceType == MST_FOLIAGE;
        const int relative = staysSurface_[i] ? surface.numVerts
                             : isFoliage      ? std::clamp(surface.patchHeight, 0, surface.numVerts)
                                              : 0;
        mark(stays, surface.firstVert, relative);
        mark(moves, surface.firstVert + relative, surface.numVerts - relative);
    }
    for (std::size_t i = 0; i < bsp_.drawSurfaces.size(); ++i) {
        bspDrawSurface_t &surface = bsp_.drawSurfaces[i];
        const auto first = moves.begin() + surface.firstVert;
        if (!staysSurface_[i] || std::find(first, first + surface.numVerts, true) == first + surface.numVerts)
            continue;
        const auto copied = std::vector<bspDrawVert_t>(bsp_.drawVerts.begin() + surface.firstVert,
                                                       bsp_.drawVerts.begin() + surface.firstVert + surface.numVerts);
        surface.firstVert = int(bsp_.drawVerts.size());
        bsp_.drawVerts.insert(bsp_.drawVerts.end(), copied.begin(), copied.end());
        moves.resize(bsp_.drawVerts.size(), false), stays.resize(bsp_.drawVerts.size(), true);
    }
    for (std::size_t i = 0; i < bsp_.drawVerts.size(); ++i)
        if (moves[i] || !stays[i])
            bsp_.drawVerts[i].xyz = Moved(bsp_.drawVerts[i].xyz);
}

/// Pairs of opposite planes that nodes, moved brushes, or no brushes use.
std::vector<bool> Shifter::PlanePairsThatMove() const {
    std::vector<bool> moves((bsp_.planes.size() + 1) / 2), stays(moves.size());
    for (const bspNode_t &node : bsp_.nodes)
        moves[std::size_t(node.planeNum / 2)] = true;
    for (std::size_t i = 0; i < bsp_.brushes.size(); ++i)
        for (int side = 0; side < bsp_.brushes[i].numSides; ++side) {
            const int plane = bsp_.brushSides[std::size_t(bsp_.brushes[i].firstSide + side)].planeNum;
            (staysBrush_[i] ? stays : moves)[std::size_t(plane / 2)] = true;
        }
    for (std::size_t i = 0; i < moves.size(); ++i)
        moves[i] = moves[i] || !stays[i];
    return moves;
}

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
        for (int side = 0; staysBrush_[i] && side < bsp_.brushes[i].numSides; ++side) {
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
    TransformGrids(before, {.shift = shift}, bsp, log);
    ValidateBsp(bsp, name, log);
}

} // namespace q3
