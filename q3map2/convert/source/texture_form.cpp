// GPL-2.0-or-later. Texture projections of brush sides: fitted to draw surfaces, and written in the three forms of map
// text.
#include "q3map2/convert/source/texture_form.h"

#include "common/text/text.h"
#include "libs/math/winding.h"
#include "q3map2/map/map_texture.h"
#include "q3map2/shader/shader_library.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

namespace q3 {

// ---- Fits texture projections of brush sides to the draw surfaces that were made from them ----

namespace {

/// Largest distance of a vertex from the plane of its side. The compiler rounds vertices to 1/8 game unit, which moves
/// them by up to sqrt(3) / 16 = 0.108. Game units.
constexpr double kMaxRounding = 0.12;
/// The same if no triangle is within kMaxRounding, since shaders may move vertices. Game units.
constexpr double kMaxMove = 2;
/// Smallest cosine between the normals of a side and of a triangle made from it.
constexpr double kMinCosine = 0.9;
/// A triangle that overlaps a side by less merely touches it from beside. Square game units.
constexpr double kLeastArea = 1e-3;
/// A triangle counts as inside a side if more than this fraction of its area is; its rounded vertices may lie outside.
constexpr double kInsideFraction = 0.99;
/// Triangles that cover less than this fraction of what the first one covers are not used for the fit.
constexpr double kLeastCover = 0.01;
/// Largest misfit of a triangle that extends a fit: texels, plus game units on the surface converted to texels.
constexpr double kSameProjection = 0.1, kSameProjectionUnits = 2 * kMaxRounding;

/// A vertex of a triangle. `st` is shifted by whole images, so that triangles of one side continue each other.
struct Corner {
    Vec3d xyz;
    std::array<double, 2> st;
    double trust = 1; ///< weight in fits
};

bool IsBetween(const Vec3d &p, const Vec3d &a, const Vec3d &b) {
    const Vec3d edge = b - a;
    const double length = Length(edge), along = Dot(p - a, edge) / std::max(length, kMaxRounding);
    return along > kMaxRounding && along < length - kMaxRounding && Length(Cross(p - a, edge)) < kMaxRounding * length;
}

/// Trusts corners of the side most, and vertices between two others least: the compiler inserted these at T-junctions,
/// with texture coordinates of a point beside the vertex.
void SetTrust(std::vector<Corner> &corners, const Winding<double> &winding) {
    constexpr double kClipped = 0.1, kBetween = 1e-3; // weights of other vertices, and of those between two others
    for (Corner &corner : corners) {
        const auto isThere = [&](const Vec3d &p) { return Length(p - corner.xyz) < kMaxRounding; };
        const auto isBetweenOthers = [&] {
            return std::ranges::any_of(corners, [&](const Corner &a) {
                return std::ranges::any_of(corners,
                                           [&](const Corner &b) { return IsBetween(corner.xyz, a.xyz, b.xyz); });
            });
        };
        corner.trust = std::ranges::any_of(winding, isThere) ? 1 : isBetweenOthers() ? kBetween : kClipped;
    }
}

/// The projection along the axes that fits the corners best, by weighted least squares. Empty if they are collinear.
std::optional<TextureProjection> Fitted(std::span<const Corner> corners, std::span<const double> weights,
                                        const ProjectionAxes &axes) {
    Vec3d center;
    std::array<double, 2> mean{};
    const double total = std::accumulate(weights.begin(), weights.end(), 0.0);
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const double weight = weights[i] / total;
        center += corners[i].xyz * weight;
        mean = {mean[0] + corners[i].st[0] * weight, mean[1] + corners[i].st[1] * weight};
    }
    // Normal equations of coordinate = mean + a x + b y, where x and y are relative to the center along the two axes.
    double xx = 0, xy = 0, yy = 0;
    std::array<double, 2> xs{}, ys{};
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const Vec3d off = corners[i].xyz - center;
        const double x = Dot(off, axes.s), y = Dot(off, axes.t), w = weights[i];
        xx += w * x * x, xy += w * x * y, yy += w * y * y;
        for (std::size_t row = 0; row < 2; ++row) {
            xs[row] += w * x * (corners[i].st[row] - mean[row]);
            ys[row] += w * y * (corners[i].st[row] - mean[row]);
        }
    }
    const double determinant = xx * yy - xy * xy;
    constexpr double kMinDeterminant = 1e-9; // relative to xx yy: 1 minus the squared correlation of x and y
    if (!(determinant > kMinDeterminant * xx * yy) || !(xx > 0) || !(yy > 0))
        return std::nullopt;
    TextureProjection fitted;
    for (std::size_t row = 0; row < 2; ++row) {
        const double a = (xs[row] * yy - ys[row] * xy) / determinant, b = (ys[row] * xx - xs[row] * xy) / determinant;
        const Vec3d axis = axes.s * a + axes.t * b;
        fitted.vecs[row] = {axis.x, axis.y, axis.z, mean[row] - Dot(axis, center)};
    }
    return fitted;
}

