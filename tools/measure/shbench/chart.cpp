// GPL-2.0-or-later. Charts as SVG and PNG: one drawing for both.
#include "tools/measure/shbench/chart.h"

#include "tools/measure/shbench/chart_scale.h"
#include "tools/measure/shbench/drawing.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace q3::bench {

namespace {

/// Picture units: pixels of the PNG at scale 1.
constexpr double kWidth = 960, kHeight = 600;
constexpr double kLeft = 84, kRight = 930, kTop = 84, kBottom = 530;
constexpr double kDot = 5, kText = Drawing::kText; // radius; height
constexpr double kTitleY = 34, kSubtitleY = 58;    // base lines
constexpr double kMiddleToBaseline = kText * 0.35; // from the middle of a line of text down to its base line

constexpr Color kGridLine{0.90, 0.91, 0.93};
constexpr std::array<Color, 5> kSeriesColors = {
    {{0.12, 0.40, 0.68}, {0.80, 0.38, 0.10}, {0.16, 0.52, 0.33}, {0.52, 0.28, 0.60}, {0.45, 0.45, 0.45}}};

/// Draws a chart; labels keep clear of each other, of dots and of the frame.
class Painter {
  public:
    Painter(const Chart &chart, Drawing &drawing)
        : chart_(chart), drawing_(drawing), canvas_(drawing.Canvas()), x_(XValues(), chart.x.scale, kLeft, kRight),
          y_(YValues(), chart.y.scale, kBottom, kTop) {}

