// GPL-2.0-or-later. Charts as SVG and PNG: one drawing for both.
#include "tools/shbench/chart.h"

#include "common/error.h"
#include "tools/shbench/chart_scale.h"

#include <cairo-svg.h>
#include <cairo.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numbers>

namespace q3::bench {

namespace {

/// Picture units: pixels of the PNG at scale 1.
constexpr double kWidth = 960, kHeight = 600;
constexpr double kLeft = 84, kRight = 930, kTop = 84, kBottom = 530;
constexpr double kDot = 5, kText = 13;
constexpr int kPngScale = 2;

struct Color {
    double r, g, b;
};
constexpr Color kInk{0.13, 0.15, 0.18}, kFaded{0.42, 0.45, 0.50}, kGridLine{0.90, 0.91, 0.93};
constexpr std::array<Color, 5> kSeriesColors = {
    {{0.12, 0.40, 0.68}, {0.80, 0.38, 0.10}, {0.16, 0.52, 0.33}, {0.52, 0.28, 0.60}, {0.45, 0.45, 0.45}}};

struct Box {
    double x0, y0, x1, y1;
    bool Meets(const Box &o) const { return x0 < o.x1 && o.x0 < x1 && y0 < o.y1 && o.y0 < y1; }
};

/// Draws a chart; labels keep clear of each other, of dots and of the frame.
class Painter {
  public:
    Painter(const Chart &chart, cairo_t *canvas)
        : chart_(chart), canvas_(canvas), x_(Values(true), chart.x.log, kLeft, kRight),
          y_(Values(false), chart.y.log, kBottom, kTop) {}