/// s or t of a point by a row of a projection.
double CoordinateAt(const std::array<double, 4> &row, const Vec3d &p) {
    return Dot(Vec3d{row[0], row[1], row[2]}, p) + row[3];
}

/// Distance between the projection and the texture coordinates of a corner, texels.
double Misfit(const TextureProjection &projection, const Corner &corner, const GeometryDirectives &shader) {
    return std::max(std::abs(CoordinateAt(projection.vecs[0], corner.xyz) - corner.st[0]) * shader.textureWidth,
                    std::abs(CoordinateAt(projection.vecs[1], corner.xyz) - corner.st[1]) * shader.textureHeight);
}

double TexelsPerUnit(const TextureProjection &projection, const GeometryDirectives &shader) {
    const auto length = [&](std::size_t i) {
        return Length(Vec3d{projection.vecs[i][0], projection.vecs[i][1], projection.vecs[i][2]});
    };
    return std::max(length(0) * shader.textureWidth, length(1) * shader.textureHeight);
}

double LargestMisfit(const TextureProjection &projection, std::span<const Corner> corners,
                     const GeometryDirectives &shader) {
    double largest = 0;
    for (const Corner &corner : corners)
        largest = std::max(largest, Misfit(projection, corner, shader));
    return largest;
}

/// A projection and its weighted sum of misfits, texels.
struct Fit {
    std::optional<TextureProjection> projection;
    double misfit = 0;
};

/// The fit with the least sum of misfits (L1), by iteratively reweighted least squares, so that a few vertices that the
/// compiler moved, such as at T-junctions, hardly count.
Fit RobustFit(std::span<const Corner> corners, const ProjectionAxes &axes, const GeometryDirectives &shader) {
    constexpr int kSteps = 16;
    constexpr double kExact = 1e-4; // texels
    std::vector<double> weights;
    for (const Corner &corner : corners)
        weights.push_back(corner.trust);
    Fit best;
    for (int step = 0; step < kSteps; ++step) {
        const auto fitted = Fitted(corners, weights, axes);
        if (!fitted)
            break;
        double sum = 0, largest = 0;
        for (std::size_t i = 0; i < corners.size(); ++i) {
            const double misfit = Misfit(*fitted, corners[i], shader);
            sum += corners[i].trust * misfit, largest = std::max(largest, misfit);
            weights[i] = corners[i].trust / std::max(misfit, kExact);
        }
        if (!best.projection || sum < best.misfit)
            best = {fitted, sum};
        if (largest <= kExact)
            break;
    }
    return best;
}

/// Rounded vertices got the texture coordinates of their place off the plane: projected along world axes in the classic
/// form, along axes of the plane in brush primitives. The form that fits better is the one that the side had.
std::optional<TextureProjection> BestFit(std::span<const Corner> corners, const Vec3d &normal,
                                         const GeometryDirectives &shader) {
    constexpr double kAsGood = 1e-3; // texels per corner
    const Fit classic = RobustFit(corners, ClassicAxes(normal), shader);
    const Fit matrix = RobustFit(corners, MatrixAxes(normal), shader);
    const bool isMatrix =
        !classic.projection || (matrix.projection && matrix.misfit + kAsGood * double(corners.size()) < classic.misfit);
    return isMatrix ? matrix.projection : classic.projection;
}

} // namespace

std::array<double, 2> WithoutTexMod(const std::array<float, 2> &st, const GeometryDirectives &shader) {
    const auto &m = shader.texMod;
    const double a = double(m[0][0]), b = double(m[0][1]), c = double(m[1][0]), d = double(m[1][1]);
    const double determinant = a * d - b * c;
    const double s = double(st[0]), t = double(st[1]);
    constexpr double kSingular = 1e-12; // determinant of a transform that cannot be undone
    if (!(std::abs(determinant) > kSingular))
        return {s, t};
    const double x = s - double(m[0][2]), y = t - double(m[1][2]);
    return {(d * x - b * y) / determinant, (a * y - c * x) / determinant};
}

