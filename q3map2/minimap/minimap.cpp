// GPL-2.0-or-later. Minimaps: pictures of a map from above, of how thick its solids are.
#include "q3map2/minimap/minimap.h"

#include "common/error.h"
#include "common/files/files.h"
#include "common/image/image.h"
#include "common/text/text.h"
#include "libs/math/sampling.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <system_error>

namespace q3 {

// ---- Options of the minimap stage ----

namespace {

/// Fraction of the image that games of the DarkPlaces engine and of qfusion expect on each side.
constexpr double kEngineBorder = 1.0 / 66;
constexpr std::string_view kDarkPlacesOutput = "../gfx/{}_mini.tga", kMinimapsOutput = "../minimaps/{}.tga";

constexpr MinimapStyle kMinimapStyles[] = {
    {},
    {.game = "nexuiz", .border = kEngineBorder, .output = kDarkPlacesOutput},
    {.game = "xonotic", .border = kEngineBorder, .output = kDarkPlacesOutput},
    {.game = "qfusion", .border = kEngineBorder, .output = kMinimapsOutput},
    {.game = "unvanquished", .pixels = MinimapPixels::White, .output = kMinimapsOutput, .sidecar = true},
};

constexpr SettingRange kMinimapSizes{1, 16384}, kMinimapSamples{1, 1024};

void SetBox(MinimapOptions &options, const SettingValues &values) {
    const auto &n = values.numbers;
    options.box = Boundsd{{n[0], n[1], n[2]}, {n[3], n[4], n[5]}};
}

SettingGroup<MinimapOptions> MinimapImageSettings() {
    return {"Image",
            "",
            {{{.name = "-size",
               .values = "N",
               .unit = "pixels",
               .range = kMinimapSizes,
               .help = "Sets the width and the height of the image",
               .since = "q3map2",
               .example = "1024"},
              &MinimapOptions::size},
             {{.name = "-border",
               .values = "F",
               .initial = "0; nexuiz, xonotic 1/66",
               .range = {.low = 0, .high = 0.5, .belowHigh = true},
               .help = "Sets the fraction of the image that is left free on each side",
               .since = "q3map2",
               .example = "0.05"},
              &MinimapOptions::border},
             {{.name = "-keepaspect",
               .help = "Widens the shorter side of the map to a square (default)",
               .since = "q3map2"},
              &MinimapOptions::keepAspect},
             {{.name = "-nokeepaspect", .help = "Stretches the map to the square image", .since = "q3map2"},
              Off(&MinimapOptions::keepAspect)},
             {{.name = "-minmax",
               .values = "X Y Z X Y Z",
               .kind = SettingKind::Number,
               .unit = "game units",
               .initial = "the world's",
               .help = "Sets the lowest and the highest corner of the box that is drawn",
               .since = "q3map2",
               .example = "-1024 -1024 -256 1024 1024 512"},
              Do<MinimapOptions>(SetBox)},
             {{.name = "-gray",
               .initial = "this; unvanquished -white",
               .help = "Writes pixels of 8 bits that hold the value",
               .since = "q3map2"},
              &MinimapOptions::gray},
             {{.name = "-black", .help = "Writes black pixels of 32 bits with the value as alpha", .since = "q3map2"},
              &MinimapOptions::black},
             {{.name = "-white", .help = "Writes white pixels of 32 bits with the value as alpha", .since = "q3map2"},
              &MinimapOptions::white},
             {{.name = "-o",
               .values = "FILE",
               .initial = "x.tga; nexuiz, xonotic ../gfx/x_mini.tga; unvanquished ../minimaps/x.tga",
               .help = "Names the image to write",
               .details =
                   "A name that is given is relative to the current folder, and the default to the folder of the map.",
               .since = "q3map2",
               .example = "mymap.tga"},
              &MinimapOptions::output}}};
}

SettingGroup<MinimapOptions> MinimapValueSettings() {
    return {"Values",
            "The value of a pixel is the thickness of solids along a vertical line, divided by the height of the box. "
            "The options act on it in the order of this list.",
            {{{.name = "-samples",
               .values = "N",
               .range = kMinimapSamples,
               .help = "Sets the number of vertical lines per pixel, at the same evenly spread places in all pixels",
               .since = "q3map2",
               .example = "16"},
              &MinimapOptions::samples},
             {{.name = "-random",
               .values = "N",
               .initial = "off",
               .range = kMinimapSamples,
               .help = "Sets the number of vertical lines per pixel, at random places up to a pixel from its middle",
               .since = "q3map2",
               .example = "16"},
              &MinimapOptions::randomSamples},
             {{.name = "-boost",
               .values = "F",
               .range = {.low = 0, .aboveLow = true},
               .help = "Raises low values if F is over 1, and lowers them if it is less",
               .details = "A value v becomes v F / ((F - 1) v + 1).",
               .since = "q3map2",
               .example = "2"},
              &MinimapOptions::boost},
             {{.name = "-autolevel", .help = "Stretches the values to the range from 0 to 1", .since = "q3map2"},
              &MinimapOptions::autoLevel},
             {{.name = "-noautolevel", .help = "Leaves the range of values as it is (default)", .since = "q3map2"},
              Off(&MinimapOptions::autoLevel)},
             {{.name = "-contrast",
               .values = "F",
               .help = "Multiplies the values by this factor",
               .since = "q3map2",
               .example = "1.5"},
              &MinimapOptions::contrast},
             {{.name = "-brightness",
               .values = "F",
               .help = "Adds this number to the values",
               .since = "q3map2",
               .example = "0.1"},
              &MinimapOptions::brightness},
             {{.name = "-sharpen",
               .values = "F",
               .help = "Sets how strongly edges are sharpened, where less than 0 means not at all",
               .details = "It is the weight of the difference from the eight pixels around.",
               .since = "q3map2",
               .example = "0.5"},
              &MinimapOptions::sharpen}}};
}

} // namespace

const MinimapStyle &MinimapStyleOf(std::string_view game) {
    const auto found = std::ranges::find_if(kMinimapStyles, [&](const MinimapStyle &style) {
        return !style.game.empty() && EqualNoCase(style.game, game);
    });
    return found == std::end(kMinimapStyles) ? kMinimapStyles[0] : *found;
}

MinimapPixels MinimapOptions::Pixels(const MinimapStyle &style) const {
    return gray ? MinimapPixels::Gray : black ? MinimapPixels::Black : white ? MinimapPixels::White : style.pixels;
}

std::filesystem::path MinimapOptions::Output(const MinimapStyle &style, const std::filesystem::path &bspPath) const {
    if (!output.empty())
        return std::filesystem::absolute(output);
    std::string name(style.output);
    name.replace(name.find("{}"), 2, bspPath.stem().string());
    return (bspPath.parent_path() / name).lexically_normal();
}

std::vector<SettingGroup<MinimapOptions>> MinimapSettings() {
    return {MinimapImageSettings(), MinimapValueSettings()};
}

MinimapOptions ParseMinimapOptions(Arguments &arguments, Log &log) {
    MinimapOptions options;
    TakeSettings(MinimapSettings(), options, arguments, log);
    if (int(options.gray) + int(options.black) + int(options.white) > 1)
        throw Error("-minimap: -gray, -black and -white exclude each other");
    if (options.samples > 1 && options.randomSamples > 0)
        throw Error("-minimap: -samples and -random exclude each other");
    if (const auto &box = options.box;
        box && !(box->mins.x < box->maxs.x && box->mins.y < box->maxs.y && box->mins.z < box->maxs.z))
        throw Error("-minimap: -minmax {} {} {} {} {} {}: expected the lowest corner, then the highest", box->mins.x,
                    box->mins.y, box->mins.z, box->maxs.x, box->maxs.y, box->maxs.z);
    return options;
}

// ---- Thickness of the solids of a map along vertical lines ----

namespace {

constexpr std::string_view kNoShaderName = "noshader";

/// Flags that any side has.
std::uint32_t FlagsOfSides(const Bsp &bsp, const bspBrush_t &brush, const std::vector<std::uint32_t> &flagsOfShader) {
    std::uint32_t flags = 0;
    for (std::int32_t i = 0; i < brush.numSides; ++i)
        flags |= flagsOfShader[std::size_t(bsp.brushSides[std::size_t(brush.firstSide + i)].shaderNum)];
    return flags;
}

/// Compile flags by number; none for sides without a shader.
std::vector<std::uint32_t> FlagsOfShaders(const Bsp &bsp, ShaderLibrary &library) {
    for (const bspShader_t &shader : bsp.shaders)
        library.SetDefaultFlags(FieldName(shader.shader), shader.surfaceFlags, shader.contentFlags);
    std::vector<std::uint32_t> flags;
    for (const bspShader_t &shader : bsp.shaders) {
        const std::string_view name = FieldName(shader.shader);
        flags.push_back(EqualNoCase(name, kNoShaderName) ? 0 : library.Get(name).compileFlags);
    }
    return flags;
}

MinimapSolid SolidOf(const Bsp &bsp, const bspBrush_t &brush) {
    constexpr double kInfinite = std::numeric_limits<double>::infinity();
    MinimapSolid solid{{}, {{-kInfinite, -kInfinite, -kInfinite}, {kInfinite, kInfinite, kInfinite}}};
    for (std::int32_t i = 0; i < brush.numSides; ++i) {
        const bspPlane_t &side = bsp.planes[std::size_t(bsp.brushSides[std::size_t(brush.firstSide + i)].planeNum)];
        const Plane plane{Vec3d(side.normal), double(side.dist)};
        for (std::size_t axis = 0; axis < 2; ++axis) {
            if (plane.normal[axis] == 1)
                solid.bounds.maxs[axis] = std::min(solid.bounds.maxs[axis], plane.dist);
            if (plane.normal[axis] == -1)
                solid.bounds.mins[axis] = std::max(solid.bounds.mins[axis], -plane.dist);
        }
        solid.planes.push_back(plane);
    }
    return solid;
}

} // namespace

double MinimapSolid::Thickness(double x, double y) const {
    double bottom = -std::numeric_limits<double>::infinity(), top = std::numeric_limits<double>::infinity();
    for (const Plane &plane : planes) {
        const double rest = plane.dist - plane.normal.x * x - plane.normal.y * y;
        if (plane.normal.z > 0)
            top = std::min(top, rest / plane.normal.z);
        else if (plane.normal.z < 0)
            bottom = std::max(bottom, rest / plane.normal.z);
        else if (rest < 0)
            return 0;
    }
    const double length = top - bottom;
    return length > 0 && std::isfinite(length) ? length : 0;
}

std::vector<MinimapSolid> MinimapSolids(const Bsp &bsp, ShaderLibrary &library) {
    const std::vector<std::uint32_t> flagsOfShader = FlagsOfShaders(bsp, library);
    std::vector<MinimapSolid> solids;
    const bspModel_t &world = bsp.models.front();
    for (std::int32_t i = 0; i < world.numBSPBrushes; ++i) {
        const bspBrush_t &brush = bsp.brushes[std::size_t(world.firstBSPBrush + i)];
        const std::uint32_t flags = FlagsOfSides(bsp, brush, flagsOfShader);
        if ((flags & C_SOLID) != 0 && (flags & C_SKY) == 0)
            solids.push_back(SolidOf(bsp, brush));
    }
    return solids;
}

// ---- Level curves and sharpening ----

namespace {

void BoostValues(std::vector<float> &values, double boost) {
    constexpr double kLeast = 1e-6; // a boost below 1 has a pole above 1, where solids overlap
    for (float &value : values)
        value = float(value * boost / std::max((boost - 1) * value + 1, kLeast));
}

/// v becomes contrast v + brightness.
struct LevelCurve {
    double contrast, brightness;
};

/// The curve that follows a stretch of the values to 0..1. The lowest counts as 1 at most, the highest as 0 at least.
LevelCurve AutoLevel(const std::vector<float> &values, LevelCurve curve, Log &log) {
    double low = 1, high = 0;
    for (const float value : values)
        low = std::min(low, double(value)), high = std::max(high, double(value));
    if (high > low) {
        curve.brightness -= curve.contrast * low / (high - low);
        curve.contrast /= high - low;
        log.Print("Auto level: brightness {:f}, contrast {:f}\n", curve.brightness, curve.contrast);
    }
    return curve;
}

/// v becomes (8 s + 1) v - s (sum of its eight neighbors); outside counts as 0.
void SharpenImage(MinimapValues &image, double s) {
    const MinimapValues from = image;
    const auto at = [&](int x, int y) {
        const bool inside = x >= 0 && y >= 0 && x < from.size && y < from.size;
        return inside ? double(from.values[std::size_t(y) * std::size_t(from.size) + std::size_t(x)]) : 0;
    };
    for (int y = 0; y < from.size; ++y)
        for (int x = 0; x < from.size; ++x) {
            double around = -at(x, y);
            for (int dy = -1; dy <= 1; ++dy)
                for (int dx = -1; dx <= 1; ++dx)
                    around += at(x + dx, y + dy);
            image.values[std::size_t(y) * std::size_t(from.size) + std::size_t(x)] =
                float((8 * s + 1) * at(x, y) - s * around);
        }
}

} // namespace

void ApplyMinimapLevels(MinimapValues &image, const MinimapOptions &options, Log &log) {
    if (options.boost != 1)
        BoostValues(image.values, options.boost);
    LevelCurve curve{options.contrast, options.brightness};
    if (options.autoLevel)
        curve = AutoLevel(image.values, curve, log);
    if (curve.contrast != 1 || curve.brightness != 0)
        for (float &value : image.values)
            value = float(value * curve.contrast + curve.brightness);
    if (options.sharpen > 0)
        SharpenImage(image, options.sharpen);
}

// ---- Where a pixel of a minimap is sampled ----

namespace {

constexpr int kMaxFailures = 1000; ///< moves in a row that do not spread the points, which end the search; chosen

/// A pseudorandom number from 0 to 1 for each index.
double RandomUnit(std::uint64_t index) {
    return UnitFromHash(HashIndex(index));
}

/// Square of the distance where the unit square repeats.
double WrappedDistanceSquared(const PixelOffset &a, const PixelOffset &b) {
    double sum = 0;
    for (std::size_t axis = 0; axis < 2; ++axis) {
        const double d = std::abs(a[axis] - b[axis]), wrapped = std::min(d, 1 - d);
        sum += wrapped * wrapped;
    }
    return sum;
}

struct ClosestPair {
    std::size_t a = 0, b = 0;
    double distanceSquared = std::numeric_limits<double>::max();
};

ClosestPair FindClosestPair(const std::vector<PixelOffset> &points) {
    ClosestPair closest;
    for (std::size_t a = 0; a < points.size(); ++a)
        for (std::size_t b = a + 1; b < points.size(); ++b)
            if (const double d = WrappedDistanceSquared(points[a], points[b]); d < closest.distanceSquared)
                closest = {a, b, d};
    return closest;
}

/// Square of the distance of `place` from the nearest point other than `omitted`.
double ClearanceSquared(const std::vector<PixelOffset> &points, std::size_t omitted, const PixelOffset &place) {
    double least = std::numeric_limits<double>::max();
    for (std::size_t i = 0; i < points.size(); ++i)
        if (i != omitted)
            least = std::min(least, WrappedDistanceSquared(points[i], place));
    return least;
}

} // namespace

std::vector<PixelOffset> SpreadOffsets(std::size_t count) {
    std::uint64_t index = 0;
    std::vector<PixelOffset> points(count);
    const auto randomPlace = [&index]() -> PixelOffset {
        const double x = RandomUnit(index++);
        return {x, RandomUnit(index++)};
    };
    for (PixelOffset &point : points)
        point = randomPlace();
    if (count < 2)
        return points;
    ClosestPair closest = FindClosestPair(points);
    for (int failures = 0; failures < kMaxFailures;) {
        const std::size_t moved = RandomUnit(index++) < 0.5 ? closest.a : closest.b;
        const PixelOffset place = randomPlace();
        if (ClearanceSquared(points, moved, place) <= closest.distanceSquared) {
            ++failures;
            continue;
        }
        points[moved] = place;
        closest = FindClosestPair(points);
        failures = 0;
    }
    return points;
}

MinimapSampler::MinimapSampler(const MinimapOptions &options)
    : count_(std::size_t(options.randomSamples > 0 ? options.randomSamples : options.samples)) {
    if (options.randomSamples == 0)
        fixed_ = count_ == 1 ? std::vector<PixelOffset>{{0.5, 0.5}} : SpreadOffsets(count_);
}

PixelOffset MinimapSampler::Offset(std::uint64_t pixel, std::size_t sample) const {
    if (!fixed_.empty())
        return fixed_[sample];
    // Uniform in the unit disc.
    const std::uint64_t index = 2 * (pixel * count_ + sample);
    const double radius = std::sqrt(RandomUnit(index)), angle = 2 * std::numbers::pi * RandomUnit(index + 1);
    return {0.5 + radius * std::cos(angle), 0.5 + radius * std::sin(angle)};
}

// ---- The picture and its files ----

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
        // Random samples are up to 1 pixel from the middle of theirs: 0.5 below its lower border, 1.5 above.
        constexpr double kBelow = 0.5, kAbove = 1.5;
        if (solid.bounds.maxs.y < y_ - kBelow * pixel_.y || solid.bounds.mins.y > y_ + kAbove * pixel_.y)
            return;
        const double from = (solid.bounds.mins.x - box_.mins.x) / pixel_.x - kAbove,
                     to = (solid.bounds.maxs.x - box_.mins.x) / pixel_.x + kAbove;
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
    log.Count(solids.size(), "opaque brushes");
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
    constexpr float kMost = 255.0f / 256; // the value that becomes byte 255
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
