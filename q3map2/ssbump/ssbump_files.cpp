// GPL-2.0-or-later. Bump maps as image files, and the options of -ssbump.
#include "q3map2/ssbump/ssbump_files.h"

#include "common/error.h"
#include "common/files/files.h"
#include "common/log.h"
#include "common/text/text.h"

#include <algorithm>
#include <cmath>

namespace q3 {

// ---- Options of the stage -ssbump ----

std::vector<SettingGroup<SsbumpOptions>> SsbumpSettings() {
    constexpr SettingRange scales{-1000, 1000}, rays{4, 1024}, passes{0, 1000};
    return {{"Bump map",
             "[ssbump.md](ssbump.md) tells how shaders use it.",
             {{{.name = "-bumpscale",
                .values = "F",
                .unit = "texels",
                .range = scales,
                .help = "Height of white over black; below 0: white is deep"},
               &SsbumpOptions::bumpScale},
              {{.name = "-notile", .help = "The image does not repeat: nothing beyond its edges casts a shadow"},
               Off(&SsbumpOptions::tile)},
              {{.name = "-rays",
                .values = "N",
                .range = rays,
                .help = "Directions all around along which a texel looks for its horizon"},
               &SsbumpOptions::rays},
              {{.name = "-filter",
                .values = "N",
                .range = passes,
                .help = "Passes that smooth the steps of slopes, by at most half a step of the image",
                .details = "For smooth heights of 8 bits, with 32 or so. Rough ones get worse."},
               &SsbumpOptions::filter},
              {{.name = "-normals",
                .values = "FILE",
                .initial = "none",
                .help = "Write the normals too, without shadows, as q3map_normalImage reads them"},
               &SsbumpOptions::normals}}}};
}

SsbumpOptions ParseSsbumpOptions(Arguments &arguments, Log &log) {
    SsbumpOptions options;
    TakeSettings(SsbumpSettings(), options, arguments, log);
    return options;
}

// ---- Bump maps as image files ----

namespace {

bool HasExtension(const std::filesystem::path &path, std::string_view extension) {
    return EqualNoCase(path.extension().string(), extension);
}

void CheckExtension(const std::filesystem::path &path) {
    if (!HasExtension(path, ".tga") && !HasExtension(path, ".png"))
        throw Error("{}: cannot write this format, expected a name that ends in .tga or .png", path.string());
}

/// Alpha of each texel; empty if all are opaque.
std::vector<std::uint8_t> AlphaOf(const DeepImage &image) {
    std::vector<std::uint8_t> alpha;
    for (std::size_t i = 3; i < image.rgba.size(); i += 4)
        alpha.push_back(std::uint8_t((image.rgba[i] + 128) / 257));
    return std::ranges::all_of(alpha, [](std::uint8_t a) { return a == 255; }) ? std::vector<std::uint8_t>() : alpha;
}

void WriteTexels(const std::filesystem::path &path, std::vector<std::uint8_t> texels,
                 const std::vector<std::uint8_t> &alpha, const HeightField &field, Log &log) {
    if (!alpha.empty()) {
        std::vector<std::uint8_t> rgba;
        rgba.reserve(4 * alpha.size());
        for (std::size_t i = 0; i < alpha.size(); ++i) {
            rgba.insert(rgba.end(), {texels[3 * i], texels[3 * i + 1], texels[3 * i + 2], alpha[i]});
        }
        texels.swap(rgba);
    }
    const int channels = alpha.empty() ? 3 : 4;
    if (HasExtension(path, ".png"))
        WritePng(path, texels, field.width, field.height, channels);
    else
        ReplaceFile(path, EncodeTga(texels, field.width, field.height, channels, TgaRows::TopFirst));
    log.Print("Wrote {}\n", path.string());
}

} // namespace

std::vector<std::uint8_t> SsbumpBytes(std::span<const Vec3f> bump) {
    std::vector<std::uint8_t> bytes;
    bytes.reserve(3 * bump.size());
    for (const Vec3f &channels : bump)
        for (std::size_t i = 0; i < 3; ++i)
            bytes.push_back(std::uint8_t(std::lround(255 * std::clamp(channels[i], 0.0f, 1.0f))));
    return bytes;
}

std::vector<std::uint8_t> NormalBytes(const HeightField &field) {
    std::vector<std::uint8_t> bytes;
    bytes.reserve(3 * field.heights.size());
    for (int y = 0; y < field.height; ++y)
        for (int x = 0; x < field.width; ++x) {
            const Vec3f normal = NormalOf(GradientAt(field, x, y));
            for (std::size_t i = 0; i < 3; ++i)
                bytes.push_back(std::uint8_t(std::clamp(std::lround(127 + 127.5f * normal[i]), 0L, 255L)));
        }
    return bytes;
}

void WriteSsbump(const std::filesystem::path &heightMap, const std::filesystem::path &output,
                 const SsbumpOptions &options, const JobPool &jobs, Log &log) {
    CheckExtension(output);
    if (!options.normals.empty())
        CheckExtension(options.normals);
    DeepImage image = ReadDeepImage(heightMap);
    log.Print("{}: {} x {} heights of {} bits\n", heightMap.string(), image.width, image.height, image.bits);
    HeightField field = HeightsOf(image, options.bumpScale, options.tile);
    const std::vector<std::uint8_t> alpha = AlphaOf(image);
    const double step = std::abs(options.bumpScale) / ((1 << image.bits) - 1);
    image.rgba = {};
    SmoothSteps(field, options.filter, step, jobs);
    Progress progress(log, field.height);
    const std::vector<Vec3f> bump = SelfShadowedBump(field, options.rays, jobs, [&](std::int64_t rows) {
        progress.Update(rows, std::uint64_t(rows) * std::uint64_t(field.width) * std::uint64_t(options.rays));
    });
    progress.Finish();
    WriteTexels(output, SsbumpBytes(bump), alpha, field, log);
    if (!options.normals.empty())
        WriteTexels(options.normals, NormalBytes(field), alpha, field, log);
}

} // namespace q3
