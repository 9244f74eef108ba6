// GPL-2.0-or-later. Writes texture projections as the numbers of a side, in the three forms of the map format.
#include "q3map2/convert/source/texture_form.h"

#include "q3map2/map/map_texture.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace q3 {

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
    constexpr double kRounding = 1e-9;
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

double CoordinateAt(const std::array<double, 4> &row, const Vec3d &p) {
    return Dot(Vec3d{row[0], row[1], row[2]}, p) + row[3];
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
    const double reference = std::max({std::abs(number.value), number.reference, 1e-30});
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
    const bool negative = text.front() == '-';
    std::string digits = text.substr(negative, e - negative);
    std::erase(digits, '.');
    if (exponent < 0)
        digits = "0." + std::string(std::size_t(-exponent - 1), '0') + digits;
    else if (digits.size() <= std::size_t(exponent))
        digits.append(std::size_t(exponent) + 1 - digits.size(), '0');
    else if (digits.size() > std::size_t(exponent) + 1)
        digits.insert(std::size_t(exponent) + 1, ".");
    return negative ? "-" + digits : digits;
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
        return {DefaultTexture(form, request.normal, 0.5), std::numeric_limits<double>::infinity()};
    TextureWords best;
    for (int digits = request.corners.empty() ? kAllDigits : kFewestDigits; digits <= kAllDigits; ++digits) {
        TextureWords words = Rounded(form, numbers, digits, request);
        const bool good = words.error <= request.tolerance;
        if (best.words.empty() || words.error < best.error || good)
            best = std::move(words);
        if (good)
            break;
    }
    return best;
}

std::vector<std::string> DefaultTexture(MapForm form, const Vec3d &normal, double scale) {
    const std::string each = ExactText(scale);
    if (form == MapForm::Classic)
        return {"0", "0", "0", each, each};
    constexpr double kImageSide = 64; // texels
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
