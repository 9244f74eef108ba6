// GPL-2.0-or-later. A picture to draw on: rectangles, spheres, small letters.
#include "q3map2/convert/preview/grid_preview_canvas.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace q3 {

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

} // namespace q3