TextureSamples::TextureSamples(const Bsp &bsp, std::size_t model, ShaderLibrary &shaders, double epsilon)
    : epsilon_(epsilon) {
    const bspModel_t &own = bsp.models[model];
    for (std::int32_t i = 0; i < own.numBSPSurfaces; ++i) {
        const bspDrawSurface_t &surface = bsp.drawSurfaces[std::size_t(own.firstBSPSurface + i)];
        if (surface.surfaceType != MST_PLANAR && surface.surfaceType != MST_TRIANGLE_SOUP)
            continue;
        const std::string_view name = FieldName(bsp.shaders[std::size_t(surface.shaderNum)].shader);
        Add(bsp, surface, shaders.Get(name).geometry);
    }
}

void TextureSamples::Add(const Bsp &bsp, const bspDrawSurface_t &surface, const GeometryDirectives &directives) {
    std::vector<Triangle> &list = triangles_[LowerCase(FieldName(bsp.shaders[std::size_t(surface.shaderNum)].shader))];
    for (std::int32_t i = 0; i + 2 < surface.numIndexes; i += 3) {
        Triangle triangle;
        Vec3d facing;
        for (std::size_t k = 0; k < 3; ++k) {
            const std::int32_t index = bsp.drawIndexes[std::size_t(surface.firstIndex + i) + k];
            const bspDrawVert_t &v = bsp.drawVerts[std::size_t(surface.firstVert + index)];
            facing += Vec3d(v.normal);
            triangle.xyz[k] = Vec3d(v.xyz) - Vec3d(v.normal) * double(directives.offset);
            triangle.st[k] = WithoutTexMod(v.st, directives);
            triangle.box.Add(triangle.xyz[k]);
        }
        const auto &[a, b, c] = triangle.xyz;
        const Vec3d across = Cross(c - a, b - a);
        triangle.normal = Normalize(across);
        triangle.area = Length(across) / 2;
        if (Dot(triangle.normal, facing) < 0)
            triangle.normal = -triangle.normal;
        const bool usable = std::ranges::all_of(
            triangle.st, [](const std::array<double, 2> &st) { return std::isfinite(st[0]) && std::isfinite(st[1]); });
        if (usable && IsFinite(a + b + c) && triangle.normal != Vec3d{})
            list.push_back(triangle);
    }
}

/// Triangles that overlap the side, by overlapping area; those inside it first, as the others may be faces of other
/// brushes in the same plane.
std::vector<TextureSamples::Cover> TextureSamples::Covering(std::span<const Triangle> triangles, const Plane &plane,
                                                            const Winding<double> &winding, double farthest) const {
    const Boundsd box = WindingBounds(winding);
    std::vector<Cover> covers;
    for (const Triangle &triangle : triangles) {
        if (!triangle.box.Touches(box, farthest) || Dot(triangle.normal, plane.normal) < kMinCosine)
            continue;
        if (std::ranges::any_of(triangle.xyz, [&](const Vec3d &p) { return std::abs(plane.Distance(p)) > farthest; }))
            continue;
        Winding<double> part = winding;
        for (std::size_t i = 0; i < 3 && !part.empty(); ++i) {
            const Vec3d &a = triangle.xyz[i], &b = triangle.xyz[(i + 1) % 3], &c = triangle.xyz[(i + 2) % 3];
            Vec3d inward = Normalize(Cross(plane.normal, b - a));
            if (Dot(inward, c - a) < 0)
                inward = -inward;
            ChopPolygon(part, {inward, Dot(inward, a)}, epsilon_);
        }
        if (const double area = WindingArea(part); area > kLeastArea)
            covers.push_back({&triangle, area, area > kInsideFraction * triangle.area});
    }
    std::ranges::stable_sort(
        covers, [](const Cover &a, const Cover &b) { return a.isInside != b.isInside ? a.isInside : a.area > b.area; });
    return covers;
}

