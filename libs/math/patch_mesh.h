// GPL-2.0-or-later. Curved surfaces as meshes.
#pragma once

#include "libs/math/vec.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace q3 {

struct MeshVert {
    Vec3f xyz, normal;
    std::array<float, 2> st{};
};

/// Rows of `width` vertices, `height` of them. A vertex has xyz, normal, st and perhaps lightmap coordinates `luxel`
/// and a color in bytes `color`.
template <typename Vert> struct MeshOf {
    int width = 0, height = 0;
    std::vector<Vert> verts;
    const Vert &At(int x, int y) const { return verts[std::size_t(y) * std::size_t(width) + std::size_t(x)]; }
};
using Mesh = MeshOf<MeshVert>;

/// The vertex between two: the mean of all attributes, with the normal renormalized.
template <typename Vert> Vert HalfwayVert(const Vert &a, const Vert &b) {
    Vert middle = a;
    middle.xyz = (a.xyz + b.xyz) * 0.5f;
    const Vec3f normal = Normalize(a.normal + b.normal);
    middle.normal = normal == Vec3f{} ? a.normal : normal;
    for (std::size_t i = 0; i < 2; ++i) {
        middle.st[i] = (a.st[i] + b.st[i]) * 0.5f;
        if constexpr (requires { a.luxel; })
            middle.luxel[i] = (a.luxel[i] + b.luxel[i]) * 0.5f;
    }
    if constexpr (requires { a.color; })
        for (std::size_t i = 0; i < a.color.size(); ++i)
            middle.color[i] = std::uint8_t((a.color[i] + b.color[i]) / 2);
    return middle;
}

/// What decides how often the curve with these control points is halved, as in NetRadiant's q3map2: |b - a| +
/// 7/8 |c - 2b + a|, a bound of half its speed |(b - a) + t (c - 2b + a)| at t = 7/8. Game units. 0 for a curve that is
/// nearly straight or a point, which needs none.
float HalvingMeasure(const Vec3f &a, const Vec3f &b, const Vec3f &c);

/// The largest HalvingMeasure of the curves in a patch of width x height control points, game units.
template <typename Vert> float LargestHalvingMeasure(int width, int height, const Vert *verts) {
    const auto at = [&](int x, int y) {
        return Vec3f(verts[std::size_t(y) * std::size_t(width) + std::size_t(x)].xyz);
    };
    float longest = 0;
    for (int y = 0; y + 2 < height; y += 2)
        for (int x = 0; x + 2 < width; x += 2) {
            longest = std::max(longest, HalvingMeasure(at(x, y), at(x + 1, y), at(x + 2, y)));
            longest = std::max(longest, HalvingMeasure(at(x, y), at(x, y + 1), at(x, y + 2)));
        }
    return longest;
}

