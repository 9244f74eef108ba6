// GPL-2.0-or-later. A picture of what the light grids of a map hold.
#include "q3map2/convert/preview/grid_preview.h"

#include "common/error.h"
#include "common/image/image.h"
#include "common/text/text.h"
#include "q3map2/convert/preview/grid_preview_map.h"
#include "q3map2/shader/image_formats.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace q3 {

// ---- A picture to draw on: rectangles, spheres, small letters ----

namespace {

constexpr int kSubsamples = 4; ///< per axis of a pixel
constexpr int kGlyphColumns = 5;

struct Glyph {
    char letter;
    std::array<std::uint8_t, 7> rows; ///< bit 4 is the left column
};

constexpr std::array kGlyphs = {
    Glyph{'0', {14, 17, 19, 21, 25, 17, 14}}, Glyph{'1', {4, 12, 4, 4, 4, 4, 14}},
    Glyph{'2', {14, 17, 1, 6, 8, 16, 31}},    Glyph{'3', {14, 17, 1, 6, 1, 17, 14}},
    Glyph{'4', {2, 6, 10, 18, 31, 2, 2}},     Glyph{'5', {31, 16, 30, 1, 1, 17, 14}},
    Glyph{'6', {6, 8, 16, 30, 17, 17, 14}},   Glyph{'7', {31, 1, 2, 4, 8, 8, 8}},
    Glyph{'8', {14, 17, 17, 14, 17, 17, 14}}, Glyph{'9', {14, 17, 17, 15, 1, 2, 12}},
    Glyph{'A', {14, 17, 17, 31, 17, 17, 17}}, Glyph{'B', {30, 17, 17, 30, 17, 17, 30}},
    Glyph{'C', {14, 17, 16, 16, 16, 17, 14}}, Glyph{'D', {30, 17, 17, 17, 17, 17, 30}},
    Glyph{'E', {31, 16, 16, 30, 16, 16, 31}}, Glyph{'F', {31, 16, 16, 30, 16, 16, 16}},
    Glyph{'G', {14, 17, 16, 23, 17, 17, 15}}, Glyph{'H', {17, 17, 17, 31, 17, 17, 17}},
    Glyph{'I', {14, 4, 4, 4, 4, 4, 14}},      Glyph{'J', {7, 2, 2, 2, 2, 18, 12}},
    Glyph{'K', {17, 18, 20, 24, 20, 18, 17}}, Glyph{'L', {16, 16, 16, 16, 16, 16, 31}},
    Glyph{'M', {17, 27, 21, 21, 17, 17, 17}}, Glyph{'N', {17, 25, 21, 19, 17, 17, 17}},
    Glyph{'O', {14, 17, 17, 17, 17, 17, 14}}, Glyph{'P', {30, 17, 17, 30, 16, 16, 16}},
    Glyph{'Q', {14, 17, 17, 17, 21, 18, 13}}, Glyph{'R', {30, 17, 17, 30, 20, 18, 17}},
    Glyph{'S', {15, 16, 16, 14, 1, 1, 30}},   Glyph{'T', {31, 4, 4, 4, 4, 4, 4}},
    Glyph{'U', {17, 17, 17, 17, 17, 17, 14}}, Glyph{'V', {17, 17, 17, 17, 17, 10, 4}},
    Glyph{'W', {17, 17, 17, 21, 21, 27, 17}}, Glyph{'X', {17, 17, 10, 4, 10, 17, 17}},
    Glyph{'Y', {17, 17, 10, 4, 4, 4, 4}},     Glyph{'Z', {31, 1, 2, 4, 8, 16, 31}},
    Glyph{'.', {0, 0, 0, 0, 0, 12, 12}},      Glyph{',', {0, 0, 0, 0, 12, 4, 8}},
    Glyph{'-', {0, 0, 0, 31, 0, 0, 0}},       Glyph{':', {0, 12, 12, 0, 12, 12, 0}},
    Glyph{'/', {1, 1, 2, 4, 8, 16, 16}},      Glyph{'(', {2, 4, 8, 8, 8, 4, 2}},
    Glyph{')', {8, 4, 2, 2, 2, 4, 8}},        Glyph{'+', {0, 4, 4, 31, 4, 4, 0}},
};

} // namespace

