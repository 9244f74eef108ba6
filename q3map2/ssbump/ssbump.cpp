// GPL-2.0-or-later. Self-shadowed bump maps: responses of a height field to the basis of radiosity normal mapping, as
// image files.
#include "q3map2/ssbump/ssbump.h"

#include "common/error.h"
#include "common/files/files.h"
#include "common/log.h"
#include "common/text/text.h"
#include "q3map2/light/batch/lanes.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace q3 {

// ---- Options of the stage -ssbump ----

std::vector<SettingGroup<SsbumpOptions>> SsbumpSettings() {
    constexpr SettingRange scales{-1000, 1000}, rays{4, 1024}, passes{0, 1000};
    return {
        {"Bump map",
         "The page [Directional light](../engines/directional.md) explains how shaders use it.",
         {{{.name = "-bumpscale",
            .values = "F",
            .unit = "texels",
            .range = scales,
            .help = "Sets the height of white over black, where less than 0 makes white deep",
            .since = "0.2.0",
            .example = "12"},
           &SsbumpOptions::bumpScale},
          {{.name = "-notile",
            .help = "Treats the image as one that does not repeat, so nothing beyond its edges casts a shadow",
            .since = "0.2.0"},
           Off(&SsbumpOptions::tile)},
          {{.name = "-rays",
            .values = "N",
            .range = rays,
            .help = "Sets the number of directions all around along which a texel looks for its horizon",
            .since = "0.2.0",
            .example = "64"},
           &SsbumpOptions::rays},
          {{.name = "-filter",
            .values = "N",
            .range = passes,
            .help = "Sets how many passes smooth the steps of slopes, by at most half a step of the image",
            .details =
                "It is for smooth heights of 8 bits, where 32 passes are a good number. Rough heights get worse by it.",
            .since = "0.1.0",
            .example = "32"},
           &SsbumpOptions::filter},
          {{.name = "-normals",
            .values = "FILE",
            .initial = "none",
            .help = "Writes the normals too, without shadows, as q3map_normalImage reads them",
            .since = "0.2.0",
            .example = "wall_n.tga"},
           &SsbumpOptions::normals}}}};
}

SsbumpOptions ParseSsbumpOptions(Arguments &arguments, Log &log) {
    SsbumpOptions options;
    TakeSettings(SsbumpSettings(), options, arguments, log);
    return options;
}

// ---- Bump maps as image files ----

namespace {

bool HasExtension(const std::filesystem::path &path, std::string_view extension) {
    return EqualNoCase(path.extension().string(), extension);
}

void CheckExtension(const std::filesystem::path &path) {
    if (!HasExtension(path, ".tga") && !HasExtension(path, ".png"))
        throw Error("{}: cannot write this format, expected a name that ends in .tga or .png", path.string());
}

/// Alpha of each texel; empty if all are opaque.
std::vector<std::uint8_t> AlphaOf(const DeepImage &image) {
    std::vector<std::uint8_t> alpha;
    for (std::size_t i = 3; i < image.rgba.size(); i += 4)
        alpha.push_back(std::uint8_t((image.rgba[i] + 128) / 257)); // 65535 = 255 * 257, rounded
    return std::ranges::all_of(alpha, [](std::uint8_t a) { return a == 255; }) ? std::vector<std::uint8_t>() : alpha;
}

void WriteTexels(const std::filesystem::path &path, std::vector<std::uint8_t> texels,
                 const std::vector<std::uint8_t> &alpha, const HeightField &field, Log &log) {
    if (!alpha.empty()) {
        std::vector<std::uint8_t> rgba;
        rgba.reserve(4 * alpha.size());
        for (std::size_t i = 0; i < alpha.size(); ++i) {
            rgba.insert(rgba.end(), {texels[3 * i], texels[3 * i + 1], texels[3 * i + 2], alpha[i]});
        }
        texels.swap(rgba);
    }
    const int channels = alpha.empty() ? 3 : 4;
    if (HasExtension(path, ".png"))
        WritePng(path, texels, field.width, field.height, channels);
    else
        ReplaceFile(path, EncodeTga(texels, field.width, field.height, channels, TgaRows::TopFirst));
    log.Print("Wrote {}\n", path.string());
}

} // namespace

