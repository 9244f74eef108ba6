// GPL-2.0-or-later. Normals and tangents of luxels: normal maps, texture axes, debug colors.
#include "q3map2/lightmap/raw/luxel_normal.h"

#include "libs/math/rnm_basis.h"
#include "q3map2/lightmap/raw/luxel_raster.h"

#include <algorithm>
#include <cmath>

namespace q3 {

// ---- Normal mapping: q3map_normalImage, q3map_ssbumpImage ----

namespace {

/// Index of the texel that is nearest to a texture coordinate, if texel k is at k / size; the texture repeats.
int NearestTexel(float coordinate, int size) {
    const float fraction = coordinate - std::floor(coordinate);
    return std::isfinite(fraction) ? int(float(size) * fraction + 0.5f) % size : 0;
}

} // namespace

NormalMap::NormalMap(const NormalImage &normals, const SurfaceVertex &a, const SurfaceVertex &b, const SurfaceVertex &c)
    : image_(normals.image.get()), ssbump_(normals.ssbump) {
    if (const auto axes = TangentAxesOf(a, b, c))
        s_ = axes->s, t_ = axes->t;
    else
        image_ = nullptr;
}

Vec3f NormalMap::Perturbed(const SurfaceVertex &v) const {
    const auto texel = image_->Texel(NearestTexel(v.st[0], image_->width), NearestTexel(v.st[1], image_->height));
    Vec3f perturbed;
    if (ssbump_) {
        Vec3f sum;
        for (std::size_t i = 0; i < kRnmBasis.size(); ++i)
            sum += kRnmBasis[i] * float(texel[i]);
        perturbed = s_ * sum.x + t_ * sum.y + v.normal * sum.z;
    } else {
        // NetRadiant's q3map2 decodes byte 127 as 0, so components are -127 / 127.5 to 128 / 127.5.
        const auto component = [](std::uint8_t byte) { return (float(byte) - 127) / 127.5f; };
        perturbed = v.normal + s_ * component(texel[0]) + t_ * component(texel[1]) + v.normal * component(texel[2]);
    }
    perturbed = Normalize(perturbed);
    return perturbed == Vec3f{} ? v.normal : perturbed;
}

// ---- Tangents of luxels from texture coordinates ----

namespace {

/// Calls triangle(a, b, c) for each triangle of a surface; curves are tessellated.
template <typename Triangle>
void ForTriangles(const SurfaceInputs &in, const SurfaceLight &surfaces, int number, const Triangle &triangle) {
    const bspDrawSurface_t &surface = in.bsp.drawSurfaces[std::size_t(number)];
    const auto first = surfaces.verts.begin() + surface.firstVert;
    if (surface.surfaceType == MST_PATCH) {
        MeshOf<SurfaceVertex> mesh{surface.patchWidth, surface.patchHeight, {first, first + surface.numVerts}};
        mesh = Tessellated(std::move(mesh), in.table[std::size_t(number)].longestCurve);
        for (int y = 0; y + 1 < mesh.height; ++y)
            for (int x = 0; x + 1 < mesh.width; ++x) {
                const auto quad = MeshQuad(mesh, x, y);
                triangle(quad[0], quad[1], quad[2]);
                triangle(quad[0], quad[2], quad[3]);
            }
        return;
    }
    for (int i = 0; i + 2 < surface.numIndexes; i += 3) {
        const int *corner = in.bsp.drawIndexes.data() + surface.firstIndex + i;
        triangle(first[corner[0]], first[corner[1]], first[corner[2]]);
    }
}

/// Tangents of the luxels of one raw lightmap.
class TangentFinder {
  public:
    TangentFinder(const SurfaceInputs &in, const SurfaceLight &surfaces, RawLightmap &raw)
        : in_(in), surfaces_(surfaces), raw_(raw), known_(raw.luxelClusters.size()), s_(known_.size()),
          handedness_(known_.size()) {}

    void Run() {
        for (const int number : raw_.surfaces)
            ForTriangles(in_, surfaces_, number, [&](const auto &a, const auto &b, const auto &c) { Add(a, b, c); });
        for (std::size_t luxel = 0; luxel < known_.size(); ++luxel)
            known_[luxel] = s_[luxel] != Vec3f{};
        while (GrowByRing()) {
        }
        raw_.tangents.resize(known_.size());
        for (std::size_t luxel = 0; luxel < known_.size(); ++luxel)
            raw_.tangents[luxel] = {Normalize(s_[luxel]), handedness_[luxel] < 0 ? -1.0f : 1.0f};
    }

  private:
    void Add(const SurfaceVertex &a, const SurfaceVertex &b, const SurfaceVertex &c) {
        const auto axes = TangentAxesOf(a, b, c);
        if (!axes)
            return;
        const float side = Dot(Cross(axes->s, axes->t), a.normal + b.normal + c.normal) < 0 ? -1.0f : 1.0f;
        ForCoveredLuxels({a.luxel, b.luxel, c.luxel}, raw_.SuperWidth(), raw_.SuperHeight(), [&](int x, int y) {
            const std::size_t luxel = raw_.SuperIndex(x, y);
            s_[luxel] += axes->s, handedness_[luxel] += side;
        });
    }

    /// Gives mapped luxels next to known ones the mean tangent of these. False: no luxel was added.
    bool GrowByRing() {
        std::vector<std::size_t> grown;
        for (int y = 0; y < raw_.SuperHeight(); ++y)
            for (int x = 0; x < raw_.SuperWidth(); ++x)
                if (const std::size_t luxel = raw_.SuperIndex(x, y);
                    !known_[luxel] && raw_.Mapped(luxel) && TakeMean(luxel, x, y))
                    grown.push_back(luxel);
        for (const std::size_t luxel : grown)
            known_[luxel] = true;
        return !grown.empty();
    }

    bool TakeMean(std::size_t luxel, int x, int y) {
        bool any = false;
        ForNeighborhood(x, y, raw_.SuperWidth(), raw_.SuperHeight(), [&](int nx, int ny) {
            if (const std::size_t neighbor = raw_.SuperIndex(nx, ny); known_[neighbor]) {
                s_[luxel] += Normalize(s_[neighbor]), handedness_[luxel] += handedness_[neighbor];
                any = true;
            }
        });
        return any;
    }

    const SurfaceInputs &in_;
    const SurfaceLight &surfaces_;
    RawLightmap &raw_;
    std::vector<bool> known_;       // by luxel
    std::vector<Vec3f> s_;          // by luxel: sum of TangentAxes::s of the triangles
    std::vector<float> handedness_; // by luxel: sum of LuxelTangent::side of the triangles
};

} // namespace

void FindTangents(const SurfaceInputs &in, SurfaceLight &surfaces) {
    in.jobs.For(std::int64_t(surfaces.lightmaps.size()), [&](std::int64_t i, int) {
        if (RawLightmap &raw = surfaces.lightmaps[std::size_t(i)]; raw.channels.basis)
            TangentFinder(in, surfaces, raw).Run();
    });
}

} // namespace q3
