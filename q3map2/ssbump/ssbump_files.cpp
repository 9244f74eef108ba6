// GPL-2.0-or-later. Bump maps as image files.
#include "q3map2/ssbump/ssbump_files.h"

#include "common/error.h"
#include "common/files/files.h"
#include "common/progress.h"
#include "common/text/text.h"

#include <algorithm>
#include <cmath>

namespace q3 {

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
