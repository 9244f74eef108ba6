// GPL-2.0-or-later. Minimaps: pictures of a map from above, of how thick its solids are.
#include "q3map2/minimap/minimap.h"

#include "common/error.h"
#include "common/files/files.h"
#include "common/image/image.h"
#include "q3map2/minimap/minimap_levels.h"
#include "q3map2/minimap/minimap_samples.h"
#include "q3map2/minimap/minimap_solids.h"

#include <algorithm>
#include <cmath>
#include <system_error>

namespace q3 {

namespace {

void PrintBox(std::string_view what, const Boundsd &box, Log &log) {
    log.Print("{} {:f} {:f} {:f} {:f} {:f} {:f}\n", what, box.mins.x, box.mins.y, box.mins.z, box.maxs.x, box.maxs.y,
              box.maxs.z);
}

/// One row of pixels. `solids` are those that a sample of it may meet.
class MinimapRow {
  public:
    MinimapRow(const Boundsd &box, int size, int row, const MinimapSampler &sampler)
        : box_(box), size_(std::size_t(size)), sampler_(sampler), pixel_((box.maxs - box.mins) / double(size)),
          y_(box.mins.y + pixel_.y * row), first_(std::uint64_t(size) * std::uint64_t(row)) {}

    /// Adds the thickness of the solid at each sample, divided by their number and the height of the box.
    void Add(const MinimapSolid &solid, std::span<float> values, std::vector<double> &sums) const {
        // Samples lie up to half a pixel outside their pixel.
        if (solid.bounds.maxs.y < y_ - 0.5 * pixel_.y || solid.bounds.mins.y > y_ + 1.5 * pixel_.y)
            return;
        const double from = (solid.bounds.mins.x - box_.mins.x) / pixel_.x - 1.5,
                     to = (solid.bounds.maxs.x - box_.mins.x) / pixel_.x + 1.5;
        const auto begin = std::size_t(std::clamp(from, 0.0, double(values.size())));
        const auto end = std::size_t(std::clamp(to, 0.0, double(values.size())));
        for (std::size_t i = begin; i < end; ++i)
            for (std::size_t k = 0; k < sampler_.Count(); ++k) {
                const PixelOffset offset = sampler_.Offset(first_ + i, k);
                sums[i] += solid.Thickness(box_.mins.x + pixel_.x * (double(i) + offset[0]), y_ + pixel_.y * offset[1]);
            }
    }

    void Draw(const std::vector<MinimapSolid> &solids, std::span<float> values) const {
        std::vector<double> sums(size_);
        for (const MinimapSolid &solid : solids)
            Add(solid, values, sums);
        const double scale = 1 / (double(sampler_.Count()) * (box_.maxs.z - box_.mins.z));
        for (std::size_t i = 0; i < size_; ++i)
            values[i] = float(sums[i] * scale);
    }

