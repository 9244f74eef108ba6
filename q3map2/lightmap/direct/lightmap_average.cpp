// GPL-2.0-or-later. The last steps of a pass over luxels: dirt and floodlight, light from neighbors for luxels
// without a position, and averages of super luxels.
#include "q3map2/lightmap/direct/lightmap_average.h"

#include "libs/math/vec.h"
#include "q3map2/lightmap/raw/lightmaps.h"
#include "q3map2/lightmap/raw/luxel_normal.h"
#include "q3map2/lightmap/raw/luxel_position.h"

#include <algorithm>

namespace q3 {

// ---- The last step of a pass over luxels: floodlight, dirt, and luxels without light of their own ----

namespace {

/// -dark: ambient light counts as this many neighbors in the mean (chosen).
constexpr float kDarkNeighbors = 2;

void AddFloodlight(RawLightmap &lightmap, bool deluxe) {
    for (std::size_t i = 0; i < lightmap.floodlight.size(); ++i) {
        if (!lightmap.Mapped(i))
            continue;
        const Vec3f &flood = lightmap.floodlight[i];
        lightmap.light[0][i] += flood;
        for (std::size_t c = 0; c < lightmap.channels.Count(); ++c)
            lightmap.directional[0][c][i] += lightmap.floodChannels[c][i];
        if (deluxe && lightmap.floodDirectionScale > 0) {
            const float weight = std::max(kLeastDeluxeWeight, Luminance(flood) / 255 * lightmap.floodDirectionScale);
            lightmap.directions[i] += lightmap.normals[i] * weight;
        }
    }
}

void ShowNormals(RawLightmap &lightmap) {
    for (std::size_t i = 0; i < lightmap.luxelClusters.size(); ++i)
        if (lightmap.Mapped(i))
            lightmap.light[0][i] = VectorColor(lightmap.normals[i]);
}

void ApplyDirt(RawLightmap &lightmap) {
    const auto apply = [&](std::vector<Vec3f> &light) {
        for (std::size_t i = 0; i < light.size() && i < lightmap.dirt.size(); ++i)
            light[i] *= lightmap.dirt[i];
    };
    for (std::size_t slot = 0; slot < kStyles; ++slot) {
        apply(lightmap.light[slot]);
        for (std::vector<Vec3f> &channel : lightmap.directional[slot])
            apply(channel);
    }
}

/// Fills luxels from their neighbors.
class LuxelFill {
  public:
    LuxelFill(const SurfaceInputs &in, const SurfacePass &pass, RawLightmap &lightmap)
        : lightmap_(lightmap), dark_(in.lightmap.dark), ambient_(pass.bounce ? Vec3f{} : lightmap.ambient) {}

    /// In place and row by row: with q3map_splotchFix a fixed luxel counts as a neighbor of the next.
    void Run() {
        for (std::size_t slot = 0; slot < kStyles; ++slot)
            if (!lightmap_.light[slot].empty())
                FillSlot(slot);
    }

  private:
    bool IsSplotch(std::size_t slot, std::size_t luxel) const {
        const Vec3f &light = lightmap_.light[slot][luxel];
        return lightmap_.splotchFix && (light.x <= ambient_.x || light.y <= ambient_.y || light.z <= ambient_.z);
    }

    void FillSlot(std::size_t slot) {
        LuxelMask sources(lightmap_.luxelClusters.size());
        for (std::size_t i = 0; i < sources.size(); ++i)
            sources[i] = lightmap_.Mapped(i) && lightmap_.filled[slot][i] != 0;
        const LuxelMask touching = Dilate(sources, lightmap_.SuperWidth(), lightmap_.SuperHeight());
        for (int y = 0; y < lightmap_.SuperHeight(); ++y)
            for (int x = 0; x < lightmap_.SuperWidth(); ++x)
                if (const std::size_t at = lightmap_.SuperIndex(x, y);
                    touching[at] != 0 && (lightmap_.splotchFix || !lightmap_.Mapped(at)))
                    Fill(slot, x, y);
    }