std::vector<std::uint8_t> SsbumpBytes(std::span<const Vec3f> bump) {
    std::vector<std::uint8_t> bytes;
    bytes.reserve(3 * bump.size());
    for (const Vec3f &channels : bump)
        for (std::size_t i = 0; i < 3; ++i)
            bytes.push_back(std::uint8_t(std::lround(255 * std::clamp(channels[i], 0.0f, 1.0f))));
    return bytes;
}

std::vector<std::uint8_t> NormalBytes(const HeightField &field) {
    std::vector<std::uint8_t> bytes;
    bytes.reserve(3 * field.heights.size());
    for (int y = 0; y < field.height; ++y)
        for (int x = 0; x < field.width; ++x) {
            const Vec3f normal = NormalOf(GradientAt(field, x, y));
            for (std::size_t i = 0; i < 3; ++i)
                bytes.push_back(std::uint8_t(std::clamp(std::lround(127 + 127.5f * normal[i]), 0L, 255L)));
        }
    return bytes;
}

void WriteSsbump(const std::filesystem::path &heightMap, const std::filesystem::path &output,
                 const SsbumpOptions &options, const JobPool &jobs, Log &log) {
    CheckExtension(output);
    if (!options.normals.empty())
        CheckExtension(options.normals);
    DeepImage image = ReadDeepImage(heightMap);
    log.Print("{}: {} x {} heights of {} bits\n", heightMap.string(), image.width, image.height, image.bits);
    HeightField field = HeightsOf(image, options.bumpScale, options.tile);
    const std::vector<std::uint8_t> alpha = AlphaOf(image);
    const double step = std::abs(options.bumpScale) / ((1 << image.bits) - 1);
    image.rgba = {};
    SmoothSteps(field, options.filter, step, jobs);
    Progress progress(log, field.height);
    const std::vector<Vec3f> bump = SelfShadowedBump(field, options.rays, jobs, [&](std::int64_t rows) {
        progress.Update(rows, std::uint64_t(rows) * std::uint64_t(field.width) * std::uint64_t(options.rays));
    });
    progress.Finish();
    WriteTexels(output, SsbumpBytes(bump), alpha, field, log);
    if (!options.normals.empty())
        WriteTexels(options.normals, NormalBytes(field), alpha, field, log);
}

// ---- Height fields: bilinear surfaces over the texels of an image ----

namespace {

/// Percent of the channels in the luminance, and its value for white.
constexpr int kRedPercent = 30, kGreenPercent = 59, kBluePercent = 11;
constexpr double kWhite = 100 * 65535.0;

/// Slope at `here`: central difference of its two neighbors, one-sided if one is missing.
float Slope(std::optional<float> before, float here, std::optional<float> after) {
    const float distance = (before ? 1.0f : 0.0f) + (after ? 1.0f : 0.0f);
    return distance > 0 ? (after.value_or(here) - before.value_or(here)) / distance : 0;
}

/// A quarter of the discrete Laplacian. At an edge the second difference across it is 0: the surface goes on straight.
float Curvature(const HeightField &field, int x, int y) {
    const float here = field.At(x, y);
    float sum = 0;
    for (const auto &[right, down] : {std::pair{1, 0}, std::pair{0, 1}}) {
        const auto before = field.Beside(x, y, -right, -down), after = field.Beside(x, y, right, down);
        if (before && after)
            sum += *before - 2 * here + *after;
    }
    return sum / 4;
}

/// Calls body(x, y, index) for all texels, each row in one worker.
template <typename Body> void ForTexels(const HeightField &field, const JobPool &jobs, const Body &body) {
    jobs.For(field.height, [&](std::int64_t y, int) {
        for (int x = 0; x < field.width; ++x)
            body(x, int(y), std::size_t(y) * std::size_t(field.width) + std::size_t(x));
    });
}

} // namespace

