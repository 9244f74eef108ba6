// GPL-2.0-or-later. The brightest emitters as patches of a light tree.
#include "q3map2/lightmap/bounce/bright_patches.h"

#include "q3map2/lightmap/raw/luxel_raster.h"

#include <algorithm>
#include <cmath>

namespace q3 {

namespace {

/// Texels are cut into this many pieces on each axis.
constexpr int kPieces = 2;
/// Triangles with less than half this area in their lightmap make no patches. Square pieces.
constexpr float kMinLuxelArea = 1e-6f;

float TwiceArea(const LuxelTriangle &t) {
    return (t[1][0] - t[0][0]) * (t[2][1] - t[0][1]) - (t[2][0] - t[0][0]) * (t[1][1] - t[0][1]);
}

/// The part of a triangle inside the square piece (x, y); in units of pieces.
Winding<float> ClippedToPiece(const LuxelTriangle &triangle, int x, int y) {
    Winding<float> clipped, rest;
    for (const auto &corner : triangle)
        clipped.push_back({corner[0], corner[1], 0});
    WindingCutter<float> cutter;
    const auto cut = [&](const Vec3f &normal, float dist) {
        if (clipped.empty())
            return;
        cutter.Classify(clipped, normal, dist, 0);
        cutter.Back(clipped, rest);
        clipped.swap(rest);
    };
    cut({1, 0, 0}, float(x + 1)), cut({-1, 0, 0}, float(-x));
    cut({0, 1, 0}, float(y + 1)), cut({0, -1, 0}, float(-y));
    return clipped;
}

/// Area and centroid of a polygon in the plane z = 0.
std::pair<float, Vec3f> AreaAndCentroid(const Winding<float> &w) {
    float area = 0;
    Vec3f sum;
    for (std::size_t i = 2; i < w.size(); ++i) {
        const float part = std::abs(Cross(w[i - 1] - w[0], w[i] - w[0]).z) / 2;
        area += part;
        sum += (w[0] + w[i - 1] + w[i]) * (part / 3);
    }
    return {area, area > 0 ? sum / area : sum};
}

/// A triangle of a face; `normal` points to the front.
struct FaceTriangle {
    std::array<FaceCorner, 3> corners;
    Vec3f normal;   ///< unit
    float area = 0; ///< square game units
    Vec3f At(float u, float v) const { return corners[0].xyz * (1 - u - v) + corners[1].xyz * u + corners[2].xyz * v; }
};

template <typename Use> void ForTriangles(const Face &face, const Use &use) {
    Vec3f front;
    for (const FaceCorner &corner : face)
        front += corner.normal;
    for (std::size_t i = 2; i < face.size(); ++i) {
        FaceTriangle triangle{{face[0], face[i - 1], face[i]}, {}, 0};
        const Vec3f cross = Cross(face[i].xyz - face[0].xyz, face[i - 1].xyz - face[0].xyz);
        triangle.area = Length(cross) / 2;
        if (!(triangle.area > 0))
            continue;
        triangle.normal = Normalize(Dot(cross, front) < 0 ? -cross : cross);
        use(triangle);
    }
}

/// Collects the pieces of the texels of a raw lightmap.
class LightmapPieces {
  public:
    LightmapPieces(const RawLightmap &raw, EmitterId first, std::span<const Vec3f> excess)
        : raw_(raw), first_(first), excess_(excess), width_(raw.width * kPieces), height_(raw.height * kPieces),
          pieces_(std::size_t(width_) * std::size_t(height_)) {}

