// GPL-2.0-or-later. Draws a bump-mapped wall by every encoding of directional light, beside the light itself.
#include "tools/bump_wall/encodings.h"

#include <cairo.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <optional>
#include <string>

namespace q3::bump_wall {

namespace {

constexpr int kScale = 2, kColumns = 5; // pixels a world unit; panels a row
constexpr int kPanelWidth = int(kWidth) * kScale, kPanelHeight = int(kHeight) * kScale, kGap = 8, kFoot = 42;
constexpr double kGamma = 2.2;

/// Light of each pixel, row by row.
using Panel = std::vector<Vec3f>;

struct Caption {
    std::string name, bytes;
};

struct Bump {
    float x, y;
    Vec3f normal;
    std::array<float, 3> texel; ///< self-shadowed, in steps of a byte
};

std::vector<Bump> Bumps() {
    std::vector<Bump> bumps;
    for (int row = 0; row < kPanelHeight; row++)
        for (int column = 0; column < kPanelWidth; column++) {
            const float x = (float(column) + 0.5f) / kScale, y = (float(row) + 0.5f) / kScale;
            const Vec3f normal = BumpNormal(x, y);
            Bump bump{x, y, normal, SelfShadowedTexel(x, y, normal)};
            for (float &channel : bump.texel)
                channel = std::round(channel * 255) / 255;
            bumps.push_back(bump);
        }
    return bumps;
}

template <typename Light> Panel Lit(const std::vector<Bump> &bumps, Light light) {
    Panel panel;
    for (const Bump &bump : bumps)
        panel.push_back(light(bump));
    return panel;
}

double RootMeanSquare(const Panel &panel, const Panel &reference) {
    double sum = 0;
    for (std::size_t i = 0; i < panel.size(); i++) {
        const Vec3f d = panel[i] - reference[i];
        sum += Dot(d, d) / 3;
    }
    return std::sqrt(sum / double(panel.size()));
}

std::uint32_t Display(const Vec3f &light) {
    const auto byte = [](float value) {
        return std::uint32_t(std::lround(255 * std::pow(std::clamp(double(value), 0.0, 1.0), 1 / kGamma)));
    };
    return 0xff000000u | byte(light.x) << 16 | byte(light.y) << 8 | byte(light.z);
}

/// A sheet of panels, five in a row, each with two lines below it.
class Sheet {
  public:
    explicit Sheet(int panels)
        : surface_(cairo_image_surface_create(CAIRO_FORMAT_RGB24, kColumns * (kPanelWidth + kGap) - kGap,
                                              (panels + kColumns - 1) / kColumns * (kPanelHeight + kFoot))),
          canvas_(cairo_create(surface_)) {
        cairo_set_source_rgb(canvas_, 0.094, 0.098, 0.11);
        cairo_paint(canvas_);
        cairo_select_font_face(canvas_, "sans-serif", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
    }
    ~Sheet() {
        cairo_destroy(canvas_);
        cairo_surface_destroy(surface_);
    }
    Sheet(const Sheet &) = delete;
    Sheet &operator=(const Sheet &) = delete;

    void Add(const Panel &panel, const std::string &name, const std::string &figures) {
        const int x = count_ % kColumns * (kPanelWidth + kGap), y = count_ / kColumns * (kPanelHeight + kFoot);
        count_++;
        cairo_surface_flush(surface_);
        unsigned char *pixels = cairo_image_surface_get_data(surface_);
        const int stride = cairo_image_surface_get_stride(surface_);
        for (int row = 0; row < kPanelHeight; row++)
            for (int column = 0; column < kPanelWidth; column++)
                reinterpret_cast<std::uint32_t *>(pixels + (y + row) * stride)[x + column] =
                    Display(panel[std::size_t(row * kPanelWidth + column)]);
        cairo_surface_mark_dirty(surface_);
        Text(x + 4, y + kPanelHeight + 16, name, 14, 0.94);
        Text(x + 4, y + kPanelHeight + 33, figures, 12, 0.7);
    }
    bool Write(const char *path) { return cairo_surface_write_to_png(surface_, path) == CAIRO_STATUS_SUCCESS; }

  private:
    void Text(double x, double y, const std::string &text, double size, double gray) {
        cairo_set_source_rgb(canvas_, gray, gray, gray);
        cairo_set_font_size(canvas_, size);
        cairo_move_to(canvas_, x, y);
        cairo_show_text(canvas_, text.c_str());
    }

    cairo_surface_t *surface_;
    cairo_t *canvas_;
    int count_ = 0;
};

struct Row {
    Encoding encoding;
    const char *name, *stored;
};
constexpr Row kRows[] = {
    {Encoding::Flat, "flat lightmap", "1 color"},
    {Encoding::Deluxe, "deluxe, light * n.d", "1 color, direction"},
    {Encoding::DeluxeReceived, "deluxe, / flat.d", "1 color, direction"},
    {Encoding::RnmRaw, "RNM raw, linear weights", "3 colors"},
    {Encoding::RnmRescaled, "RNM rescaled, linear", "3 colors"},
    {Encoding::RnmSquared, "RNM rescaled, squared", "3 colors"},
    {Encoding::L1, "L1 SH, RGB", "12 floats"},
    {Encoding::L1WithFlat, "L1 SH, to flat light", "12 floats, 1 color"},
    {Encoding::L1Curved, "L1 SH, curved", "12 floats"},
    {Encoding::High, "Lightmass, high quality", "8 bytes"},
    {Encoding::Low, "Lightmass, low quality", "8 bytes"},
    {Encoding::Ssbump, "SSBump, RNM raw", "3 colors"},
    {Encoding::SsbumpRescaled, "SSBump, RNM rescaled", "3 colors"},
};

std::string Figures(const char *stored, double error) {
    char text[80];
    std::snprintf(text, sizeof text, "%s; RMSE %.4f", stored, error);
    return text;
}

int Draw(const char *path, float spacing) {
    const std::vector<Bump> bumps = Bumps();
    const LuxelGrid grid(spacing);
    const Panel plain = Lit(bumps, [](const Bump &b) { return BruteForce(b.x, b.y, b.normal, false); });
    const Panel shadowed = Lit(bumps, [](const Bump &b) { return BruteForce(b.x, b.y, b.normal, true); });
    Sheet sheet(int(std::size(kRows)) + 2);
    sheet.Add(plain, "the light itself", "reference of all but the last two");
    for (const Row &row : kRows) {
        const bool ssbump = row.encoding == Encoding::Ssbump || row.encoding == Encoding::SsbumpRescaled;
        if (row.encoding == Encoding::Ssbump)
            sheet.Add(shadowed, "the light itself, bumps cast shadows", "reference of the last two");
        const Panel panel =
            Lit(bumps, [&](const Bump &b) { return grid.Decoded(row.encoding, b.x, b.y, b.normal, b.texel); });
        const double error = RootMeanSquare(panel, ssbump ? shadowed : plain);
        sheet.Add(panel, row.name, Figures(row.stored, error));
        std::printf("%-28s RMSE %.4f\n", row.name, error);
        if (row.encoding == Encoding::SsbumpRescaled)
            std::printf("%-28s RMSE %.4f\n", "without shadows of bumps", RootMeanSquare(plain, shadowed));
    }
    if (sheet.Write(path))
        return EXIT_SUCCESS;
    std::fprintf(stderr, "%s: cannot be written\n", path);
    return EXIT_FAILURE;
}

} // namespace

} // namespace q3::bump_wall

/// usage: bump_wall OUT.png [UNITS]: luxels UNITS apart, 16 if left out.
int main(int argc, char **argv) {
    const float spacing = argc == 3 ? std::strtof(argv[2], nullptr) : 16;
    if (argc < 2 || argc > 3 || !(spacing >= 1 && spacing <= 64)) {
        std::fprintf(stderr, "usage: bump_wall OUT.png [UNITS]\nUNITS: 1 to 64 between luxels, default 16\n");
        return 2;
    }
    return q3::bump_wall::Draw(argv[1], spacing);
}
