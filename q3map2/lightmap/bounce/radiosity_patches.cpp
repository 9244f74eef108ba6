// GPL-2.0-or-later. Under -fast: how far bounced light reaches.
#include "q3map2/lightmap/bounce/radiosity_patches.h"

#include "libs/math/winding.h"
#include "q3map2/light/batch/form_factor.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace q3 {

namespace {

/// Longest side of the box of a piece, halved while light varies in it, down to the least. Game units.
constexpr float kPieceSize = 256, kLeastSize = 64;
/// Light varies much if its range times its greatest value exceeds this, in a channel; 1 = byte 255.
constexpr float kVaries = 0.75f;
constexpr float kOnCut = 0.125f; ///< corners this near to a cut count as on it. Game units
constexpr double kMinArea = 1, kMaxArea = 20'000'000;
/// Polygons with a corner farther out than this are in no map. Game units.
constexpr float kMaxCoordinate = 262144;
/// About so many pieces at most come from one polygon.
constexpr double kMaxPieces = 65536;
constexpr float kFlatQuad = 0.1f; ///< a quad's fourth corner this near to the plane of the others keeps it whole
/// Weights of samples of a triangle go from 1 to this.
constexpr int kSteps = 5, kMostSamples = 150;
/// Receivers so near to the plane of a piece see it from that far off. Game units.
constexpr float kPushReach = 8;
/// Near the plane of a piece, what of it lies behind the receiver takes away from what lies before it: wholly up to
/// kPushReach from the plane, not at all from here on. Game units.
constexpr float kLowReach = 16;
/// Receivers so far behind the plane 1 unit before a piece lie behind the piece itself. Game units; some for rounding.
constexpr float kBehind = 1.01f;
/// From so many radii on a piece looks like a point; and one that is brighter by this factor as a point is bright.
constexpr float kFarRadii = 3, kSurely = 4;

FaceCorner Lerp(const FaceCorner &a, const FaceCorner &b, float t) {
    FaceCorner c;
    c.xyz = a.xyz + (b.xyz - a.xyz) * t;
    c.normal = Normalize(a.normal + (b.normal - a.normal) * t);
    for (std::size_t i = 0; i < 2; ++i)
        c.luxel[i] = a.luxel[i] + (b.luxel[i] - a.luxel[i]) * t;
    c.vertex = t < 0.5f ? a.vertex : b.vertex;
    return c;
}

Winding<float> WindingOf(const Face &face) {
    Winding<float> w;
    for (const FaceCorner &corner : face)
        w.push_back(corner.xyz);
    return w;
}

/// Of the part of a convex polygon that is not behind the place.
float FormFactorInFront(const Vec3f &p, const Vec3f &n, std::span<const Vec3f> w) {
    float total = 0;
    Vec3f u = w.back() - p, leaves, enters;
    float before = Dot(n, u);
    for (const Vec3f &corner : w) {
        const Vec3f v = corner - p;
        const float after = Dot(n, v);
        if ((before >= 0) != (after >= 0)) {
            const Vec3f cut = u + (v - u) * (before / (before - after));
            total += before >= 0 ? EdgeTerm(u, cut, n) : EdgeTerm(cut, v, n);
            (before >= 0 ? leaves : enters) = cut;
        } else if (before >= 0) {
            total += EdgeTerm(u, v, n);
        }
        u = v, before = after;
    }
    return (total + EdgeTerm(leaves, enters, n)) / (2 * std::numbers::pi_v<float>);
}

bool HoldsLight(const RawLightmap &raw, std::size_t texel) {
    return std::any_of(raw.radiosity.begin(), raw.radiosity.end(),
                       [&](const auto &slot) { return !slot.empty() && slot[texel].x >= 0; });
}

/// Faces as one light each would take them: quads that are not flat become triangles.
void FlatFaces(Face face, std::vector<Face> &flat) {
    if (face.size() == 4) {
        const Vec3f normal = Normalize(Cross(face[2].xyz - face[0].xyz, face[1].xyz - face[0].xyz));
        if (normal == Vec3f{} || std::abs(Dot(normal, face[3].xyz - face[0].xyz)) >= kFlatQuad) {
            flat.push_back({face[0], face[1], face[2]});
            face = {face[0], face[2], face[3]};
        }
    }
    flat.push_back(std::move(face));
}

} // namespace

