// GPL-2.0-or-later. Light on the six sides of ambient cubes.
#include "q3map2/light/cubes/cube_light.h"

#include "libs/sh/polygon_moments.h"
#include "libs/sh/sh.h"
#include "q3map2/bspfile/bspfile_grid.h"
#include "q3map2/light/batch/form_factor.h"
#include "q3map2/light/grid/grid_bricks.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

namespace q3 {

namespace {

/// Area lights with less fluence are not split at the plane of a side into the parts in front and behind. Byte scale.
constexpr double kMinSplitFluence = 1.0 / 16;
/// Upper limit of a side, reached only with absurd keys and scales. 1 = byte 255.
constexpr double kMaxSide = 1e9;

using SideSums = std::array<Vec3d, 6>;

Vec3d Axis(std::size_t axis) {
    Vec3d normal;
    normal[axis] = 1;
    return normal;
}

/// Light on the two surfaces that face + and - an axis, for a light of color 1 1 1.
struct OppositeSides {
    double plus = 0, minus = 0;
};

/// OppositeSides::plus + minus, from bands 0 and 2 of radiance coefficients: odd bands cancel out in the sum, bands
/// from 4 on are left out.
double SumOfOppositeSides(const SHVector &c, std::size_t axis) {
    const Vec3d n = Axis(axis);
    const SHVector basis = SHBasis(n);
    double sum = 0;
    for (const std::size_t k : {0, 4, 5, 6, 7, 8})
        sum += 2 * kCosineLobe[k] * basis[k] * c[k];
    return sum;
}

/// The part of a polygon whose coordinate on the axis is above that of p.
Winding<float> PartBeyond(const Winding<float> &w, const Vec3f &p, std::size_t axis) {
    WindingCutter<float> cutter;
    Winding<float> part;
    cutter.Classify(w, Vec3f(Axis(axis)), p[axis], 0);
    cutter.Front(w, part);
    return part;
}

/// The light of one source at one receiver.
struct LightAtReceiver {
    const Light &light;
    float weight; ///< of the light
    Vec3f position;
    SHVector radiance; ///< SH projection; light of strength 1 from direction w projects to Y(w)
    Vec3d vector;      ///< irradiance vector
    double fluence;    ///< sum over directions of the light on a surface that faces it

    LightAtReceiver(const Light &source, float sourceWeight, const Vec3f &at, const ProbeIncidentLight &incident,
                    std::size_t lane)
        : light(source), weight(sourceWeight), position(at) {
        for (std::size_t k = 0; k < 9; ++k)
            radiance[k] = double(incident.shCoeffs[k][lane]);
        vector = Vec3d{radiance[3], radiance[1], radiance[2]} / kSHC1;
        fluence = radiance[0] / kSHC0;
    }
    /// Whether an area light is partly in front of and partly behind a surface that faces along the axis.
    bool Straddles(std::size_t axis) const {
        if (light.type != LightType::Area)
            return false;
        bool inFront = false, behind = false;
        for (const Vec3f &corner : light.polygon)
            inFront = inFront || corner[axis] > position[axis], behind = behind || corner[axis] < position[axis];
        return inFront && behind;
    }
    /// Light on the two sides that face along the axis.
    OppositeSides SidesAlong(std::size_t axis) const;
    OppositeSides SidesOfStraddlingLight(std::size_t axis) const;
};

OppositeSides LightAtReceiver::SidesAlong(std::size_t axis) const {
    if (vector == Vec3d{}) // the receiver is at the light's position: the light comes evenly from all directions
        return {fluence / 4, fluence / 4};
    if (fluence * double(MaxAbsComponent(light.color)) > kMinSplitFluence && Straddles(axis))
        return SidesOfStraddlingLight(axis);
    return {std::max(0.0, vector[axis]), std::max(0.0, -vector[axis])};
}

/// The sides for an area light that is on both sides of the plane through the receiver. With F(A) the form factor of a
/// polygon A, S(L) = SumOfOppositeSides of light L, and v the visible fraction of the light:
///
///     plus - minus = irradiance vector on the axis
///     plus + minus = v radiosity (|F(part in front)| + |F(part behind)|) + S(visible light) - v S(unshadowed light)
///
/// The second is a control variate: exact where all or nothing of the light is visible.
OppositeSides LightAtReceiver::SidesOfStraddlingLight(std::size_t axis) const {
    const Vec3d p(position), normal = Axis(axis);
    const std::span<const Vec3f> polygon(light.polygon);
    const Winding<float> part = PartBeyond(light.polygon, position, axis);
    const double front = FormFactor(p, normal, std::span<const Vec3f>(part));
    const double behind = std::abs(FormFactor(p, normal, polygon) - front);
    const bool fromBehind = Dot(light.shape.normal, p) < light.shape.dist;
    SHVector unshadowed = MomentsOfPolygon(fromBehind ? light.shape.back : light.polygon, p).Projection();
    for (double &coefficient : unshadowed)
        coefficient *= double(light.radiosity) * double(weight) / std::numbers::pi;
    const double visible = unshadowed[0] > 0 ? std::min(1.0, radiance[0] / unshadowed[0]) : 1;
    const double sum = visible * double(light.radiosity) * double(weight) * (std::abs(front) + behind) +
                       SumOfOppositeSides(radiance, axis) - visible * SumOfOppositeSides(unshadowed, axis);
    const double both = std::max(std::abs(vector[axis]), sum); // so that neither side is negative
    return {(both + vector[axis]) / 2, (both - vector[axis]) / 2};
}

/// Adds the light of one source at the receivers of a block.
void AddLight(const Light &light, float weight, const ReceiverBatch &receivers, const ProbeIncidentLight &incident,
              std::span<SideSums> sums) {
    const Vec3d scale = Vec3d(light.color) * ((light.negative ? -1 : 1) / 255.0);
    for (unsigned lanes = incident.live.Bits(); lanes != 0; lanes &= lanes - 1) {
        const auto i = std::size_t(std::countr_zero(lanes));
        const LightAtReceiver atReceiver(light, weight, receivers.position[i], incident, i);
        const Vec3d color = incident.tinted ? scale * Vec3d(incident.tint[i]) : scale;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const OppositeSides sides = atReceiver.SidesAlong(axis);
            sums[i][2 * axis] += color * sides.plus;
            sums[i][2 * axis + 1] += color * sides.minus;
        }
    }
}

/// Adds bounced light.
void AddIndirect(const GridInputs &in, const ReceiverBatch &receivers, std::size_t i, SideSums &sides,
                 RayCounts &counts) {
    std::vector<IndirectRay> rays;
    in.indirect->Gather(receivers.rayOrigin[i], receivers.index[i], rays);
    counts.rays += rays.size();
    for (const IndirectRay &ray : rays) {
        const Vec3d light = Vec3d(ray.light) * (1 / 255.0);
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const double along = double(ray.direction[axis]);
            sides[2 * axis + (along < 0 ? 1 : 0)] += light * std::abs(along);
        }
    }
}