Canvas::Canvas(int width, int height, const Vec3f &color) {
    image_.width = width;
    image_.height = height;
    image_.rgba.assign(4 * std::size_t(width) * std::size_t(height), 255);
    Rectangle(0, 0, width, height, color);
}

void Canvas::Blend(int x, int y, const Vec3f &color, float alpha) {
    if (x < 0 || y < 0 || x >= image_.width || y >= image_.height)
        return;
    std::uint8_t *texel = &image_.rgba[4 * (std::size_t(y) * std::size_t(image_.width) + std::size_t(x))];
    for (std::size_t channel = 0; channel < 3; channel++) {
        const float mixed = float(texel[channel]) * (1 - alpha) + 255 * color[channel] * alpha;
        texel[channel] = std::uint8_t(std::clamp(mixed + 0.5f, 0.0f, 255.0f));
    }
}

void Canvas::Rectangle(int x, int y, int width, int height, const Vec3f &color) {
    for (int row = y; row < y + height; row++)
        for (int column = x; column < x + width; column++)
            Blend(column, row, color);
}

void Canvas::Text(int x, int y, int scale, const Vec3f &color, std::string_view text) {
    for (std::size_t i = 0; i < text.size(); i++) {
        const auto glyph = std::ranges::find(kGlyphs, text[i], &Glyph::letter);
        if (glyph == kGlyphs.end())
            continue;
        const int left = x + int(i) * kGlyphWidth * scale;
        for (int row = 0; row < kGlyphHeight; row++)
            for (int column = 0; column < kGlyphColumns; column++)
                if (glyph->rows[std::size_t(row)] >> (kGlyphColumns - 1 - column) & 1)
                    Rectangle(left + column * scale, y + row * scale, scale, scale, color);
    }
}

void Canvas::TextCentered(int x, int y, int scale, const Vec3f &color, std::string_view text) {
    Text(x - TextWidth(scale, text) / 2, y, scale, color, text);
}