/// Cuts the faces of one surface.
struct RadiosityPatches::Maker {
    RadiosityPatches &to;
    const SurfaceInputs &in;
    const SurfaceLight &surfaces;
    const EmitterNumbers &emitters;
    std::span<const Vec3f> emission;
    std::size_t surface = 0;
    bool varies = false;                           ///< its light may vary much
    std::vector<std::uint8_t> surely = {};         ///< texels whose middle is in their piece
    std::vector<std::pair<Face, float>> todo = {}; ///< and the sizes to cut them to

    const RawLightmap *Lightmap() const {
        const int lightmap = surfaces.lightmapOf[surface];
        return lightmap < 0 ? nullptr : &surfaces.lightmaps[std::size_t(lightmap)];
    }
    EmitterId Texel(int x, int y) const { return emitters.Texel(std::size_t(surfaces.lightmapOf[surface]), x, y); }
    void Begin(std::size_t number);
    void Add(Face first);
    bool Varies(const Face &face) const;
    void AddPiece(const Face &face, double area);
    void Mark(const Face &face, std::uint32_t piece, const RawLightmap &raw);
};

void RadiosityPatches::Maker::Begin(std::size_t number) {
    surface = number;
    const auto most = [&](EmitterId first, std::size_t count) {
        float value = 0;
        for (const Vec3f &one : emission.subspan(first, count))
            value = std::max(value, MaxComponent(one));
        return value;
    };
    const bspDrawSurface_t &record = in.bsp.drawSurfaces[number];
    const RawLightmap *raw = Lightmap();
    const float value = raw ? most(Texel(0, 0), std::size_t(raw->width) * std::size_t(raw->height))
                            : most(emitters.Vertex(record.firstVert), std::size_t(record.numVerts));
    const float full = 255 * BounceScale(in, number);
    varies = value * value > kVaries * full * full;
}

void RadiosityPatches::Maker::Add(Face first) {
    for (const FaceCorner &corner : first)
        if (!IsFinite(corner.xyz) || MaxComponent(Max(corner.xyz, -corner.xyz)) > kMaxCoordinate)
            return;
    const Winding<float> whole = WindingOf(first);
    const Boundsf bounds = WindingBounds(whole);
    const float least = float(std::max(double(MaxComponent(bounds.maxs - bounds.mins)) / kMaxPieces,
                                       std::sqrt(2 * WindingArea(whole) / kMaxPieces)));
    const float wanted = in.table[surface].shader->lightSubdivide;
    todo.emplace_back(std::move(first), std::max(wanted > 0 ? wanted : kPieceSize, least));
    while (!todo.empty()) {
        auto [face, size] = std::move(todo.back());
        todo.pop_back();
        const Winding<float> w = WindingOf(face);
        const Boundsf box = WindingBounds(w);
        std::size_t axis = 0;
        while (axis < 3 && !(box.maxs[axis] - box.mins[axis] > size))
            ++axis;
        if (axis < 3) {
            Face front, back;
            CutAcrossAxis(face, axis, box.Center()[axis], kOnCut, Lerp, front, back);
            if (back.size() >= 3)
                todo.emplace_back(std::move(back), size);
            if (front.size() >= 3)
                todo.emplace_back(std::move(front), size);
            continue;
        }
        const double area = WindingArea(w);
        if (!(area >= kMinArea && area <= kMaxArea))
            continue;
        if (varies && size > kLeastSize && Varies(face))
            todo.emplace_back(std::move(face), size / 2);
        else
            AddPiece(face, area);
    }
}