/// Adds floodlight as uniform light from the hemispheres around +z and -z: all of it on the side that faces the
/// hemisphere, half on each vertical side, since half of the hemisphere is in front of it.
void AddFlood(const GridInputs &in, const ReceiverBatch &receivers, std::size_t i, SideSums &sides, RayCounts &counts) {
    for (const float up : {1.0f, -1.0f}) {
        const float fraction =
            FloodFraction(in.scene, receivers.position[i], up, in.world.floodDistance, in.floodDirections, counts);
        const Vec3d light = Vec3d(in.world.floodColor) * (double(in.world.floodIntensity) * double(fraction) / 255);
        for (std::size_t side = 0; side < 4; ++side)
            sides[side] += light * 0.5;
        sides[up > 0 ? 4 : 5] += light;
    }
}

/// The sides to store: adds ambient light, raises the mean to at least the minimum, applies the grid scale.
CubeSides Finish(const GridInputs &in, SideSums sides) {
    Vec3d mean;
    for (Vec3d &side : sides) {
        side += Vec3d(in.world.ambient) / 255.0;
        mean += side / 6.0;
    }
    const Vec3d lift = Max(Vec3d(in.world.minGrid) / 255.0 - mean, Vec3d{});
    const double scale = double(in.options.PositiveGridScale());
    CubeSides finished;
    for (std::size_t side = 0; side < sides.size(); ++side)
        finished[side] = Vec3f(Min(Max((sides[side] + lift) * scale, Vec3d{}), Vec3d{kMaxSide, kMaxSide, kMaxSide}));
    return finished;
}

} // namespace

CubeIntegrator::CubeIntegrator(const GridInputs &in, const std::vector<Light> &lights)
    : in_(in), lighting_(in, lights, SHQuantity::Radiance, LightSplit::None) {}

std::vector<CubeSides> CubeIntegrator::Sides(std::vector<ReceiverBatch> &blocks, std::uint64_t seed,
                                             GridStats &work) const {
    std::vector<std::array<SideSums, kPacketSize>> sums(blocks.size());
    const auto add = [&](const WeightedLight &source, const std::vector<ProbeIncidentLight> &incident) {
        for (std::size_t block = 0; block < blocks.size(); ++block)
            AddLight(*source.light, source.weight, blocks[block], incident[block], sums[block]);
    };
    lighting_.Trace(blocks, seed, LightPart::Whole, work, add);
    const bool flood = in_.options.floodlight || in_.world.hasFloodlight;
    std::vector<CubeSides> cubes;
    for (std::size_t block = 0; block < blocks.size(); ++block)
        for (std::size_t i = 0; i < blocks[block].count; ++i) {
            SideSums &sides = sums[block][i];
            if (flood)
                AddFlood(in_, blocks[block], i, sides, work.counts);
            if (in_.indirect)
                AddIndirect(in_, blocks[block], i, sides, work.counts);
            cubes.push_back(Finish(in_, sides));
        }
    return cubes;
}

CubeSides CubesFromGridSH::At(const Vec3f &position) const {
    const shgrid_grid grid = UniformReader(grid_);
    shgrid_coeffs coeffs;
    const float at[3] = {position.x, position.y, position.z};
    shgrid_sample(&grid, at, &coeffs);
    if (radiance_)
        shgrid_convolve(&coeffs);
    CubeSides sides;
    for (std::size_t side = 0; side < sides.size(); ++side) {
        float normal[3] = {0, 0, 0}, rgb[3];
        normal[side / 2] = side % 2 == 0 ? 1.0f : -1.0f;
        shgrid_evaluate(&coeffs, normal, rgb);
        sides[side] = {rgb[0], rgb[1], rgb[2]};
    }
    return sides;
}

} // namespace q3
