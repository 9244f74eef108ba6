// GPL-2.0-or-later. Curved surfaces as meshes.
#include "q3map2/light/light_patch.h"

#include <algorithm>

namespace q3 {

namespace {

/// Curves up to 8 * 16 * 2^n game units long are halved n times, longer ones three times.
constexpr float kCurveUnit = 8 * 16;
constexpr int kMaxHalvings = 3;
constexpr int kMaxMeshSize = 128;
/// A row or column closer than this to the line through its neighbours is dropped. Game units.
constexpr float kFlat = 0.1f;

MeshVert Middle(const MeshVert &a, const MeshVert &b) {
    const Vec3f normal = Normalize(a.normal + b.normal);
    return {(a.xyz + b.xyz) * 0.5f,
            normal == Vec3f{} ? a.normal : normal,
            {(a.st[0] + b.st[0]) * 0.5f, (a.st[1] + b.st[1]) * 0.5f}};
}

Mesh Transposed(const Mesh &mesh) {
    Mesh result{mesh.height, mesh.width, {}};
    result.verts.reserve(mesh.verts.size());
    for (int x = 0; x < mesh.width; ++x)
        for (int y = 0; y < mesh.height; ++y)
            result.verts.push_back(mesh.At(x, y));
    return result;
}

/// Every three columns a, b, c become a, ab, m, bc, c.
Mesh HalvedColumns(const Mesh &mesh) {
    const int spans = (mesh.width - 1) / 2;
    const int split = std::clamp((kMaxMeshSize - 1 - mesh.width) / 2 + 1, 0, spans);
    Mesh result{mesh.width + 2 * split, mesh.height, {}};
    for (int y = 0; y < mesh.height; ++y) {
        result.verts.push_back(mesh.At(0, y));
        for (int span = 0; span < spans; ++span) {
            const MeshVert &a = mesh.At(2 * span, y), &b = mesh.At(2 * span + 1, y), &c = mesh.At(2 * span + 2, y);
            if (span < split) {
                const MeshVert ab = Middle(a, b), bc = Middle(b, c);
                result.verts.insert(result.verts.end(), {ab, Middle(ab, bc), bc, c});
            } else
                result.verts.insert(result.verts.end(), {b, c});
        }
    }
    return result;
}

/// Moves the odd columns from control points onto the curve.
void PutOnCurve(Mesh &mesh) {
    for (int y = 0; y < mesh.height; ++y)
        for (int x = 1; x + 1 < mesh.width; x += 2) {
            MeshVert &v = mesh.verts[std::size_t(y) * std::size_t(mesh.width) + std::size_t(x)];
            const MeshVert a = mesh.At(x - 1, y), c = mesh.At(x + 1, y);
            v.xyz = (a.xyz + v.xyz * 2 + c.xyz) * 0.25f;
            for (std::size_t i = 0; i < 2; ++i)
                v.st[i] = (a.st[i] + 2 * v.st[i] + c.st[i]) * 0.25f;
        }
}

bool NearLine(const Vec3f &p, const Vec3f &a, const Vec3f &b) {
    const Vec3f direction = Normalize(b - a);
    const Vec3f off = (p - a) - direction * Dot(p - a, direction);
    return Length(off) < kFlat;
}

Mesh WithoutFlatColumns(const Mesh &mesh) {
    std::vector<int> kept{0};
    for (int x = 1; x + 1 < mesh.width; ++x) {
        bool flat = true;
        for (int y = 0; y < mesh.height && flat; ++y)
            flat = NearLine(mesh.At(x, y).xyz, mesh.At(kept.back(), y).xyz, mesh.At(x + 1, y).xyz);
        if (!flat)
            kept.push_back(x);
    }
    kept.push_back(mesh.width - 1);
    Mesh result{int(kept.size()), mesh.height, {}};
    for (int y = 0; y < mesh.height; ++y)
        for (const int x : kept)
            result.verts.push_back(mesh.At(x, y));
    return result;
}

} // namespace

Mesh TessellatePatch(const Bsp &bsp, const bspDrawSurface_t &surface, float longestCurve) {
    Mesh mesh{surface.patchWidth, surface.patchHeight, {}};
    for (int i = 0; i < surface.numVerts; ++i) {
        const bspDrawVert_t &v = bsp.drawVerts[std::size_t(surface.firstVert + i)];
        mesh.verts.push_back({Vec3f(v.xyz), Vec3f(v.normal), v.st});
    }
    int halvings = 0;
    while (halvings < kMaxHalvings && kCurveUnit * float(1 << halvings) < longestCurve)
        ++halvings;
    for (int i = 0; i < halvings; ++i)
        mesh = Transposed(HalvedColumns(Transposed(HalvedColumns(mesh))));
    PutOnCurve(mesh);
    mesh = Transposed(mesh);
    PutOnCurve(mesh);
    mesh = Transposed(mesh);
    return Transposed(WithoutFlatColumns(Transposed(WithoutFlatColumns(mesh))));
}

float LongestCurve(const Bsp &bsp, const bspDrawSurface_t &surface) {
    const auto control = [&](int x, int y) {
        return Vec3f(bsp.drawVerts[std::size_t(surface.firstVert + y * surface.patchWidth + x)].xyz);
    };
    const auto curve = [](const Vec3f &a, const Vec3f &b, const Vec3f &c) {
        const float ab = Length(b - a), bc = Length(c - b), ac = Length(c - a);
        if (ab < 0.125f || bc < 0.125f || ac < 0.125f)
            return 0.0f;
        const Vec3f nab = (b - a) / ab;
        if (Dot(nab, (c - b) / bc) > 0.99f && Dot(nab, (c - a) / ac) > 0.99f)
            return 0.0f;
        return ab + 0.875f * Length((c - b) - (b - a));
    };
    float longest = 0;
    for (int y = 0; y + 2 < surface.patchHeight; y += 2)
        for (int x = 0; x + 2 < surface.patchWidth; x += 2) {
            longest = std::max(longest, curve(control(x, y), control(x + 1, y), control(x + 2, y)));
            longest = std::max(longest, curve(control(x, y), control(x, y + 1), control(x, y + 2)));
        }
    return longest;
}

std::array<MeshVert, 4> MeshQuad(const Mesh &mesh, int x, int y) {
    const MeshVert &a = mesh.At(x, y), &b = mesh.At(x, y + 1), &c = mesh.At(x + 1, y + 1), &d = mesh.At(x + 1, y);
    return (x + y) % 2 == 0 ? std::array{a, b, c, d} : std::array{b, c, d, a};
}

} // namespace q3
