// GPL-2.0-or-later. A lit map as an engine draws it.
#include "tools/measure/lightmap_compare/lit_map.h"

#include "common/error.h"
#include "common/files/files.h"
#include "common/image/image.h"
#include "common/text/text.h"
#include "common/text/text_scan.h"
#include "libs/math/sampling.h"
#include "q3map2/bspfile/bsp.h"
#include "q3map2/lightmap/store/lightmap_scripts.h"

#include <algorithm>
#include <cmath>

namespace q3::compare {

namespace {

std::vector<Page> PagesOfLump(const Bsp &bsp, int side) {
    const std::size_t bytes = 3 * std::size_t(side) * std::size_t(side);
    std::vector<Page> pages;
    for (std::size_t at = 0; at + bytes <= bsp.lightmaps.size(); at += bytes)
        pages.push_back(
            {side,
             side,
             {bsp.lightmaps.begin() + std::ptrdiff_t(at), bsp.lightmaps.begin() + std::ptrdiff_t(at + bytes)}});
    return pages;
}

/// Images lm_0000.tga and so on, up to the first gap; gaps before `atLeast` are pages of the lump.
std::vector<Page> PagesOfFolder(const std::filesystem::path &folder, std::size_t atLeast) {
    std::vector<Page> pages;
    std::error_code ignored;
    for (std::size_t i = 0;; ++i) {
        const auto path = folder / fmt::format("lm_{:04}.tga", i);
        if (!std::filesystem::exists(path, ignored)) {
            if (i >= atLeast)
                return pages;
            pages.emplace_back();
            continue;
        }
        const Image image = DecodeTga(ReadFile(path), path.string());
        Page page{image.width, image.height, {}};
        for (std::size_t at = 0; at < image.rgba.size(); at += 4)
            page.rgb.insert(page.rgb.end(), &image.rgba[at], &image.rgba[at + 3]);
        pages.push_back(std::move(page));
    }
}

/// Generated shaders, each with the first page image that it uses.
std::map<std::string, int> PagesOfShaders(const std::filesystem::path &script, std::string_view mapName) {
    std::map<std::string, int> result;
    std::error_code ignored;
    if (!std::filesystem::exists(script, ignored))
        return result;
    TextScanner scanner(ReadTextFile(script), script.string());
    const std::string prefix = fmt::format("maps/{}/lm_", mapName);
    std::string token, shader;
    int depth = 0;
    while (scanner.Next(token)) {
        if (token == "{")
            ++depth;
        else if (token == "}")
            --depth;
        else if (depth == 0)
            shader = LowerCase(token);
        else if (StartsWithNoCase(token, prefix))
            result.emplace(shader, IntegerFromText(std::string_view(token).substr(prefix.size())));
    }
    return result;
}

Vec3d Texel(const Page &page, int x, int y) {
    const std::size_t at = 3 * (std::size_t(y) * std::size_t(page.width) + std::size_t(x));
    return {double(page.rgb[at]), double(page.rgb[at + 1]), double(page.rgb[at + 2])};
}

/// The point at parameters 0..1 of a patch, whose pieces of 3 x 3 control points are biquadratic Bezier surfaces.
SurfacePoint OnPatch(const bspDrawSurface_t &s, double u, double v) {
    const int across = (s.patchWidth - 1) / 2, down = (s.patchHeight - 1) / 2;
    const int column = std::min(int(u * across), across - 1), row = std::min(int(v * down), down - 1);
    // Quadratic Bernstein polynomials.
    const auto weights = [](double t) { return std::array{(1 - t) * (1 - t), 2 * t * (1 - t), t * t}; };
    const auto a = weights(u * across - column), b = weights(v * down - row);
    SurfacePoint point;
    for (int y = 0; y < 3; ++y)
        for (int x = 0; x < 3; ++x) {
            point.verts[point.count] = s.firstVert + (2 * row + y) * s.patchWidth + 2 * column + x;
            point.weights[point.count++] = a[std::size_t(x)] * b[std::size_t(y)];
        }
    return point;
}

Vec3d PositionOf(const Bsp &bsp, const SurfacePoint &point) {
    Vec3d sum;
    for (std::size_t i = 0; i < point.count; ++i)
        sum += Vec3d(bsp.drawVerts[std::size_t(point.verts[i])].xyz) * point.weights[i];
    return sum;
}

/// Cumulative sums of twice the triangle areas.
std::vector<double> CumulativeAreas(const Bsp &bsp, const bspDrawSurface_t &s) {
    std::vector<double> area{0};
    for (int i = s.firstIndex; i + 2 < s.firstIndex + s.numIndexes; i += 3) {
        const auto at = [&](int corner) {
            return Vec3d(bsp.drawVerts[std::size_t(s.firstVert + bsp.drawIndexes[std::size_t(i + corner)])].xyz);
        };
        area.push_back(area.back() + Length(Cross(at(1) - at(0), at(2) - at(0))));
    }
    return area;
}

} // namespace

LitMap::LitMap(Bsp bsp, std::vector<Page> pages, std::map<std::string, int> pageOfShader)
    : bsp_(std::move(bsp)), pages_(std::move(pages)) {
    const auto known = [&](int page) {
        return page >= 0 && std::size_t(page) < pages_.size() && !pages_[std::size_t(page)].rgb.empty();
    };
    // In deluxe files every odd page holds directions, so that surfaces name even ones only.
    bool any = false, even = true;
    for (std::size_t i = 0; i < bsp_.drawSurfaces.size(); ++i) {
        int page = bsp_.drawSurfaces[i].surfaceType == MST_FLARE ? -1 : bsp_.drawSurfaces[i].lightmapNum[0];
        if (const auto made = pageOfShader.find(LowerCase(ShaderOf(i))); page < 0 && made != pageOfShader.end())
            page = made->second;
        pageOf_.push_back(known(page) ? page : -1);
        any |= pageOf_.back() >= 0;
        even &= pageOf_.back() < 0 || pageOf_.back() % 2 == 0;
    }
    deluxe_ = any && even && pages_.size() % 2 == 0;
}

LitMap LitMap::Load(const std::filesystem::path &path, int side, Log &log) {
    Bsp bsp = ReadBspFile(path, BspFormat{}, log);
    std::filesystem::path folder = path;
    folder.replace_extension();
    const std::string name = path.stem().string();
    RemoveMipmapHints(name, bsp);
    auto shaders = PagesOfShaders(std::filesystem::absolute(path).parent_path().parent_path() / "scripts" /
                                      fmt::format("q3map2_{}.shader", name),
                                  name);
    std::vector<Page> pages = PagesOfLump(bsp, side);
    // Generated shaders number the pages of the lump and the images in one sequence.
    std::size_t most = 0;
    for (const auto &[shader, page] : shaders)
        most = std::max(most, std::size_t(std::max(page, 0)) + 1);
    if (pages.empty() || most > 0) {
        std::vector<Page> images = PagesOfFolder(folder, most);
        images.resize(std::max(images.size(), pages.size()));
        for (std::size_t i = 0; i < pages.size(); ++i)
            if (images[i].rgb.empty())
                images[i] = std::move(pages[i]);
        pages = std::move(images);
    }
    return LitMap(std::move(bsp), std::move(pages), std::move(shaders));
}

Vec3d LitMap::Sample(int page, const SurfacePoint &point) const {
    const Page &p = pages_[std::size_t(page)];
    double s = 0, t = 0;
    for (std::size_t i = 0; i < point.count; ++i) {
        const bspDrawVert_t &v = bsp_.drawVerts[std::size_t(point.verts[i])];
        s += point.weights[i] * double(v.lightmap[0][0]), t += point.weights[i] * double(v.lightmap[0][1]);
    }
    const auto along = [](double coordinate, int size) {
        const double at = coordinate * size - 0.5;
        return std::isfinite(at) ? std::clamp(at, 0.0, double(size - 1)) : 0.0;
    };
    const double x = along(s, p.width), y = along(t, p.height);
    const int x0 = int(x), y0 = int(y), x1 = std::min(x0 + 1, p.width - 1), y1 = std::min(y0 + 1, p.height - 1);
    const double fx = x - x0, fy = y - y0;
    return (Texel(p, x0, y0) * (1 - fx) + Texel(p, x1, y0) * fx) * (1 - fy) +
           (Texel(p, x0, y1) * (1 - fx) + Texel(p, x1, y1) * fx) * fy;
}

Vec3d LitMap::Direction(std::size_t surface, const SurfacePoint &point) const {
    constexpr double kZero = 127.5; // bytes 0 and 255 are -1 and 1
    return (Sample(PageOf(surface) + 1, point) - Vec3d{kZero, kZero, kZero}) / kZero;
}

Vec3d LitMap::Position(const SurfacePoint &point) const {
    return PositionOf(bsp_, point);
}

bool IsUndrawn(const Bsp &bsp, std::size_t surface) {
    // Flags of Quake III: SURF_SKY, SURF_HINT, SURF_SKIP, SURF_NODRAW.
    constexpr std::uint32_t kSky = 0x4, kHint = 0x100, kSkip = 0x200, kNoDraw = 0x80;
    const auto flags = std::uint32_t(bsp.shaders[std::size_t(bsp.drawSurfaces[surface].shaderNum)].surfaceFlags);
    return (flags & (kSky | kHint | kSkip | kNoDraw)) != 0;
}

bool DrawsVertexColors(const ShaderInfo &shader) {
    if (shader.scriptText.empty() || !shader.implicitMap.empty() || !shader.implicitMask.empty() ||
        !shader.implicitBlend.empty())
        return true;
    TextScanner scanner(shader.scriptText, shader.name);
    std::string token;
    // vertex, exactVertex, oneMinusVertex and what later engines added.
    while (scanner.Next(token))
        if (EqualNoCase(token, "rgbGen") && scanner.NextOnLine(token) &&
            LowerCase(token).find("vertex") != std::string::npos)
            return true;
    return false;
}

bool IsBuried(const Bsp &bsp, std::size_t surface, const SurfacePoint &point) {
    constexpr float kInFront = 1; // game units
    const bspModel_t &world = bsp.models.front();
    const auto number = std::int64_t(surface);
    if (number < world.firstBSPSurface || number >= std::int64_t(world.firstBSPSurface) + world.numBSPSurfaces)
        return false;
    Vec3d normal;
    for (std::size_t i = 0; i < point.count; ++i)
        normal += Vec3d(bsp.drawVerts[std::size_t(point.verts[i])].normal) * point.weights[i];
    const Vec3f front = Vec3f(PositionOf(bsp, point)) + Normalize(Vec3f(normal)) * kInFront;
    return bsp.leafs[std::size_t(LeafAt(bsp, front))].cluster == kSolidCluster;
}

double AreaOf(const Bsp &bsp, std::size_t surface) {
    const bspDrawSurface_t &s = bsp.drawSurfaces[surface];
    if (s.surfaceType == MST_PLANAR || s.surfaceType == MST_TRIANGLE_SOUP)
        return CumulativeAreas(bsp, s).back() / 2;
    if (s.surfaceType != MST_PATCH)
        return 0;
    constexpr int kSteps = 32; // quads along each side
    const auto at = [&](int x, int y) { return PositionOf(bsp, OnPatch(s, double(x) / kSteps, double(y) / kSteps)); };
    double area = 0;
    for (int y = 0; y < kSteps; ++y)
        for (int x = 0; x < kSteps; ++x)
            // Half the cross product of the diagonals of a quad.
            area += Length(Cross(at(x + 1, y + 1) - at(x, y), at(x, y + 1) - at(x + 1, y))) / 2;
    return area;
}

std::vector<SurfacePoint> PointsOn(const Bsp &bsp, std::size_t surface, int count) {
    const bspDrawSurface_t &s = bsp.drawSurfaces[surface];
    std::vector<SurfacePoint> points;
    if (s.surfaceType == MST_PATCH) {
        for (int i = 0; i < count; ++i) {
            const Sample2 at = PlasticSample(std::uint32_t(i), surface);
            points.push_back(OnPatch(s, at.u, at.v));
        }
        return points;
    }
    if (s.surfaceType != MST_PLANAR && s.surfaceType != MST_TRIANGLE_SOUP)
        return points;
    const std::vector<double> area = CumulativeAreas(bsp, s);
    const auto index = [&](std::size_t triangle, std::size_t corner) {
        return s.firstVert + bsp.drawIndexes[std::size_t(s.firstIndex) + 3 * triangle + corner];
    };
    for (int i = 0; i < count && area.back() > 0; ++i) {
        const Sample2 at = PlasticSample(std::uint32_t(i), surface);
        const double chosen = (i + 0.5) / count * area.back();
        const auto t = std::size_t(std::upper_bound(area.begin(), area.end() - 1, chosen) - area.begin()) - 1;
        // Of uniform u and v: weights 1 - sqrt u, sqrt u (1 - v), sqrt u v of the corners (Turk, 1990).
        const double rootU = std::sqrt(at.u);
        const std::size_t triangle = std::min(t, std::size_t(s.numIndexes) / 3 - 1);
        points.push_back({{index(triangle, 0), index(triangle, 1), index(triangle, 2)},
                          {1 - rootU, rootU * (1 - at.v), rootU * at.v},
                          3});
    }
    return points;
}

} // namespace q3::compare
