// GPL-2.0-or-later. Lines, dots and text as SVG and PNG.
#include "tools/measure/shbench/drawing.h"

#include "common/error.h"
#include "common/text/text.h"

#include <cairo-svg.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>

namespace q3::bench {

namespace {

void Check(cairo_status_t status, const std::filesystem::path &path) {
    if (status != CAIRO_STATUS_SUCCESS)
        throw Error("{}: {}", path.string(), cairo_status_to_string(status));
}

using SurfacePtr = std::unique_ptr<cairo_surface_t, void (*)(cairo_surface_t *)>;
using CanvasPtr = std::unique_ptr<cairo_t, void (*)(cairo_t *)>;

bool HasExtension(const std::filesystem::path &file, std::string_view extension) {
    return EqualNoCase(file.extension().string(), extension);
}

/// Candidates for the place of a label: right, left and middle, each above and below the dot, in rings.
constexpr int kSides = 6, kRings = 16;

/// Box of candidate number `place` for a label of that width. Picture units.
Box LabelBox(double x, double y, double radius, double width, int place) {
    constexpr double kGap = 5, kAbove = 11;      // from the dot to labels beside it, and to the middle of those above
    constexpr double kRingStep = 17;             // vertical, from ring to ring
    constexpr double kMargin = 2, kHalfText = 8; // left and right of the text; half the height of the box
    const int ring = place / kSides, side = place % kSides;
    const double dx = radius + kGap, dy = kRingStep * ring;
    const double left = side < 2 ? x + dx : side < 4 ? x - dx - width : x - width / 2;
    const double sign = side % 2 == 0 ? -1 : 1;
    const double middle = side < 4 ? y + sign * dy : y + sign * (dy + radius + kAbove);
    return {left - kMargin, middle - kHalfText, left + width + kMargin, middle + kHalfText};
}

} // namespace

Drawing::Drawing(cairo_t *canvas) : canvas_(canvas) {
    Use({1, 1, 1});
    cairo_paint(canvas_);
    cairo_select_font_face(canvas_, "sans-serif", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
}

void Drawing::Use(const Color &color) {
    cairo_set_source_rgba(canvas_, color.r, color.g, color.b, color.a);
}

double Drawing::TextWidth(const std::string &text, double size) {
    cairo_set_font_size(canvas_, size);
    cairo_text_extents_t extents;
    cairo_text_extents(canvas_, text.c_str(), &extents);
    return extents.x_advance;
}

std::string Drawing::Fitting(std::string text, double width, double size) {
    if (TextWidth(text, size) <= width)
        return text;
    const auto isContinuation = [](char byte) { return (byte & 0xC0) == 0x80; };
    while (!text.empty() && TextWidth(text + "...", size) > width) {
        while (text.size() > 1 && isContinuation(text.back()))
            text.pop_back();
        text.pop_back();
    }
    return text + "...";
}

void Drawing::Text(double x, double y, double align, const std::string &text, double size) {
    cairo_move_to(canvas_, x - align * TextWidth(text, size), y);
    cairo_show_text(canvas_, text.c_str());
    cairo_new_path(canvas_); // text leaves a current point behind, which an arc would join
}

void Drawing::Line(double x0, double y0, double x1, double y1) {
    cairo_move_to(canvas_, x0, y0);
    cairo_line_to(canvas_, x1, y1);
    cairo_stroke(canvas_);
}

void Drawing::Dot(double x, double y, double radius) {
    cairo_arc(canvas_, x, y, radius, 0, 2 * std::numbers::pi);
    cairo_fill(canvas_);
}

void Drawing::Ring(double x, double y, double radius) {
    cairo_arc(canvas_, x, y, radius, 0, 2 * std::numbers::pi);
    cairo_stroke(canvas_);
}

void Drawing::Fill(const Box &box) {
    cairo_rectangle(canvas_, box.x0, box.y0, box.x1 - box.x0, box.y1 - box.y0);
    cairo_fill(canvas_);
}

Box LabelPlaces::Place(double x, double y, double radius, double width) {
    Box box = LabelBox(x, y, radius, width, 0);
    for (int place = 0; place < kSides * kRings; ++place) {
        const Box tried = LabelBox(x, y, radius, width, place);
        if (tried.Within(frame_) &&
            std::none_of(taken_.begin(), taken_.end(), [&](const Box &b) { return b.Meets(tried); })) {
            box = tried;
            break;
        }
    }
    Take(box);
    return box;
}

bool IsPictureName(const std::filesystem::path &file) {
    return HasExtension(file, ".svg") || HasExtension(file, ".png");
}

void WriteDrawing(double width, double height, const std::filesystem::path &file,
                  const std::function<void(Drawing &)> &draw) {
    if (!IsPictureName(file))
        throw Error("{}: expected a name that ends in .png or .svg", file.string());
    const bool svg = HasExtension(file, ".svg");
    const int scale = svg ? 1 : kPngScale;
    const SurfacePtr surface(svg ? cairo_svg_surface_create(file.c_str(), width, height)
                                 : cairo_image_surface_create(CAIRO_FORMAT_RGB24, int(std::ceil(width * scale)),
                                                              int(std::ceil(height * scale))),
                             cairo_surface_destroy);
    Check(cairo_surface_status(surface.get()), file);
    const CanvasPtr canvas(cairo_create(surface.get()), cairo_destroy);
    cairo_scale(canvas.get(), scale, scale);
    Drawing drawing(canvas.get());
    draw(drawing);
    Check(cairo_status(canvas.get()), file);
    if (!svg)
        Check(cairo_surface_write_to_png(surface.get(), file.c_str()), file);
    cairo_surface_finish(surface.get());
    Check(cairo_surface_status(surface.get()), file);
}

} // namespace q3::bench