std::optional<TextureProjection> TextureSamples::Find(std::string_view shader, const GeometryDirectives &directives,
                                                      const Plane &plane, const Winding<double> &winding) const {
    const auto found = triangles_.find(LowerCase(shader));
    if (found == triangles_.end())
        return std::nullopt;
    std::vector<Cover> covers = Covering(found->second, plane, winding, kMaxRounding);
    if (covers.empty())
        covers = Covering(found->second, plane, winding, kMaxMove);
    std::vector<Corner> corners;
    std::optional<TextureProjection> best;
    for (const Cover &cover : covers) {
        if (cover.area < kLeastCover * covers.front().area)
            continue;
        std::vector<Corner> added;
        std::array<double, 2> wholeImages{};
        for (std::size_t i = 0; i < 2 && best; ++i)
            wholeImages[i] = std::round(CoordinateAt(best->vecs[i], cover.triangle->xyz[0]) - cover.triangle->st[0][i]);
        for (std::size_t k = 0; k < 3; ++k) {
            const auto &[s, t] = cover.triangle->st[k];
            added.push_back({cover.triangle->xyz[k], {s + wholeImages[0], t + wholeImages[1]}});
        }
        if (best && LargestMisfit(*best, added, directives) >
                        kSameProjection + kSameProjectionUnits * TexelsPerUnit(*best, directives))
            continue;
        corners.insert(corners.end(), added.begin(), added.end());
        constexpr std::size_t kManyCorners = 60; // the fit is settled
        if (corners.size() > kManyCorners)
            break;
        SetTrust(corners, winding);
        if (const auto fit = BestFit(corners, plane.normal, directives))
            best = fit;
        else if (!best)
            corners.clear();
    }
    return best;
}

// ---- Writes texture projections as the numbers of a side, in the three forms of the map format ----

