// GPL-2.0-or-later. The picture of a grid's errors.
#include "tools/measure/shbench/drawing.h"
#include "tools/measure/shbench/error_top_view.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numeric>
#include <set>
#include <utility>

namespace q3::bench {

namespace {

/// Picture units.
constexpr double kViewWidth = 1000, kSideLeft = 662, kSideRight = 976, kBottomMargin = 50;
constexpr double kRing = 8, kMinDot = 1.6, kMaxDot = 4.2, kCross = 3;
constexpr double kCrossRaster = 8; ///< one cross stands for all lights in a square of it
constexpr double kLineHeight = 19; ///< of text
constexpr double kTextLeft = 24;   ///< left end of title and subtitle
constexpr double kSmall = 12;      ///< text in lists
constexpr std::size_t kMaxListed = 24;
constexpr float kLevelHeight = 96; ///< positions farther off the view's height get dashed rings; game units
constexpr Color kSolid{0.74, 0.76, 0.79}, kElsewhere{0.90, 0.91, 0.92}, kOpen{1, 1, 1}, kStepLine{0.68, 0.70, 0.74},
    kLight{0.05, 0.35, 0.85};
constexpr std::array<Color, 4> kGroundColors = {kSolid, kElsewhere, kOpen, kStepLine}; ///< by TopViewGround
/// Colors of errors from none to full scale, with equal steps between.
constexpr std::array<Vec3f, 4> kErrorRamp = {
    {{0.86f, 0.85f, 0.76f}, {0.99f, 0.71f, 0.29f}, {0.84f, 0.19f, 0.15f}, {0.30f, 0.00f, 0.24f}}};

/// Color of that share of the error at full scale.
Color ColorOf(double share) {
    const Vec3f rgb = ErrorColor(share);
    return {double(rgb.x), double(rgb.y), double(rgb.z)};
}

class TopViewPainter {
  public:
    TopViewPainter(const ErrorTopView &view, Drawing &drawing)
        : view_(view), frame_(FrameOf(view.area)), drawing_(drawing), canvas_(drawing.Canvas()) {}

    /// Height of the picture.
    static double Height(const ErrorTopView &view);

    void Draw() {
        drawing_.Use(kInk);
        drawing_.Text(kTextLeft, 36, 0, view_.title, 20);
        drawing_.Use(kFaded);
        drawing_.Text(kTextLeft, 60, 0, drawing_.Fitting(view_.subtitle, kViewWidth - 2 * kTextLeft));
        drawing_.Text(kTextLeft, 80, 0,
                      "L2 truncation limit: error of the exact L2 projection, the best that can be stored; grid error: "
                      "difference from it");
        cairo_save(canvas_);
        cairo_rectangle(canvas_, frame_.x, frame_.y, frame_.width, frame_.height);
        cairo_clip(canvas_);
        DrawGround();
        DrawDots();
        DrawLights();
        DrawRings();
        cairo_restore(canvas_);
        DrawFrame();
        double y = DrawScale(frame_.y);
        y = DrawKey(y + 14);
        y = DrawList(y + 14);
        DrawShares(y + 14);
    }

  private:
    enum class Level { Same, Other }; ///< whether a position is at the height of the view

    double X(const Vec3f &p) const { return frame_.x + double(p.x - view_.area.mins.x) * frame_.scale; }
    double Y(const Vec3f &p) const { return frame_.y + double(view_.area.maxs.y - p.y) * frame_.scale; }
    Level LevelOf(const Vec3f &p) const {
        return std::abs(p.z - view_.height) > kLevelHeight ? Level::Other : Level::Same;
    }
    std::size_t Listed() const { return std::min(view_.rings.size(), kMaxListed); }
    void DrawGround();
    void DrawDots();
    void DrawLights();
    void DrawCross(double x, double y);
    void DrawRing(double x, double y, Level level);
    void DrawRings();
    void DrawFrame();
    double DrawScale(double y);
    double DrawKey(double y);
    double DrawList(double y);
    void DrawShares(double y);