std::optional<float> HeightField::Beside(int x, int y, int right, int down) const {
    const int column = x + right, row = y + down;
    if (tiles)
        return At(Wrapped(column, width), Wrapped(row, height));
    if (column < 0 || column >= width || row < 0 || row >= height)
        return std::nullopt;
    return At(column, row);
}

Gradient GradientAt(const HeightField &field, int x, int y) {
    const float here = field.At(x, y);
    return {Slope(field.Beside(x, y, -1, 0), here, field.Beside(x, y, 1, 0)),
            Slope(field.Beside(x, y, 0, -1), here, field.Beside(x, y, 0, 1))};
}

Vec3f NormalOf(const Gradient &gradient) {
    return Normalize(Vec3f{-gradient.s, -gradient.t, 1});
}

HeightField HeightsOf(const DeepImage &image, double scale, bool tiles) {
    HeightField field{image.width, image.height, tiles};
    field.heights.reserve(image.rgba.size() / 4);
    for (std::size_t i = 0; i < image.rgba.size(); i += 4) {
        const int sum =
            kRedPercent * image.rgba[i] + kGreenPercent * image.rgba[i + 1] + kBluePercent * image.rgba[i + 2];
        field.heights.push_back(float(sum * scale / kWhite));
    }
    return field;
}

void SmoothSteps(HeightField &field, int passes, double step, const JobPool &jobs) {
    // Steps of gradient descent converge below 2 over the largest eigenvalue: Curvature has 2, applied twice 4.
    constexpr float kRelaxation = 0.45f;
    const std::vector<float> original = field.heights;
    HeightField curvature = field;
    const auto half = float(step / 2);
    for (int pass = 0; pass < passes; ++pass) {
        ForTexels(field, jobs, [&](int x, int y, std::size_t at) { curvature.heights[at] = Curvature(field, x, y); });
        ForTexels(field, jobs, [&](int x, int y, std::size_t at) {
            const float height = field.heights[at] - kRelaxation * Curvature(curvature, x, y);
            field.heights[at] = std::clamp(height, original[at] - half, original[at] + half);
        });
    }
}

// ---- Self-shadowed bump maps: responses of a height field to the basis of radiosity normal mapping ----

namespace {

constexpr int kLanes = 32;        // texels of a row in one SIMD block
constexpr int kRunLength = 12;    // crossings that are tested or skipped together
constexpr int kCellSide = 16;     // texels a side of the cells of HeightBounds; at least the extent of a run
constexpr float kMinRise = 1e-4f; // a horizon blocks if its slope exceeds that of the tangent plane by this
/// A slope raises the horizon only if it exceeds it by this factor. Rounding alone then cannot raise the horizon of a
/// texel whose own ray would have ended, so its result does not depend on the other texels of its block.
constexpr float kRaise = 1.000002f;
/// Lower slopes are ignored, which limits the reach of rays. A lobe gets 0.05 % of its light from below it.
constexpr float kLeastSlope = 0.03f;
constexpr float kMaxReach = 2048;  // texels
constexpr float kRounding = 1e-6f; // error of a slope by rounding, divided by the range of heights
constexpr float kNothing = -1e30f; // height beyond the edges of a field that does not tile

using Lanes = std::array<float, kLanes>;

/// Where a ray crosses an edge between two texel centers. Offsets from the texel where the ray starts; wrapped to
/// 0 .. size - 1 in fields that tile.
struct Crossing {
    float distance = 0, weight = 0; ///< texels along the ray; weight of the second center
    std::array<int, 2> x{}, y{};
};

/// Up to kRunLength crossings in a row. The offsets of both centers are in a box of kCellSide x kCellSide from a corner
/// on.
struct Run {
    std::size_t begin = 0, end = 0;
    int x = 0, y = 0; ///< the corner, wrapped as crossings are
};

/// A direction in the plane of the texture, and what a ray along it meets.
struct Azimuth {
    float s = 0, t = 0; ///< unit vector: to the right, down
    std::vector<Crossing> crossings{};
    std::vector<Run> runs{};
};

/// Rows of heights, long enough to read kLanes from any texel with any offset of a crossing.
class PaddedRows {
  public:
    explicit PaddedRows(const HeightField &field) : width_(field.width), tiles_(field.tiles) {
        const auto width = std::size_t(field.width);
        stride_ = (field.tiles ? 2 : 3) * width + 2 * kLanes;
        rows_.assign(stride_ * std::size_t(field.height), kNothing);
        for (std::size_t y = 0; y < std::size_t(field.height); ++y) {
            const float *from = field.heights.data() + y * width;
            float *to = rows_.data() + y * stride_;
            if (field.tiles)
                for (std::size_t x = 0; x < stride_; ++x)
                    to[x] = from[x % width];
            else
                std::copy(from, from + width, to + width);
        }
    }
    /// Heights from texel (0, y) on.
    const float *Row(int y) const { return rows_.data() + std::size_t(y) * stride_ + std::size_t(tiles_ ? 0 : width_); }

