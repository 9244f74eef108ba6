// GPL-2.0-or-later. The last step of a pass over luxels: floodlight, dirt, and luxels without light of their own.
#include "q3map2/lightmap/direct/luxel_fill.h"

#include "libs/math/color.h"
#include "q3map2/lightmap/raw/luxel_masks.h"
#include "q3map2/lightmap/raw/vector_colors.h"

#include <algorithm>

namespace q3 {

namespace {

/// -dark: ambient light counts as this many neighbors in the mean.
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
            const float share = std::max(1.0f / 256, Luminance(flood) / 255 * lightmap.floodDirectionScale);
            lightmap.directions[i] += lightmap.normals[i] * share;
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
        : lightmap_(lightmap), dark_(in.lightmap.dark),
          ambient_(pass.bounce ? Vec3f{} : lightmap.ambient) {}

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
        for (int oy = std::max(y - 1, 0); oy <= std::min(y + 1, lightmap_.SuperHeight() - 1); ++oy)
            for (int ox = std::max(x - 1, 0); ox <= std::min(x + 1, lightmap_.SuperWidth() - 1); ++ox) {
                const std::size_t from = lightmap_.SuperIndex(ox, oy);
                if (from == at || !lightmap_.Mapped(from) || lightmap_.filled[slot][from] == 0)
                    continue;
                if (needsDirection)
                    direction += lightmap_.directions[from], directions += 1;
                if (lightmap_.splotchFix && lightmap_.light[slot][from] == ambient_)
                    continue;
                color += lightmap_.light[slot][from], colors += 1;
                for (std::size_t c = 0; c < channels.size(); ++c)
                    sums[c] += channels[c][from];
            }
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
        LuxelFill(in, pass, lightmap).Run();
    });
}

} // namespace q3