View PlanView() {
    return {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
}

View ObjectView() {
    constexpr float degree = std::numbers::pi_v<float> / 180;
    const float around = 225 * degree, above = 35 * degree; // from east by north to south-west; from the horizon
    const Vec3f toCamera(std::cos(around) * std::cos(above), std::sin(around) * std::cos(above), std::sin(above));
    const Vec3f right = Normalize(Cross(Vec3f(0, 0, 1), toCamera));
    return {right, Cross(toCamera, right), toCamera};
}

Vec3f ToDisplay(const Vec3f &linear) {
    const auto curve = [](float channel) { return SrgbFromLinear(std::clamp(channel, 0.0f, 1.0f)); };
    return {curve(linear.x), curve(linear.y), curve(linear.z)};
}

void DrawSphere(Canvas &canvas, float x, float y, float radius, const View &view,
                const std::function<Vec3f(const Vec3f &)> &light) {
    for (int row = int(std::floor(y - radius)); row <= int(y + radius); row++)
        for (int column = int(std::floor(x - radius)); column <= int(x + radius); column++) {
            Vec3f sum;
            int covered = 0;
            for (int sample = 0; sample < kSubsamples * kSubsamples; sample++) {
                const float u = float(column) + (float(sample % kSubsamples) + 0.5f) / kSubsamples - x;
                const float v = float(row) + (float(sample / kSubsamples) + 0.5f) / kSubsamples - y;
                const float squaredHeight = radius * radius - u * u - v * v;
                if (squaredHeight < 0)
                    continue;
                covered++;
                sum += light((view.right * u - view.up * v + view.toCamera * std::sqrt(squaredHeight)) / radius);
            }
            if (covered > 0)
                canvas.Blend(column, row, ToDisplay(sum / float(covered)),
                             float(covered) / float(kSubsamples * kSubsamples));
        }
}

// ---- The picture: a plan of the map, and spheres lit by its grids ----

namespace {

// Lengths and positions are in pixels.
constexpr int kWidth = 1600, kHeight = 1000;
constexpr int kTitleScale = 3, kTextScale = 2, kSmallScale = 1; ///< of letters
constexpr int kTitleTop = 22, kTextBesideTitleTop = 28;

constexpr int kPlanLeft = 20, kPlanTop = 60, kPlanSide = 860;
constexpr int kPlanHeightLeft = kPlanLeft + 150; ///< of the text that says the height of the plan
constexpr int kCaptionTops[] = {kPlanTop + kPlanSide + 14, kPlanTop + kPlanSide + 40};
constexpr int kLattice = 27; ///< between the small spheres of the plan
constexpr float kSmallRadius = 10;
constexpr int kPlanSubsamples = 2; ///< per axis of a pixel

// Legend of the sizes of cells: a square in the color of the size, the size, a gap.
constexpr int kLegendLeft = kPlanLeft + 560, kLegendSquare = 14, kLegendStep = 18, kLegendGap = 12;

// Numbers of the positions in the plan, in a frame. Their centers keep a distance from the border of the plan.
constexpr int kMarkFrame = 2, kMarkPaddingX = 4, kMarkPaddingY = 3, kMarkMarginX = 14, kMarkMarginY = 10;

// A box for each position, with a sphere lit by the SH grid and one by the legacy grid, or the first alone. Positions
// within the box.
constexpr int kPairsLeft = 900, kPairsTop = 60, kPairWidth = 228, kPairHeight = 215, kPairGap = 8;
constexpr int kColumns = 3, kRows = 4;
constexpr int kNumberLeft = 10, kNumberTop = 10, kCoordinatesLeft = 48, kCoordinatesTop = 14;
constexpr float kPairRadius = 52, kSphereGap = 3, kSingleRadius = 72;
constexpr int kPairCenterTop = 104, kSingleCenterTop = 112, kSphereNameTop = 176;

constexpr float kMinCellPixels = 3; ///< smaller cells of a sparse grid have no outlines
constexpr float kOutlineAlpha = 0.75f;
constexpr int kLegendSizes = 6; ///< sizes of cells in the legend
constexpr float kMinExposure = 1.0f / 64, kMaxExposure = 16;
constexpr float kContrastWeight = 8;               ///< weight of color contrast, relative to brightness
constexpr float kGroundFactor = 0.35f;             ///< factor of the light on the ground, so that spheres stand out
constexpr Vec3f kDarkGround{0.03f, 0.03f, 0.033f}; ///< linear color of the ground without light

constexpr Vec3f kPaper{0.11f, 0.115f, 0.13f}, kSolid{0.05f, 0.052f, 0.06f}, kInk{0.93f, 0.93f, 0.93f};
constexpr Vec3f kFaint{0.6f, 0.62f, 0.66f}, kMark{1.0f, 0.86f, 0.25f};

/// Maps world to picture positions in the plan: north up, centered in its square.
struct Plan {
    float height = 0, scale = 1; ///< scale: pixels per unit
    Vec3f center;

    Plan(const PreviewMap &map) : height(map.BestHeight()) {
        const Boundsf area = map.OpenArea(height);
        const Vec3f size = area.maxs - area.mins;
        scale = float(kPlanSide) / std::max({size.x, size.y, 1.0f});
        center = area.Center();
    }
    Vec3f World(float x, float y) const {
        return {center.x + (x - (kPlanLeft + kPlanSide / 2)) / scale,
                center.y - (y - (kPlanTop + kPlanSide / 2)) / scale, height};
    }
    float X(const Vec3f &p) const { return (p.x - center.x) * scale + (kPlanLeft + kPlanSide / 2); }
    float Y(const Vec3f &p) const { return (center.y - p.y) * scale + (kPlanTop + kPlanSide / 2); }
};

/// Rank of a position: the greatest sum of the brightness of two opposite sides, plus the weighted greatest contrast of
/// the colors of two opposite sides, over the three axes.
float InterestOf(const SHSample &sample) {
    float brightness = 0, contrast = 0;
    for (const Vec3f &axis : {Vec3f(1, 0, 0), Vec3f(0, 1, 0), Vec3f(0, 0, 1)}) {
        const Vec3f a = LightOn(sample, axis), b = LightOn(sample, -axis);
        const float high = MaxComponent(a), low = MaxComponent(b);
        brightness = std::max(brightness, high + low);
        if (high > 0 && low > 0)
            contrast = std::max(contrast, MaxComponent(a / high - b / low) * std::min(high, low));
    }
    return brightness + kContrastWeight * contrast;
}

class Preview {
  public:
    explicit Preview(const Bsp &bsp)
        : sparse_(bsp.sparseGridSH ? &*bsp.sparseGridSH : nullptr), map_(bsp), sh_(bsp),
          legacy_(LegacyPreview::Make(bsp)), plan_(map_), canvas_(kWidth, kHeight, kPaper) {
        positions_ = map_.ChoosePositions(kColumns * kRows, [this](const Vec3f &p) { return InterestOf(sh_.At(p)); });
        exposure_ = ChooseExposure();
    }

    const Image &Draw() {
        DrawGround();
        DrawCells();
        DrawLattice();
        for (std::size_t i = 0; i < positions_.size(); i++) {
            DrawMark(i);
            DrawPair(i);
        }
        DrawCaptions();
        return canvas_.Picture();
    }

    std::size_t PositionCount() const { return positions_.size(); }
    bool HasLegacy() const { return legacy_.has_value(); }
    float Exposure() const { return exposure_; }

  private:
    /// The brightest side of nine in ten positions is not clipped. Rounded to two digits for the caption.
    float ChooseExposure() const {
        std::vector<float> brightest;
        for (const Vec3f &position : positions_) {
            const SHSample sample = sh_.At(position);
            float most = 0;
            for (int direction = 0; direction < 27; direction++) // the steps -1, 0, 1 on each axis
                most = std::max(most, MaxComponent(LightOn(sample, Normalize(Vec3f(float(direction % 3 - 1),
                                                                                   float(direction / 3 % 3 - 1),
                                                                                   float(direction / 9 - 1))))));
            brightest.push_back(most);
        }
        const auto high = brightest.begin() + std::ptrdiff_t(brightest.size() * 9 / 10);
        std::nth_element(brightest.begin(), high, brightest.end());
        if (!(*high > 0))
            return 1;
        const float exposure = std::clamp(1 / *high, kMinExposure, kMaxExposure);
        const float step = std::pow(10.0f, std::floor(std::log10(exposure)) - 1);
        return std::round(exposure / step) * step;
    }

    template <typename Sample> auto Shading(const Sample &sample) const {
        return [sample, exposure = exposure_](const Vec3f &normal) { return LightOn(sample, normal) * exposure; };
    }

    void DrawGround() {
        constexpr int samples = kPlanSubsamples * kPlanSubsamples;
        for (int row = 0; row < kPlanSide; row++)
            for (int column = 0; column < kPlanSide; column++) {
                int open = 0;
                for (int sample = 0; sample < samples; sample++) {
                    const float x = (float(sample % kPlanSubsamples) + 0.5f) / kPlanSubsamples;
                    const float y = (float(sample / kPlanSubsamples) + 0.5f) / kPlanSubsamples;
                    open += map_.IsOpen(plan_.World(float(kPlanLeft + column) + x, float(kPlanTop + row) + y));
                }
                const int atX = kPlanLeft + column, atY = kPlanTop + row;
                canvas_.Blend(atX, atY, kSolid);
                if (open == 0)
                    continue;
                const Vec3f position = plan_.World(float(atX) + 0.5f, float(atY) + 0.5f);
                const Vec3f light = LightOn(sh_.At(position), {0, 0, 1}) * (exposure_ * kGroundFactor);
                canvas_.Blend(atX, atY, ToDisplay(light + kDarkGround), float(open) / samples);
            }
    }

    /// Outlines of the cells of a sparse grid at the height of the plan.
    void DrawCells() {
        if (sparse_ == nullptr)
            return;
        const auto cellAt = [this](int column, int row) {
            return SparseCellAt(*sparse_, plan_.World(float(kPlanLeft + column) + 0.5f, float(kPlanTop + row) + 0.5f));
        };
        for (int row = 0; row + 1 < kPlanSide; row++)
            for (int column = 0; column + 1 < kPlanSide; column++) {
                const std::optional<SparseCell> cell = cellAt(column, row);
                const auto isBorder = [&](const std::optional<SparseCell> &other) { return other && *other != *cell; };
                if (!cell || float(1 << cell->size) * sparse_->cell[0] * plan_.scale < kMinCellPixels)
                    continue;
                if (isBorder(cellAt(column + 1, row)) || isBorder(cellAt(column, row + 1)))
                    canvas_.Blend(kPlanLeft + column, kPlanTop + row, SparseCellColor(cell->size), kOutlineAlpha);
            }
    }

    /// Legend of the outlines above the plan: colors and edges of cells, game units.
    void DrawCellSizes() {
        int x = kLegendLeft;
        for (int size = 0; size < std::min(sparse_->levels, kLegendSizes); size++) {
            canvas_.Rectangle(x, kTextBesideTitleTop, kLegendSquare, kLegendSquare, SparseCellColor(size));
            const std::string text = fmt::format("{:g}", double(sparse_->cell[0]) * double(1 << size));
            canvas_.Text(x + kLegendStep, kTextBesideTitleTop, kTextScale, kFaint, text);
            x += kLegendStep + Canvas::TextWidth(kTextScale, text) + kLegendGap;
        }
    }

    void DrawLattice() {
        for (int y = kPlanTop + kLattice / 2; y < kPlanTop + kPlanSide; y += kLattice)
            for (int x = kPlanLeft + kLattice / 2; x < kPlanLeft + kPlanSide; x += kLattice) {
                const Vec3f position = plan_.World(float(x), float(y));
                const float radius = kSmallRadius / plan_.scale;
                if (IsClear(position, radius))
                    DrawSphere(canvas_, float(x), float(y), kSmallRadius, PlanView(), Shading(sh_.At(position)));
            }
    }

    bool IsClear(const Vec3f &position, float radius) const {
        for (const auto &[x, y] : {std::pair{0.0f, 0.0f}, {1.0f, 0.0f}, {-1.0f, 0.0f}, {0.0f, 1.0f}, {0.0f, -1.0f}})
            if (!map_.IsOpen(position + Vec3f(x, y, 0) * radius))
                return false;
        return true;
    }

    void DrawMark(std::size_t index) {
        const std::string number = std::to_string(index + 1);
        const int x =
            std::clamp(int(plan_.X(positions_[index])), kPlanLeft + kMarkMarginX, kPlanLeft + kPlanSide - kMarkMarginX);
        const int y =
            std::clamp(int(plan_.Y(positions_[index])), kPlanTop + kMarkMarginY, kPlanTop + kPlanSide - kMarkMarginY);
        const int width = Canvas::TextWidth(kTextScale, number) + 2 * kMarkPaddingX;
        const int height = kTextScale * Canvas::kGlyphHeight + 2 * kMarkPaddingY;
        canvas_.Rectangle(x - width / 2 - kMarkFrame, y - height / 2 - kMarkFrame, width + 2 * kMarkFrame,
                          height + 2 * kMarkFrame, kMark);
        canvas_.Rectangle(x - width / 2, y - height / 2, width, height, kSolid);
        canvas_.TextCentered(x + 1, y - kTextScale * Canvas::kGlyphHeight / 2, kTextScale, kMark, number);
    }

    void DrawPair(std::size_t index) {
        const int left = kPairsLeft + int(index) % kColumns * kPairWidth;
        const int top = kPairsTop + int(index) / kColumns * kPairHeight;
        const Vec3f &position = positions_[index];
        canvas_.Rectangle(left, top, kPairWidth - kPairGap, kPairHeight - kPairGap, kSolid);
        canvas_.Text(left + kNumberLeft, top + kNumberTop, kTextScale, kMark, std::to_string(index + 1));
        canvas_.Text(left + kCoordinatesLeft, top + kCoordinatesTop, kSmallScale, kFaint,
                     fmt::format("AT {:.0f} {:.0f} {:.0f}", position.x, position.y, position.z));
        const float middle = float(left + (kPairWidth - kPairGap) / 2);
        if (!legacy_) {
            DrawSphere(canvas_, middle, float(top + kSingleCenterTop), kSingleRadius, ObjectView(),
                       Shading(sh_.At(position)));
            return;
        }
        const float y = float(top + kPairCenterTop), apart = kPairRadius + kSphereGap / 2;
        DrawSphere(canvas_, middle - apart, y, kPairRadius, ObjectView(), Shading(sh_.At(position)));
        DrawSphere(canvas_, middle + apart, y, kPairRadius, ObjectView(), Shading(legacy_->At(position)));
        canvas_.TextCentered(int(middle - apart), top + kSphereNameTop, kTextScale, kInk, "SH");
        canvas_.TextCentered(int(middle + apart), top + kSphereNameTop, kTextScale, kFaint, "LEGACY");
    }

    void DrawCaptions() {
        canvas_.Text(kPlanLeft, kTitleTop, kTitleScale, kInk, "SH GRID");
        canvas_.Text(kPlanHeightLeft, kTextBesideTitleTop, kTextScale, kFaint,
                     fmt::format("PLAN AT Z {:.0f}, NORTH UP", plan_.height));
        const shgrid_grid &grid = sh_.Grid();
        if (sparse_ != nullptr)
            DrawCellSizes();
        canvas_.Text(kPlanLeft, kCaptionTops[0], kTextScale, kFaint,
                     sparse_ != nullptr
                         ? fmt::format("{} POINTS, SMALLEST CELL {:.4g} X {:.4g} X {:.4g}", grid.count, grid.cell[0],
                                       grid.cell[1], grid.cell[2])
                         : fmt::format("{} X {} X {} POINTS, CELL {:.4g} X {:.4g} X {:.4g}", grid.bounds[0],
                                       grid.bounds[1], grid.bounds[2], grid.cell[0], grid.cell[1], grid.cell[2]));
        canvas_.Text(kPlanLeft, kCaptionTops[1], kTextScale, kFaint,
                     fmt::format("EXPOSURE {:.2g}, LINEAR TO SRGB. SMALL SPHERES: SEEN FROM ABOVE", exposure_));
        if (legacy_) {
            canvas_.Text(kPairsLeft, kTitleTop, kTitleScale, kInk, "SH GRID  AND  LEGACY GRID");
            canvas_.Text(kPairsLeft, kCaptionTops[0], kTextScale, kFaint,
                         sh_.HasTone() ? "LEFT: SH, WITH TONE. RIGHT: AMBIENT + DIRECTED, BLENDED"
                                       : "LEFT: SH. RIGHT: AMBIENT + DIRECTED, BLENDED");
            canvas_.Text(kPairsLeft, kCaptionTops[1], kTextScale, kFaint,
                         "AS AN ENGINE DOES. SEEN FROM SOUTH-WEST ABOVE");
        } else {
            canvas_.Text(kPairsLeft, kTitleTop, kTitleScale, kInk, "SH GRID");
            canvas_.Text(kPairsLeft, kCaptionTops[0], kTextScale, kFaint, "THE MAP HAS NO LEGACY GRID TO COMPARE");
            canvas_.Text(kPairsLeft, kCaptionTops[1], kTextScale, kFaint, "SEEN FROM SOUTH-WEST ABOVE");
        }
    }

    const SparseGridSH *sparse_; ///< null: the grid is uniform
    PreviewMap map_;
    SHPreview sh_;
    std::optional<LegacyPreview> legacy_;
    Plan plan_;
    Canvas canvas_;
    std::vector<Vec3f> positions_;
    float exposure_ = 1;
};

} // namespace

void WriteGridPreview(const std::filesystem::path &png, const Bsp &bsp, Log &log) {
    Preview preview(bsp);
    WritePng(png, preview.Draw());
    log.Print("Writing {}\n{}, {}, exposure {:.2g}\n", png.string(), Counted(preview.PositionCount(), "positions"),
              preview.HasLegacy() ? "both grids" : "SH grid only", preview.Exposure());
}

} // namespace q3
