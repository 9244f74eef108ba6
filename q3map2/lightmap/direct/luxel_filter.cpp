// GPL-2.0-or-later. -filter and filter radii: blurs light over luxels, across the borders of raw lightmaps.
#include "q3map2/lightmap/direct/luxel_filter.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

namespace q3 {

// ---- -filter: blur of light over luxels ----

namespace {

/// Fraction of the kernel of linear interpolation, a tent from -1 to 1 around the center of a cell, that lies in a box
/// whose rim is `inside` cells beyond that center: an integral of 1 - |x|.
float FractionInBox(float inside) {
    const float off = std::clamp(1 - std::abs(inside), 0.0f, 1.0f), outer = off * off / 2;
    return inside < 0 ? outer : 1 - outer;
}

/// Calls use(cell, weight) for the cells of a row or column that count in the box around cell `at` of it. first:
/// cell 0; stride: from cell to cell; count: their number.
template <typename Use>
void ForBox(const LuxelSurroundings &around, std::size_t first, std::size_t stride, int count, int at, float radius,
            const Use &use) {
    const auto cellAt = [&](int k) { return first + stride * std::size_t(std::clamp(k, 0, count - 1)); };
    const auto inside = [&](int k) { return k >= 0 && k < count; };
    // Beyond the end of the walk a surface goes on as it does in the last cell.
    const auto blocked = [&](int k) {
        const CellState state = around.At(cellAt(k));
        return state == CellState::Blocked || (!inside(k) && state != CellState::Empty);
    };
    use(cellAt(at), 1.0f);
    const int most = int(std::min(std::ceil(radius), float(count)));
    for (int k = 1; k <= most; ++k) {
        if (blocked(at - k) || blocked(at + k))
            continue;
        const float weight = FractionInBox(radius - float(k));
        for (const int side : {at - k, at + k})
            if (inside(side))
                use(cellAt(side), weight);
    }
}

} // namespace

void LuxelFilter::Apply(const LuxelSurroundings &around, float radius, const std::vector<Vec3f> &values,
                        std::vector<Vec3f> &blurred) {
    const int width = around.Width(), height = around.Height();
    rows_.assign(values.size(), {});
    rowWeight_.assign(values.size(), 0);
    blurred.assign(values.size(), {});
    const auto holds = [&](std::size_t cell) {
        return around.At(cell) == CellState::Own || around.At(cell) == CellState::Tapped;
    };
    // A separable kernel: rows, then columns.
    for (int y = 0; y < height; ++y) {
        const std::size_t first = std::size_t(y) * std::size_t(width);
        for (int x = around.Reach(); x < width - around.Reach(); ++x)
            ForBox(around, first, 1, width, x, radius, [&](std::size_t from, float weight) {
                const float counted = holds(from) ? weight : 0;
                rows_[first + std::size_t(x)] += values[from] * counted;
                rowWeight_[first + std::size_t(x)] += counted;
            });
    }
    for (int y = around.Reach(); y < height - around.Reach(); ++y)
        for (int x = around.Reach(); x < width - around.Reach(); ++x) {
            const std::size_t cell = std::size_t(y) * std::size_t(width) + std::size_t(x);
            if (!holds(cell))
                continue;
            Vec3f sum;
            float weights = 0;
            ForBox(around, std::size_t(x), std::size_t(width), height, y, radius, [&](std::size_t from, float weight) {
                sum += rows_[from] * weight;
                weights += rowWeight_[from] * weight;
            });
            blurred[cell] = weights > 0 ? sum / weights : Vec3f{};
        }
}

// ---- -filter and filter radii: blurs light over luxels, across the borders of raw lightmaps ----

namespace {

/// Boxes reach at most this many luxels over the border of a lightmap.
constexpr int kMostReach = 32;
/// Basis normals within 11 degrees, of which this is the cosine, count as the same.
constexpr float kSameBasisCosine = 0.98f;

/// Width of a luxel of the super grid. Game units.
float LuxelWidth(const RawLightmap &raw) {
    return std::max(raw.actualSampleSize, 1.0f) / float(raw.super);
}

/// Half the width of the box that blurs light of sources with that filter radius: at least a luxel, or 0 for no blur.
/// Game units.
float BoxRadius(const SurfaceInputs &in, const RawLightmap &raw, float filterRadius) {
    const float radius = std::max({0.0f, raw.filterRadius, filterRadius});
    return radius > 0 || in.lightmap.filter ? std::max(radius, LuxelWidth(raw)) : 0;
}

/// The radius of a box over luxels of `raw` that blurs as widely as the box of `other` does: box and interpolation
/// together have the same variance, radius^2 / 3 + width^2 / 6 (LuxelFilter::Apply), with the width of the luxels. Game
/// units; 0: less than a luxel.
float MatchingRadius(const SurfaceInputs &in, const RawLightmap &raw, const RawLightmap &other, float filterRadius) {
    const float radius = BoxRadius(in, other, filterRadius), width = LuxelWidth(raw), otherWidth = LuxelWidth(other);
    const float square = radius * radius + (otherWidth * otherWidth - width * width) / 2;
    return radius > 0 && square >= width * width ? std::sqrt(square) : 0;
}

/// The largest BoxRadius of the light of a lightmap.
float LargestBox(const SurfaceInputs &in, const RawLightmap &raw, const std::vector<UnblurredLight> &light) {
    float largest = 0;
    for (const UnblurredLight &one : light)
        largest = std::max(largest, BoxRadius(in, raw, one.filterRadius));
    return largest;
}

const UnblurredLight *FindLight(const std::vector<UnblurredLight> &light, int style, float filterRadius) {
    for (const UnblurredLight &one : light)
        if (one.style == style && one.filterRadius == filterRadius)
            return &one;
    return nullptr;
}

/// Blurs the light of one raw lightmap at a time. For one thread.
class LightmapBlur {
  public:
    LightmapBlur(const SurfaceInputs &in, const SurfaceLight &surfaces, const UnblurredLights &light,
                 const SurfaceFinder &finder)
        : in_(in), surfaces_(surfaces), light_(light), sources_(light.size()), around_(surfaces, finder) {}