    const ErrorTopView &view_;
    TopViewFrame frame_;
    Drawing &drawing_;
    cairo_t *canvas_;
};

double TopViewPainter::Height(const ErrorTopView &view) {
    const std::size_t listed = std::min(view.rings.size(), kMaxListed);
    constexpr double kKeyLines = 10;                      // of the key and of the headings of both lists
    constexpr double kScaleHeight = 90, kSideMargin = 24; // the color scale above the lines, and space below them
    const bool cutShort = view.rings.size() > listed;     // "and N more" takes a line
    const double lines = double(listed + (cutShort ? 1 : 0)) + double(kCauses) + kKeyLines;
    const TopViewFrame frame = FrameOf(view.area);
    const double viewEnd = frame.y + frame.height + kBottomMargin;
    return std::ceil(std::max(viewEnd, frame.y + kScaleHeight + lines * kLineHeight + kSideMargin));
}

void TopViewPainter::DrawGround() {
    const std::unique_ptr<cairo_surface_t, void (*)(cairo_surface_t *)> image(
        cairo_image_surface_create(CAIRO_FORMAT_RGB24, view_.columns, view_.rows), cairo_surface_destroy);
    unsigned char *pixels = cairo_image_surface_get_data(image.get());
    if (!pixels) // the canvas takes over the error status of the image
        return cairo_set_source_surface(canvas_, image.get(), 0, 0);
    const auto stride = std::size_t(cairo_image_surface_get_stride(image.get()));
    const auto byte = [](double value) { return std::uint32_t(std::lround(255 * value)); };
    for (int row = 0; row < view_.rows; ++row) {
        auto *line = reinterpret_cast<std::uint32_t *>(pixels + std::size_t(row) * stride);
        for (int column = 0; column < view_.columns; ++column) {
            const std::size_t at = std::size_t(row) * std::size_t(view_.columns) + std::size_t(column);
            const Color &color = kGroundColors[std::size_t(view_.ground[at])];
            line[column] = byte(color.r) << 16 | byte(color.g) << 8 | byte(color.b);
        }
    }
    cairo_surface_mark_dirty(image.get());
    cairo_save(canvas_);
    cairo_translate(canvas_, frame_.x, frame_.y);
    cairo_scale(canvas_, frame_.width / view_.columns, frame_.height / view_.rows);
    cairo_set_source_surface(canvas_, image.get(), 0, 0);
    cairo_pattern_set_filter(cairo_get_source(canvas_), CAIRO_FILTER_NEAREST);
    cairo_paint(canvas_);
    cairo_restore(canvas_);
}

void TopViewPainter::DrawDots() {
    std::vector<std::size_t> order(view_.dots.size());
    std::iota(order.begin(), order.end(), std::size_t(0));
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return view_.dots[a].error < view_.dots[b].error; });
    for (const std::size_t i : order) {
        const TopViewDot &dot = view_.dots[i];
        const double share = std::min(1.0, dot.error / view_.fullScaleError);
        drawing_.Use(ColorOf(share));
        drawing_.Dot(X(dot.position), Y(dot.position), kMinDot + share * (kMaxDot - kMinDot));
    }
}

void TopViewPainter::DrawCross(double x, double y) {
    for (const auto &[color, width] : {std::pair(Color{1, 1, 1, 0.8}, 3.2), std::pair(kLight, 1.3)}) {
        drawing_.Use(color);
        cairo_set_line_width(canvas_, width);
        drawing_.Line(x - kCross, y - kCross, x + kCross, y + kCross);
        drawing_.Line(x - kCross, y + kCross, x + kCross, y - kCross);
    }
}

void TopViewPainter::DrawLights() {
    std::set<std::pair<int, int>> taken;
    for (const Vec3f &light : view_.lights) {
        const double x = X(light), y = Y(light);
        if (taken.insert({int(std::floor(x / kCrossRaster)), int(std::floor(y / kCrossRaster))}).second)
            DrawCross(x, y);
    }
}

void TopViewPainter::DrawRing(double x, double y, Level level) {
    const double dashes[2] = {3, 2.5};
    drawing_.Use({1, 1, 1, 0.85});
    cairo_set_line_width(canvas_, 4);
    drawing_.Ring(x, y, kRing);
    drawing_.Use(kInk);
    cairo_set_line_width(canvas_, 1.6);
    cairo_set_dash(canvas_, dashes, level == Level::Other ? 2 : 0, 0);
    drawing_.Ring(x, y, kRing);
    cairo_set_dash(canvas_, nullptr, 0, 0);
}