bool RadiosityPatches::Maker::Varies(const Face &face) const {
    Vec3f least{1e30f, 1e30f, 1e30f}, most;
    const auto take = [&](const Vec3f &light) { least = Min(least, light), most = Max(most, light); };
    const RawLightmap *raw = Lightmap();
    if (!raw)
        for (const FaceCorner &corner : face)
            take(emission[emitters.Vertex(corner.vertex)]);
    int samples = 0;
    for (std::size_t v = 1; raw && v + 1 < face.size(); ++v)
        for (int i = 1; i <= kSteps; ++i)
            for (int j = 1; j <= kSteps; ++j)
                for (int k = 1; k <= kSteps && samples < kMostSamples; ++k, ++samples) {
                    const auto texel = [&](std::size_t axis, int size) {
                        const float at = float(i) * face[0].luxel[axis] + float(j) * face[v].luxel[axis] +
                                         float(k) * face[v + 1].luxel[axis];
                        return std::clamp(int(at / float(i + j + k)) / raw->super, 0, size - 1);
                    };
                    const int x = texel(0, raw->width), y = texel(1, raw->height);
                    if (HoldsLight(*raw, raw->Index(x, y)))
                        take(emission[Texel(x, y)]);
                }
    const Vec3f range = (most - least) * most;
    const float full = 255 * BounceScale(in, surface);
    return MaxComponent(range) > kVaries * full * full;
}

void RadiosityPatches::Maker::AddPiece(const Face &face, double area) {
    const ShaderInfo &shader = *in.table[surface].shader;
    Piece piece;
    Vec3f mean;
    for (const FaceCorner &corner : face)
        piece.normal += corner.normal, mean += corner.xyz / float(face.size());
    piece.normal = Normalize(piece.normal);
    if (piece.normal == Vec3f{})
        return;
    const Winding<float> w = WindingOf(face);
    Vec3d center;
    for (std::size_t i = 2; i < w.size(); ++i)
        center += Vec3d(w[0] + w[i - 1] + w[i]) * (WindingArea(Winding<float>{w[0], w[i - 1], w[i]}) / 3);
    piece.center = Vec3f(center / area);
    piece.plane = -Vec3f(WindingAreaVector(w));
    piece.origin = mean + piece.normal;
    piece.dist = Dot(piece.origin, piece.normal);
    // Light of form factor 1 is 255 times what white sends on.
    const float add = 255 * std::abs(BounceScale(in, surface));
    piece.least = shader.noFast ? -2 : in.options.tolerance / add;
    float radius = 0;
    for (const Vec3f &p : w)
        radius = std::max(radius, Length(p - piece.center));
    piece.far = kFarRadii * kFarRadii * radius * radius;
    piece.twoSided = shader.twoSided || (shader.compileFlags & C_FOG) != 0;
    piece.first = std::uint32_t(to.corners_.size()), piece.count = std::uint32_t(w.size());
    const auto number = std::uint32_t(to.pieces_.size());
    to.pieces_.push_back(piece);
    to.corners_.insert(to.corners_.end(), w.begin(), w.end());
    if (const RawLightmap *raw = Lightmap())
        return Mark(face, number, *raw);
    for (const FaceCorner &corner : face)
        if (std::uint32_t &known = to.pieceOf_[emitters.Vertex(corner.vertex)];
            known == kNone || Length(to.pieces_[known].plane) < Length(piece.plane))
            known = number;
}

