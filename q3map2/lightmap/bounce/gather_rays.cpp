// GPL-2.0-or-later. Gather rays: their origins at luxels, and their directions.
#include "q3map2/lightmap/bounce/gather_rays.h"

#include "q3map2/light/scene/open_parts.h"
#include "q3map2/lightmap/raw/lightmaps.h"

#include <algorithm>
#include <utility>

namespace q3 {

namespace {

/// Ray origins are moved aside if a solid is this near. Game units.
constexpr float kSolidMargin = 0.25f;
/// A place is clear if at most kMaxBackHits of kTestRays rays from it hit the back of a surface.
constexpr int kTestRays = 8, kMaxBackHits = 2;

/// Finds the origins of one lightmap.
class OriginFinder {
  public:
    OriginFinder(const BspSpace &space, const BounceScene &scene, const RawLightmap &raw)
        : space_(space), scene_(scene), raw_(raw) {
        for (std::uint32_t i = 0; i < kTestRays; ++i)
            directions_[i] = CosineDirection(PlasticSample(i, 0));
    }
    std::vector<Vec3f> Find() const {
        std::vector<Vec3f> origins(raw_.luxelClusters.size());
        std::vector<std::size_t> batch;
        const auto flush = [&] {
            const auto backHits = CountBackHits(batch);
            for (std::size_t i = 0; i < batch.size(); ++i) {
                const std::size_t luxel = batch[i];
                const bool clear = backHits[i] <= kMaxBackHits && !TouchesSolid(raw_.positions[luxel]);
                origins[luxel] = clear ? raw_.positions[luxel] : PlaceAside(luxel);
            }
            batch.clear();
        };
        ForMappedLuxelsByTile(raw_, 4, [&](std::size_t luxel, int, int) {
            batch.push_back(luxel);
            if (batch.size() == kPacketSize)
                flush();
        });
        flush();
        return origins;
    }

  private:
    bool TouchesSolid(const Vec3f &p) const {
        constexpr Vec3f kMargin{kSolidMargin, kSolidMargin, kSolidMargin};
        return space_.AnySolid(p - kMargin, p + kMargin);
    }
    /// For up to 16 luxels: number of test rays from their positions that hit backs of surfaces.
    std::array<int, kPacketSize> CountBackHits(std::span<const std::size_t> luxels) const {
        std::array<int, kPacketSize> backs{};
        RayPacket rays;
        for (const Vec3f &direction : directions_) {
            for (std::size_t i = 0; i < luxels.size(); ++i)
                rays.Set(i, raw_.positions[luxels[i]], GatherFrame(raw_.normals[luxels[i]]).World(direction),
                         kRayLength);
            const auto found = scene_.FirstEmitters(rays, RayCoherence::Coherent);
            for (std::size_t i = 0; i < luxels.size(); ++i)
                backs[i] += found[i] == kBackOfSurface;
        }
        return backs;
    }
    int CountBackHitsFrom(const Vec3f &origin, const GatherFrame &frame) const {
        RayPacket rays;
        for (std::size_t i = 0; i < kTestRays; ++i)
            rays.Set(i, origin, frame.World(directions_[i]), kRayLength);
        const auto found = scene_.FirstEmitters(rays, RayCoherence::Incoherent);
        return int(std::count(found.begin(), found.begin() + kTestRays, kBackOfSurface));
    }
    /// The first clear place around the position; if none is clear, the place outside solids that sees the fewest
    /// backs.
    Vec3f PlaceAside(std::size_t luxel) const {
        const GatherFrame frame(raw_.normals[luxel]);
        const float spacing = raw_.actualSampleSize / float(raw_.super);
        const Vec3f u = raw_.hasVectors ? raw_.step[0] : frame.right * spacing;
        const Vec3f v = raw_.hasVectors ? raw_.step[1] : frame.up * spacing;
        Vec3f best = raw_.positions[luxel];
        int fewest = TouchesSolid(best) ? kTestRays + 1 : CountBackHitsFrom(best, frame);
        for (const float distance : {0.25f, 0.5f}) // luxels
            for (const auto &[x, y] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}, {1, 1}, {-1, 1}, {1, -1}, {-1, -1}}) {
                const Vec3f aside = raw_.positions[luxel] + (u * float(x) + v * float(y)) * distance;
                if (TouchesSolid(aside) ||
                    StateOfSegment(space_, raw_.positions[luxel], aside) == SegmentState::Blocked)
                    continue;
                const int backs = CountBackHitsFrom(aside, frame);
                if (backs < fewest)
                    fewest = backs, best = aside;
                if (backs <= kMaxBackHits)
                    return aside;
            }
        return best;
    }

    const BspSpace &space_;
    const BounceScene &scene_;
    const RawLightmap &raw_;
    std::array<Vec3f, kTestRays> directions_;
};

} // namespace

std::vector<Vec3f> RayOrigins(const BspSpace &space, const BounceScene &scene, const RawLightmap &raw) {
    return OriginFinder(space, scene, raw).Find();
}

} // namespace q3