    void Draw() {
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
    std::vector<double> Coordinates(double ChartPoint::*axis) const {
        std::vector<double> values;
        for (const ChartSeries &series : chart_.series)
            for (const ChartPoint &point : series.points)
                values.push_back(point.*axis);
        return values;
    }
    std::vector<double> XValues() const { return Coordinates(&ChartPoint::x); }
    std::vector<double> YValues() const {
        std::vector<double> values = Coordinates(&ChartPoint::y);
        if (chart_.level)
            values.push_back(*chart_.level);
        return values;
    }
    bool Shows(const ChartPoint &point) const { return x_.Shows(point.x) && y_.Shows(point.y); }

    void DrawAxes();
    void DrawTitles();
    void DrawReferences();
    void DrawKey();
    void DrawSeries();
    const Color &ColorOf(std::size_t series) const {
        const int color = chart_.series[series].color;
        return kSeriesColors[(color >= 0 ? std::size_t(color) : series) % kSeriesColors.size()];
    }
    void KeepLabelsOffLines(const ChartSeries &series);
    void DrawLabels();

    const Chart &chart_;
    Drawing &drawing_;
    cairo_t *canvas_;
    ChartScale x_, y_;
    LabelPlaces labels_{{kLeft, kTop, kRight, kBottom}};
};

void Painter::DrawAxes() {
    cairo_set_line_width(canvas_, 1);
    for (const auto &tick : x_.Ticks()) {
        drawing_.Use(kGridLine);
        drawing_.Line(x_.At(tick.value), kTop, x_.At(tick.value), kBottom);
        drawing_.Use(kFaded);
        drawing_.Text(x_.At(tick.value), kBottom + 20, 0.5, tick.label);
    }
    for (const auto &tick : y_.Ticks()) {
        drawing_.Use(kGridLine);
        drawing_.Line(kLeft, y_.At(tick.value), kRight, y_.At(tick.value));
        drawing_.Use(kFaded);
        drawing_.Text(kLeft - 10, y_.At(tick.value) + kMiddleToBaseline, 1, tick.label);
    }
    drawing_.Use(kFaded);
    drawing_.Line(kLeft, kBottom, kRight, kBottom);
    drawing_.Line(kLeft, kTop, kLeft, kBottom);
}

void Painter::DrawTitles() {
    drawing_.Use(kInk);
    drawing_.Text(kLeft, kTitleY, 0, chart_.title, 19);
    drawing_.Use(kFaded);
    drawing_.Text(kLeft, kSubtitleY, 0, chart_.subtitle);
    drawing_.Use(kInk);
    drawing_.Text((kLeft + kRight) / 2, kHeight - 24, 0.5, chart_.x.title, 14);
    cairo_save(canvas_);
    cairo_translate(canvas_, 26, (kTop + kBottom) / 2);
    cairo_rotate(canvas_, -std::numbers::pi / 2);
    drawing_.Text(0, 0, 0.5, chart_.y.title, 14);
    cairo_restore(canvas_);
}

void Painter::DrawReferences() {
    const double dashes[2] = {7, 5};
    drawing_.Use(kFaded);
    cairo_set_line_width(canvas_, 1.3);
    cairo_set_dash(canvas_, dashes, 2, 0);
    if (chart_.level && y_.Shows(*chart_.level)) {
        const double y = y_.At(*chart_.level);
        drawing_.Line(kLeft, y, kRight, y);
        drawing_.Text(kRight - 6, y + kText + 3, 1,
                      chart_.levelLabel); // below it, where no dots are if it is the least value that there can be
        const double width = drawing_.TextWidth(chart_.levelLabel);
        labels_.Take({kRight - 8 - width, y, kRight, y + kText + 8});
        labels_.Take({kLeft, y - 1, kRight, y + 1});
    }
    if (chart_.slopeOne && Shows(*chart_.slopeOne)) {
        const double slope = chart_.slopeOne->y / chart_.slopeOne->x;
        drawing_.Line(x_.At(x_.Low()), y_.At(slope * x_.Low()), x_.At(x_.High()), y_.At(slope * x_.High()));
        // Its label, where the line leaves the frame.
        const double endX = std::min(x_.High(), y_.High() / slope);
        const double x = std::min(x_.At(endX) - 14, kRight - 14), y = std::max(y_.At(endX * slope) + 18, kTop + 18);
        drawing_.Text(x - 10, y, 1, chart_.slopeOne->label);
        labels_.Take({x - 14 - drawing_.TextWidth(chart_.slopeOne->label), y - 14, x, y + 4});
    }
    cairo_set_dash(canvas_, nullptr, 0, 0);
}

void Painter::DrawKey() {
    double x = kRight;
    for (std::size_t s = chart_.series.size(); s-- > 0;) {
        const std::string &name = chart_.series[s].name;
        if (name.empty())
            continue;
        drawing_.Use(ColorOf(s));
        drawing_.Text(x, kSubtitleY, 1, name);
        x -= drawing_.TextWidth(name) + 12;
        drawing_.Dot(x, kSubtitleY - kMiddleToBaseline, kDot);
        x -= 24;
    }
}

void Painter::DrawSeries() {
    for (std::size_t s = 0; s < chart_.series.size(); ++s) {
        const ChartSeries &series = chart_.series[s];
        drawing_.Use(ColorOf(s));
        cairo_set_line_width(canvas_, 1.6);
        cairo_new_path(canvas_);
        for (const ChartPoint &point : series.points)
            if (series.joined && Shows(point))
                cairo_line_to(canvas_, x_.At(point.x), y_.At(point.y));
        cairo_stroke(canvas_);
        if (series.joined)
            KeepLabelsOffLines(series);
        for (const ChartPoint &point : series.points) {
            if (!Shows(point))
                continue;
            const double x = x_.At(point.x), y = y_.At(point.y);
            drawing_.Dot(x, y, kDot);
            labels_.Take({x - kDot, y - kDot, x + kDot, y + kDot});
        }
    }
}

/// Takes small boxes along the lines between the points, so that no label covers these.
void Painter::KeepLabelsOffLines(const ChartSeries &series) {
    constexpr double kStep = 6, kHalf = 1.5; // from box to box; half the side of a box
    for (std::size_t i = 1; i < series.points.size(); ++i) {
        const ChartPoint &from = series.points[i - 1], &to = series.points[i];
        if (!Shows(from) || !Shows(to))
            continue;
        const double x0 = x_.At(from.x), y0 = y_.At(from.y), dx = x_.At(to.x) - x0, dy = y_.At(to.y) - y0;
        const int steps = int(std::hypot(dx, dy) / kStep) + 1;
        for (int step = 0; step <= steps; ++step) {
            const double x = x0 + dx * step / steps, y = y0 + dy * step / steps;
            labels_.Take({x - kHalf, y - kHalf, x + kHalf, y + kHalf});
        }
    }
}

void Painter::DrawLabels() {
    for (std::size_t s = 0; s < chart_.series.size(); ++s)
        for (const ChartPoint &point : chart_.series[s].points) {
            if (!Shows(point) || point.label.empty())
                continue;
            const double x = x_.At(point.x), y = y_.At(point.y);
            const Box box = labels_.Place(x, y, kDot, drawing_.TextWidth(point.label));
            const double middle = (box.y0 + box.y1) / 2;
            constexpr double kLeaderFrom = 20; // labels farther above or below get a leader line to their dot
            if (std::abs(middle - y) > kLeaderFrom) {
                drawing_.Use(kFaded);
                cairo_set_line_width(canvas_, 0.7);
                drawing_.Line(x, y, std::clamp(x, box.x0, box.x1), middle > y ? box.y0 : box.y1);
            }
            drawing_.Use(kInk);
            drawing_.Text(box.x0 + 2, middle + kMiddleToBaseline, 0, point.label);
        }
}

} // namespace

void WriteChart(const Chart &chart, const std::filesystem::path &base) {
    for (const char *extension : {".svg", ".png"})
        WriteDrawing(kWidth, kHeight, base.string() + extension,
                     [&](Drawing &drawing) { Painter(chart, drawing).Draw(); });
}

} // namespace q3::bench
