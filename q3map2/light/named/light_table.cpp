// GPL-2.0-or-later. The lights that a grid can name: those of a pass, with the pieces of each lamp joined.
#include "q3map2/light/named/light_table.h"

#include "q3map2/light/sources/falloff.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>
#include <numbers>

namespace q3 {

namespace {

/// The bounding boxes of two polygons of a lamp are at most this far apart along each axis. Game units.
constexpr float kMaxGap = 4;
/// A light has at most this many pieces, and its bounding box at most this half diagonal (game units). A larger lamp
/// becomes several lights, since a wall often hides only a part of it.
constexpr std::size_t kMaxPolygons = 8;
constexpr float kMaxLampRadius = 128;
/// The directions to the samples of a sun have at least this cosine to that of the first one: an angle of 20 degrees.
constexpr float kMinSunCosine = 0.94f;
/// Polygons are coplanar if their planes are less than kMaxPlaneOffset apart (game units) and their normals have a
/// larger cosine than kMinNormalCosine.
constexpr float kMaxPlaneOffset = 0.1f, kMinNormalCosine = 0.9999f;
/// Corners that are closer to each other are the same corner. Game units.
constexpr float kSameCorner = 0.1f;
/// A corner with a smaller sine between its edges lies on a straight edge and is removed.
constexpr float kMinTurn = 1e-3f;

/// Whether two lights of the pass agree in all that the pieces of a lamp, or the samples of a sun, have in common.
bool MayJoin(const Light &a, const Light &b) {
    return a.type == b.type && a.style == b.style && a.color == b.color && a.negative == b.negative &&
           a.twoSided == b.twoSided && a.radiosity == b.radiosity && a.photons == b.photons && a.name == b.name &&
           a.skyIndex == b.skyIndex && a.entity == b.entity;
}

Boundsf BoxOf(const Light &light) {
    Boundsf box;
    for (const Vec3f &corner : light.polygon)
        box.Add(corner);
    return box;
}

/// The union of two coplanar convex polygons with a common edge. Polygons are clockwise seen from the front. Empty if
/// they have no common edge, if the union is not convex, or if it has too many vertices.
std::vector<Vec3f> JoinedPolygon(const std::vector<Vec3f> &a, const std::vector<Vec3f> &b, const Vec3f &normal) {
    const auto same = [](const Vec3f &p, const Vec3f &q) { return Length(p - q) < kSameCorner; };
    for (std::size_t i = 0; i < a.size(); ++i)
        for (std::size_t j = 0; j < b.size(); ++j) {
            if (!same(a[i], b[(j + 1) % b.size()]) || !same(a[(i + 1) % a.size()], b[j]))
                continue;
            std::vector<Vec3f> ring; // a from the end of the common edge around to its start, then the rest of b
            for (std::size_t k = 1; k <= a.size(); ++k)
                ring.push_back(a[(i + k) % a.size()]);
            for (std::size_t k = 2; k < b.size(); ++k)
                ring.push_back(b[(j + k) % b.size()]);
            std::vector<Vec3f> joined;
            for (std::size_t k = 0; k < ring.size(); ++k) {
                const Vec3f &before = ring[(k + ring.size() - 1) % ring.size()], &after = ring[(k + 1) % ring.size()];
                // Clockwise seen from the front: the cross product of the edges points to the back.
                const float turn = -Dot(Cross(Normalize(ring[k] - before), Normalize(after - ring[k])), normal);
                if (turn < -kMinTurn)
                    return {};
                if (turn > kMinTurn)
                    joined.push_back(ring[k]);
            }
            return joined.size() <= SHGRID_POLYGON_VERTICES ? joined : std::vector<Vec3f>();
        }
    return {};
}

/// A polygon of a light before coplanar neighbors are joined. Its plane: normal . p = dist.
struct Piece {
    std::vector<Vec3f> corners;
    Vec3f normal;
    float dist;
};

/// Replaces coplanar pieces that share an edge by their unions where these are convex.
void JoinPieces(std::vector<Piece> &pieces) {
    for (std::size_t i = 0; i < pieces.size(); ++i)
        for (std::size_t j = i + 1; j < pieces.size();) {
            std::vector<Vec3f> joined;
            if (Dot(pieces[i].normal, pieces[j].normal) > kMinNormalCosine &&
                std::abs(pieces[i].dist - pieces[j].dist) < kMaxPlaneOffset)
                joined = JoinedPolygon(pieces[i].corners, pieces[j].corners, pieces[i].normal);
            if (joined.empty()) {
                ++j;
                continue;
            }
            pieces[i].corners = std::move(joined);
            pieces.erase(pieces.begin() + std::ptrdiff_t(j));
            j = i + 1; // the union may have a common edge with pieces that were passed over
        }
}

void AddPolygon(const Piece &piece, GridLights &table) {
    Light light;
    light.polygon.assign(piece.corners.begin(), piece.corners.end());
    light.SetShape(); // plane, center, area, radius
    GridPolygon polygon;
    polygon.firstVertex = std::uint32_t(table.vertices.size());
    polygon.vertexCount = std::uint32_t(piece.corners.size());
    polygon.normal = Vec3f(light.shape.normal).Array();
    polygon.dist = float(light.shape.dist);
    polygon.center = light.shape.center.Array();
    polygon.area = light.shape.area, polygon.radius = light.shape.radius;
    for (const Vec3f &corner : piece.corners)
        table.vertices.push_back(corner.Array());
    table.polygons.push_back(polygon);
}

/// Sets the falloff of a point light or spotlight.
void SetCurve(const Light &light, GridLight &record) {
    const Attenuation &k = light.attenuation;
    record.extraDist = light.extraDist;
    record.nearest = light.curve == FalloffCurve::Polynomial ? kNearestPolynomial : kNearest;
    switch (light.curve) {
    case FalloffCurve::InverseSquare:
        record.curve = SHGRID_INVERSE_SQUARE;
        break;
    case FalloffCurve::Linear:
        record.curve = SHGRID_LINEAR;
        record.fade = light.fade;
        break;
    case FalloffCurve::Windowed:
        record.curve = SHGRID_WINDOWED;
        record.end = k.end;
        break;
    case FalloffCurve::Polynomial:
        record.curve = SHGRID_POLYNOMIAL;
        record.constant = k.constant, record.linear = k.linear, record.quadratic = k.quadratic;
        record.flatFrom = k.flatFrom, record.fadeFrom = k.fadeFrom, record.end = k.end;
        break;
    }
}

/// Makes a record a spotlight.
void SetCone(const Light &light, GridLight &record) {
    record.type = SHGRID_SPOT;
    record.normal = light.normal.Array();
    if (light.cone.byAngles) {
        record.flags |= SHGRID_CONE_BY_ANGLES;
        record.cosInner = light.cone.cosInner, record.cosOuter = light.cone.cosOuter;
        record.exponent = light.cone.exponent;
    } else {
        record.coneRadius = light.radiusByDist;
        record.coneFade = kConeFade;
    }
}

} // namespace

LightTable::LightTable(const std::vector<Light> &lights, float scale) : lights_(lights), numberOf_(lights.size()) {
    GroupLights();
    for (const std::vector<std::size_t> &members : members_)
        AddRecord(members, scale);
    reader_.lights = reinterpret_cast<const unsigned char *>(table_.lights.data());
    reader_.polygons = reinterpret_cast<const unsigned char *>(table_.polygons.data());
    reader_.vertices = reinterpret_cast<const unsigned char *>(table_.vertices.data());
    reader_.lightCount = std::int32_t(table_.lights.size());
}

/// Sets members_ and numberOf_. A light joins the newest group that it fits. Groups are never merged, even if a later
/// light touches both.
void LightTable::GroupLights() {
    struct Group {
        Boundsf box;
        std::vector<Boundsf> pieces;
        Vec3f towardSun; ///< direction to the first sample of a sun
    };
    std::vector<Group> groups;
    std::map<std::pair<int, int>, std::vector<std::size_t>> byTypeAndStyle; // numbers of groups
    for (std::size_t i = 0; i < lights_.size(); ++i) {
        const Light &light = lights_[i];
        const Boundsf box = BoxOf(light);
        std::size_t found = groups.size();
        std::vector<std::size_t> &candidates = byTypeAndStyle[{int(light.type), light.style}];
        for (std::size_t c = candidates.size(); c-- > 0 && found == groups.size();) {
            Group &group = groups[candidates[c]];
            if (!MayJoin(light, lights_[members_[candidates[c]].front()]))
                continue;
            if (light.type == LightType::Sun && light.style == 0) {
                if (Dot(group.towardSun, -light.normal) > kMinSunCosine)
                    found = candidates[c];
            } else if (light.type == LightType::Area && group.pieces.size() < kMaxPolygons) {
                Boundsf both = group.box;
                both.Add(box.mins), both.Add(box.maxs);
                const bool fits = Length(both.maxs - both.mins) < 2 * kMaxLampRadius;
                const bool touches = std::ranges::any_of(group.pieces, [&](const Boundsf &piece) {
                    for (std::size_t axis = 0; axis < 3; ++axis)
                        if (piece.mins[axis] > box.maxs[axis] + kMaxGap || box.mins[axis] > piece.maxs[axis] + kMaxGap)
                            return false;
                    return true;
                });
                if (fits && touches)
                    found = candidates[c];
            }
        }
        if (found == groups.size()) {
            groups.push_back({box, {}, -light.normal});
            members_.emplace_back();
            candidates.push_back(found);
        }
        groups[found].pieces.push_back(box);
        groups[found].box.Add(box.mins), groups[found].box.Add(box.maxs);
        members_[found].push_back(i);
        numberOf_[i] = std::uint32_t(found);
    }
}

/// Appends the record of a group, with its polygons. members: lights of the pass.
void LightTable::AddRecord(std::vector<std::size_t> members, float scale) {
    const Light &light = lights_[members.front()];
    GridLight record;
    record.style = std::uint8_t(light.style);
    record.color = (light.color * (scale * (light.negative ? -1.0f : 1.0f) / 255)).Array();
    record.origin = light.origin.Array();
    record.name = std::uint32_t(table_.text.size());
    table_.text += light.name.empty() ? light.label : light.name;
    table_.text += '\0';
    if (light.twoSided)
        record.flags |= SHGRID_TWO_SIDED;
    if (light.type == LightType::Area) {
        record.type = SHGRID_POLYGONS;
        record.intensity = light.radiosity;
        record.normal = light.normal.Array();
        record.origin = light.shape.center.Array();
        std::vector<Piece> pieces;
        for (const std::size_t i : members)
            pieces.push_back({{lights_[i].polygon.begin(), lights_[i].polygon.end()},
                              Vec3f(lights_[i].shape.normal),
                              float(lights_[i].shape.dist)});
        JoinPieces(pieces);
        record.firstPolygon = std::uint32_t(table_.polygons.size());
        record.polygonCount = std::uint32_t(pieces.size());
        for (const Piece &piece : pieces)
            AddPolygon(piece, table_);
    } else if (light.type == LightType::Sun) {
        record.type = SHGRID_SUN;
        Vec3f mean;
        for (const std::size_t i : members)
            mean = mean - lights_[i].normal;
        const Vec3f direction = Normalize(mean);
        float sineSquares = 0;
        for (const std::size_t i : members)
            sineSquares += 1 - Dot(direction, -lights_[i].normal) * Dot(direction, -lights_[i].normal);
        // Over a uniform disc of angular radius a the mean of sin^2 of the angle to its center is sin(a)^2 / 2.
        record.spread = std::sqrt(std::max(0.0f, 2 * sineSquares / float(members.size())));
        record.normal = direction.Array();
        record.intensity = light.photons * Length(mean);
    } else {
        record.type = SHGRID_POINT;
        record.intensity = light.photons;
        SetCurve(light, record);
        if (light.type == LightType::Spot)
            SetCone(light, record);
    }
    table_.lights.push_back(record);
}

std::string LightTable::Label(std::uint32_t number) const {
    const GridLight &light = table_.lights[number];
    const std::string name = table_.text.c_str() + light.name;
    return fmt::format("{} of style {} at {:g} {:g} {:g}", name.empty() ? "light" : name, light.style, light.origin[0],
                       light.origin[1], light.origin[2]);
}

bool LightTable::MaySee(std::uint32_t number, int cluster) const {
    return std::ranges::any_of(members_[number], [&](std::size_t i) { return lights_[i].SeenFrom(cluster); });
}

SHFloats LightTable::At(std::uint32_t number, const Vec3f &position) const {
    const float at[3] = {position.x, position.y, position.z};
    const GridLight &light = table_.lights[number];
    shgrid_beam_ beam;
    shgrid_beam_at_(&reader_, number, at, &beam);
    shgrid_coeffs sum{};
    for (std::size_t k = 0; beam.hasSH && k < 9; ++k)
        for (std::size_t channel = 0; channel < 3; ++channel)
            sum.c[k][channel] = beam.sh[k] * light.color[channel];
    float color[3];
    for (std::size_t channel = 0; channel < 3; ++channel)
        color[channel] = light.color[channel] * beam.strength;
    if (beam.strength > 0)
        shgrid_add_direct_(beam.direction, beam.spread, color, &sum);
    return std::bit_cast<SHFloats>(sum);
}

bool LightTable::HasInPlane(std::uint32_t number, const Vec3f &position) const {
    constexpr float kInPlane = 1.0f / 64; // game units
    const GridLight &light = table_.lights[number];
    const auto polygons = std::span(table_.polygons).subspan(light.firstPolygon, light.polygonCount);
    return std::ranges::any_of(polygons, [&](const GridPolygon &polygon) {
        const Vec3f to = Vec3f(polygon.center) - position;
        return std::abs(Dot(Vec3f(polygon.normal), position) - polygon.dist) <= kInPlane &&
               Dot(to, to) < polygon.radius * polygon.radius;
    });
}

Vec3f LightTable::RoughVector(std::uint32_t number, const Vec3f &position) const {
    const GridLight &light = table_.lights[number];
    const float color = MaxAbsComponent(Vec3f(light.color)), at[3] = {position.x, position.y, position.z};
    if (light.type != SHGRID_POLYGONS) {
        shgrid_beam_ beam;
        shgrid_beam_at_(&reader_, number, at, &beam);
        return Vec3f{beam.direction[0], beam.direction[1], beam.direction[2]} * (beam.strength * color);
    }
    // The form factor of a polygon of area A is about h R^2 / (d (d^2 + R^2)), with R^2 = A / pi, d the distance of its
    // center, and h the height of the position over its plane. This is exact far away and on the axis of a disc. It is
    // not on the polygon, where h is 0 and the form factor 1: at positions that near, the vector is exact.
    Vec3f sum;
    for (std::uint32_t i = light.firstPolygon; i < light.firstPolygon + light.polygonCount; ++i) {
        const GridPolygon &polygon = table_.polygons[i];
        const float height = Dot(Vec3f(polygon.normal), position) - polygon.dist;
        if (height <= 0 && !(light.flags & SHGRID_TWO_SIDED))
            continue;
        const Vec3f to = Vec3f(polygon.center) - position;
        const float d2 = Dot(to, to), r2 = polygon.area / std::numbers::pi_v<float>;
        if (d2 < polygon.radius * polygon.radius) {
            shgrid_moments_ m{};
            shgrid_add_polygon_(&reader_, reinterpret_cast<const unsigned char *>(&polygon), at, height < 0, 0, 1, &m);
            sum = sum + Vec3f{float(m.first[0]), float(m.first[1]), float(m.first[2])} / std::numbers::pi_v<float>;
        } else if (d2 > 0)
            sum = sum + to * (r2 * std::abs(height) / (d2 * (d2 + r2)));
    }
    return sum * (light.intensity * color);
}

} // namespace q3