  private:
    int width_;
    bool tiles_;
    std::size_t stride_ = 0;
    std::vector<float> rows_;
};

/// Upper bounds of the heights in parts of a field: rays skip parts that cannot rise above their horizon.
class HeightBounds {
  public:
    explicit HeightBounds(const HeightField &field)
        : columns_((field.width + kCellSide - 1) / kCellSide), rows_((field.height + kCellSide - 1) / kCellSide) {
        // The range that From asks for may begin kCellSide - 1 texels after its cell.
        constexpr int kWide = kLanes + 2 * kCellSide, kHigh = 2 * kCellSide;
        const auto columns = std::size_t(columns_);
        std::vector<float> wide(columns * std::size_t(field.height), kNothing);
        bounds_.assign(columns * std::size_t(rows_), kNothing);
        for (int y = 0; y < field.height; ++y)
            for (int i = 0; i < columns_; ++i) {
                float &most = wide[std::size_t(y) * columns + std::size_t(i)];
                for (int x = i * kCellSide; x < i * kCellSide + kWide && (field.tiles || x < field.width); ++x)
                    most = std::max(most, field.At(x % field.width, y));
            }
        for (int i = 0; i < rows_; ++i)
            for (int y = i * kCellSide; y < i * kCellSide + kHigh && (field.tiles || y < field.height); ++y)
                for (std::size_t k = 0; k < columns; ++k) {
                    float &most = bounds_[std::size_t(i) * columns + k];
                    most = std::max(most, wide[std::size_t(y % field.height) * columns + k]);
                }
    }
    /// Upper bound of the heights of (kLanes + kCellSide) x kCellSide texels, to the right of (x, y) and down. In a
    /// field that tiles, (x, y) lies in it.
    float From(int x, int y) const {
        const auto column = std::size_t(std::clamp(x / kCellSide, 0, columns_ - 1)),
                   row = std::size_t(std::clamp(y / kCellSide, 0, rows_ - 1));
        return bounds_[row * std::size_t(columns_) + column];
    }