/// Steps of Tessellated.
namespace patch {

/// q3map2's default of `subdivisions`; larger numbers give coarser meshes.
inline constexpr int kSubdivisions = 8;
/// How often the curves of a patch are halved: n times if HalvingMeasure is at most subdivisions * 16 * 2^n game units,
/// at most 3 times.
int Halvings(float halvingMeasure, int subdivisions = kSubdivisions);
/// How many of `spans` curves along an axis of `size` points are halved before the mesh gets too large.
int SpansToHalve(int size, int spans);
/// Whether p is so close to the line through a and b that the mesh leaves it out.
bool NearLine(const Vec3f &p, const Vec3f &a, const Vec3f &b);

/// The mesh with rows and columns swapped.
template <typename Vert> MeshOf<Vert> Transposed(const MeshOf<Vert> &mesh) {
    MeshOf<Vert> result{mesh.height, mesh.width, {}};
    result.verts.reserve(mesh.verts.size());
    for (int x = 0; x < mesh.width; ++x)
        for (int y = 0; y < mesh.height; ++y)
            result.verts.push_back(mesh.At(x, y));
    return result;
}

/// Halves curves: every three columns a, b, c become a, ab, m, bc, c with midpoints ab, bc and m of ab and bc.
template <typename Vert> MeshOf<Vert> HalvedColumns(const MeshOf<Vert> &mesh) {
    const int spans = (mesh.width - 1) / 2, split = SpansToHalve(mesh.width, spans);
    MeshOf<Vert> result{mesh.width + 2 * split, mesh.height, {}};
    for (int y = 0; y < mesh.height; ++y) {
        result.verts.push_back(mesh.At(0, y));
        for (int span = 0; span < spans; ++span) {
            const Vert &a = mesh.At(2 * span, y), &b = mesh.At(2 * span + 1, y), &c = mesh.At(2 * span + 2, y);
            if (span < split) {
                const Vert ab = HalfwayVert(a, b), bc = HalfwayVert(b, c);
                result.verts.insert(result.verts.end(), {ab, HalfwayVert(ab, bc), bc, c});
            } else
                result.verts.insert(result.verts.end(), {b, c});
        }
    }
    return result;
}

/// Moves the odd columns from control points onto the curve, to its middle (a + 2b + c) / 4.
template <typename Vert> void PutOnCurve(MeshOf<Vert> &mesh) {
    for (int y = 0; y < mesh.height; ++y)
        for (int x = 1; x + 1 < mesh.width; x += 2) {
            Vert &v = mesh.verts[std::size_t(y) * std::size_t(mesh.width) + std::size_t(x)];
            const Vert &a = mesh.At(x - 1, y), &c = mesh.At(x + 1, y);
            v.xyz = (a.xyz + v.xyz * 2 + c.xyz) * 0.25f;
            for (std::size_t i = 0; i < 2; ++i) {
                v.st[i] = (a.st[i] + 2 * v.st[i] + c.st[i]) * 0.25f;
                if constexpr (requires { v.luxel; })
                    v.luxel[i] = (a.luxel[i] + 2 * v.luxel[i] + c.luxel[i]) * 0.25f;
            }
            if constexpr (requires { v.color; })
                for (std::size_t i = 0; i < v.color.size(); ++i)
                    v.color[i] = std::uint8_t((a.color[i] + 2 * v.color[i] + c.color[i]) / 4);
        }
}

/// The mesh without inner columns that are, in all rows, NearLine between the column kept before and the next one.
template <typename Vert> MeshOf<Vert> WithoutFlatColumns(const MeshOf<Vert> &mesh) {
    std::vector<int> kept{0};
    for (int x = 1; x + 1 < mesh.width; ++x) {
        bool flat = true;
        for (int y = 0; y < mesh.height && flat; ++y)
            flat = NearLine(mesh.At(x, y).xyz, mesh.At(kept.back(), y).xyz, mesh.At(x + 1, y).xyz);
        if (!flat)
            kept.push_back(x);
    }
    kept.push_back(mesh.width - 1);
    MeshOf<Vert> result{int(kept.size()), mesh.height, {}};
    for (int y = 0; y < mesh.height; ++y)
        for (const int x : kept)
            result.verts.push_back(mesh.At(x, y));
    return result;
}

} // namespace patch

/// Moves control points that are off the curve onto it.
template <typename Vert> MeshOf<Vert> OnCurve(MeshOf<Vert> mesh) {
    patch::PutOnCurve(mesh);
    mesh = patch::Transposed(mesh);
    patch::PutOnCurve(mesh);
    return patch::Transposed(mesh);
}

/// The mesh that casts and receives light for these control points; halvingMeasure (game units) sets its resolution.
template <typename Vert>
MeshOf<Vert> Tessellated(MeshOf<Vert> mesh, float halvingMeasure, int subdivisions = patch::kSubdivisions) {
    for (int i = patch::Halvings(halvingMeasure, subdivisions); i > 0; --i)
        mesh = patch::Transposed(patch::HalvedColumns(patch::Transposed(patch::HalvedColumns(mesh))));
    mesh = OnCurve(std::move(mesh));
    return patch::Transposed(patch::WithoutFlatColumns(patch::Transposed(patch::WithoutFlatColumns(mesh))));
}

/// Corners of the quad at (x, y), clockwise seen from the front, starting so that its triangles are (0, 1, 2) and (0,
/// 2, 3).
template <typename Vert> std::array<Vert, 4> MeshQuad(const MeshOf<Vert> &mesh, int x, int y) {
    const Vert &a = mesh.At(x, y), &b = mesh.At(x, y + 1), &c = mesh.At(x + 1, y + 1), &d = mesh.At(x + 1, y);
    return (x + y) % 2 == 0 ? std::array{a, b, c, d} : std::array{b, c, d, a};
}

} // namespace q3