    void Run(std::size_t number, RawLightmap &raw) {
        number_ = number, raw_ = &raw;
        Walk();
        std::vector<std::pair<int, float>> done;
        const auto add = [&](const std::vector<UnblurredLight> &light) {
            for (const UnblurredLight &one : light)
                if (const std::pair kind{one.style, one.filterRadius};
                    std::find(done.begin(), done.end(), kind) == done.end()) {
                    AddLight(one.style, one.filterRadius);
                    done.push_back(kind);
                }
        };
        add(light_[number]);
        for (const std::uint32_t other : around_.Neighbors()) // light that reaches only the neighbor
            add(light_[other]);
    }

  private:
    /// A blur that is wider than the lightmap's own: that of neighbors with larger luxels or a filter radius.
    struct WiderBlur {
        float radius = 0;             ///< game units
        std::vector<float> fractions; ///< by cell: weight of this blur against the narrower ones
    };
    /// Values of a light that are blurred alike: color, direction or a channel.
    struct Values {
        std::function<const std::vector<Vec3f> *(const UnblurredLight &)> of; ///< null: no such channel
        bool onBasis = false;                                                 ///< light on a basis normal
    };

    int CellsWithin(float radius) const { return int(std::min(std::ceil(radius / LuxelWidth(*raw_)), 1e6f)); }
    void Walk();
    void FindWiderBlurs(float ownRadius, float filterRadius);
    std::vector<float> FractionsNear(float radius, float filterRadius) const;
    void AddLight(int style, float filterRadius);
    bool IsLitAround() const;
    std::size_t NearestLuxel(std::size_t cell) const;
    bool SameBasis(std::size_t luxel, const LuxelTap &tap) const;
    Vec3f TappedValue(std::size_t cell, const Values &values) const;
    void AddValues(float radius, const Values &values, std::vector<Vec3f> &to);

