// GPL-2.0-or-later. Packing of lightmaps into pages.
#include "q3map2/lightmap/store/lightmap_pack.h"

#include <algorithm>
#include <bit>

namespace q3 {

namespace {

constexpr int kWordBits = 64;
/// Fast allocation tries positions 1 / kFastSteps of the lightmap's size apart, and skips pages with less than
/// 1 / kFastFree of their texels free.
constexpr int kFastSteps = 15;
constexpr double kFastFree = 10;

/// Word `index` of the row after a shift towards lower columns.
std::uint64_t Shifted(const std::uint64_t *row, std::size_t words, std::size_t index, int shift) {
    const std::size_t at = index + std::size_t(shift / kWordBits);
    const int part = shift % kWordBits;
    std::uint64_t word = at < words ? row[at] >> part : 0;
    if (part != 0 && at + 1 < words)
        word |= row[at + 1] << (kWordBits - part);
    return word;
}

} // namespace

Stamp MakeStamp(const LightmapLayer &layer) {
    if (layer.solid)
        return {1, 1, 1, {{0, 0, 1}}};
    Stamp stamp{layer.width, layer.height, 0, {}};
    for (int y = 0; y < layer.height; ++y)
        for (int x = 0; x < layer.width; ++x) {
            if (!layer.Used(std::size_t(y) * std::size_t(layer.width) + std::size_t(x)))
                continue;
            ++stamp.texels;
            if (stamp.runs.empty() || stamp.runs.back().row != y ||
                stamp.runs.back().start + stamp.runs.back().length != x)
                stamp.runs.push_back({y, x, 0});
            ++stamp.runs.back().length;
        }
    // Long runs first: they rule out most columns.
    std::stable_sort(stamp.runs.begin(), stamp.runs.end(),
                     [](const Stamp::Run &a, const Stamp::Run &b) { return a.length > b.length; });
    return stamp;
}

PageSpace::PageSpace(int width, int height)
    : width_(width), height_(height), free_(width * height), words_(std::size_t((width + kWordBits - 1) / kWordBits)),
      bits_(std::size_t(height) * kLevels * words_) {}

bool PageSpace::Fits(const Stamp &stamp, int x, int y) const {
    if (x < 0 || y < 0 || x + stamp.width > width_ || y + stamp.height > height_)
        return false;
    for (const Stamp::Run &run : stamp.runs) {
        const std::uint64_t *row = Row(y + run.row, 0);
        for (int column = x + run.start; column < x + run.start + run.length; ++column)
            if ((row[column / kWordBits] >> (column % kWordBits) & 1) != 0)
                return false;
    }
    return true;
}

/// Clears the bits of columns at which the run would cover a taken texel, if the stamp were in row y; false if none is
/// left. The run is covered by windows of 2^level texels, the last of which may overlap the one before.
bool PageSpace::ClearTaken(const Stamp::Run &run, int y, std::span<std::uint64_t> columns) const {
    const int level = std::min(int(std::bit_width(unsigned(run.length))) - 1, kLevels - 1);
    const std::uint64_t *row = Row(y + run.row, level);
    std::uint64_t any = 0;
    const int window = 1 << level;
    const int last = run.start + run.length - window;
    for (std::size_t i = 0; i < words_; ++i) {
        if (columns[i] == 0)
            continue;
        std::uint64_t taken = Shifted(row, words_, i, last);
        for (int at = run.start; at < last; at += window)
            taken |= Shifted(row, words_, i, at);
        any |= columns[i] &= ~taken;
    }
    return any != 0;
}

std::optional<std::array<int, 2>> PageSpace::Find(const Stamp &stamp, int stepX, int stepY) const {
    if (stamp.width > width_ || stamp.height > height_)
        return std::nullopt;
    std::vector<std::uint64_t> allColumns(words_), columns(words_);
    for (int x = 0; x + stamp.width <= width_; x += stepX)
        allColumns[std::size_t(x / kWordBits)] |= std::uint64_t(1) << (x % kWordBits);
    for (int y = 0; y + stamp.height <= height_; y += stepY) {
        columns = allColumns;
        const bool found = std::all_of(stamp.runs.begin(), stamp.runs.end(),
                                       [&](const Stamp::Run &run) { return ClearTaken(run, y, columns); });
        for (std::size_t i = 0; i < words_ && found; ++i)
            if (columns[i] != 0)
                return std::array{int(i) * kWordBits + std::countr_zero(columns[i]), y};
    }
    return std::nullopt;
}

void PageSpace::Take(const Stamp &stamp, int x, int y) {
    for (const Stamp::Run &run : stamp.runs) {
        std::uint64_t *row = Row(y + run.row, 0);
        for (int column = x + run.start; column < x + run.start + run.length; ++column)
            row[column / kWordBits] |= std::uint64_t(1) << (column % kWordBits);
    }
    for (int row = y; row < y + stamp.height; ++row)
        RebuildLevels(row);
    free_ -= stamp.texels;
}

void PageSpace::RebuildLevels(int row) {
    for (int level = 1; level < kLevels; ++level) {
        const std::uint64_t *below = Row(row, level - 1);
        for (std::size_t i = 0; i < words_; ++i)
            Row(row, level)[i] = below[i] | Shifted(below, words_, i, 1 << (level - 1));
    }
}

namespace {

class Packer {
  public:
    Packer(const LightmapOptions &options, LightmapLayers &layers) : options_(options), layers_(layers) {}

