// GPL-2.0-or-later. Texture axes of brush sides, in the three forms of the map format.
#include "q3map2/map/map_texture.h"

#include <cmath>
#include <numbers>

namespace q3 {

namespace {

struct BaseAxes {
    Vec3d normal, s, t;
};

/// Tested in this order; a later row must fit clearly better.
constexpr std::array<BaseAxes, 6> kBaseAxes{{{{0, 0, 1}, {1, 0, 0}, {0, -1, 0}},
                                             {{0, 0, -1}, {1, 0, 0}, {0, -1, 0}},
                                             {{1, 0, 0}, {0, 1, 0}, {0, 0, -1}},
                                             {{-1, 0, 0}, {0, 1, 0}, {0, 0, -1}},
                                             {{0, 1, 0}, {1, 0, 0}, {0, 0, -1}},
                                             {{0, -1, 0}, {1, 0, 0}, {0, 0, -1}}}};
constexpr double kClearlyLarger = 0.0001; ///< difference of dot products
constexpr double kVertical = 1e-6;        ///< x and y of vertical normals are smaller
/// Larger values times a coordinate would exceed the range of float.
constexpr double kMaxProjection = 1e30;
/// Images per game unit. Along a shorter axis the whole world spans about a ten-thousandth of an image.
constexpr double kMinAxis = 1e-9;
/// Least sine of the angle between axes on a side.
constexpr double kMinAxisSine = 1e-4;

const BaseAxes &BaseAxesOf(const Vec3d &normal) {
    const BaseAxes *best = nullptr;
    double bestDot = 0;
    for (const BaseAxes &row : kBaseAxes) {
        const double dot = Dot(normal, row.normal);
        if (!best || dot > bestDot + kClearlyLarger)
            best = &row, bestDot = dot;
    }
    return *best;
}

/// Rotation by an angle.
struct Rotation {
    double sine, cosine;
};

/// Exact at multiples of 90 degrees.
Rotation RotationOf(double degrees) {
    if (degrees == 0)
        return {0, 1};
    if (degrees == 90)
        return {1, 0};
    if (degrees == 180)
        return {0, -1};
    if (degrees == 270)
        return {-1, 0};
    const double angle = degrees / 180 * std::numbers::pi;
    return {std::sin(angle), std::cos(angle)};
}

/// Number of the world axis along which a base axis is.
std::size_t WorldAxis(const Vec3d &axis) {
    return axis.x != 0 ? 0 : axis.y != 0 ? 1 : 2;
}

double ScaleOf(const TextureAxes &texture, std::size_t row) {
    return texture.scale[row] == 0 ? 1 : texture.scale[row];
}

/// Row of a projection: axis in texels per game unit and shift in texels, divided by the image size.
std::array<double, 4> ProjectionRow(const Vec3d &axis, double shift, int size) {
    const double texels = double(size);
    return {axis.x / texels, axis.y / texels, axis.z / texels, shift / texels};
}

} // namespace

ProjectionAxes ClassicAxes(const Vec3d &normal) {
    const BaseAxes &base = BaseAxesOf(normal);
    return {base.s, base.t};
}

ProjectionAxes MatrixAxes(const Vec3d &normal) {
    if (std::abs(normal.x) < kVertical && std::abs(normal.y) < kVertical)
        return {{0, 1, 0}, {normal.z > 0 ? 1.0 : -1.0, 0, 0}};
    const Vec3d across = Normalize(Cross(normal, Vec3d{0, 0, 1}));
    return {-across, Normalize(Cross(normal, across))};
}

TextureProjection ProjectClassic(const TextureAxes &texture, const Vec3d &normal, const GeometryDirectives &shader) {
    const BaseAxes &base = BaseAxesOf(normal);
    const std::size_t sAxis = WorldAxis(base.s), tAxis = WorldAxis(base.t);
    const Rotation rotation = RotationOf(texture.rotate);
    const std::array<int, 2> size{shader.textureWidth, shader.textureHeight};
    TextureProjection projection;
    for (std::size_t row = 0; row < 2; ++row) {
        const Vec3d axis = row == 0 ? base.s : base.t;
        Vec3d turned = axis;
        turned[sAxis] = rotation.cosine * axis[sAxis] - rotation.sine * axis[tAxis];
        turned[tAxis] = rotation.sine * axis[sAxis] + rotation.cosine * axis[tAxis];
        double shift = texture.shift[row];
        if (!shader.globalTexture)
            shift -= std::floor(shift / size[row]) * size[row];
        projection.vecs[row] = ProjectionRow(turned / ScaleOf(texture, row), shift, size[row]);
    }
    return projection;
}

TextureProjection ProjectValve(const TextureAxes &texture, const GeometryDirectives &shader) {
    const std::array<int, 2> size{shader.textureWidth, shader.textureHeight};
    TextureProjection projection;
    for (std::size_t row = 0; row < 2; ++row)
        projection.vecs[row] = ProjectionRow(texture.axes[row] / ScaleOf(texture, row), texture.shift[row], size[row]);
    return projection;
}

TextureProjection ProjectMatrix(const TextureMatrix &matrix, const Vec3d &normal) {
    const ProjectionAxes axes = MatrixAxes(normal);
    TextureProjection projection;
    for (std::size_t row = 0; row < 2; ++row) {
        const Vec3d axis = axes.s * matrix[row][0] + axes.t * matrix[row][1];
        projection.vecs[row] = {axis.x, axis.y, axis.z, matrix[row][2]};
    }
    return projection;
}

bool HasExtent(const TextureProjection &projection, const Vec3d &normal) {
    std::array<Vec3d, 2> axes;
    for (std::size_t row = 0; row < 2; ++row)
        for (std::size_t i = 0; i < 3; ++i)
            if (const double value = projection.vecs[row][i]; std::abs(value) < kMaxProjection)
                axes[row][i] = value;
    const double s = Length(axes[0]), t = Length(axes[1]);
    return s > kMinAxis && t > kMinAxis && std::abs(Dot(normal, Cross(axes[0], axes[1]))) > kMinAxisSine * s * t;
}

TextureProjection DefaultProjection(const Vec3d &normal, const GeometryDirectives &shader) {
    TextureAxes plain;
    plain.scale = {kDefaultTextureScale, kDefaultTextureScale};
    return ProjectClassic(plain, normal, shader);
}

TextureProjection FinalProjection(TextureProjection own, const GeometryDirectives &shader, bool flat) {
    if (shader.hasTexGen)
        for (std::size_t row = 0; row < 2; ++row) {
            const Vec3d axis(shader.texGen[row]);
            own.vecs[row] = {axis.x, axis.y, axis.z, 0};
        }
    else if (flat) // the middle of the last texel
        own.vecs = {{{0, 0, 0, 1 - 0.5 / shader.textureWidth}, {0, 0, 0, 1 - 0.5 / shader.textureHeight}}};
    for (auto &row : own.vecs)
        for (double &value : row)
            if (!(std::abs(value) < kMaxProjection))
                value = 0;
    return own;
}

} // namespace q3
