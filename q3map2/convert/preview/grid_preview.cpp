// GPL-2.0-or-later. A picture of what the light grids of a map hold.
#include "q3map2/convert/preview/grid_preview.h"

#include "common/error.h"
#include "common/image/image.h"
#include "common/text/counted.h"
#include "q3map2/convert/preview/grid_preview_canvas.h"
#include "q3map2/convert/preview/grid_preview_cells.h"
#include "q3map2/convert/preview/grid_preview_light.h"
#include "q3map2/convert/preview/grid_preview_map.h"

#include <algorithm>
#include <cmath>

namespace q3 {

namespace {

constexpr int kWidth = 1600, kHeight = 1000;
constexpr int kPlanLeft = 20, kPlanTop = 60, kPlanSide = 860;
constexpr int kPairsLeft = 900, kPairsTop = 60, kCellWidth = 228, kCellHeight = 215;
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
float Strength(const ShSample &sample) {
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
        positions_ = map_.ChoosePositions(kColumns * kRows, [this](const Vec3f &p) { return Strength(sh_.At(p)); });
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
    // The brightest side of nine in ten positions is not clipped. Rounded to two digits for the caption.
    float ChooseExposure() const {
        std::vector<float> brightest;
        for (const Vec3f &position : positions_) {
            const ShSample sample = sh_.At(position);
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
        const int left = kPairsLeft + int(index) % kColumns * kCellWidth;
        const int top = kPairsTop + int(index) / kColumns * kCellHeight;
        const Vec3f &position = positions_[index];
        canvas_.Rectangle(left, top, kCellWidth - 8, kCellHeight - 8, kSolid);
        canvas_.Text(left + 10, top + 10, 2, kMark, std::to_string(index + 1));
        canvas_.Text(left + 48, top + 14, 1, kFaint,
                     fmt::format("AT {:.0f} {:.0f} {:.0f}", position.x, position.y, position.z));
        const float middle = float(left + (kCellWidth - 8) / 2), y = float(top + 104);
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
    ShPreview sh_;
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
    log.Print("Writing {}\n{}, {}, exposure {:.2g}\n", png.string(),
              Counted((long long)(preview.PositionCount()), "positions"),
              preview.HasLegacy() ? "both grids" : "SH grid only", preview.Exposure());
}

} // namespace q3