    void Fill(std::size_t slot, int x, int y) {
        const std::size_t at = lightmap_.SuperIndex(x, y);
        const bool mapped = lightmap_.Mapped(at), needsColor = !mapped || IsSplotch(slot, at);
        const bool needsDirection = slot == 0 && !lightmap_.directions.empty() && !mapped;
        if (!needsColor && !needsDirection)
            return;
        Vec3f color, direction;
        float colors = 0, directions = 0;
        ChannelImages &channels = lightmap_.directional[slot];
        std::array<Vec3f, kMaxChannels> sums{};
        ForNeighborhood(x, y, lightmap_.SuperWidth(), lightmap_.SuperHeight(), [&](int nx, int ny) {
            const std::size_t from = lightmap_.SuperIndex(nx, ny);
            if (from == at || !lightmap_.Mapped(from) || lightmap_.filled[slot][from] == 0)
                return;
            if (needsDirection)
                direction += lightmap_.directions[from], directions += 1;
            if (lightmap_.splotchFix && lightmap_.light[slot][from] == ambient_)
                return;
            color += lightmap_.light[slot][from], colors += 1;
            for (std::size_t c = 0; c < channels.size(); ++c)
                sums[c] += channels[c][from];
        });
        if (directions > 0)
            lightmap_.directions[at] = direction / directions;
        if (!needsColor || colors == 0)
            return;
        if (dark_) {
            const Vec3f ambient = slot == 0 ? ambient_ * kDarkNeighbors : Vec3f{};
            const ChannelWeights uniform = UniformWeights(lightmap_.channels);
            color += ambient;
            for (std::size_t c = 0; c < channels.size(); ++c)
                sums[c] += ambient * uniform[c];
            colors += kDarkNeighbors;
        }
        lightmap_.light[slot][at] = color / colors;
        for (std::size_t c = 0; c < channels.size(); ++c)
            channels[c][at] = sums[c] / colors;
        lightmap_.filled[slot][at] = 1;
        if (lightmap_.luxelClusters[at] < 0)
            lightmap_.luxelClusters[at] = kFlooded;
    }

    RawLightmap &lightmap_;
    bool dark_;
    Vec3f ambient_;
};

} // namespace

void FinishLuxels(const SurfaceInputs &in, const SurfacePass &pass, SurfaceLight &surfaces) {
    in.jobs.For(std::int64_t(surfaces.lightmaps.size()), [&](std::int64_t index, int) {
        RawLightmap &lightmap = surfaces.lightmaps[std::size_t(index)];
        if (!pass.bounce)
            AddFloodlight(lightmap, in.lightmap.deluxe);
        if (in.lightmap.debugNormals)
            ShowNormals(lightmap);
        ApplyDirt(lightmap);
        if (!in.lightmap.dark)
            FillWallLuxels(in.space, lightmap);
        LuxelFill(in, pass, lightmap).Run();
    });
}

// ---- Averages the light of super luxels into luxels ----

namespace {

constexpr Vec3f kUnused{-1, -1, -1};     ///< result of a luxel with no surface on it or beside it
constexpr Vec3f kBorderColor{255, 0, 0}; ///< -border; -debug: corner of a further style

/// -debug: color of luxels without a cluster.
Vec3f NoClusterColor(int cluster) {
    switch (cluster) {
    case kUnmapped:
        return {255, 204, 0};
    case kOccluded:
        return {255, 0, 255};
    default:
        return {0, 32, 255};
    }
}

/// Whether a super luxel is mapped or was filled from mapped ones. Others that hold a value count only in luxels
/// without any of these.
bool CountsAsLit(int cluster) {
    return cluster >= 0 || cluster == kFlooded;
}

/// Sums over the super luxels of a luxel.
struct SuperLuxelSum {
    Vec3f lit;     ///< light of super luxels that CountsAsLit
    Vec3f reserve; ///< of other super luxels that hold a value; used only if litCount is 0
    int litCount = 0, reserveCount = 0, surfaceCount = 0;
    Vec3f direction;
};

/// Luxels of one style of one raw lightmap in one pass. Vectors are reused.
struct LuxelGrid {
    std::vector<Vec3f> colors, directions;
    std::vector<Vec3f> channel;  ///< means of one directional channel
    std::vector<Vec3f> lastPass; ///< radiosity of the last pass, which the lightmap does not keep
    LuxelMask valid;             ///< whether colors and directions hold a value
};

class Averager {
  public:
    Averager(const RawLightmap &lightmap, std::size_t slot, const LightmapOptions &options)
        : lightmap_(lightmap), slot_(slot), options_(options) {}

    void Fill(LuxelGrid &grid, const Vec3f &ambient) const {
        const std::size_t count = std::size_t(lightmap_.width) * std::size_t(lightmap_.height);
        grid.colors.resize(count);
        grid.valid.resize(count);
        grid.directions.resize(IsSpoiledByUnevenScaling() ? count : 0);
        if (lightmap_.super == 1 && !options_.debug && !options_.border)
            return FillWithoutSuper(grid, ambient);
        for (int y = 0; y < lightmap_.height; ++y)
            for (int x = 0; x < lightmap_.width; ++x) {
                const std::size_t at = lightmap_.Index(x, y);
                const SuperLuxelSum sum = Sum(x, y);
                const bool lit = sum.litCount > 0;
                const int samples = lit ? sum.litCount : sum.reserveCount;
                grid.valid[at] = samples > 0 || sum.surfaceCount > 0;
                grid.colors[at] = samples > 0 ? (lit ? sum.lit : sum.reserve) / float(samples) : ambient;
                // -debug marks the lightmap of a further style by a corner of 2 x 2 luxels.
                if (options_.debug && slot_ > 0 && x < 2 && y < 2)
                    grid.colors[at] = kBorderColor, grid.valid[at] = true;
                if (IsSpoiledByUnevenScaling())
                    grid.directions[at] = sum.direction;
            }
    }