  private:
    int columns_, rows_;
    std::vector<float> bounds_;
};

/// The crossings of a ray with the lines between centers, out to `reach`, in the order of distance.
std::vector<Crossing> CrossingsOf(float s, float t, float reach) {
    std::vector<Crossing> crossings;
    // The second center is one column or one row after the first.
    const auto add = [&](float distance, int column, int row, int nextColumn, int nextRow, float weight) {
        Crossing c{distance, weight, {column, nextColumn}, {row, nextRow}};
        if (weight == 0) // at a center
            c.x[1] = c.x[0], c.y[1] = c.y[0];
        crossings.push_back(c);
    };
    constexpr float kParallel = 1e-6f; // component of the unit vector
    for (int i = 1; std::abs(s) > kParallel && float(i) <= reach * std::abs(s); ++i) {
        const float distance = float(i) / std::abs(s), t1 = distance * t;
        const int column = s < 0 ? -i : i, row = int(std::floor(t1));
        add(distance, column, row, column, row + 1, t1 - std::floor(t1));
    }
    for (int i = 1; std::abs(t) > kParallel && float(i) <= reach * std::abs(t); ++i) {
        const float distance = float(i) / std::abs(t), s1 = distance * s;
        const int column = int(std::floor(s1)), row = t < 0 ? -i : i;
        add(distance, column, row, column + 1, row, s1 - std::floor(s1));
    }
    std::ranges::sort(crossings, {}, &Crossing::distance);
    return crossings;
}

/// Whether one of the two centers is outside the field, wherever the ray begins.
bool IsOutside(const Crossing &c, const HeightField &field) {
    const auto outside = [](int offset, int size) { return offset <= -size || offset >= size; };
    return outside(c.x[0], field.width) || outside(c.x[1], field.width) || outside(c.y[0], field.height) ||
           outside(c.y[1], field.height);
}

Azimuth AzimuthOf(double angle, float reach, const HeightField &field) {
    Azimuth azimuth{float(std::cos(angle)), float(std::sin(angle))};
    auto &crossings = azimuth.crossings = CrossingsOf(azimuth.s, azimuth.t, reach);
    if (!field.tiles)
        std::erase_if(crossings, [&](const Crossing &c) { return IsOutside(c, field); });
    for (std::size_t i = 0; i < crossings.size(); i += kRunLength) {
        Run run{i, std::min(i + kRunLength, crossings.size()), crossings[i].x[0], crossings[i].y[0]};
        for (std::size_t k = run.begin; k < run.end; ++k) {
            run.x = std::min({run.x, crossings[k].x[0], crossings[k].x[1]});
            run.y = std::min({run.y, crossings[k].y[0], crossings[k].y[1]});
        }
        if (field.tiles)
            run.x = Wrapped(run.x, field.width), run.y = Wrapped(run.y, field.height);
        azimuth.runs.push_back(run);
    }
    if (field.tiles)
        for (Crossing &c : crossings)
            for (std::size_t k = 0; k < 2; ++k)
                c.x[k] = Wrapped(c.x[k], field.width), c.y[k] = Wrapped(c.y[k], field.height);
    return azimuth;
}

/// Data of the whole field, the same for all texels.
struct Horizons {
    Horizons(const HeightField &field_, int rays) : field(field_), rows(field_), bounds(field_) {
        const auto [low, high] = std::ranges::minmax(field.heights);
        highest = high;
        minRise = kMinRise + kRounding * (high - low);
        const float reach = std::min((high - low) / kLeastSlope, kMaxReach);
        // Between the axes, along which many textures have edges; mirror images have mirrored rays.
        for (int i = 0; i < rays; ++i)
            azimuths.push_back(AzimuthOf(2 * std::numbers::pi * (i + 0.5) / rays, reach, field));
    }

