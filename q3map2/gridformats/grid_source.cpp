// GPL-2.0-or-later. The SH light grid of a map as the source of other grids: its light, split into ambient and
// directed, in the tone of the lightmaps.
#include "q3map2/gridformats/grid_source.h"

#include "common/error.h"
#include "libs/math/vec.h"
#include "libs/sh/sh.h"
#include "q3map2/bspfile/bspfile_grid.h"
#include "q3map2/bspfile/entities.h"
#include "q3map2/bspfile/entity_key.h"
#include "q3map2/bspfile/light_keys.h"
#include "q3map2/light/grid/light_gridsh.h"
#include "q3map2/light/grid/probe_integrator.h"
#include "q3map2/shader/image_formats.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numbers>
#include <string>

namespace q3 {

// ---- Light of SH coefficients as an ambient part and one directed light ----

namespace {

using std::numbers::pi;

constexpr double kMinDirection = 1e-7; ///< light, 1 is byte 255: shorter vectors are rounding errors

Vec3d Coefficient(const bspGridPointSH_t &light, std::size_t k) {
    const Float3 &rgb = light.coeffs[k];
    return {double(rgb[0]), double(rgb[1]), double(rgb[2])};
}

Vec3d DominantDirection(const bspGridPointSH_t &light) {
    const auto luminance = [&](std::size_t k) { return double(Luminance(Vec3f(light.coeffs[k]))); };
    const Vec3d v{luminance(3), luminance(1), luminance(2)}; // basis functions 3, 1, 2 are x, y, z
    const double length = Length(v);
    return length > kMinDirection ? v / length : Vec3d{0, 0, 1};
}

/// Integrals over all normals n of the light, and of the light times max(0, n . direction).
struct SphereIntegrals {
    Vec3d ofLight, ofLightTimesLobe;
};

SphereIntegrals IntegralsOf(const bspGridPointSH_t &light, const Vec3d &direction) {
    SphereIntegrals sum{Coefficient(light, 0) / kSHC0, {}};
    const SHVector basis = SHBasis(direction);
    for (std::size_t k = 0; k < 9; ++k)
        sum.ofLightTimesLobe += Coefficient(light, k) * (kCosineLobe[k] * basis[k]);
    return sum;
}

} // namespace

Vec3d MeanLight(const bspGridPointSH_t &light) {
    return Coefficient(light, 0) * kSHC0;
}

Vec3d LightOn(const bspGridPointSH_t &light, const Vec3d &normal) {
    const SHVector basis = SHBasis(normal);
    Vec3d sum;
    for (std::size_t k = 0; k < 9; ++k)
        sum += Coefficient(light, k) * basis[k];
    return Max(sum, Vec3d{});
}

AmbientDirected FitAmbientDirected(const bspGridPointSH_t &light, double minAmbient) {
    // Normal equations of (light - ambient - directed * lobe)^2; the integrals of 1, lobe and lobe^2 over the sphere
    // are 4 pi, pi and 2 pi / 3.
    AmbientDirected fit;
    fit.direction = DominantDirection(light);
    const SphereIntegrals sum = IntegralsOf(light, fit.direction);
    for (std::size_t i = 0; i < 3; ++i) {
        const double e1 = sum.ofLight[i], e2 = sum.ofLightTimesLobe[i];
        double ambient = (2 * e1 - 3 * e2) / (5 * pi), directed = (12 * e2 - 3 * e1) / (5 * pi);
        if (directed < 0)
            directed = 0, ambient = e1 / (4 * pi);
        if (ambient < minAmbient)
            ambient = minAmbient, directed = 3 * (e2 - pi * minAmbient) / (2 * pi);
        fit.ambient[i] = ambient;
        fit.directed[i] = std::max(directed, 0.0);
    }
    return fit;
}

AmbientDirected FitMeanAndDirected(const bspGridPointSH_t &light, double directedWeight) {
    AmbientDirected fit = FitAmbientDirected(light);
    const Vec3d mean = Max(MeanLight(light), Vec3d{});
    for (std::size_t i = 0; i < 3; ++i) {
        fit.directed[i] = std::min(fit.directed[i], mean[i] / directedWeight);
        fit.ambient[i] = std::max(mean[i] - directedWeight * fit.directed[i], 0.0);
    }
    return fit;
}

// ---- The tone of the lightmaps, for grids that hold bytes ----

namespace {

constexpr float kFullByte = 255;
/// Unlimited scales light by this before the limit at 255, and undoes it after: limits light at 2^20 times 255. A power
/// of two, so that no rounding is added.
constexpr float kHeadroom = 1.0f / (1 << 20);

} // namespace

GridTone::GridTone(std::string_view entities, Log &log) {
    const std::string text(StoredWorld(std::string(entities)).Value(kToneKey));
    if (shgrid_parse_tone(text.c_str(), &tone_) != SHGRID_OK)
        log.Warn("tone", "worldspawn: {} \"{}\" is not pairs of a word and a number in range: grids get no tone",
                 kToneKey, text);
}

GridTone::GridTone(const char *tone) {
    if (shgrid_parse_tone(tone, &tone_) != SHGRID_OK)
        throw Error("tone \"{}\": expected pairs of a word and a number in range", tone);
}

bool GridTone::IsPlain() const {
    return tone_.contrast == 1 && tone_.gamma == 1 && tone_.exposure == 0 && tone_.saturation == 1 &&
           tone_.scale == 1 && tone_.maxlight == kFullByte && tone_.srgb == 0;
}

Vec3d GridTone::Limited(const Vec3d &light) const {
    float rgb[3] = {float(light.x), float(light.y), float(light.z)};
    shgrid_apply_tone(&tone_, rgb);
    return Vec3d{double(rgb[0]), double(rgb[1]), double(rgb[2])} * double(kFullByte);
}

Vec3d GridTone::Unlimited(const Vec3d &light) const {
    if (tone_.maxlight < kFullByte)
        return Limited(light);
    shgrid_tone tone = tone_;
    tone.scale *= kHeadroom;
    tone.srgb = 0;
    float rgb[3] = {float(light.x), float(light.y), float(light.z)};
    shgrid_apply_tone(&tone, rgb);
    Vec3d color;
    for (std::size_t i = 0; i < 3; ++i) {
        const float linear = rgb[i] / kHeadroom;
        color[i] = double(kFullByte * (tone_.srgb ? SrgbFromLinear(linear) : linear));
    }
    return color;
}

std::array<std::uint8_t, 3> GridTone::Bytes(const Vec3d &light) const {
    const Vec3d color = Limited(light);
    std::array<std::uint8_t, 3> bytes;
    for (std::size_t i = 0; i < 3; ++i)
        bytes[i] = std::uint8_t(std::lround(color[i]));
    return bytes;
}

// ---- The SH light grid of a map as the source of other grids ----

namespace {

bool IsBlack(const bspGridPointSH_t &point) {
    return std::ranges::all_of(point.coeffs, [](const Float3 &rgb) { return rgb == Float3{}; });
}

/// The points that the light stage gives the SH grid of the map by default.
GridLayout DefaultLayoutSH(const Bsp &bsp) {
    if (bsp.models.empty())
        throw Error("the map has no world model, so no place for a light grid");
    const Vec3f legacy = LegacyCell(bsp);
    Float3 size{};
    for (std::size_t axis = 0; axis < 3; ++axis)
        size[axis] = std::max(kMinCell, legacy[axis] / LightOptions{}.gridScaleSH);
    return LayoutGridSH(bsp, size);
}

} // namespace

Vec3f LegacyCell(const Bsp &bsp) {
    return keys::kGridSize.Vector(StoredWorld(bsp.entities)).value_or(Vec3f(kDefaultGridSize));
}

LightGridSH ExpandSparseGrid(const SparseGridSH &sparse, const GridLayout &layout) {
    static_assert(sizeof(shgrid_coeffs) == sizeof(bspGridPointSH_t));
    const std::vector<std::byte> lump = EncodeSparseGrid(sparse);
    const shgrid_grid reader = SparseReader(lump);
    LightGridSH grid{{layout.mins, layout.size, layout.bounds, std::int32_t(layout.Count())}, {}};
    std::size_t count = 0;
    grid.points.resize(std::size_t(layout.Count()));
    for (int z = 0; z < layout.bounds[2]; ++z)
        for (int y = 0; y < layout.bounds[1]; ++y)
            for (int x = 0; x < layout.bounds[0]; ++x) {
                const Float3 at = layout.Position(x, y, z);
                shgrid_coeffs value;
                shgrid_sample(&reader, at.data(), &value);
                grid.points[count++] = std::bit_cast<bspGridPointSH_t>(value);
            }
    return grid;
}

StoredGridSH SourceGrid(const Bsp &bsp) {
    const bool hasUniform = bsp.gridSH && !bsp.gridSH->points.empty();
    if (!hasUniform && !bsp.sparseGridSH)
        throw Error("the map has no SH light grid to convert: light it with -sh, -shbspx or -shadaptive first");
    return {hasUniform ? *bsp.gridSH : ExpandSparseGrid(*bsp.sparseGridSH, DefaultLayoutSH(bsp)),
            StoredWorld(bsp.entities).Value(kGridSHKey) == kRadiance};
}

GridSource::GridSource(const StoredGridSH &stored, const std::vector<bool> &isSolid)
    : layout_{stored.grid.header.gridMins, stored.grid.header.gridSize, stored.grid.header.gridBounds},
      points_(stored.grid.points), void_(points_.size()) {
    for (std::size_t i = 0; i < points_.size(); ++i) {
        void_[i] = isSolid[i] && IsBlack(points_[i]);
        if (stored.isRadiance)
            for (std::size_t k = 0; k < 9; ++k)
                for (float &value : points_[i].coeffs[k])
                    value *= float(kCosineLobe[k]);
    }
}

bool GridSource::Sample(const Vec3f &position, bspGridPointSH_t &light) const {
    light = {};
    std::array<std::int64_t, 3> low{};
    std::array<float, 3> fraction{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const double last = layout_.bounds[axis] - 1;
        const double at = (double(position[axis]) - double(layout_.mins[axis])) / double(layout_.size[axis]);
        const double inside = std::clamp(at, 0.0, last);
        low[axis] = std::int64_t(inside);
        fraction[axis] = float(inside - double(low[axis]));
    }
    float total = 0;
    for (unsigned corner = 0; corner < 8; ++corner) {
        std::array<std::int64_t, 3> at = low;
        float weight = 1;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const bool upper = (corner >> axis & 1) != 0;
            at[axis] += upper;
            weight *= upper ? fraction[axis] : 1 - fraction[axis];
        }
        if (!(weight > 0)) // also of corners past the last point, which have no index
            continue;
        const auto index = std::size_t(layout_.Index(at[0], at[1], at[2]));
        if (void_[index])
            continue;
        AddScaled(weight, points_[index], light);
        total += weight;
    }
    if (!(total > 0))
        return false;
    for (Float3 &rgb : light.coeffs)
        for (float &value : rgb)
            value /= total;
    return true;
}

} // namespace q3
