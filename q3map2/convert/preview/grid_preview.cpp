// GPL-2.0-or-later. A picture of what the light grids of a map hold.
#include "q3map2/convert/preview/grid_preview.h"

#include "common/error.h"
#include "common/image/image.h"
#include "common/text/text.h"
#include "q3map2/convert/preview/grid_preview_map.h"

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

float SrgbCurve(float linear) {
    const float value = std::clamp(linear, 0.0f, 1.0f);
    return value <= 0.0031308f ? 12.92f * value : 1.055f * std::pow(value, 1 / 2.4f) - 0.055f;
}

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
    const float around = 225 * degree, above = 35 * degree;
    const Vec3f toCamera(std::cos(around) * std::cos(above), std::sin(around) * std::cos(above), std::sin(above));
    const Vec3f right = Normalize(Cross(Vec3f(0, 0, 1), toCamera));
    return {right, Cross(toCamera, right), toCamera};
}

Vec3f ToDisplay(const Vec3f &linear) {
    return {SrgbCurve(linear.x), SrgbCurve(linear.y), SrgbCurve(linear.z)};
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
                const float height = radius * radius - u * u - v * v;
                if (height < 0)
                    continue;
                covered++;
                sum += light((view.right * u - view.up * v + view.toCamera * std::sqrt(height)) / radius);
            }
            if (covered > 0)
                canvas.Blend(column, row, ToDisplay(sum / float(covered)),
                             float(covered) / float(kSubsamples * kSubsamples));
        }
}

// ---- A picture of what the light grids of a map hold ----

namespace {

constexpr int kWidth = 1600, kHeight = 1000;
constexpr int kPlanLeft = 20, kPlanTop = 60, kPlanSide = 860;
constexpr int kPairsLeft = 900, kPairsTop = 60, kPairWidth = 228, kPairHeight = 215;
constexpr int kColumns = 3, kRows = 4;
constexpr float kPairRadius = 52, kSingleRadius = 72;
constexpr int kLattice = 27; ///< pixels between the small spheres of the plan
constexpr float kSmallRadius = 10;
constexpr int kPlanSubsamples = 2;
constexpr float kMinCellPixels = 3; ///< smaller cells of a sparse grid have no outlines
constexpr float kOutlineAlpha = 0.75f;
constexpr int kLegendSizes = 6; ///< sizes of cells in the legend
constexpr float kMinExposure = 1.0f / 64, kMaxExposure = 16;
constexpr float kContrastWeight = 8;   ///< weight of color contrast, relative to brightness
constexpr float kGroundFactor = 0.35f; ///< factor of the light on the ground, so that spheres stand out

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

/// Rank of a position: brightness of opposite sides, plus weighted contrast of their colors; axis maxima.
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
            for (int direction = 0; direction < 27; direction++)
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
                canvas_.Blend(atX, atY, ToDisplay(light + Vec3f(0.03f, 0.03f, 0.033f)), float(open) / samples);
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
        int x = kPlanLeft + 560;
        for (int size = 0; size < std::min(sparse_->levels, kLegendSizes); size++) {
            canvas_.Rectangle(x, 28, 14, 14, SparseCellColor(size));
            const std::string text = fmt::format("{:g}", double(sparse_->cell[0]) * double(1 << size));
            canvas_.Text(x + 18, 28, 2, kFaint, text);
            x += 18 + Canvas::TextWidth(2, text) + 12;
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
        const int x = std::clamp(int(plan_.X(positions_[index])), kPlanLeft + 14, kPlanLeft + kPlanSide - 14);
        const int y = std::clamp(int(plan_.Y(positions_[index])), kPlanTop + 10, kPlanTop + kPlanSide - 10);
        const int width = Canvas::TextWidth(2, number) + 8, height = 2 * Canvas::kGlyphHeight + 6;
        canvas_.Rectangle(x - width / 2 - 2, y - height / 2 - 2, width + 4, height + 4, kMark);
        canvas_.Rectangle(x - width / 2, y - height / 2, width, height, kSolid);
        canvas_.TextCentered(x + 1, y - Canvas::kGlyphHeight, 2, kMark, number);
    }