    /// Sets `channel` to the means of a directional channel. ambient: of luxels without light.
    void FillChannel(const std::vector<Vec3f> &values, const Vec3f &ambient, std::vector<Vec3f> &channel) const {
        channel.resize(std::size_t(lightmap_.width) * std::size_t(lightmap_.height));
        for (int y = 0; y < lightmap_.height; ++y)
            for (int x = 0; x < lightmap_.width; ++x)
                channel[lightmap_.Index(x, y)] = ChannelMean(values, ambient, x, y);
    }

  private:
    /// Mean over the super luxels that Sum counts as lit, or else as reserve.
    Vec3f ChannelMean(const std::vector<Vec3f> &values, const Vec3f &ambient, int x, int y) const {
        Vec3f lit, reserve;
        int litCount = 0, reserveCount = 0;
        const int super = lightmap_.super;
        for (int sy = y * super; sy < (y + 1) * super; ++sy)
            for (int sx = x * super; sx < (x + 1) * super; ++sx) {
                const std::size_t at = lightmap_.SuperIndex(sx, sy);
                if (lightmap_.filled[slot_][at] == 0)
                    continue;
                if (CountsAsLit(lightmap_.luxelClusters[at]))
                    lit += values[at], ++litCount;
                else
                    reserve += values[at], ++reserveCount;
            }
        return litCount > 0 ? lit / float(litCount) : reserveCount > 0 ? reserve / float(reserveCount) : ambient;
    }

    bool IsSpoiledByUnevenScaling() const { return slot_ == 0 && !lightmap_.directions.empty(); }

    /// Fill without supersampling.
    void FillWithoutSuper(LuxelGrid &grid, const Vec3f &ambient) const {
        const std::vector<std::uint8_t> &filled = lightmap_.filled[slot_];
        const std::vector<Vec3f> &light = lightmap_.light[slot_];
        for (std::size_t at = 0; at < grid.colors.size(); ++at) {
            grid.valid[at] = filled[at] != 0 || lightmap_.luxelClusters[at] != kUnmapped;
            grid.colors[at] = filled[at] != 0 ? light[at] : ambient;
        }
        if (IsSpoiledByUnevenScaling())
            grid.directions = lightmap_.directions;
    }

    SuperLuxelSum Sum(int x, int y) const {
        SuperLuxelSum sum;
        const int super = lightmap_.super;
        for (int sy = y * super; sy < (y + 1) * super; ++sy)
            for (int sx = x * super; sx < (x + 1) * super; ++sx)
                Add(sx, sy, sum);
        return sum;
    }

    void Add(int x, int y, SuperLuxelSum &sum) const {
        const std::size_t at = lightmap_.SuperIndex(x, y);
        const int cluster = lightmap_.luxelClusters[at];
        const bool filled = lightmap_.filled[slot_][at] != 0;
        sum.surfaceCount += cluster != kUnmapped;
        if (IsSpoiledByUnevenScaling())
            sum.direction += lightmap_.directions[at];
        if (options_.border &&
            (x == 0 || y == 0 || x == lightmap_.SuperWidth() - 1 || y == lightmap_.SuperHeight() - 1)) {
            if (filled)
                sum.lit += kBorderColor, ++sum.litCount;
        } else if (options_.debug && cluster < 0) {
            sum.reserve += NoClusterColor(cluster), ++sum.reserveCount;
        } else if (filled && CountsAsLit(cluster)) {
            sum.lit += lightmap_.light[slot_][at], ++sum.litCount;
        } else if (filled) {
            sum.reserve += lightmap_.light[slot_][at], ++sum.reserveCount;
        }
    }

