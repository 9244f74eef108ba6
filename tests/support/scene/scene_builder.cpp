// GPL-2.0-or-later. The parts of a scene: checks, and surfaces from boxes, quads, triangles and patches.
#include "tests/support/scene/scene_builder.h"

#include "common/error.h"
#include "tests/support/scene/scene_surface.h"

#include <algorithm>
#include <cmath>

namespace q3 {

namespace {

constexpr int kMinPatchSide = 3, kMaxPatchSide = 31;

void CheckShader(const SceneShader &shader) {
    if (shader.name.empty() || shader.name.size() > kMaxShaderName)
        throw Error("scene: shader \"{}\": the name has {} bytes, expected 1..{}", shader.name, shader.name.size(),
                    kMaxShaderName);
}

void CheckPoints(std::span<const Vec3f> points, std::string_view what) {
    for (std::size_t i = 0; i < points.size(); i++)
        if (!IsFinite(points[i]))
            throw Error("scene: {}: point {} is not finite", what, i);
}

Boundsf CheckedBox(const Vec3f &mins, const Vec3f &maxs, std::string_view what, std::size_t number) {
    if (!IsFinite(mins) || !IsFinite(maxs))
        throw Error("scene: {} {}: the bounds are not finite", what, number);
    for (std::size_t axis = 0; axis < 3; axis++)
        if (mins[axis] >= maxs[axis])
            throw Error("scene: {} {}: mins {} is not below maxs {} on axis {}", what, number, mins[axis], maxs[axis],
                        "XYZ"[axis]);
    return {mins, maxs};
}

SceneBuilder::Box MakeBox(const Boundsf &bounds, const SceneShader &shader, BoxKind kind) {
    CheckShader(shader);
    SceneBuilder::Box box{bounds, shader, {}, kind};
    box.faces.fill(shader);
    return box;
}

bspDrawVert_t SceneVert(const Vec3f &point, const Vec3f &normal, float s, float t) {
    return {point.Array(), {s / kSceneTextureSize, t / kSceneTextureSize}, {}, normal.Array(), {255, 255, 255, 255}};
}

// Texture coordinates along the two axes that the normal is farthest from.
bspDrawVert_t ProjectedVert(const Vec3f &point, const Vec3f &normal) {
    const float x = std::abs(normal.x), y = std::abs(normal.y), z = std::abs(normal.z);
    if (z >= x && z >= y)
        return SceneVert(point, normal, point.x, point.y);
    return x >= y ? SceneVert(point, normal, point.y, -point.z) : SceneVert(point, normal, point.x, -point.z);
}

// Twice the area times the normal of a clockwise triangle.
Vec3f TriangleNormal(const Vec3f &a, const Vec3f &b, const Vec3f &c) {
    return -Cross(b - a, c - a);
}

// (next column) x (next row), from differences of the control points around (column, row).
Vec3f PatchNormal(std::span<const Vec3f> points, int width, int height, int column, int row) {
    const auto at = [&](int i, int j) { return points[std::size_t(j * width + i)]; };
    const Vec3f across = at(std::min(column + 1, width - 1), row) - at(std::max(column - 1, 0), row);
    const Vec3f down = at(column, std::min(row + 1, height - 1)) - at(column, std::max(row - 1, 0));
    return Normalize(Cross(across, down));
}

} // namespace

SceneBuilder::Surface BoxFaceSurface(const Boundsf &bounds, BoxFace face, const SceneShader &shader) {
    const std::size_t side = std::size_t(face), axis = side / 2, u = (axis + 1) % 3, v = (axis + 2) % 3;
    const bool plus = side % 2 != 0;
    Vec3f normal;
    normal[axis] = plus ? 1.0f : -1.0f;
    SceneBuilder::Surface surface{shader, MST_PLANAR, {}, {0, 1, 2, 0, 2, 3}};
    // Counterclockwise as seen from the plus side of `axis`, so clockwise from the minus side.
    for (const auto &[atU, atV] : {std::pair{false, false}, {true, false}, {true, true}, {false, true}}) {
        Vec3f point;
        point[axis] = plus ? bounds.maxs[axis] : bounds.mins[axis];
        point[u] = atU ? bounds.maxs[u] : bounds.mins[u];
        point[v] = atV ? bounds.maxs[v] : bounds.mins[v];
        surface.verts.push_back(ProjectedVert(point, normal));
    }
    if (plus)
        std::ranges::reverse(surface.verts);
    return surface;
}

void SceneBuilder::SetInterior(const Vec3f &mins, const Vec3f &maxs, const SceneShader &walls) {
    interior_ = CheckedBox(mins, maxs, "interior", 0);
    walls_.clear();
    const Vec3f thick(kWallThickness, kWallThickness, kWallThickness);
    for (std::size_t side = 0; side < 6; side++) {
        Boundsf bounds{mins - thick, maxs + thick};
        if (side % 2 == 0)
            bounds.maxs[side / 2] = mins[side / 2];
        else
            bounds.mins[side / 2] = maxs[side / 2];
        walls_.push_back(MakeBox(bounds, walls, BoxKind::Structural));
    }
}

void SceneBuilder::SetWallShader(BoxFace wall, const SceneShader &shader) {
    CheckShader(shader);
    if (walls_.empty())
        throw Error("scene: SetWallShader needs SetInterior first");
    const auto side = std::size_t(wall);
    walls_[side].faces[side ^ 1] = shader;
}

int SceneBuilder::AddBox(const Vec3f &mins, const Vec3f &maxs, const SceneShader &shader, BoxKind kind) {
    boxes_.push_back(MakeBox(CheckedBox(mins, maxs, "box", boxes_.size()), shader, kind));
    return int(boxes_.size()) - 1;
}

void SceneBuilder::SetFaceShader(int box, BoxFace face, const SceneShader &shader) {
    CheckShader(shader);
    if (box < 0 || std::size_t(box) >= boxes_.size())
        throw Error("scene: box {} is not one of {}", box, boxes_.size());
    boxes_[std::size_t(box)].faces[std::size_t(face)] = shader;
}

void SceneBuilder::AddPatch(int width, int height, std::span<const Vec3f> points, const SceneShader &shader) {
    CheckShader(shader);
    CheckPoints(points, "patch");
    for (const int side : {width, height})
        if (side < kMinPatchSide || side > kMaxPatchSide || side % 2 == 0)
            throw Error("scene: patch: {} control points a side, expected an odd number in {}..{}", side, kMinPatchSide,
                        kMaxPatchSide);
    if (points.size() != std::size_t(width * height))
        throw Error("scene: patch: {} control points, expected {} x {}", points.size(), width, height);
    Surface surface{shader, MST_PATCH, {}, {}, width, height};
    for (int row = 0; row < height; row++)
        for (int column = 0; column < width; column++)
            surface.verts.push_back(SceneVert(points[std::size_t(row * width + column)],
                                              PatchNormal(points, width, height, column, row),
                                              float(column) * kSceneTextureSize, float(row) * kSceneTextureSize));
    surfaces_.push_back(std::move(surface));
}

void SceneBuilder::AddQuad(const std::array<Vec3f, 4> &corners, const SceneShader &shader) {
    CheckShader(shader);
    CheckPoints(corners, "quad");
    const Vec3f normal = Normalize(TriangleNormal(corners[0], corners[1], corners[2]));
    Surface surface{shader, MST_PLANAR, {}, {0, 1, 2, 0, 2, 3}};
    for (const Vec3f &corner : corners)
        surface.verts.push_back(ProjectedVert(corner, normal));
    surfaces_.push_back(std::move(surface));
}

void SceneBuilder::AddTriangles(std::span<const Vec3f> points, std::span<const std::int32_t> indexes,
                                const SceneShader &shader) {
    CheckShader(shader);
    CheckPoints(points, "triangles");
    if (indexes.size() % 3 != 0)
        throw Error("scene: triangles: {} indexes are not a multiple of 3", indexes.size());
    for (const std::int32_t index : indexes)
        if (index < 0 || std::size_t(index) >= points.size())
            throw Error("scene: triangles: index {} is not one of {} points", index, points.size());
    std::vector<Vec3f> normals(points.size());
    for (std::size_t i = 0; i < indexes.size(); i += 3) {
        const std::size_t a = std::size_t(indexes[i]), b = std::size_t(indexes[i + 1]), c = std::size_t(indexes[i + 2]);
        const Vec3f normal = TriangleNormal(points[a], points[b], points[c]);
        for (const std::size_t vert : {a, b, c})
            normals[vert] += normal;
    }
    Surface surface{shader, MST_TRIANGLE_SOUP, {}, {indexes.begin(), indexes.end()}};
    for (std::size_t i = 0; i < points.size(); i++)
        surface.verts.push_back(ProjectedVert(points[i], Normalize(normals[i])));
    surfaces_.push_back(std::move(surface));
}

void SceneBuilder::AddInlineModel(const Vec3f &mins, const Vec3f &maxs, const SceneShader &shader,
                                  const Entity &entity) {
    models_.push_back(MakeBox(CheckedBox(mins, maxs, "inline model", models_.size()), shader, BoxKind::Detail));
    entities_.push_back(entity);
    entities_.back().Set("model", "*" + std::to_string(models_.size()));
}

} // namespace q3