namespace {

/// Shorter texture axes have no direction. Texels per game unit.
constexpr double kNoExtent = 1e-12;
constexpr double kDegreesPerRadian = 180 / std::numbers::pi;
constexpr int kFewestDigits = 3, kAllDigits = 17; ///< significant ones
constexpr double kAngleReference = 100;           ///< degrees, see FormNumber

/// A number to write. Its significant digits count from the larger of its own and the reference's magnitude, so that
/// numbers with the same reference get about as many decimals.
struct FormNumber {
    double value = 0, reference = 1;
};

/// Factors of a texture coordinate as a function of points p of a plane: a (p . s) + b (p . t) + constant.
struct PlaneFactors {
    double a = 0, b = 0;
};

PlaneFactors FactorsOnPlane(const std::array<double, 4> &row, const Plane &plane, const ProjectionAxes &axes) {
    // On the plane, a multiple of its normal only adds a constant. Subtracts the one that leaves a vector in the span
    // of s and t.
    const Vec3d vector{row[0], row[1], row[2]}, across = Cross(axes.s, axes.t);
    const double alongNormal = Dot(across, vector) / Dot(across, plane.normal);
    const Vec3d within = vector - plane.normal * alongNormal;
    return {Dot(within, axes.s), Dot(within, axes.t)};
}

std::array<int, 2> SizeOf(const GeometryDirectives &shader) {
    return {shader.textureWidth, shader.textureHeight};
}

/// Numbers of a brush primitive side. Offsets are left 0, here and in the other forms: Rounded sets them.
std::vector<FormNumber> MatrixNumbers(const TextureRequest &request) {
    const ProjectionAxes axes = MatrixAxes(request.normal);
    std::vector<FormNumber> numbers;
    for (const auto &row : request.projection.vecs) {
        const auto [a, b] = FactorsOnPlane(row, request.plane, axes);
        const double reference = std::max(std::abs(a), std::abs(b));
        numbers.insert(numbers.end(), {{a, reference}, {b, reference}, {0, 1}});
    }
    return numbers;
}

/// Numbers of a Valve 220 side; empty if a texture axis has no length.
std::vector<FormNumber> ValveNumbers(const TextureRequest &request) {
    const std::array<int, 2> size = SizeOf(request.shader);
    std::vector<FormNumber> numbers, scales;
    for (std::size_t i = 0; i < 2; ++i) {
        const auto &row = request.projection.vecs[i];
        const Vec3d axis = Vec3d{row[0], row[1], row[2]} * double(size[i]);
        const double length = Length(axis);
        if (!(length > kNoExtent))
            return {};
        for (std::size_t k = 0; k < 3; ++k)
            numbers.push_back({axis[k] / length, 1});
        numbers.push_back({0, double(size[i])});
        scales.push_back({1 / length, 1 / length});
    }
    numbers.insert(numbers.end(), scales.begin(), scales.end());
    return numbers;
}

/// Numbers of a classic side; empty if a texture axis has no length.
std::vector<FormNumber> ClassicNumbers(const TextureRequest &request) {
    const ProjectionAxes axes = ClassicAxes(request.normal);
    const std::array<int, 2> size = SizeOf(request.shader);
    std::array<PlaneFactors, 2> rows;
    std::array<double, 2> lengths{};
    for (std::size_t i = 0; i < 2; ++i) {
        rows[i] = FactorsOnPlane(request.projection.vecs[i], request.plane, axes);
        lengths[i] = std::hypot(rows[i].a, rows[i].b) * size[i];
        if (!(lengths[i] > kNoExtent))
            return {};
    }
    // Rotated by an angle, s runs along (cos, -sin) and t along (sin, cos) of the axes. If the texture is sheared, s
    // and t have different angles: take the mean.
    const double sAngle = std::atan2(-rows[0].b, rows[0].a);
    const double sign = rows[1].a * std::sin(sAngle) + rows[1].b * std::cos(sAngle) < 0 ? -1 : 1;
    const double tAngle = std::atan2(rows[1].a * sign, rows[1].b * sign);
    std::array<double, 2> scales{1 / lengths[0], sign / lengths[1]};
    double degrees = (sAngle + std::remainder(tAngle - sAngle, 2 * std::numbers::pi) / 2) * kDegreesPerRadian;
    // An angle outside -90 < degrees <= 90, but for rounding, becomes its opposite with both scales negated.
    constexpr double kRounding = 1e-9; // degrees
    if (degrees > 90 + kRounding || degrees <= -90 + kRounding) {
        degrees += degrees > 0 ? -180 : 180;
        scales = {-scales[0], -scales[1]};
    }
    return {{0, double(size[0])},
            {0, double(size[1])},
            {degrees, kAngleReference},
            {scales[0], std::abs(scales[0])},
            {scales[1], std::abs(scales[1])}};
}

/// The projection that a reader of the map gets from the numbers.
TextureProjection Projected(MapForm form, const std::vector<double> &n, const TextureRequest &request) {
    if (form == MapForm::Primitive)
        return ProjectMatrix({{{n[0], n[1], n[2]}, {n[3], n[4], n[5]}}}, request.normal);
    TextureAxes texture;
    if (form == MapForm::Valve) {
        texture.hasAxes = true;
        texture.axes = {Vec3d{n[0], n[1], n[2]}, Vec3d{n[4], n[5], n[6]}};
        texture.shift = {n[3], n[7]};
        texture.scale = {n[8], n[9]};
        return ProjectValve(texture, request.shader);
    }
    texture.shift = {n[0], n[1]};
    texture.rotate = n[2];
    texture.scale = {n[3], n[4]};
    return ProjectClassic(texture, request.normal, request.shader);
}

/// Largest difference from the requested projection at a corner, texels. `wraps`: modulo whole images, since the
/// classic form drops them from offsets.
double Difference(const TextureProjection &a, const TextureRequest &request, bool wraps) {
    double largest = 0;
    const std::array<int, 2> size = SizeOf(request.shader);
    for (std::size_t i = 0; i < 2; ++i) {
        const auto at = [&](const Vec3d &p) {
            return CoordinateAt(a.vecs[i], p) - CoordinateAt(request.projection.vecs[i], p);
        };
        const double whole = wraps && !request.corners.empty() ? std::round(at(request.corners.front())) : 0;
        for (const Vec3d &p : request.corners)
            largest = std::max(largest, std::abs(at(p) - whole) * size[i]);
    }
    return largest;
}

int DecimalsFor(const FormNumber &number, int digits) {
    constexpr double kMinReference = 1e-30; // zero has no logarithm
    const double reference = std::max({std::abs(number.value), number.reference, kMinReference});
    return std::max(0, digits - 1 - int(std::floor(std::log10(reference))));
}

/// Positions of the offsets of s and t among the numbers.
constexpr std::array<std::size_t, 2> OffsetPlaces(MapForm form) {
    switch (form) {
    case MapForm::Primitive:
        return {2, 5};
    case MapForm::Valve:
        return {3, 7};
    default:
        return {0, 1};
    }
}

/// The numbers rounded to `digits`. Offsets are chosen after rounding the others, so that the texture stays in place at
/// the center of the side.
TextureWords Rounded(MapForm form, const std::vector<FormNumber> &numbers, int digits, const TextureRequest &request) {
    TextureWords words;
    std::vector<double> rounded;
    for (const FormNumber &number : numbers) {
        words.words.push_back(FixedText(number.value, DecimalsFor(number, digits)));
        rounded.push_back(NumberFromText(words.words.back()));
    }
    Vec3d middle = request.corners.empty() ? request.plane.normal * request.plane.dist : Vec3d{};
    for (const Vec3d &p : request.corners)
        middle += p / double(request.corners.size());
    const bool wraps = form == MapForm::Classic && !request.shader.globalTexture;
    const TextureProjection withoutOffsets = Projected(form, rounded, request);
    const std::array<int, 2> size = SizeOf(request.shader);
    for (std::size_t row = 0; row < 2; ++row) {
        const std::size_t place = OffsetPlaces(form)[row];
        double offset =
            CoordinateAt(request.projection.vecs[row], middle) - CoordinateAt(withoutOffsets.vecs[row], middle);
        if (wraps)
            offset -= std::floor(offset);
        if (form != MapForm::Primitive)
            offset *= size[row];
        words.words[place] = FixedText(offset, DecimalsFor({offset, numbers[place].reference}, digits));
        rounded[place] = NumberFromText(words.words[place]);
    }
    words.error = Difference(Projected(form, rounded, request), request, wraps);
    return words;
}

/// "1.5e-07" as "0.00000015".
std::string WithoutExponent(const std::string &text) {
    const std::size_t e = text.find('e');
    if (e == std::string::npos)
        return text == "-0" ? "0" : text;
    const int exponent = IntegerFromText(text.substr(e + 1));
    const bool isNegative = text.front() == '-';
    std::string digits = text.substr(isNegative, e - isNegative);
    std::erase(digits, '.');
    if (exponent < 0)
        digits = "0." + std::string(std::size_t(-exponent - 1), '0') + digits;
    else if (digits.size() <= std::size_t(exponent))
        digits.append(std::size_t(exponent) + 1 - digits.size(), '0');
    else if (digits.size() > std::size_t(exponent) + 1)
        digits.insert(std::size_t(exponent) + 1, ".");
    return isNegative ? "-" + digits : digits;
}

} // namespace