  private:
    const Boundsd &box_;
    std::size_t size_;
    const MinimapSampler &sampler_;
    Vec3d pixel_;         ///< its size, game units
    double y_;            ///< lowest of the row
    std::uint64_t first_; ///< number of its first pixel
};

} // namespace

Boundsd MinimapBox(Boundsd box, bool keepAspect, double border) {
    if (keepAspect) {
        const Vec3d size = box.maxs - box.mins;
        const std::size_t shorter = size.x < size.y ? 0 : 1;
        const double missing = std::abs(size.x - size.y) / 2;
        box.mins[shorter] -= missing;
        box.maxs[shorter] += missing;
    }
    const Vec3d margin = (box.maxs - box.mins) * (border / (1 - 2 * border));
    return {box.mins - margin, box.maxs + margin};
}

Minimap DrawMinimap(const Bsp &bsp, ShaderLibrary &library, const MinimapOptions &options, const MinimapStyle &style,
                    const JobPool &jobs, Log &log) {
    const bspModel_t &world = bsp.models.front();
    const Boundsd drawn = options.box.value_or(Boundsd{Vec3d(world.mins), Vec3d(world.maxs)});
    if (!(drawn.mins.x < drawn.maxs.x && drawn.mins.y < drawn.maxs.y && drawn.mins.z < drawn.maxs.z))
        throw Error("the world has no size to draw: its bounds are ( {} {} {} ) to ( {} {} {} ); give a box by -minmax",
                    drawn.mins.x, drawn.mins.y, drawn.mins.z, drawn.maxs.x, drawn.maxs.y, drawn.maxs.z);
    PrintBox("size", drawn, log);
    Minimap minimap{MinimapBox(drawn, options.keepAspect, options.Border(style)), {options.size, {}}};
    PrintBox("size_texcoords", minimap.box, log);

    const std::vector<MinimapSolid> solids = MinimapSolids(bsp, library);
    log.Count((long long)(solids.size()), "opaque brushes");
    const MinimapSampler sampler(options);
    const auto size = std::size_t(options.size);
    minimap.image.values.resize(size * size);
    jobs.For(options.size, [&](std::int64_t row, int) {
        const auto values = std::span(minimap.image.values).subspan(std::size_t(row) * size, size);
        MinimapRow(minimap.box, options.size, int(row), sampler).Draw(solids, values);
    });
    ApplyMinimapLevels(minimap.image, options, log);
    return minimap;
}

std::vector<std::uint8_t> MinimapBytes(std::span<const float> values) {
    constexpr float kMost = 255.0f / 256;
    std::vector<std::uint8_t> bytes;
    bytes.reserve(values.size());
    for (const float value : values)
        bytes.push_back(std::uint8_t(256 * std::clamp(value, 0.0f, kMost)));
    return bytes;
}

std::vector<std::byte> MinimapTga(const MinimapValues &image, MinimapPixels pixels) {
    const std::vector<std::uint8_t> bytes = MinimapBytes(image.values);
    if (pixels == MinimapPixels::Gray)
        return EncodeTga(bytes, image.size, image.size, 1, TgaRows::BottomFirst);
    const std::uint8_t color = pixels == MinimapPixels::White ? 255 : 0;
    std::vector<std::uint8_t> rgba;
    rgba.reserve(4 * bytes.size());
    for (const std::uint8_t byte : bytes)
        rgba.insert(rgba.end(), {color, color, color, byte});
    return EncodeTga(rgba, image.size, image.size, 4, TgaRows::BottomFirst);
}

std::string MinimapSidecar(const Boundsd &box, std::string_view name) {
    return fmt::format("{{\n\tbackgroundColor 0.0 0.0 0.0 0.333\n\tzone {{\n"
                       "\t\tbounds {:f} {:f} {:f} {:f} {:f} {:f}\n"
                       "\t\timage \"minimaps/{}\" {:f} {:f} {:f} {:f}\n\t}}\n}}\n",
                       box.mins.x, box.mins.y, box.mins.z, box.maxs.x, box.maxs.y, box.maxs.z, name, box.mins.x,
                       box.mins.y, box.maxs.x, box.maxs.y);
}

void WriteMinimap(const Bsp &bsp, const std::filesystem::path &bspPath, ShaderLibrary &library,
                  const MinimapOptions &options, const MinimapStyle &style, const JobPool &jobs, Log &log) {
    const Minimap minimap = DrawMinimap(bsp, library, options, style, jobs, log);
    auto path = options.Output(style, bspPath);
    MakeFolder(path.parent_path());
    log.Print("Writing {}\n", path.string());
    ReplaceFile(path, MinimapTga(minimap.image, options.Pixels(style)));
    if (!style.sidecar)
        return;
    const std::string text = MinimapSidecar(minimap.box, path.stem().string());
    path.replace_extension(".minimap");
    log.Print("Writing {}\n", path.string());
    ReplaceTextFile(path, text);
}

} // namespace q3