/// Texels belong to the piece that their middle is in, else to one that their rim may be in.
void RadiosityPatches::Maker::Mark(const Face &face, std::uint32_t piece, const RawLightmap &raw) {
    std::vector<std::array<float, 2>> at;
    std::array<float, 2> least{1e30f, 1e30f}, most{-1e30f, -1e30f};
    for (const FaceCorner &corner : face) {
        at.push_back({corner.luxel[0] / float(raw.super), corner.luxel[1] / float(raw.super)});
        for (std::size_t axis = 0; axis < 2; ++axis)
            least[axis] = std::min(least[axis], at.back()[axis]), most[axis] = std::max(most[axis], at.back()[axis]);
    }
    const auto inside = [&](float x, float y) {
        bool left = false, right = false;
        for (std::size_t i = 0; i < at.size(); ++i) {
            const auto &a = at[i], &b = at[(i + 1) % at.size()];
            const float side = (b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0]);
            left |= side > 0, right |= side < 0;
        }
        return !(left && right);
    };
    const auto whole = [](float value, int size) { return std::clamp(int(value), 0, size - 1); };
    for (int y = whole(least[1], raw.height); y <= whole(most[1], raw.height); ++y)
        for (int x = whole(least[0], raw.width); x <= whole(most[0], raw.width); ++x) {
            const EmitterId texel = Texel(x, y);
            const bool middle = surely[texel] == 0 && inside(float(x) + 0.5f, float(y) + 0.5f);
            if (middle || to.pieceOf_[texel] == kNone)
                to.pieceOf_[texel] = piece;
            surely[texel] |= std::uint8_t(middle);
        }
}

RadiosityPatches::RadiosityPatches(const SurfaceInputs &in, const SurfaceLight &surfaces,
                                   const EmitterNumbers &emitters, std::span<const Vec3f> emission)
    : pieceOf_(emitters.Count(), kNone) {
    Maker maker{*this, in, surfaces, emitters, emission};
    maker.surely.resize(emitters.Count());
    std::vector<Face> flat;
    for (std::size_t i = 0; i < in.bsp.drawSurfaces.size(); ++i) {
        if (!MeetsBounces(in, i) || !(in.table[i].shader->bounceScale > 0))
            continue;
        maker.Begin(i);
        flat.clear();
        for (Face &face : FacesOf(in, surfaces, i))
            FlatFaces(std::move(face), flat);
        for (Face &face : flat)
            maker.Add(std::move(face));
    }
}

float RadiosityPatches::ShareOf(const Piece &piece, const Vec3f &place, const Vec3f &normal, bool twoSided) const {
    const float over = Dot(place, piece.normal) - piece.dist;
    if ((!piece.twoSided && over < -kBehind) || (!twoSided && Dot(piece.origin - place, normal) < 0))
        return 0;
    const float height = std::abs(over);
    const Vec3f p = height < kPushReach ? place + piece.normal * (kPushReach - over) : place;
    const Vec3f way = piece.center - p;
    const float distance2 = Dot(way, way), ahead = Dot(normal, way);
    const bool anySide = piece.twoSided || twoSided;
    const auto enough = [&](float factor, float least) { return (anySide ? std::abs(factor) : factor) > least; };
    const float asPoint = -ahead * Dot(piece.plane, way);
    const float least = piece.least * std::numbers::pi_v<float> * distance2 * distance2;
    // Nothing of a piece whose ball lies before the receiver is behind it.
    const bool parted = height < kLowReach && !(ahead > 0 && kFarRadii * kFarRadii * ahead * ahead > piece.far);
    if (distance2 > piece.far || (!parted && asPoint > kSurely * least))
        return enough(asPoint, least) ? 1 : 0;
    const auto corners = std::span(corners_).subspan(piece.first, piece.count);
    const float whole = FormFactor(p, normal, corners);
    if (!enough(whole, piece.least))
        return 0;
    if (!parted)
        return 1;
    const float front = FormFactorInFront(p, normal, corners);
    const float left = front != 0 ? std::clamp(whole / front, 0.0f, 1.0f) : 0;
    const float low = std::min(1.0f, (kLowReach - height) / (kLowReach - kPushReach));
    return 1 - (1 - left) * low;
}

} // namespace q3
