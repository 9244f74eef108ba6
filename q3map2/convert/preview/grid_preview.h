// GPL-2.0-or-later. A picture of what the light grids of a map hold.
#pragma once

#include "common/image/image.h"
#include "common/log.h"
#include "libs/math/vec.h"
#include "q3map2/bspfile/bsp.h"

#include <filesystem>
#include <functional>
#include <string_view>

namespace q3 {

/// A picture to draw on. Positions and sizes are in pixels from the top left corner; colors are display values (sRGB)
/// in 0..1.
class Canvas {
  public:
    static constexpr int kGlyphWidth = 6, kGlyphHeight = 7; ///< pixels at scale 1, space between letters included

    Canvas(int width, int height, const Vec3f &color);

    int Width() const { return image_.width; }
    int Height() const { return image_.height; }
    /// Blends over what is there; positions outside the picture are ignored.
    void Blend(int x, int y, const Vec3f &color, float alpha = 1);
    void Rectangle(int x, int y, int width, int height, const Vec3f &color);
    /// Capital letters, digits and . , - : / ( ) +; others are blank. (x, y) is the top left corner.
    void Text(int x, int y, int scale, const Vec3f &color, std::string_view text);
    void TextCentered(int x, int y, int scale, const Vec3f &color, std::string_view text);
    static int TextWidth(int scale, std::string_view text) { return (int(text.size()) * kGlyphWidth - 1) * scale; }

    const Image &Picture() const { return image_; }

  private:
    Image image_;
};

/// Axes of an orthographic view in world space: right and up on the picture, and toward the camera.
struct View {
    Vec3f right, up, toCamera;
};
/// Straight down, north up.
View PlanView();
/// From the south-west, 35 degrees above the horizon.
View ObjectView();

/// Display value of linear light: sRGB curve, clamped to 0..1.
Vec3f ToDisplay(const Vec3f &linear);

/// Draws a sphere with smooth edges, center and radius in pixels; `light` gives linear light on a world normal.
void DrawSphere(Canvas &canvas, float x, float y, float radius, const View &view,
                const std::function<Vec3f(const Vec3f &)> &light);

/// Renders the two light grids of `bsp`: a plan of the map, and pairs of spheres, lit by the SH grid and by the legacy
/// grid as engines do. Errors: no SH grid.
void WriteGridPreview(const std::filesystem::path &png, const Bsp &bsp, Log &log);

} // namespace q3