    const RawLightmap &lightmap_;
    std::size_t slot_;
    const LightmapOptions &options_;
};

/// Frees data that only the passes need.
void EndPasses(RawLightmap &lightmap) {
    lightmap.positions = {}, lightmap.dirt = {}, lightmap.floodlight = {};
    lightmap.light = {}, lightmap.filled = {}, lightmap.directions = {};
    lightmap.tangents = {}, lightmap.floodChannels = {}, lightmap.directional = {};
}

/// Adds the light of a pass to the result; unused luxels (red below 0) count as zero. Without `store` luxels that the
/// pass uses are only marked as used.
void Accumulate(const std::vector<Vec3f> &pass, bool store, std::vector<Vec3f> &result) {
    if (result.empty() && store) {
        result = pass;
        return;
    }
    if (result.empty())
        result.assign(pass.size(), kUnused);
    for (std::size_t i = 0; i < pass.size(); ++i)
        if (pass[i].x >= 0)
            result[i] = (result[i].x >= 0 ? result[i] : Vec3f{}) + (store ? pass[i] : Vec3f{});
}

/// Adds the directions of a pass. Those of the first pass are moved into `result`.
void AddDirections(LuxelGrid &grid, std::vector<Vec3f> &result) {
    const std::size_t count = grid.directions.size();
    if (result.empty()) {
        result.swap(grid.directions);
        for (std::size_t i = 0; i < count; ++i)
            if (!grid.valid[i])
                result[i] = {};
        return;
    }
    for (std::size_t i = 0; i < count; ++i)
        if (grid.valid[i])
            result[i] += grid.directions[i];
}

/// Adds the directional channels of a pass to the result, except at unused luxels. used: the light of the pass.
void AccumulateChannels(const Averager &averager, const std::vector<Vec3f> &used, const LuxelMask &touching,
                        const Vec3f &ambient, bool store, std::size_t slot, LuxelGrid &grid, RawLightmap &lightmap) {
    const ChannelWeights uniform = UniformWeights(lightmap.channels);
    ChannelImages &result = lightmap.resultChannels[slot];
    result.resize(lightmap.channels.Count());
    for (std::size_t c = 0; c < result.size(); ++c) {
        result[c].resize(used.size());
        if (!store)
            continue;
        averager.FillChannel(lightmap.directional[slot][c], ambient * uniform[c], grid.channel);
        const bool isSigned = lightmap.channels.IsSH(c);
        std::size_t at = 0;
        for (int y = 0; y < lightmap.height; ++y)
            for (int x = 0; x < lightmap.width; ++x, ++at) {
                if (used[at].x < 0)
                    continue;
                const Vec3f value = grid.valid[at] ? grid.channel[at]
                                    : touching[at]
                                        ? NeighborMean(x, y, lightmap.width, lightmap.height, grid.valid, grid.channel)
                                        : Vec3f{};
                result[c][at] += isSigned ? value : Max(value, Vec3f{});
            }
    }
}

void AverageLightmap(const SurfaceInputs &in, const SurfacePass &pass, PassData data, LuxelGrid &grid,
                     RawLightmap &lightmap) {
    const bool store = pass.bounce || !in.lightmap.bounceOnly || in.lightmap.bounces == 0;
    for (std::size_t slot = 0; slot < kStyles; ++slot) {
        lightmap.radiosity[slot].clear();
        if (lightmap.styles[slot] == kNoStyle || lightmap.light[slot].empty())
            continue;
        std::vector<Vec3f> &radiosity = data == PassData::Free ? grid.lastPass : lightmap.radiosity[slot];
        const Averager averager(lightmap, slot, in.lightmap);
        const Vec3f ambient = slot == 0 && !pass.bounce ? lightmap.ambient : Vec3f{};
        averager.Fill(grid, ambient);
        radiosity.resize(grid.colors.size());
        const LuxelMask touching = Dilate(grid.valid, lightmap.width, lightmap.height);
        std::size_t at = 0;
        for (int y = 0; y < lightmap.height; ++y)
            for (int x = 0; x < lightmap.width; ++x, ++at)
                radiosity[at] =
                    grid.valid[at] ? Max(grid.colors[at], Vec3f{})
                    : touching[at]
                        ? Max(NeighborMean(x, y, lightmap.width, lightmap.height, grid.valid, grid.colors), Vec3f{})
                        : kUnused;
        AccumulateChannels(averager, radiosity, touching, ambient, store, slot, grid, lightmap);
        Accumulate(radiosity, store, lightmap.result[slot]);
        AddDirections(grid, lightmap.resultDirections);
    }
    if (data == PassData::Free)
        EndPasses(lightmap);
}

} // namespace

void AverageLuxels(const SurfaceInputs &in, const SurfacePass &pass, PassData data, SurfaceLight &surfaces) {
    std::vector<LuxelGrid> grids(std::size_t(in.jobs.Threads()));
    in.jobs.For(std::int64_t(surfaces.lightmaps.size()), [&](std::int64_t i, int worker) {
        AverageLightmap(in, pass, data, grids[std::size_t(worker)], surfaces.lightmaps[std::size_t(i)]);
    });
}

} // namespace q3
