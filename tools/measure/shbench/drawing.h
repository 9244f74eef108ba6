// GPL-2.0-or-later. Lines, dots and text as SVG and PNG, and places for labels.
#pragma once

#include <cairo.h>

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace q3::bench {

/// Display values in 0..1.
struct Color {
    double r = 0, g = 0, b = 0, a = 1;
};
inline constexpr Color kInk{0.13, 0.15, 0.18}, kFaded{0.42, 0.45, 0.50};

/// Rectangle in picture units, y down.
struct Box {
    double x0 = 0, y0 = 0, x1 = 0, y1 = 0;
    bool Meets(const Box &o) const { return x0 < o.x1 && o.x0 < x1 && y0 < o.y1 && o.y0 < y1; }
    bool Within(const Box &o) const { return x0 > o.x0 && x1 < o.x1 && y0 > o.y0 && y1 < o.y1; }
};

/// A white sheet to draw on, in picture units. Does not own the canvas.
class Drawing {
  public:
    static constexpr double kText = 13; ///< usual height of text

    explicit Drawing(cairo_t *canvas);

    cairo_t *Canvas() { return canvas_; }
    void Use(const Color &color);
    double TextWidth(const std::string &text, double size = kText);
    /// The text or, if that is wider, as many of its characters (UTF-8) as fit into the width with "..." after them.
    std::string Fitting(std::string text, double width, double size = kText);
    /// align 0: x is the left end, 0.5: the middle, 1: the right end. y: base line.
    void Text(double x, double y, double align, const std::string &text, double size = kText);
    void Line(double x0, double y0, double x1, double y1);
    void Dot(double x, double y, double radius);
    void Ring(double x, double y, double radius);
    void Fill(const Box &box);

  private:
    cairo_t *canvas_;
};

/// Picks places for labels beside their dots, where they overlap neither each other nor boxes that are taken.
class LabelPlaces {
  public:
    explicit LabelPlaces(const Box &frame) : frame_(frame) {}
    void Take(const Box &box) { taken_.push_back(box); }
    /// Finds the nearest free box for a label of a dot at (x, y), and takes it. If none is free, the one beside the
    /// dot.
    Box Place(double x, double y, double radius, double width);

  private:
    Box frame_;
    std::vector<Box> taken_;
};

/// Pixels per picture unit in a PNG.
inline constexpr int kPngScale = 2;

/// Whether WriteDrawing knows the extension: .svg or .png.
bool IsPictureName(const std::filesystem::path &file);

/// Writes what `draw` draws, of that size in picture units, as .svg or .png by the name of the file. Errors: another
/// extension, a file that cannot be written.
void WriteDrawing(double width, double height, const std::filesystem::path &file,
                  const std::function<void(Drawing &)> &draw);

} // namespace q3::bench