std::string FixedText(double value, int decimals) {
    std::string text = fmt::format("{:.{}f}", value, decimals);
    if (text.find('.') != std::string::npos) {
        text.erase(text.find_last_not_of('0') + 1);
        if (text.back() == '.')
            text.pop_back();
    }
    return text == "-0" ? "0" : text;
}

std::string ExactText(double value) {
    return WithoutExponent(fmt::format("{}", value));
}

std::string ExactText(float value) {
    return WithoutExponent(fmt::format("{}", value));
}

TextureWords TextureInForm(MapForm form, const TextureRequest &request) {
    const std::vector<FormNumber> numbers = form == MapForm::Classic     ? ClassicNumbers(request)
                                            : form == MapForm::Primitive ? MatrixNumbers(request)
                                                                         : ValveNumbers(request);
    if (numbers.empty())
        return {DefaultTexture(form, request.normal, kDefaultTextureScale), std::numeric_limits<double>::infinity()};
    TextureWords best;
    for (int digits = request.corners.empty() ? kAllDigits : kFewestDigits; digits <= kAllDigits; ++digits) {
        TextureWords words = Rounded(form, numbers, digits, request);
        const bool isGood = words.error <= request.tolerance;
        if (best.words.empty() || words.error < best.error || isGood)
            best = std::move(words);
        if (isGood)
            break;
    }
    return best;
}

std::vector<std::string> DefaultTexture(MapForm form, const Vec3d &normal, double scale) {
    const std::string each = ExactText(scale);
    if (form == MapForm::Classic)
        return {"0", "0", "0", each, each};
    constexpr double kImageSide = 64; // texels; see the header
    const std::string images = ExactText(1 / (kImageSide * scale));
    if (form == MapForm::Primitive)
        return {images, "0", "0", "0", images, "0"};
    const ProjectionAxes axes = ClassicAxes(normal);
    std::vector<std::string> words;
    for (const Vec3d &axis : {axes.s, axes.t}) {
        for (std::size_t i = 0; i < 3; ++i)
            words.push_back(ExactText(axis[i]));
        words.emplace_back("0");
    }
    words.insert(words.end(), {each, each});
    return words;
}

} // namespace q3