void TopViewPainter::DrawRings() {
    LabelPlaces labels({frame_.x, frame_.y, frame_.x + frame_.width, frame_.y + frame_.height});
    for (const ErrorTopView::Ring &ring : view_.rings) {
        const Vec3f &p = view_.dots[ring.dot].position;
        labels.Take({X(p) - kRing, Y(p) - kRing, X(p) + kRing, Y(p) + kRing});
    }
    for (std::size_t i = view_.rings.size(); i-- > 0;) { // the worst on top
        const Vec3f &p = view_.dots[view_.rings[i].dot].position;
        DrawRing(X(p), Y(p), LevelOf(p));
    }
    for (std::size_t i = 0; i < view_.rings.size(); ++i) {
        const Vec3f &p = view_.dots[view_.rings[i].dot].position;
        const std::string number = std::to_string(i + 1);
        const Box box = labels.Place(X(p), Y(p), kRing, drawing_.TextWidth(number));
        const double middle = (box.y0 + box.y1) / 2;
        if (std::abs(middle - Y(p)) > kRing + 14) { // a leader line to its ring
            drawing_.Use(kInk);
            cairo_set_line_width(canvas_, 0.8);
            const double side = middle > Y(p) ? 1 : -1;
            drawing_.Line(X(p), Y(p) + side * kRing, (box.x0 + box.x1) / 2, side > 0 ? box.y0 : box.y1);
        }
        drawing_.Use({1, 1, 1, 0.85});
        drawing_.Fill({box.x0, box.y0 + 1, box.x1, box.y1 - 1});
        drawing_.Use(kInk);
        drawing_.Text(box.x0 + 2, middle + Drawing::kText * 0.36, 0, number);
    }
}

void TopViewPainter::DrawFrame() {
    drawing_.Use(kFaded);
    cairo_set_line_width(canvas_, 1);
    cairo_rectangle(canvas_, frame_.x, frame_.y, frame_.width, frame_.height);
    cairo_stroke(canvas_);
    // The scale bar: a power of two game units.
    constexpr double kLeastLength = 16, kMaxBar = 150; // game units; picture units
    double length = kLeastLength;
    while (length * 2 * frame_.scale < kMaxBar)
        length *= 2;
    const double y = frame_.y + frame_.height + 26, x1 = frame_.x + length * frame_.scale;
    drawing_.Use(kInk);
    cairo_set_line_width(canvas_, 1.6);
    drawing_.Line(frame_.x, y, x1, y);
    drawing_.Line(frame_.x, y - 5, frame_.x, y + 5);
    drawing_.Line(x1, y - 5, x1, y + 5);
    drawing_.Text(x1 + 10, y + 4.5, 0, fmt::format("{:.0f} units; seen from above, +x right, +y up", length));
}

double TopViewPainter::DrawScale(double y) {
    drawing_.Use(kInk);
    drawing_.Text(kSideLeft, y + 11, 0, view_.errorName);
    const int steps = 100;
    const double width = kSideRight - kSideLeft, top = y + 22, bottom = top + 14;
    for (int i = 0; i < steps; ++i) {
        drawing_.Use(ColorOf((i + 0.5) / steps));
        drawing_.Fill({kSideLeft + width * i / steps, top,
                       kSideLeft + width * (i + 1) / steps + (i + 1 < steps ? 0.5 : 0), bottom});
    }
    drawing_.Use(kFaded);
    drawing_.Text(kSideLeft, bottom + 17, 0, "0");
    drawing_.Text((kSideLeft + kSideRight) / 2, bottom + 17, 0.5, fmt::format("{:g}", view_.fullScaleError / 2));
    drawing_.Text(kSideRight, bottom + 17, 1, fmt::format("{:g} and more", view_.fullScaleError));
    return bottom + 20;
}