    void DrawPair(std::size_t index) {
        const int left = kPairsLeft + int(index) % kColumns * kPairWidth;
        const int top = kPairsTop + int(index) / kColumns * kPairHeight;
        const Vec3f &position = positions_[index];
        canvas_.Rectangle(left, top, kPairWidth - 8, kPairHeight - 8, kSolid);
        canvas_.Text(left + 10, top + 10, 2, kMark, std::to_string(index + 1));
        canvas_.Text(left + 48, top + 14, 1, kFaint,
                     fmt::format("AT {:.0f} {:.0f} {:.0f}", position.x, position.y, position.z));
        const float middle = float(left + (kPairWidth - 8) / 2), y = float(top + 104);
        if (!legacy_) {
            DrawSphere(canvas_, middle, y + 8, kSingleRadius, ObjectView(), Shading(sh_.At(position)));
            return;
        }
        const float apart = kPairRadius + 1.5f;
        DrawSphere(canvas_, middle - apart, y, kPairRadius, ObjectView(), Shading(sh_.At(position)));
        DrawSphere(canvas_, middle + apart, y, kPairRadius, ObjectView(), Shading(legacy_->At(position)));
        canvas_.TextCentered(int(middle - apart), top + 176, 2, kInk, "SH");
        canvas_.TextCentered(int(middle + apart), top + 176, 2, kFaint, "LEGACY");
    }

    void DrawCaptions() {
        canvas_.Text(kPlanLeft, 22, 3, kInk, "SH GRID");
        canvas_.Text(kPlanLeft + 150, 28, 2, kFaint, fmt::format("PLAN AT Z {:.0f}, NORTH UP", plan_.height));
        const shgrid_grid &grid = sh_.Grid();
        if (sparse_ != nullptr)
            DrawCellSizes();
        canvas_.Text(kPlanLeft, kPlanTop + kPlanSide + 14, 2, kFaint,
                     sparse_ != nullptr
                         ? fmt::format("{} POINTS, SMALLEST CELL {:.4g} X {:.4g} X {:.4g}", grid.count, grid.cell[0],
                                       grid.cell[1], grid.cell[2])
                         : fmt::format("{} X {} X {} POINTS, CELL {:.4g} X {:.4g} X {:.4g}", grid.bounds[0],
                                       grid.bounds[1], grid.bounds[2], grid.cell[0], grid.cell[1], grid.cell[2]));
        canvas_.Text(kPlanLeft, kPlanTop + kPlanSide + 40, 2, kFaint,
                     fmt::format("EXPOSURE {:.2g}, LINEAR TO SRGB. SMALL SPHERES: SEEN FROM ABOVE", exposure_));
        if (legacy_) {
            canvas_.Text(kPairsLeft, 22, 3, kInk, "SH GRID  AND  LEGACY GRID");
            canvas_.Text(kPairsLeft, kPlanTop + kPlanSide + 14, 2, kFaint,
                         sh_.HasTone() ? "LEFT: SH, WITH TONE. RIGHT: AMBIENT + DIRECTED, BLENDED"
                                       : "LEFT: SH. RIGHT: AMBIENT + DIRECTED, BLENDED");
            canvas_.Text(kPairsLeft, kPlanTop + kPlanSide + 40, 2, kFaint,
                         "AS AN ENGINE DOES. SEEN FROM SOUTH-WEST ABOVE");
        } else {
            canvas_.Text(kPairsLeft, 22, 3, kInk, "SH GRID");
            canvas_.Text(kPairsLeft, kPlanTop + kPlanSide + 14, 2, kFaint, "THE MAP HAS NO LEGACY GRID TO COMPARE");
            canvas_.Text(kPairsLeft, kPlanTop + kPlanSide + 40, 2, kFaint, "SEEN FROM SOUTH-WEST ABOVE");
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