    void Pack(LightmapLayer &layer) {
        const Stamp stamp = MakeStamp(layer);
        const LightmapLayer *firstStyle = nullptr;
        if (layer.slot > 0)
            firstStyle = &layers_.layers[std::size_t(layers_.layerOf[std::size_t(layer.lightmap)][0])];
        if ((firstStyle && PackAlignedWithFirst(*firstStyle, stamp, layer)) || PackAnywhere(stamp, layer))
            return;
        AddPage(layer);
        Put(pages_.size() - 1, stamp, firstStyle ? std::array{firstStyle->x, firstStyle->y} : std::array{0, 0}, layer);
    }

    std::vector<std::array<int, 2>> Sizes() const {
        std::vector<std::array<int, 2>> sizes;
        for (const PageSpace &page : pages_)
            sizes.push_back({page.Width(), page.Height()});
        return sizes;
    }

  private:
    struct Page : PageSpace {
        using PageSpace::PageSpace;
        bool hasBasis = false; ///< its lightmaps have basis maps: other pages need none
    };

    void AddPage(const LightmapLayer &layer) {
        Page &page = pages_.emplace_back(layer.pageSize[0], layer.pageSize[1]);
        page.hasBasis = layer.kinds.basis;
        // The last texel is undefined in ioquake3's HDR pages (EncodeIoquake3Hdr).
        if (options_.hdrFiles == HdrFiles::Ioquake3)
            page.Take({.runs = {{0, 0, 1}}}, page.Width() - 1, page.Height() - 1);
    }

    bool MayHold(const Page &page, const Stamp &stamp, const LightmapLayer &layer) const {
        return page.FreeTexels() >= stamp.texels && page.Width() == layer.pageSize[0] &&
               page.Height() == layer.pageSize[1] && page.hasBasis == layer.kinds.basis;
    }

    void Put(std::size_t page, const Stamp &stamp, std::array<int, 2> at, LightmapLayer &layer) {
        pages_[page].Take(stamp, at[0], at[1]);
        layer.page = int(page), layer.x = at[0], layer.y = at[1];
    }

    /// Packs at the coordinates of the lightmap's first style, on any page, or half a page aside: surfaces that
    /// share a shader then share the offset of its stages, so few generated shaders are needed.
    bool PackAlignedWithFirst(const LightmapLayer &first, const Stamp &stamp, LightmapLayer &layer) {
        for (const int reach : {0, 1}) // half pages aside, on each axis
            for (std::size_t page = 0; page < pages_.size(); ++page) {
                if (!MayHold(pages_[page], stamp, layer))
                    continue;
                for (int dy = -reach; dy <= reach; ++dy)
                    for (int dx = -reach; dx <= reach; ++dx) {
                        const std::array at{first.x + dx * pages_[page].Width() / 2,
                                            first.y + dy * pages_[page].Height() / 2};
                        if (!pages_[page].Fits(stamp, at[0], at[1]))
                            continue;
                        Put(page, stamp, at, layer);
                        return true;
                    }
            }
        return false;
    }

    bool PackAnywhere(const Stamp &stamp, LightmapLayer &layer) {
        std::size_t page = 0;
        if (const std::size_t block = std::size_t(options_.searchBlock); block > 0 && !pages_.empty())
            page = (pages_.size() - 1) / block * block;
        const bool fast = options_.fastAllocate;
        for (; page < pages_.size(); ++page) {
            const Page &space = pages_[page];
            if (!MayHold(space, stamp, layer) ||
                (fast && double(space.FreeTexels()) * kFastFree < double(space.Width()) * space.Height()))
                continue;
            const auto at = space.Find(stamp, fast ? std::max(1, stamp.width / kFastSteps) : 1,
                                       fast ? std::max(1, stamp.height / kFastSteps) : 1);
            if (at) {
                Put(page, stamp, *at, layer);
                return true;
            }
        }
        return false;
    }

    const LightmapOptions &options_;
    LightmapLayers &layers_;
    std::vector<Page> pages_;
};

} // namespace

std::vector<std::array<int, 2>> PackLayers(const std::vector<std::size_t> &order, const LightmapOptions &options,
                                           LightmapLayers &layers) {
    Packer packer(options, layers);
    for (const std::size_t i : order)
        packer.Pack(layers.layers[i]);
    for (LightmapLayer &layer : layers.layers)
        if (layer.twin >= 0) {
            const LightmapLayer &first = layers.layers[std::size_t(layer.twin)];
            layer.page = first.page, layer.x = first.x, layer.y = first.y;
        }
    return packer.Sizes();
}

} // namespace q3