    void Add(const FaceTriangle &triangle, bool twoSided) {
        LuxelTriangle inPieces;
        for (std::size_t i = 0; i < 3; ++i)
            for (std::size_t axis = 0; axis < 2; ++axis)
                inPieces[i][axis] = triangle.corners[i].luxel[axis] * float(kPieces) / float(raw_.super);
        const float twice = TwiceArea(inPieces);
        if (std::abs(twice) < kMinLuxelArea)
            return;
        ForCoveredLuxels(inPieces, width_, height_, [&](int x, int y) {
            if (Excess(x, y) == Vec3f{})
                return;
            const auto [area, center] = AreaAndCentroid(ClippedToPiece(inPieces, x, y));
            if (!(area > 0))
                return;
            const std::array<float, 2> at{center.x, center.y};
            const float u = TwiceArea({inPieces[0], at, inPieces[2]}) / twice,
                        v = TwiceArea({inPieces[0], inPieces[1], at}) / twice;
            Piece &piece = pieces_[std::size_t(y) * std::size_t(width_) + std::size_t(x)];
            const float world = area * triangle.area / (std::abs(twice) / 2);
            piece.area += world;
            piece.center += triangle.At(u, v) * world;
            piece.normal += triangle.normal * world;
            piece.twoSided = piece.twoSided || twoSided;
        });
    }
    void Append(std::vector<BrightPatch> &patches) const {
        for (int y = 0; y < height_; ++y)
            for (int x = 0; x < width_; ++x) {
                const Piece &piece = pieces_[std::size_t(y) * std::size_t(width_) + std::size_t(x)];
                const Vec3f normal = Normalize(piece.normal);
                if (!(piece.area > 0) || normal == Vec3f{})
                    continue;
                const int half = raw_.super / 2, tx = x / kPieces, ty = y / kPieces;
                const int code = raw_.luxelClusters[raw_.SuperIndex(tx * raw_.super + half, ty * raw_.super + half)];
                patches.push_back({piece.center / piece.area, normal, piece.area, Excess(x, y),
                                   first_ + EmitterId(raw_.Index(tx, ty)), code >= 0 ? code : BrightPatch::kNoCluster,
                                   piece.twoSided});
            }
    }

  private:
    struct Piece {
        Vec3f center, normal; // times area
        float area = 0;
        bool twoSided = false;
    };
    const Vec3f &Excess(int x, int y) const { return excess_[first_ + raw_.Index(x / kPieces, y / kPieces)]; }

    const RawLightmap &raw_;
    EmitterId first_;
    std::span<const Vec3f> excess_;
    int width_, height_;
    std::vector<Piece> pieces_;
};

/// Appends a patch for each corner of a triangle whose vertex has excess: the part of the triangle nearest to it.
void AppendVertexPatches(const FaceTriangle &triangle, bool twoSided, const EmitterIndex &emitters,
                         std::span<const Vec3f> excess, std::vector<BrightPatch> &patches) {
    constexpr float kOwn = 11.0f / 18, kOther = 7.0f / 36; // barycentric coordinates of the centroid of such a part
    for (std::size_t i = 0; i < 3; ++i) {
        const EmitterId emitter = emitters.Vertex(triangle.corners[i].vertex);
        if (excess[emitter] == Vec3f{})
            continue;
        const Vec3f center = triangle.corners[i].xyz * kOwn + triangle.corners[(i + 1) % 3].xyz * kOther +
                             triangle.corners[(i + 2) % 3].xyz * kOther;
        patches.push_back(
            {center, triangle.normal, triangle.area / 3, excess[emitter], emitter, BrightPatch::kNoCluster, twoSided});
    }
}

} // namespace

std::vector<BrightPatch> MakeBrightPatches(const SurfaceInputs &in, const SurfaceLight &surfaces,
                                           const EmitterIndex &emitters, std::span<const Vec3f> excess) {
    const auto anyIn = [&](EmitterId first, std::size_t count) {
        return std::any_of(excess.begin() + first, excess.begin() + first + std::ptrdiff_t(count),
                           [](const Vec3f &one) { return one != Vec3f{}; });
    };
    std::vector<BrightPatch> patches;
    for (std::size_t i = 0; i < surfaces.lightmaps.size(); ++i) {
        const RawLightmap &raw = surfaces.lightmaps[i];
        const EmitterId first = emitters.FirstOf(i);
        if (!anyIn(first, std::size_t(raw.width) * std::size_t(raw.height)))
            continue;
        LightmapPieces pieces(raw, first, excess);
        for (const int surface : raw.surfaces)
            if (IsInBounceScene(in, std::size_t(surface)))
                for (const Face &face : FacesOf(in, surfaces, std::size_t(surface)))
                    ForTriangles(face, [&](const FaceTriangle &triangle) {
                        pieces.Add(triangle, in.table[std::size_t(surface)].shader->twoSided);
                    });
        pieces.Append(patches);
    }
    for (std::size_t i = 0; i < in.bsp.drawSurfaces.size(); ++i) {
        const bspDrawSurface_t &surface = in.bsp.drawSurfaces[i];
        if (surfaces.lightmapOf[i] >= 0 || surface.numVerts == 0 || !IsInBounceScene(in, i) ||
            !anyIn(emitters.Vertex(surface.firstVert), std::size_t(surface.numVerts)))
            continue;
        for (const Face &face : FacesOf(in, surfaces, i))
            ForTriangles(face, [&](const FaceTriangle &triangle) {
                AppendVertexPatches(triangle, in.table[i].shader->twoSided, emitters, excess, patches);
            });
    }
    return patches;
}

} // namespace q3
