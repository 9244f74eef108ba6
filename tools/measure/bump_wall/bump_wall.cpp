// GPL-2.0-or-later. Draws a bump-mapped wall by every encoding of directional light, beside the light itself.
#include "q3map2/ssbump/ssbump.h"
#include "tools/measure/bump_wall/encodings.h"
#include "tools/measure/bump_wall/random_light.h"
#include "tools/measure/bump_wall/wall.h"

#include <cairo.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>

namespace q3::bump_wall {

namespace {

constexpr int kScale = 2, kColumns = 5; // pixels per world unit; panels in a row
// Pixels.
constexpr int kPanelWidth = int(kWidth) * kScale, kPanelHeight = int(kHeight) * kScale, kGap = 8, kCaptionHeight = 42;
constexpr double kGamma = 2.2;
constexpr char kUsage[] = R"(usage: bump_wall OUT.png [UNITS]
       bump_wall -errors
The first draws the wall with luxels UNITS apart, 1 to 64, default 16. The second prints a table of errors on random
lights.
)";

/// Light of each pixel, row by row.
using Panel = std::vector<Vec3f>;

/// A point of the wall.
struct Bump {
    float x, y;
    Vec3f normal;
    std::array<float, 3> texel; ///< of the self-shadowed bump map, 0 to 1 in steps of a byte
};

/// The self-shadowed bump map of the wall, a texel for each pixel, as `q3map2 -ssbump -notile` makes it.
std::vector<std::uint8_t> SelfShadowed() {
    constexpr int kAzimuths = 32; // the default of -ssbump
    HeightField field{.width = kPanelWidth, .height = kPanelHeight, .tiles = false};
    for (int row = 0; row < kPanelHeight; row++)
        for (int column = 0; column < kPanelWidth; column++)
            field.heights.push_back(kScale * BumpHeight((float(column) + 0.5f) / kScale, (float(row) + 0.5f) / kScale));
    return SsbumpBytes(SelfShadowedBump(field, kAzimuths, JobPool()));
}

std::vector<Bump> Bumps() {
    const std::vector<std::uint8_t> texels = SelfShadowed();
    std::vector<Bump> bumps;
    for (int row = 0; row < kPanelHeight; row++)
        for (int column = 0; column < kPanelWidth; column++) {
            const float x = (float(column) + 0.5f) / kScale, y = (float(row) + 0.5f) / kScale;
            Bump bump{x, y, BumpNormal(x, y), {}};
            for (std::size_t i = 0; i < 3; i++)
                bump.texel[i] = float(texels[3 * bumps.size() + i]) / 255;
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
                                              (panels + kColumns - 1) / kColumns * (kPanelHeight + kCaptionHeight))),
          canvas_(cairo_create(surface_)) {
        cairo_set_source_rgb(canvas_, 0.094, 0.098, 0.11); // nearly black
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
        const int x = count_ % kColumns * (kPanelWidth + kGap), y = count_ / kColumns * (kPanelHeight + kCaptionHeight);
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

/// Luxels over the wall, `spacing` world units apart.
class LuxelGrid {
  public:
    explicit LuxelGrid(float spacing)
        : spacing_(spacing), columns_(int(std::ceil(kWidth / spacing)) + 1),
          rows_(int(std::ceil(kHeight / spacing)) + 1), luxels_(Lights()) {}
    Vec3f Decoded(Encoding encoding, const Bump &bump) const {
        return luxels_.Decoded(encoding, Around(bump.x, bump.y), bump.normal, bump.texel);
    }

  private:
    std::vector<LocalLight> Lights() const {
        std::vector<LocalLight> lights;
        for (int row = 0; row < rows_; row++)
            for (int column = 0; column < columns_; column++)
                lights.push_back(LampsAt(float(column) * spacing_, float(row) * spacing_));
        return lights;
    }
    Corners Around(float x, float y) const {
        constexpr float kInside = 1e-3f; // there always is a luxel to the right and below
        const float column = std::clamp(x / spacing_, 0.0f, float(columns_ - 1) - kInside),
                    row = std::clamp(y / spacing_, 0.0f, float(rows_ - 1) - kInside);
        const float fx = column - std::floor(column), fy = row - std::floor(row);
        const auto at = std::size_t(row) * std::size_t(columns_) + std::size_t(column),
                   below = at + std::size_t(columns_);
        return {{at, at + 1, below, below + 1}, {(1 - fx) * (1 - fy), fx * (1 - fy), (1 - fx) * fy, fx * fy}};
    }

    float spacing_;
    int columns_, rows_;
    EncodedLuxels luxels_;
};

std::string Figures(const char *stored, double error) {
    char text[80];
    std::snprintf(text, sizeof text, "%s; RMSE %.4f", stored, error);
    return text;
}

int Draw(const char *path, float spacing) {
    const std::vector<Bump> bumps = Bumps();
    const LuxelGrid grid(spacing);
    const Panel plain = Lit(bumps, [](const Bump &b) { return Received(LampsAt(b.x, b.y), b.normal); });
    const Panel shadowed = Lit(bumps, [](const Bump &b) { return Received(VisibleLamps(b.x, b.y), b.normal); });
    Sheet sheet(int(Encodings().size()) + 2);
    sheet.Add(plain, "the light itself", "reference of all but the last two");
    for (const EncodingInfo &info : Encodings()) {
        if (info.encoding == Encoding::Ssbump)
            sheet.Add(shadowed, "the light itself, bumps cast shadows", "reference of the last two");
        const bool ssbump = info.encoding == Encoding::Ssbump || info.encoding == Encoding::SsbumpRescaled;
        const Panel panel = Lit(bumps, [&](const Bump &b) { return grid.Decoded(info.encoding, b); });
        const double error = RootMeanSquare(panel, ssbump ? shadowed : plain);
        sheet.Add(panel, info.name, Figures(info.stored, error));
        std::printf("%-28s RMSE %.4f\n", info.name, error);
    }
    std::printf("%-28s RMSE %.4f\n", "without shadows of bumps", RootMeanSquare(plain, shadowed));
    if (sheet.Write(path))
        return EXIT_SUCCESS;
    std::fprintf(stderr, "%s: cannot be written\n", path);
    return EXIT_FAILURE;
}

} // namespace

} // namespace q3::bump_wall

/// See kUsage.
int main(int argc, char **argv) {
    const std::string first = argc > 1 ? argv[1] : "";
    if (argc == 2 && first == "-errors") {
        q3::bump_wall::PrintErrors();
        return EXIT_SUCCESS;
    }
    const float spacing = argc == 3 ? std::strtof(argv[2], nullptr) : 16;
    if (argc < 2 || argc > 3 || first.starts_with("-") || !(spacing >= 1 && spacing <= 64)) {
        std::fputs(q3::bump_wall::kUsage, stderr);
        return 2;
    }
    return q3::bump_wall::Draw(argv[1], spacing);
}
