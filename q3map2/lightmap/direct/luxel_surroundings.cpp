// GPL-2.0-or-later. What lies around the luxels of a raw lightmap: drawn surfaces by place, and where they go on in
// other lightmaps.
#include "q3map2/lightmap/direct/luxel_surroundings.h"

#include "q3map2/light/batch/receivers.h"
#include "q3map2/lightmap/raw/face_scene.h"
#include "q3map2/lightmap/raw/luxel_raster.h"

#include <algorithm>
#include <cmath>

namespace q3 {

// ---- Finds the drawn surface at a place, and its luxels there ----

SurfaceFinder::SurfaceFinder(const SurfaceInputs &in, const SurfaceLight &surfaces)
    : in_(in), surfaces_(surfaces), models_(in.bsp.drawSurfaces.size()), opaque_(std::make_unique<FaceScene>()),
      translucent_(std::make_unique<FaceScene>()) {
    FindModels();
    for (std::size_t i = 0; i < in.bsp.drawSurfaces.size(); ++i) {
        const bspShader_t &record = in.bsp.shaders[std::size_t(in.bsp.drawSurfaces[i].shaderNum)];
        const ShaderInfo &shader = *in.table[i].shader;
        if ((shader.compileFlags & (C_NODRAW | C_SKY)) != 0 || shader.autosprite || in.table[i].skyBoxCopy ||
            (record.surfaceFlags & in.options.noDrawSurfaceFlags) != 0)
            continue;
        for (const Face &face : FacesOf(in, surfaces, i))
            (KindOf(int(i)) == Kind::Opaque ? opaque_ : translucent_)->Add(int(i), face);
    }
    opaque_->Commit();
    translucent_->Commit();
}

SurfaceFinder::~SurfaceFinder() = default;

void SurfaceFinder::FindModels() {
    for (std::size_t m = 1; m < in_.bsp.models.size(); ++m) {
        const bspModel_t &model = in_.bsp.models[m];
        for (int i = std::max(0, model.firstBSPSurface);
             i < std::min(model.firstBSPSurface + model.numBSPSurfaces, int(models_.size())); ++i)
            models_[std::size_t(i)] = int(m);
    }
}

SurfaceFinder::Kind SurfaceFinder::KindOf(int surface) const {
    const bool translucent = (in_.table[std::size_t(surface)].shader->compileFlags & C_TRANSLUCENT) != 0;
    return translucent ? Kind::Translucent : Kind::Opaque;
}

SurfaceFinder::Places SurfaceFinder::FirstHits(const RayPacket &rays, Kind kind) const {
    const FaceScene::Hits hits =
        (kind == Kind::Opaque ? opaque_ : translucent_)->FirstHits(rays, RayCoherence::Coherent);
    Places places;
    for (std::size_t i = 0; i < kPacketSize; ++i) {
        if (!hits.triangle[i] || !hits.InFront(i, rays))
            continue;
        const FaceTriangle &triangle = *hits.triangle[i];
        SurfacePlace &place = places[i];
        place.surface = triangle.surface;
        place.lightmap = surfaces_.lightmapOf[std::size_t(triangle.surface)];
        place.position = triangle.PositionAt(hits.u[i], hits.v[i]);
        place.luxel = triangle.LuxelAt(hits.u[i], hits.v[i]);
        place.normal = Normalize(triangle.NormalAt(hits.u[i], hits.v[i]));
        place.facet = Normalize(triangle.front);
    }
    return places;
}

void SurfaceFinder::TraceOccluded(RayPacket &rays) const {
    opaque_->TraceOccluded(rays);
}

bool SurfaceFinder::FindTap(const SurfacePlace &place, LuxelTap &tap) const {
    const RawLightmap &raw = surfaces_.lightmaps[std::size_t(place.lightmap)];
    tap.lightmap = std::uint32_t(place.lightmap);
    const auto split = [](float at, int size, std::array<int, 2> &luxels, std::array<float, 2> &fractions) {
        const float first = std::isfinite(at) ? std::floor(std::clamp(at - 0.5f, 0.0f, float(size - 1))) : 0;
        luxels = {int(first), std::min(int(first) + 1, size - 1)};
        fractions[1] = std::isfinite(at) ? std::clamp(at - 0.5f - first, 0.0f, 1.0f) : 0;
        fractions[0] = 1 - fractions[1];
    };
    std::array<int, 2> x{}, y{};
    std::array<float, 2> across{}, down{};
    split(place.luxel[0], raw.SuperWidth(), x, across);
    split(place.luxel[1], raw.SuperHeight(), y, down);
    float sum = 0;
    for (std::size_t i = 0; i < 4; ++i) {
        const std::size_t luxel = raw.SuperIndex(x[i & 1], y[i >> 1]);
        tap.luxels[i] = std::uint32_t(luxel);
        tap.weights[i] = raw.Mapped(luxel) ? across[i & 1] * down[i >> 1] : 0;
        sum += tap.weights[i];
    }
    for (float &weight : tap.weights)
        weight = sum > 0 ? weight / sum : 0;
    return sum > 0;
}

// ---- What lies around the luxels of a raw lightmap: where its surfaces go on in other lightmaps ----

namespace {

/// Surfaces continue each other if their normals turn by at most 30 degrees from cell to cell, of which kMostTurnCosine
/// is the cosine, and the segment between the cells leaves the surface by at most kMaxRise of its length plus
/// kRiseSlack (game units).
constexpr float kMostTurnCosine = 0.866f, kMaxRise = 0.15f, kRiseSlack = 0.25f;
/// A surface is searched this far over and under the tangent plane, plus kHeightFraction of the step. Game units.
constexpr float kHeight = 2, kHeightFraction = 0.5f;
/// The ray that tests whether the segment to a cell is free runs this far over the surfaces, plus kLiftFraction of the
/// step. Game units.
constexpr float kLift = 1, kLiftFraction = 0.125f;
/// Where the normal has a smaller component along the axis of the lightmap, steps do not follow the slope of the
/// surface.
constexpr float kLeastSlant = 0.1f;

/// In tapOf_ and footingOf_: the cell has none.
constexpr std::uint32_t kNone = ~std::uint32_t(0);

/// Steps to the cells around one, those at its corners last.
constexpr std::array<std::array<int, 2>, 8> kAround{
    {{1, 0}, {-1, 0}, {0, 1}, {0, -1}, {1, 1}, {-1, 1}, {1, -1}, {-1, -1}}};

/// `v` turned into the plane with normal n, at its length.
Vec3f IntoPlane(const Vec3f &v, const Vec3f &n) {
    return Normalize(v - n * Dot(v, n)) * Length(v);
}

} // namespace

/// Whether a surface was found that faces about the same way and moves together with the lightmap's own.
bool LuxelSurroundings::FacesAlike(const Vec3f &normal, const SurfacePlace &place) const {
    return place.surface >= 0 && Dot(normal, place.normal) >= kMostTurnCosine &&
           finder_.MoveTogether(place.surface, raw_->surfaces.front());
}

/// Whether a place that was found from `from` continues the same surface.
bool LuxelSurroundings::Continues(const Footing &from, const SurfacePlace &place) const {
    if (!FacesAlike(from.normal, place))
        return false;
    // Curves are drawn as facets: the segment lies in the plane of one of them, or between both.
    const Vec3f offset = place.position - from.position;
    const float most = kMaxRise * Length(offset) + kRiseSlack;
    return std::abs(Dot(offset, Normalize(from.normal + place.normal))) <= most ||
           std::abs(Dot(offset, from.facet)) <= most || std::abs(Dot(offset, place.facet)) <= most;
}

/// Makes the cell Tapped.
void LuxelSurroundings::Tap(std::size_t cell, const LuxelTap &tap) {
    states_[cell] = CellState::Tapped;
    tapOf_[cell] = std::uint32_t(taps_.size());
    taps_.push_back(tap);
    if (const auto at = std::lower_bound(neighbors_.begin(), neighbors_.end(), tap.lightmap);
        at == neighbors_.end() || *at != tap.lightmap)
        neighbors_.insert(at, tap.lightmap);
}

/// The footing at a mapped luxel, with its center instead of the position at which it is lit.
LuxelSurroundings::Footing LuxelSurroundings::FootingOf(int x, int y) const {
    const RawLightmap &raw = *raw_;
    const std::size_t luxel = raw.SuperIndex(x, y);
    Footing at{raw.positions[luxel], raw.normals[luxel], raw.normals[luxel], {}, {}};
    if (raw.planar && raw.hasVectors) {
        at.position = raw.origin + raw.step[0] * float(x) + raw.step[1] * float(y);
        at.normal = at.facet = raw.planeNormal;
        at.across = raw.step[0], at.down = raw.step[1];
        return at;
    }
    if (raw.hasVectors) {
        const std::size_t along = AxesOf(raw.axis).along;
        const auto step = [&](const Vec3f &one) {
            Vec3f slanted = one;
            if (std::abs(at.normal[along]) > kLeastSlant)
                slanted[along] -= Dot(one, at.normal) / at.normal[along];
            return slanted;
        };
        at.across = step(raw.step[0]), at.down = step(raw.step[1]);
        return at;
    }
    // A curve: the steps between its own luxels.
    const auto step = [&](int dx, int dy) {
        const auto position = [&](int side) {
            const int u = std::clamp(x + side * dx, 0, raw.SuperWidth() - 1),
                      v = std::clamp(y + side * dy, 0, raw.SuperHeight() - 1);
            const std::size_t other = raw.SuperIndex(u, v);
            return raw.Mapped(other) ? std::pair{side * int(other != luxel), raw.positions[other]}
                                     : std::pair{0, raw.positions[luxel]};
        };
        const auto [before, from] = position(-1);
        const auto [after, to] = position(1);
        return after == before ? Vec3f{} : (to - from) / float(after - before);
    };
    at.across = step(1, 0), at.down = step(0, 1);
    return at;
}

/// Finds where the outermost luxels stand. One whose center lies on a surface of another lightmap takes its light.
void LuxelSurroundings::LookAtBorder(const LuxelMask &nearBorder) {
    struct Look {
        std::size_t cell;
        std::uint32_t footing;
    };
    auto rays = MakeRayBatcher<Look>([&](RayPacket &packet, std::span<const Look> looks) {
        const SurfaceFinder::Places places = finder_.FirstHits(packet, kind_);
        for (std::size_t i = 0; i < looks.size(); ++i) {
            Footing &at = footings_[looks[i].footing];
            if (!FacesAlike(at.normal, places[i])) { // beside the surface: nothing to walk on
                footingOf_[looks[i].cell] = kNone;
                continue;
            }
            LuxelTap tap;
            if (places[i].lightmap >= 0 && std::size_t(places[i].lightmap) != lightmap_ &&
                finder_.FindTap(places[i], tap))
                Tap(looks[i].cell, tap);
            at.position = places[i].position, at.normal = places[i].normal, at.facet = places[i].facet;
            at.across = IntoPlane(at.across, at.normal), at.down = IntoPlane(at.down, at.normal);
        }
    });
    for (int y = 0; y < raw_->SuperHeight(); ++y)
        for (int x = 0; x < raw_->SuperWidth(); ++x) {
            const std::size_t cell = CellOf(x, y);
            if (!raw_->Mapped(raw_->SuperIndex(x, y)))
                continue;
            states_[cell] = CellState::Own;
            visited_[cell] = 1;
            if (nearBorder[cell] == 0)
                continue;
            const Footing at = FootingOf(x, y);
            footingOf_[cell] = std::uint32_t(footings_.size());
            footings_.push_back(at);
            const float height = kHeight + kHeightFraction * std::max(Length(at.across), Length(at.down));
            rays.Add({cell, footingOf_[cell]}, at.position + at.normal * height, -at.normal, 2 * height);
        }
    rays.Flush();
}

/// Steps to cells that the walk has not been at, from their neighbors in the frontier, the cells of the last steps;
/// from one beside them rather than from one at a corner.
void LuxelSurroundings::FindNextSteps(std::span<const std::size_t> frontier, std::vector<Step> &steps) {
    steps.clear();
    for (const auto &[dx, dy] : kAround)
        for (const std::size_t cell : frontier) {
            const auto x = int(cell % std::size_t(width_)) + dx, y = int(cell / std::size_t(width_)) + dy;
            if (x < 0 || y < 0 || x >= width_ || y >= height_)
                continue;
            const std::size_t next = std::size_t(y) * std::size_t(width_) + std::size_t(x);
            const Footing &from = footings_[footingOf_[cell]];
            if (visited_[next] != 0 || (dx != 0 && from.across == Vec3f{}) || (dy != 0 && from.down == Vec3f{}))
                continue;
            visited_[next] = 1;
            steps.push_back({next, from, from.position + from.across * float(dx) + from.down * float(dy)});
        }
}

/// Sets where the steps lead, if the surface continues there and nothing opaque is in between.
void LuxelSurroundings::TakeSteps(std::vector<Step> &steps) {
    auto downRays = MakeRayBatcher<std::size_t>([&](RayPacket &packet, std::span<const std::size_t> numbers) {
        const SurfaceFinder::Places places = finder_.FirstHits(packet, kind_);
        for (std::size_t i = 0; i < numbers.size(); ++i)
            if (Step &step = steps[numbers[i]]; Continues(step.from, places[i]))
                step.found = places[i];
    });
    for (std::size_t i = 0; i < steps.size(); ++i) {
        const Footing &from = steps[i].from;
        const float height = kHeight + kHeightFraction * Length(steps[i].target - from.position);
        downRays.Add(i, steps[i].target + from.normal * height, -from.normal, 2 * height);
    }
    downRays.Flush();
    auto betweenRays = MakeRayBatcher<std::size_t>([&](RayPacket &packet, std::span<const std::size_t> numbers) {
        finder_.TraceOccluded(packet);
        for (std::size_t i = 0; i < numbers.size(); ++i)
            if (packet.live[i] == 0)
                steps[numbers[i]].found = {};
    });
    for (std::size_t i = 0; i < steps.size(); ++i)
        if (const auto &[cell, from, target, found] = steps[i]; found.surface >= 0) {
            const float lift = kLift + kLiftFraction * Length(found.position - from.position);
            betweenRays.Aim(i, from.position + from.normal * lift, found.position + found.normal * lift);
        }
    betweenRays.Flush();
}

/// Sets the state of a cell after the step to it.
void LuxelSurroundings::Arrive(const Step &step) {
    const auto &[cell, from, target, found] = step;
    if (found.surface < 0)
        return;
    LuxelTap tap;
    const bool tapped = found.lightmap >= 0 && finder_.FindTap(found, tap);
    const auto x = int(cell % std::size_t(width_)) - reach_, y = int(cell / std::size_t(width_)) - reach_;
    const bool inside = x >= 0 && y >= 0 && x < raw_->SuperWidth() && y < raw_->SuperHeight();
    if (inside && std::size_t(found.lightmap) == lightmap_)
        return; // a luxel of its own without light: in a solid, or below something
    if (!tapped) {
        states_[cell] = CellState::Blocked;
        return;
    }
    Tap(cell, tap);
    footingOf_[cell] = std::uint32_t(footings_.size());
    footings_.push_back({found.position, found.normal, found.facet, IntoPlane(from.across, found.normal),
                         IntoPlane(from.down, found.normal)});
}

void LuxelSurroundings::Walk(std::size_t lightmap, int reach) {
    raw_ = &surfaces_.lightmaps[lightmap];
    lightmap_ = lightmap, reach_ = reach;
    width_ = raw_->SuperWidth() + 2 * reach, height_ = raw_->SuperHeight() + 2 * reach;
    kind_ = finder_.KindOf(raw_->surfaces.front());
    const std::size_t cells = std::size_t(width_) * std::size_t(height_);
    states_.assign(cells, CellState::Empty);
    visited_.assign(cells, 0);
    tapOf_.assign(cells, kNone), footingOf_.assign(cells, kNone);
    taps_.clear(), footings_.clear(), neighbors_.clear();
    LuxelMask outside(cells, 1);
    for (int y = 0; y < raw_->SuperHeight(); ++y)
        for (int x = 0; x < raw_->SuperWidth(); ++x)
            outside[CellOf(x, y)] = !raw_->Mapped(raw_->SuperIndex(x, y));
    const LuxelMask besideOutside = Dilate(outside, width_, height_);
    // Rings of luxels beside the surface, and the luxels that it covers in part.
    LuxelMask nearBorder = std::move(outside);
    for (int ring = 0; ring <= std::max(1, raw_->super / 2); ++ring)
        nearBorder = Dilate(nearBorder, width_, height_);
    LookAtBorder(nearBorder);
    std::vector<std::size_t> frontier;
    for (std::size_t cell = 0; cell < cells; ++cell)
        if (footingOf_[cell] != kNone && besideOutside[cell] != 0)
            frontier.push_back(cell);
    std::vector<Step> steps;
    for (int ring = 0; ring < reach && !frontier.empty(); ++ring) {
        FindNextSteps(frontier, steps);
        TakeSteps(steps);
        frontier.clear();
        for (const Step &step : steps) {
            Arrive(step);
            if (states_[step.cell] == CellState::Tapped)
                frontier.push_back(step.cell);
        }
    }
}

} // namespace q3