    void Draw() {
        Use({1, 1, 1});
        cairo_paint(canvas_);
        cairo_select_font_face(canvas_, "sans-serif", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
        DrawAxes();
        DrawTitles();
        cairo_save(canvas_);
        cairo_rectangle(canvas_, kLeft, kTop, kRight - kLeft, kBottom - kTop);
        cairo_clip(canvas_);
        DrawReferences();
        cairo_restore(canvas_);
        DrawKey();
        DrawSeries();
        DrawLabels();
    }

  private:
    std::vector<double> Values(bool ofX) const {
        std::vector<double> values;
        for (const ChartSeries &series : chart_.series)
            for (const ChartPoint &point : series.points)
                values.push_back(ofX ? point.x : point.y);
        if (!ofX && chart_.level)
            values.push_back(*chart_.level);
        return values;
    }
    void Use(const Color &color) { cairo_set_source_rgb(canvas_, color.r, color.g, color.b); }
    double TextWidth(const std::string &text, double size = kText) {
        cairo_set_font_size(canvas_, size);
        cairo_text_extents_t extents;
        cairo_text_extents(canvas_, text.c_str(), &extents);
        return extents.x_advance;
    }
    /// align 0: x is the left end, 0.5: the middle, 1: the right end.
    void Text(double x, double y, double align, const std::string &text, double size = kText) {
        cairo_move_to(canvas_, x - align * TextWidth(text, size), y);
        cairo_show_text(canvas_, text.c_str());
    }
    void Line(double x0, double y0, double x1, double y1) {
        cairo_move_to(canvas_, x0, y0);
        cairo_line_to(canvas_, x1, y1);
        cairo_stroke(canvas_);
    }
    void Dot(double x, double y) {
        cairo_new_path(canvas_); // text leaves a current point behind, which an arc would join
        cairo_arc(canvas_, x, y, kDot, 0, 2 * std::numbers::pi);
        cairo_fill(canvas_);
    }
    bool Shows(const ChartPoint &point) const { return x_.Shows(point.x) && y_.Shows(point.y); }

    void DrawAxes();
    void DrawTitles();
    void DrawReferences();
    void DrawKey();
    void DrawSeries();
    void DrawLabels();
    Box LabelBox(double x, double y, double width, int place) const;

    const Chart &chart_;
    cairo_t *canvas_;
    ChartScale x_, y_;
    std::vector<Box> taken_;
};

void Painter::DrawAxes() {
    cairo_set_line_width(canvas_, 1);
    for (const auto &tick : x_.Ticks()) {
        Use(kGridLine);
        Line(x_.At(tick.value), kTop, x_.At(tick.value), kBottom);
        Use(kFaded);
        Text(x_.At(tick.value), kBottom + 20, 0.5, tick.label);
    }
    for (const auto &tick : y_.Ticks()) {
        Use(kGridLine);
        Line(kLeft, y_.At(tick.value), kRight, y_.At(tick.value));
        Use(kFaded);
        Text(kLeft - 10, y_.At(tick.value) + kText * 0.35, 1, tick.label);
    }
    Use(kFaded);
    Line(kLeft, kBottom, kRight, kBottom);
    Line(kLeft, kTop, kLeft, kBottom);
}

void Painter::DrawTitles() {
    Use(kInk);
    Text(kLeft, 34, 0, chart_.title, 19);
    Use(kFaded);
    Text(kLeft, 58, 0, chart_.subtitle);
    Use(kInk);
    Text((kLeft + kRight) / 2, kHeight - 24, 0.5, chart_.x.title, 14);
    cairo_save(canvas_);
    cairo_translate(canvas_, 26, (kTop + kBottom) / 2);
    cairo_rotate(canvas_, -std::numbers::pi / 2);
    Text(0, 0, 0.5, chart_.y.title, 14);
    cairo_restore(canvas_);
}

void Painter::DrawReferences() {
    const double dashes[2] = {7, 5};
    Use(kFaded);
    cairo_set_line_width(canvas_, 1.3);
    cairo_set_dash(canvas_, dashes, 2, 0);
    if (chart_.level && y_.Shows(*chart_.level)) {
        const double y = y_.At(*chart_.level);
        Line(kLeft, y, kRight, y);
        Text(kRight - 6, y + kText + 3, 1, chart_.levelLabel); // nothing is under a floor
        const double width = TextWidth(chart_.levelLabel);
        taken_.push_back({kRight - 8 - width, y, kRight, y + kText + 8});
        taken_.push_back({kLeft, y - 1, kRight, y + 1});
    }
    if (chart_.slopeOne && Shows(*chart_.slopeOne)) {
        const double slope = chart_.slopeOne->y / chart_.slopeOne->x;
        Line(x_.At(x_.Low()), y_.At(slope * x_.Low()), x_.At(x_.High()), y_.At(slope * x_.High()));
        // Its label, where the line leaves the frame.
        const double endX = std::min(x_.High(), y_.High() / slope);
        const double x = std::min(x_.At(endX) - 14, kRight - 14), y = std::max(y_.At(endX * slope) + 18, kTop + 18);
        Text(x - 10, y, 1, chart_.slopeOne->label);
        taken_.push_back({x - 14 - TextWidth(chart_.slopeOne->label), y - 14, x, y + 4});
    }
    cairo_set_dash(canvas_, nullptr, 0, 0);
}

void Painter::DrawKey() {
    double x = kRight;
    for (std::size_t s = chart_.series.size(); s-- > 0;) {
        const std::string &name = chart_.series[s].name;
        if (name.empty())
            continue;
        Use(kSeriesColors[s % kSeriesColors.size()]);
        Text(x, 58, 1, name);
        x -= TextWidth(name) + 12;
        Dot(x, 58 - kText * 0.35);
        x -= 24;
    }
}

void Painter::DrawSeries() {
    for (std::size_t s = 0; s < chart_.series.size(); ++s) {
        const ChartSeries &series = chart_.series[s];
        Use(kSeriesColors[s % kSeriesColors.size()]);
        cairo_set_line_width(canvas_, 1.6);
        cairo_new_path(canvas_);
        for (const ChartPoint &point : series.points)
            if (series.joined && Shows(point))
                cairo_line_to(canvas_, x_.At(point.x), y_.At(point.y));
        cairo_stroke(canvas_);
        for (const ChartPoint &point : series.points) {
            if (!Shows(point))
                continue;
            const double x = x_.At(point.x), y = y_.At(point.y);
            Dot(x, y);
            taken_.push_back({x - kDot, y - kDot, x + kDot, y + kDot});
        }
    }
}

/// Places beside, above and below the dot, on rings that grow.
Box Painter::LabelBox(double x, double y, double width, int place) const {
    const int ring = place / 6, side = place % 6;
    const double dx = kDot + 5, dy = 17.0 * ring;
    const double left = side < 2 ? x + dx : side < 4 ? x - dx - width : x - width / 2;
    const double sign = side % 2 == 0 ? -1 : 1;
    const double middle = side < 4 ? y + sign * dy : y + sign * (dy + 16);
    return {left - 2, middle - 8, left + width + 2, middle + 8};
}

void Painter::DrawLabels() {
    constexpr int kPlaces = 6 * 16;
    for (std::size_t s = 0; s < chart_.series.size(); ++s)
        for (const ChartPoint &point : chart_.series[s].points) {
            if (!Shows(point) || point.label.empty())
                continue;
            const double x = x_.At(point.x), y = y_.At(point.y), width = TextWidth(point.label);
            Box box = LabelBox(x, y, width, 0);
            for (int place = 0; place < kPlaces; ++place) {
                const Box tried = LabelBox(x, y, width, place);
                const bool inside = tried.x0 > kLeft && tried.x1 < kRight && tried.y0 > kTop && tried.y1 < kBottom;
                if (inside &&
                    std::none_of(taken_.begin(), taken_.end(), [&](const Box &b) { return b.Meets(tried); })) {
                    box = tried;
                    break;
                }
            }
            taken_.push_back(box);
            const double middle = (box.y0 + box.y1) / 2;
            if (std::abs(middle - y) > 20) { // a thin line tells which dot it belongs to
                Use(kFaded);
                cairo_set_line_width(canvas_, 0.7);
                Line(x, y, std::clamp(x, box.x0, box.x1), middle > y ? box.y0 : box.y1);
            }
            Use(kInk);
            Text(box.x0 + 2, middle + kText * 0.35, 0, point.label);
        }
}

void Check(cairo_status_t status, const std::filesystem::path &path) {
    if (status != CAIRO_STATUS_SUCCESS)
        throw Error("{}: {}", path.string(), cairo_status_to_string(status));
}

using SurfacePtr = std::unique_ptr<cairo_surface_t, void (*)(cairo_surface_t *)>;
using CanvasPtr = std::unique_ptr<cairo_t, void (*)(cairo_t *)>;

void Paint(const Chart &chart, cairo_surface_t *surface, double scale, const std::filesystem::path &path) {
    const CanvasPtr canvas(cairo_create(surface), cairo_destroy);
    cairo_scale(canvas.get(), scale, scale);
    Painter(chart, canvas.get()).Draw();
    Check(cairo_status(canvas.get()), path);
}

} // namespace

void WriteChart(const Chart &chart, const std::filesystem::path &base) {
    const std::filesystem::path svg = base.string() + ".svg", png = base.string() + ".png";
    const SurfacePtr vector(cairo_svg_surface_create(svg.c_str(), kWidth, kHeight), cairo_surface_destroy);
    Check(cairo_surface_status(vector.get()), svg);
    Paint(chart, vector.get(), 1, svg);
    cairo_surface_finish(vector.get());
    Check(cairo_surface_status(vector.get()), svg);
    const SurfacePtr pixels(
        cairo_image_surface_create(CAIRO_FORMAT_RGB24, int(kWidth) * kPngScale, int(kHeight) * kPngScale),
        cairo_surface_destroy);
    Paint(chart, pixels.get(), kPngScale, png);
    Check(cairo_surface_write_to_png(pixels.get(), png.c_str()), png);
}

} // namespace q3::bench
