// GPL-2.0-or-later. Last changes to vertices before they are written.
#include "q3map2/geometry/emit/emit_modify.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace q3 {

namespace {

constexpr double kVolumeSlack = 1; // game units outside a color volume that still count as inside

/// The factor by which a dot-product step scales a color; 1 for other steps.
float Facing(const ColorStep &step, const Vec3f &normal) {
    using enum ColorStep::Kind;
    const float d = Dot(normal, step.value);
    const float range = step.max - step.min;
    switch (step.kind) {
    case DotProduct:
        return d;
    case DotProductScale:
        return (d - step.min) / range;
    case DotProduct2:
        return d * d;
    case DotProduct2Scale:
        return (d * d - step.min) / range;
    default:
        return 1;
    }
}

void ApplyStep(const ColorStep &step, DrawVert &vert) {
    using enum ColorStep::Kind;
    constexpr float kFull = 255;
    const float facing = Facing(step, vert.normal);
    for (std::size_t channel = step.alpha ? 3 : 0; channel < (step.alpha ? 4u : 3u); ++channel) {
        const float argument = step.alpha ? step.value.x : step.value[channel];
        float value = vert.color[channel];
        if (step.kind == Set)
            value = kFull * argument;
        else
            value *= step.kind == Scale ? argument : facing;
        vert.color[channel] = std::uint8_t(std::clamp(value, 0.0f, kFull));
    }
}

bool Inside(const Brush &brush, const Vec3f &p, const PlaneTable &planes) {
    return std::all_of(brush.sides.begin(), brush.sides.end(), [&](const BrushSide &side) {
        return side.planeNum < 0 || planes[side.planeNum].Distance(Vec3d(p)) <= kVolumeSlack;
    });
}

void ApplyVolumes(DrawSurface &surface, const MapEntity &owner, const PlaneTable &planes) {
    if (owner.colorVolumes.empty())
        return;
    Boundsf bounds;
    for (const DrawVert &vert : surface.verts)
        bounds.Add(vert.xyz);
    for (const Brush &volume : owner.colorVolumes) {
        const bool applies = volume.settings.entity == 0 || volume.settings.entity == surface.settings.entity;
        if (!applies || !volume.contentShader || !volume.bounds.Touches(bounds, float(kVolumeSlack)))
            continue;
        const std::vector<ColorStep> &steps = volume.contentShader->geometry.colorSteps;
        for (DrawVert &vert : surface.verts)
            if (Inside(volume, vert.xyz, planes))
                for (const ColorStep &step : steps)
                    if (step.kind != ColorStep::Kind::Volume)
                        ApplyStep(step, vert);
    }
}

} // namespace

void ModifySurface(DrawSurface &surface, const MapEntity &entity, const MapEntity &world, const PlaneTable &planes) {
    const GeometryDirectives &shader = surface.shader->geometry;
    const auto &m = shader.texMod;
    for (DrawVert &vert : surface.verts) {
        const float s = vert.st[0], t = vert.st[1];
        vert.st = {m[0][0] * s + m[0][1] * t + m[0][2], m[1][0] * s + m[1][1] * t + m[1][2]};
        if (!shader.IsColorVolume())
            for (const ColorStep &step : shader.colorSteps)
                ApplyStep(step, vert);
    }
    ApplyVolumes(surface, world, planes);
    if (&entity != &world)
        ApplyVolumes(surface, entity, planes);
}

void BiasTexture(DrawSurface &surface) {
    if (surface.shader->geometry.globalTexture || surface.verts.empty())
        return;
    for (std::size_t axis = 0; axis < 2; ++axis) {
        float least = std::numeric_limits<float>::max(), most = std::numeric_limits<float>::lowest();
        for (const DrawVert &vert : surface.verts) {
            least = std::min(least, vert.st[axis]);
            most = std::max(most, vert.st[axis]);
        }
        const float repeats = std::floor((least + most) * 0.5f);
        for (DrawVert &vert : surface.verts)
            vert.st[axis] -= repeats;
    }
}

void InsetTriangles(DrawSurface &surface) {
    std::vector<DrawVert> verts;
    for (std::size_t i = 0; i + 2 < surface.indexes.size(); i += 3) {
        std::array<DrawVert, 3> corners;
        Vec3f center;
        for (std::size_t j = 0; j < 3; ++j) {
            corners[j] = surface.verts[std::size_t(surface.indexes[i + j])];
            center += corners[j].xyz / 3.0f;
        }
        for (DrawVert &corner : corners) {
            corner.xyz += Normalize(center - corner.xyz);
            verts.push_back(corner);
        }
    }
    surface.verts = std::move(verts);
    surface.indexes.resize(surface.verts.size());
    for (std::size_t i = 0; i < surface.indexes.size(); ++i)
        surface.indexes[i] = int(i);
}

void ReverseSurface(DrawSurface &surface) {
    for (DrawVert &vert : surface.verts)
        vert.normal = -vert.normal;
    surface.lightmapVecs[2] = -surface.lightmapVecs[2];
    for (std::size_t i = 0; i + 2 < surface.indexes.size(); i += 3)
        std::swap(surface.indexes[i], surface.indexes[i + 1]);
    if (surface.kind == SurfaceKind::Patch)
        for (int row = 0; row < surface.height; ++row) {
            const auto first = surface.verts.begin() + row * surface.width;
            std::reverse(first, first + surface.width);
        }
}

void OrderSpriteQuad(DrawSurface &surface, const BspContext &context) {
    const auto side = [&](std::size_t i) { return Length(surface.verts[(i + 1) % 4].xyz - surface.verts[i].xyz); };
    if (surface.verts.size() != 4 || surface.indexes.size() != 6) {
        context.WarnAt("sprite shape", surface.settings.entity, surface.primitive,
                       fmt::format("shader {}: autosprite2 needs quads, this surface has {} vertices",
                                   surface.shader->name, surface.verts.size()));
        return;
    }
    if (std::abs(side(0) - side(1)) < 0.1f) {
        context.WarnAt(
            "sprite shape", surface.settings.entity, surface.primitive,
            fmt::format("shader {}: autosprite2 needs an oblong quad, this one is a square", surface.shader->name));
        return;
    }
    if (side(1) < side(0))
        std::rotate(surface.verts.begin(), surface.verts.begin() + 1, surface.verts.end());
    surface.indexes = {3, 0, 2, 2, 0, 1};
}

} // namespace q3