    const HeightField &field;
    PaddedRows rows;
    HeightBounds bounds;
    float highest = 0;
    float minRise = 0; ///< of a horizon that blocks over the tangent plane, slope
    std::vector<Azimuth> azimuths{};
};

/// kLanes texels of a row, from `x` on.
struct Block {
    int x = 0, y = 0;
    alignas(64) Lanes height, gradientS, gradientT;
    alignas(64) std::array<Lanes, 2> besideS, besideT; ///< heights of the texels before and after along s and t
    alignas(64) Lanes tangent, horizon;                ///< slopes along the current azimuth
    alignas(64) std::array<Lanes, 3> visible;          ///< integral of each lobe above the horizon
    alignas(64) std::array<Lanes, 3> whole;            ///< integral of each lobe above the tangent plane
};

/// The row of heights that begins (x, y) texels from the block's first; null above and below the field.
inline const float *HeightsAt(const Horizons &in, const Block &block, int x, int y) {
    int row = block.y + y;
    if (in.field.tiles)
        row -= row >= in.field.height ? in.field.height : 0;
    else if (row < 0 || row >= in.field.height)
        return nullptr;
    return in.rows.Row(row) + block.x + x;
}

/// Upper bound of the heights that the lanes of a block meet in a run.
inline float BoundOf(const Horizons &in, const Block &block, const Run &run) {
    int x = block.x + run.x, y = block.y + run.y;
    if (in.field.tiles)
        x -= x >= in.field.width ? in.field.width : 0, y -= y >= in.field.height ? in.field.height : 0;
    return in.bounds.From(x, y);
}

/// Whether a height at that distance would rise above the horizon of any lane.
inline bool Rises(const Block &block, float height, float distance) {
    int count = 0;
    for (int k = 0; k < kLanes; ++k) {
        const auto lane = std::size_t(k);
        count += height - block.height[lane] > block.horizon[lane] * distance ? 1 : 0;
    }
    return count > 0;
}

/// Raises the horizon to heights a + (b - a) weight at that distance.
inline void RaiseHorizon(const float *a, const float *b, float weight, float distance, Block &block) {
    const float inverse = 1 / distance;
    Q3_INDEPENDENT
    for (int k = 0; k < kLanes; ++k) {
        const auto lane = std::size_t(k);
        const float slope = (a[k] + (b[k] - a[k]) * weight - block.height[lane]) * inverse;
        block.horizon[lane] = slope > block.horizon[lane] * kRaise ? slope : block.horizon[lane];
    }
}

/// Raises the horizon to the steepest slope along the azimuth.
void FindHorizon(const Horizons &in, const Azimuth &azimuth, Block &block) {
    Vectorize([&]() Q3_INLINE {
        for (const Run &run : azimuth.runs) {
            const float distance = azimuth.crossings[run.begin].distance;
            if (!Rises(block, BoundOf(in, block, run), distance)) {
                if (!Rises(block, in.highest, distance))
                    return;
                continue;
            }
            for (std::size_t i = run.begin; i < run.end; ++i) {
                const Crossing &c = azimuth.crossings[i];
                const float *a = HeightsAt(in, block, c.x[0], c.y[0]), *b = HeightsAt(in, block, c.x[1], c.y[1]);
                if (a && b)
                    RaiseHorizon(a, b, c.weight, c.distance, block);
            }
        }
    });
}

/// The integral of (b.w) (n.w) cos e over elevations e from a slope up to the zenith, in the half-plane of one azimuth
/// with directions w = (cos e, sin e). Both vectors: component along the azimuth, component up. By the antiderivatives
/// sin e - sin^3 e / 3 of cos^3 e, -cos^3 e / 3 of cos^2 e sin e, and sin^3 e / 3 of cos e sin^2 e.
inline float IntegralAbove(float slope, float bAlong, float bUp, float nAlong, float nUp) {
    const float cosine = 1 / std::sqrt(1 + slope * slope), sine = slope * cosine;
    const float sine3 = sine * sine * sine / 3, cosine3 = cosine * cosine * cosine / 3;
    return bAlong * nAlong * (2.0f / 3 - sine + sine3) + (bAlong * nUp + bUp * nAlong) * cosine3 +
           bUp * nUp * (1.0f / 3 - sine3);
}

/// Adds to `sum` the integral of a lobe above the slope of each lane.
inline void AddAbove(const Lanes &slopes, std::size_t lobe, const Azimuth &azimuth, const Block &block, Lanes &sum) {
    const Vec3f &b = kRnmBasis[lobe];
    // lobeEdge: the slope below which b.w is negative.
    const float along = b.x * azimuth.s + b.y * azimuth.t, lobeEdge = along < 0 ? -along / b.z : 0;
    Q3_INDEPENDENT
    for (int k = 0; k < kLanes; ++k) {
        const auto lane = std::size_t(k);
        // The normal is not unit length: the factor cancels in visible / whole.
        const float normalAlong = -(block.gradientS[lane] * azimuth.s + block.gradientT[lane] * azimuth.t);
        const float slope = slopes[lane] > lobeEdge ? slopes[lane] : lobeEdge;
        sum[lane] += IntegralAbove(slope, along, b.z, normalAlong, 1);
    }
}

/// Adds this azimuth's integrals above the horizon to `visible`, above the tangent plane to `whole`.
void AddLobes(const Horizons &in, const Azimuth &azimuth, Block &block) {
    Vectorize([&]() Q3_INLINE {
        int blocked = 0;
        for (int k = 0; k < kLanes; ++k) {
            const auto lane = std::size_t(k);
            const bool rises = block.horizon[lane] > block.tangent[lane] + in.minRise;
            block.horizon[lane] = rises ? block.horizon[lane] : block.tangent[lane];
            blocked += rises ? 1 : 0;
        }
        for (std::size_t lobe = 0; lobe < 3; ++lobe) {
            alignas(64) Lanes whole{};
            AddAbove(block.tangent, lobe, azimuth, block, whole);
            Lanes &visible = block.visible[lobe], &sum = block.whole[lobe];
            for (std::size_t k = 0; k < kLanes; ++k)
                sum[k] += whole[k];
            if (blocked > 0)
                AddAbove(block.horizon, lobe, azimuth, block, visible);
            else
                for (std::size_t k = 0; k < kLanes; ++k)
                    visible[k] += whole[k];
        }
    });
}

/// Sets the slopes of the tangent planes, and starts the horizon with the bilinear cell in which the ray begins.
void SetTangents(const Horizons &in, const Azimuth &azimuth, const Lanes &besideS, const Lanes &besideT, Block &block) {
    Vectorize([&]() Q3_INLINE {
        const float s = std::abs(azimuth.s), t = std::abs(azimuth.t);
        for (int k = 0; k < kLanes; ++k) {
            const auto lane = std::size_t(k);
            const float slope = block.gradientS[lane] * azimuth.s + block.gradientT[lane] * azimuth.t;
            const float tangent = slope > 0 ? slope : 0, least = tangent + in.minRise;
            const float first = (besideS[lane] - block.height[lane]) * s + (besideT[lane] - block.height[lane]) * t;
            block.tangent[lane] = tangent;
            block.horizon[lane] = first > least ? first : least;
        }
    });
}

/// The texels of a block, and their neighbors.
void LoadBlock(const Horizons &in, Block &block) {
    const HeightField &field = in.field;
    for (int k = 0; k < kLanes; ++k) {
        const auto lane = std::size_t(k);
        const int x = std::min(block.x + k, field.width - 1); // lanes beyond the row are not used
        block.height[lane] = field.At(x, block.y);
        const Gradient gradient = GradientAt(field, x, block.y);
        block.gradientS[lane] = gradient.s, block.gradientT[lane] = gradient.t;
        for (const int side : {0, 1}) {
            const auto i = std::size_t(side);
            block.besideS[i][lane] = field.Beside(x, block.y, 2 * side - 1, 0).value_or(kNothing);
            block.besideT[i][lane] = field.Beside(x, block.y, 0, 2 * side - 1).value_or(kNothing);
        }
    }
    block.visible = block.whole = {};
}

/// Channels of the texels of a block.
void BumpOfBlock(const Horizons &in, Block &block, Vec3f *out) {
    LoadBlock(in, block);
    for (const Azimuth &azimuth : in.azimuths) {
        SetTangents(in, azimuth, block.besideS[azimuth.s > 0], block.besideT[azimuth.t > 0], block);
        FindHorizon(in, azimuth, block);
        AddLobes(in, azimuth, block);
    }
    for (int k = 0; k < std::min(kLanes, in.field.width - block.x); ++k) {
        const auto lane = std::size_t(k);
        const Vec3f normal = NormalOf({block.gradientS[lane], block.gradientT[lane]});
        for (std::size_t i = 0; i < 3; ++i) {
            const float whole = block.whole[i][lane], facing = Dot(kRnmBasis[i], normal);
            out[k][i] = facing > 0 && whole > 0 ? facing * (block.visible[i][lane] / whole) : 0;
        }
    }
}

} // namespace

std::vector<Vec3f> SelfShadowedBump(const HeightField &field, int rays, const JobPool &jobs,
                                    const std::function<void(std::int64_t)> &done) {
    const Horizons in(field, rays);
    std::vector<Vec3f> bump(field.heights.size());
    jobs.For(
        field.height,
        [&](std::int64_t y, int) {
            Block block;
            block.y = int(y);
            for (block.x = 0; block.x < field.width; block.x += kLanes)
                BumpOfBlock(in, block, bump.data() + std::size_t(y) * std::size_t(field.width) + block.x);
        },
        done);
    return bump;
}

} // namespace q3