double TopViewPainter::DrawKey(double y) {
    const double symbol = kSideLeft + kRing, text = kSideLeft + 30;
    const auto line = [&](const std::string &words) {
        drawing_.Use(kInk);
        drawing_.Text(text, y + 4.5, 0, words, kSmall);
        y += kLineHeight;
    };
    y += kLineHeight / 2;
    const auto swatch = [&](const Color &color, const std::string &words) {
        const Box box{symbol - 8, y - 6, symbol + 8, y + 6};
        drawing_.Use(color);
        drawing_.Fill(box);
        drawing_.Use(kFaded);
        cairo_set_line_width(canvas_, 0.8);
        cairo_rectangle(canvas_, box.x0, box.y0, box.x1 - box.x0, box.y1 - box.y0);
        cairo_stroke(canvas_);
        line(words);
    };
    swatch(kOpen, fmt::format("open space at z = {:.0f}", double(view_.height)));
    swatch(kElsewhere, "open at other heights only");
    swatch(kSolid, "solid or outside the map");
    drawing_.Use(kStepLine);
    cairo_set_line_width(canvas_, 1.2);
    drawing_.Line(symbol - 8, y, symbol + 8, y);
    line("edges and steps below, over 20 units");
    DrawCross(symbol, y);
    std::string lights = fmt::format("{} {}", view_.lights.size(), view_.lights.size() == 1 ? "light" : "lights");
    if (view_.suns > 0)
        lights += fmt::format("; {} {} not drawn", view_.suns, view_.suns == 1 ? "sun is" : "suns are");
    line(lights);
    DrawRing(symbol, y, Level::Same);
    line("worst positions, numbered as below");
    DrawRing(symbol, y, Level::Other);
    line(fmt::format("the same, over {:.0f} units off the plan", double(kLevelHeight)));
    return y - kLineHeight / 2;
}

double TopViewPainter::DrawList(double y) {
    const std::array<double, 4> at = {kSideLeft + 22, kSideLeft + 72, kSideLeft + 122, kSideLeft + 138};
    const auto row = [&](const std::array<std::string, 4> &cells) {
        for (std::size_t i = 0; i < cells.size(); ++i)
            drawing_.Text(at[i], y, i + 1 < cells.size() ? 1 : 0, cells[i], kSmall);
        y += kLineHeight;
    };
    y += 11;
    drawing_.Use(kFaded);
    row({"no.", "error", "z", "cause"});
    drawing_.Use(kInk);
    for (std::size_t i = 0; i < Listed(); ++i) {
        const TopViewDot &dot = view_.dots[view_.rings[i].dot];
        row({std::to_string(i + 1), fmt::format("{:.1f}", dot.error), fmt::format("{:.0f}", double(dot.position.z)),
             std::string(NameOf(view_.rings[i].cause))});
    }
    if (Listed() < view_.rings.size())
        row({"", "", "", fmt::format("and {} more", view_.rings.size() - Listed())});
    return y - 11;
}

void TopViewPainter::DrawShares(double y) {
    drawing_.Use(kFaded);
    drawing_.Text(kSideLeft, y + 11, 0, "fraction of the squared grid error, all positions", kSmall);
    y += 11 + kLineHeight;
    const double bar = kSideLeft + 186, percent = kSideRight;
    for (std::size_t i = 0; i < kCauses; ++i) {
        const double share = view_.shares[i].error;
        drawing_.Use(kInk);
        drawing_.Text(kSideLeft, y, 0, std::string(NameOf(Cause(i))), kSmall);
        drawing_.Text(percent, y, 1, fmt::format("{:.0f} %", 100 * share), kSmall);
        drawing_.Use({0.35, 0.42, 0.52});
        drawing_.Fill({bar, y - 9, bar + share * (percent - 42 - bar), y});
        y += kLineHeight;
    }
}

} // namespace

Vec3f ErrorColor(double share) {
    const double at = std::clamp(share, 0.0, 1.0) * double(kErrorRamp.size() - 1);
    const std::size_t low = std::min(std::size_t(at), kErrorRamp.size() - 2);
    const float part = float(at - double(low));
    return kErrorRamp[low] * (1 - part) + kErrorRamp[low + 1] * part;
}

void WriteErrorTopView(const ErrorTopView &view, const std::filesystem::path &file) {
    WriteDrawing(kViewWidth, TopViewPainter::Height(view), file,
                 [&](Drawing &drawing) { TopViewPainter(view, drawing).Draw(); });
}

} // namespace q3::bench