    const SurfaceInputs &in_;
    const SurfaceLight &surfaces_;
    const UnblurredLights &light_;
    std::vector<const UnblurredLight *> sources_; // of the light at hand, by raw lightmap; null: none
    LuxelSurroundings around_;
    LuxelFilter filter_;
    std::size_t number_ = 0;
    RawLightmap *raw_ = nullptr;
    std::vector<WiderBlur> wider_; // ascending
    std::vector<Vec3f> cells_, blurred_, widerBlurred_;
};

/// Finds the surroundings as far as boxes reach, which depends on the neighbors.
void LightmapBlur::Walk() {
    const auto reach = [&](float radius) { return std::clamp(CellsWithin(radius), 1, kMostReach); };
    float radius = LargestBox(in_, *raw_, light_[number_]);
    around_.Walk(number_, reach(radius));
    for (const std::uint32_t other : around_.Neighbors()) {
        radius = std::max(radius, LargestBox(in_, *raw_, light_[other]));
        for (const std::vector<UnblurredLight> *light : {&light_[number_], &light_[other]})
            for (const UnblurredLight &one : *light)
                radius = std::max(radius, MatchingRadius(in_, *raw_, surfaces_.lightmaps[other], one.filterRadius));
    }
    if (reach(radius) > around_.Reach())
        around_.Walk(number_, reach(radius));
}

/// Sets wider_ from the neighbors that blur by more than `ownRadius`.
void LightmapBlur::FindWiderBlurs(float ownRadius, float filterRadius) {
    constexpr float kWider = 1.01f; // factor of radii that differ by more than rounding
    wider_.clear();
    for (const std::uint32_t other : around_.Neighbors())
        if (const float radius = MatchingRadius(in_, *raw_, surfaces_.lightmaps[other], filterRadius);
            radius > ownRadius * kWider &&
            std::none_of(wider_.begin(), wider_.end(), [&](const WiderBlur &blur) { return blur.radius == radius; }))
            wider_.push_back({radius, FractionsNear(radius, filterRadius)});
    std::sort(wider_.begin(), wider_.end(), [](const WiderBlur &a, const WiderBlur &b) { return a.radius < b.radius; });
}

/// By cell: 1 beside neighbors that blur by `radius`, falling to 0 at that distance from them. Distances are those
/// along the axes and diagonals, by two passes over the cells (Borgefors' chamfer distance transform).
std::vector<float> LightmapBlur::FractionsNear(float radius, float filterRadius) const {
    const int width = around_.Width(), height = around_.Height();
    std::vector<float> distance(std::size_t(width) * std::size_t(height), 1e6f);
    for (std::size_t cell = 0; cell < distance.size(); ++cell)
        if (around_.At(cell) == CellState::Tapped &&
            MatchingRadius(in_, *raw_, surfaces_.lightmaps[around_.TapOf(cell).lightmap], filterRadius) == radius)
            distance[cell] = 0;
    // Towards neighbors above and to the left (side -1), or below and to the right (side 1).
    const auto shorten = [&](int x, int y, int side) {
        const auto at = [&](int u, int v) -> float & {
            return distance[std::size_t(v) * std::size_t(width) + std::size_t(u)];
        };
        for (const auto &[dx, dy] : {std::pair{side, 0}, {-side, side}, {0, side}, {side, side}})
            if (const int u = x + dx, v = y + dy; u >= 0 && v >= 0 && u < width && v < height)
                at(x, y) = std::min(at(x, y), at(u, v) + (dx != 0 && dy != 0 ? std::numbers::sqrt2_v<float> : 1));
    };
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            shorten(x, y, -1);
    for (int y = height - 1; y >= 0; --y)
        for (int x = width - 1; x >= 0; --x)
            shorten(x, y, 1);
    for (float &one : distance)
        one = std::clamp(1 - (one - 1) * LuxelWidth(*raw_) / radius, 0.0f, 1.0f);
    return distance;
}

/// Whether any light of neighbors is in reach.
bool LightmapBlur::IsLitAround() const {
    const std::size_t cells = std::size_t(around_.Width()) * std::size_t(around_.Height());
    for (std::size_t cell = 0; cell < cells; ++cell)
        if (around_.At(cell) == CellState::Tapped) {
            const LuxelTap &tap = around_.TapOf(cell);
            if (sources_[tap.lightmap] && tap.Of(sources_[tap.lightmap]->color) != Vec3f{})
                return true;
        }
    return false;
}

/// Blurs light of one style and filter radius, of the lightmap and its neighbors, and adds it to the lightmap.
void LightmapBlur::AddLight(int style, float filterRadius) {
    const float radius = BoxRadius(in_, *raw_, filterRadius);
    FindWiderBlurs(radius, filterRadius);
    const UnblurredLight *ownLight = FindLight(light_[number_], style, filterRadius);
    if (!ownLight && radius == 0 && wider_.empty())
        return;
    for (const std::uint32_t other : around_.Neighbors())
        sources_[other] = FindLight(light_[other], style, filterRadius);
    sources_[number_] = ownLight;
    const std::size_t slot = StyleSlotFor(raw_->styles, style);
    if (slot == kStyles || (!ownLight && !IsLitAround()))
        return;
    if (raw_->light[slot].empty())
        ClearStyleSlot(*raw_, slot, {});
    raw_->styles[slot] = std::uint8_t(style);
    AddValues(radius, {[](const UnblurredLight &one) { return &one.color; }}, raw_->light[slot]);
    if (in_.lightmap.deluxe)
        AddValues(radius, {[](const UnblurredLight &one) { return &one.direction; }}, raw_->directions);
    for (std::size_t c = 0; c < raw_->channels.Count(); ++c)
        AddValues(radius,
                  {[c](const UnblurredLight &one) { return c < one.channels.size() ? &one.channels[c] : nullptr; },
                   !raw_->channels.IsSH(c)},
                  raw_->directional[slot][c]);
}

/// The own luxel nearest to a cell.
std::size_t LightmapBlur::NearestLuxel(std::size_t cell) const {
    const auto width = std::size_t(around_.Width());
    return raw_->SuperIndex(std::clamp(int(cell % width) - around_.Reach(), 0, raw_->SuperWidth() - 1),
                            std::clamp(int(cell / width) - around_.Reach(), 0, raw_->SuperHeight() - 1));
}

/// Whether an own luxel has about the same basis normals as the luxels of a tap.
bool LightmapBlur::SameBasis(std::size_t luxel, const LuxelTap &tap) const {
    const RawLightmap &other = surfaces_.lightmaps[tap.lightmap];
    const auto most = std::max_element(tap.weights.begin(), tap.weights.end()) - tap.weights.begin();
    if (!other.channels.basis)
        return false;
    const BasisNormals basis = raw_->BasisOf(luxel), otherBasis = other.BasisOf(tap.luxels[std::size_t(most)]);
    return Dot(basis[0], otherBasis[0]) > kSameBasisCosine && Dot(basis[1], otherBasis[1]) > kSameBasisCosine;
}

/// The value in a cell of another lightmap. If that has no such channel, or other basis normals, light there is spread
/// over the channels as in the nearest luxel of the lightmap's own.
Vec3f LightmapBlur::TappedValue(std::size_t cell, const Values &values) const {
    const LuxelTap &tap = around_.TapOf(cell);
    const UnblurredLight *from = sources_[tap.lightmap], *ownLight = sources_[number_];
    if (!from)
        return {};
    const std::size_t luxel = NearestLuxel(cell);
    if (const std::vector<Vec3f> *there = values.of(*from); there && (!values.onBasis || SameBasis(luxel, tap)))
        return tap.Of(*there);
    const std::vector<Vec3f> *here = ownLight ? values.of(*ownLight) : nullptr;
    if (!here)
        return {};
    const Vec3f light = tap.Of(from->color);
    Vec3f value;
    for (std::size_t i = 0; i < 3; ++i)
        value[i] = ownLight->color[luxel][i] > 0 ? light[i] * (*here)[luxel][i] / ownLight->color[luxel][i] : 0;
    return value;
}

/// Adds the blurred values of the light at hand.
void LightmapBlur::AddValues(float radius, const Values &values, std::vector<Vec3f> &to) {
    cells_.assign(std::size_t(around_.Width()) * std::size_t(around_.Height()), {});
    const auto forLuxels = [&](const auto &use) {
        for (int y = 0; y < raw_->SuperHeight(); ++y)
            for (int x = 0; x < raw_->SuperWidth(); ++x)
                use(around_.CellOf(x, y), raw_->SuperIndex(x, y));
    };
    if (const UnblurredLight *ownLight = sources_[number_])
        if (const std::vector<Vec3f> *from = values.of(*ownLight))
            forLuxels([&](std::size_t cell, std::size_t luxel) { cells_[cell] = (*from)[luxel]; });
    const std::vector<Vec3f> ownCells = cells_;
    for (std::size_t cell = 0; cell < cells_.size(); ++cell)
        if (around_.At(cell) == CellState::Tapped)
            cells_[cell] = TappedValue(cell, values);
    if (radius > 0)
        filter_.Apply(around_, radius / LuxelWidth(*raw_), cells_, blurred_);
    else
        blurred_ = ownCells;
    for (const WiderBlur &blur : wider_) {
        filter_.Apply(around_, blur.radius / LuxelWidth(*raw_), cells_, widerBlurred_);
        for (std::size_t cell = 0; cell < cells_.size(); ++cell)
            blurred_[cell] += (widerBlurred_[cell] - blurred_[cell]) * blur.fractions[cell];
    }
    forLuxels([&](std::size_t cell, std::size_t luxel) {
        if (raw_->Mapped(luxel))
            to[luxel] += blurred_[cell];
    });
}

} // namespace

bool BlursAllLight(const SurfaceInputs &in, const SurfaceLight &surfaces) {
    return in.lightmap.filter || std::any_of(surfaces.lightmaps.begin(), surfaces.lightmaps.end(),
                                             [](const RawLightmap &raw) { return raw.filterRadius > 0; });
}

void ClearStyleSlot(RawLightmap &raw, std::size_t slot, const Vec3f &value) {
    const std::size_t count = raw.luxelClusters.size();
    raw.light[slot].assign(count, {});
    raw.filled[slot].assign(count, 0);
    for (std::size_t i = 0; i < count; ++i)
        if (raw.Mapped(i))
            raw.light[slot][i] = value, raw.filled[slot][i] = 1;
    const ChannelWeights uniform = UniformWeights(raw.channels);
    raw.directional[slot].resize(raw.channels.Count());
    for (std::size_t c = 0; c < raw.channels.Count(); ++c) {
        raw.directional[slot][c].assign(count, {});
        for (std::size_t i = 0; i < count; ++i)
            if (raw.Mapped(i))
                raw.directional[slot][c][i] = value * uniform[c];
    }
}

void AddBlurredLight(const SurfaceInputs &in, const UnblurredLights &light, SurfaceLight &surfaces) {
    if (std::all_of(light.begin(), light.end(), [](const auto &one) { return one.empty(); }))
        return;
    const SurfaceFinder finder(in, surfaces);
    std::vector<std::unique_ptr<LightmapBlur>> workers(std::size_t(in.jobs.Threads()));
    for (std::unique_ptr<LightmapBlur> &worker : workers)
        worker = std::make_unique<LightmapBlur>(in, surfaces, light, finder);
    in.jobs.For(std::int64_t(light.size()), [&](std::int64_t number, int worker) {
        const auto i = std::size_t(number);
        workers[std::size_t(worker)]->Run(i, surfaces.lightmaps[i]);
    });
}

} // namespace q3
