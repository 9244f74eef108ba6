// GPL-2.0-or-later. Writes the .bsp and the .srf: models, brushes, surfaces, the tree.
#include "q3map2/geometry/emit/bsp_writer.h"

#include "common/error.h"
#include "common/text/text.h"
#include "q3map2/map/map_parse.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace q3 {

// ---- Records of the .bsp, except draw surfaces ----

namespace {

constexpr std::string_view kNoShader = "noshader";

/// Bounds rounded outward to integers; zeros for an empty box.
void SetBounds(const Boundsf &bounds, Int3 &mins, Int3 &maxs) {
    mins = maxs = {};
    if (bounds.Empty())
        return;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        mins[axis] = std::int32_t(std::floor(bounds.mins[axis]));
        maxs[axis] = std::int32_t(std::ceil(bounds.maxs[axis]));
    }
}

std::array<char, 64> NameField(std::string_view name) {
    if (name.size() > kMaxShaderName)
        throw Error("shader name {}: {} bytes, expected at most {}", name, name.size(), kMaxShaderName);
    std::array<char, 64> field{};
    std::copy(name.begin(), name.end(), field.begin());
    return field;
}

/// Bounds of an entity. For a world with lightgrid brushes (surfaceparm lightgrid), bounds of these brushes only.
Boundsf ModelBounds(const MapEntity &entity, bool isWorld) {
    Boundsf all, grid;
    for (const Brush &brush : entity.brushes) {
        all.Add(brush.bounds);
        if ((brush.compileFlags & C_LIGHTGRID) != 0)
            grid.Add(brush.bounds);
    }
    for (const Patch &patch : entity.patches)
        for (const DrawVert &vert : patch.verts)
            all.Add(vert.xyz);
    return isWorld && !grid.Empty() ? grid : all;
}

/// Value of bspFog_t::visibleSide: the last axial side that is visible, else the first other visible side; -1: none.
int VisibleSide(const Brush &brush) {
    constexpr int kAxialSides = 6;
    const auto isVisible = [&](int number) {
        const BrushSide &side = brush.sides[std::size_t(number)];
        return side.visibleHull.size() >= 3 && side.shader && (side.compileFlags & C_NODRAW) == 0;
    };
    const int count = int(brush.sides.size());
    for (int i = std::min(kAxialSides, count) - 1; i >= 0; --i)
        if (isVisible(i))
            return i;
    for (int i = kAxialSides; i < count; ++i)
        if (isVisible(i))
            return i;
    return -1;
}

} // namespace

BspWriter::BspWriter(Map &map, const BspContext &context)
    : map_(map), context_(context), worldSettings_(SettingsOf(map.World(), map, context)), skyBox_(ReadSkyBox(map)) {
    bsp.drawIndexes = {0, 1, 2, 0, 2, 3}; // of a triangle and of a quad: IndexRuns finds them from the start
    bsp.leafs.emplace_back();             // no node refers to it
    surfaceFile =
        DefaultSurfaceBlock(worldSettings_, std::max(context.options.sampleSize, context.options.minSampleSize));
}

int BspWriter::ShaderNumber(std::string_view name, std::uint32_t surfaceFlags, std::uint32_t contentFlags) {
    const std::string_view known = name.empty() ? kNoShader : name;
    const auto [entry, isNew] =
        shaderNumbers_.try_emplace({LowerCase(known), surfaceFlags, contentFlags}, int(bsp.shaders.size()));
    if (isNew)
        bsp.shaders.push_back({NameField(known), surfaceFlags, contentFlags});
    return entry->second;
}

int BspWriter::ShaderNumber(const ShaderInfo &shader) {
    const std::size_t count = bsp.shaders.size();
    const int number = ShaderNumber(shader.name, shader.surfaceFlags, shader.contentFlags);
    const bool isNew = bsp.shaders.size() > count;
    // For the game, which shows it once the surface is damaged. Its own damage shader is not followed.
    if (const std::string &damage = shader.geometry.damageShader; isNew && !damage.empty())
        ShaderNumber(damage);
    return number;
}

int BspWriter::ShaderNumber(std::string_view name) {
    const ShaderInfo &info = context_.shaders.Get(name.empty() ? kNoShader : name);
    return ShaderNumber(name, info.surfaceFlags, info.contentFlags);
}

void BspWriter::BeginModel(const MapEntity &entity) {
    const Boundsf bounds = ModelBounds(entity, bsp.models.empty());
    bspModel_t model{};
    if (!bounds.Empty()) {
        model.mins = bounds.mins.Array();
        model.maxs = bounds.maxs.Array();
    }
    model.firstBSPSurface = std::int32_t(bsp.drawSurfaces.size());
    model.firstBSPBrush = std::int32_t(bsp.brushes.size());
    bsp.models.push_back(model);
}

void BspWriter::EmitBrushes(MapEntity &entity) {
    for (Brush &brush : entity.brushes) {
        brush.bspBrush = int(bsp.brushes.size());
        bspBrush_t record{};
        const ShaderInfo *content = brush.contentShader;
        record.shaderNum = content ? ShaderNumber(*content) : ShaderNumber(kNoShader);
        record.firstSide = std::int32_t(bsp.brushSides.size());
        record.numSides = std::int32_t(brush.sides.size());
        bsp.brushes.push_back(record);
        for (const BrushSide &side : brush.sides)
            EmitBrushSide(side);
    }
}

void BspWriter::EmitBrushSide(const BrushSide &side) {
    bspBrushSide_t record{};
    record.planeNum = side.planeNum;
    if (side.shader)
        record.shaderNum = ShaderNumber(*side.shader);
    else if (side.bevel)
        record.shaderNum = ShaderNumber(kNoShader, side.surfaceFlags, context_.shaders.Get(kNoShader).contentFlags);
    else
        record.shaderNum = ShaderNumber(kNoShader);
    bsp.brushSides.push_back(record);
}

/// Copies final shaders of surfaces to their brush sides: engines take surface properties of a hit from the side.
void BspWriter::FixSideShaders(const MapEntity &entity, const Geometry &geometry) {
    for (const Brush &brush : entity.brushes)
        for (std::size_t i = 0; i < brush.sides.size() && brush.bspBrush >= 0; ++i) {
            const BrushSide &side = brush.sides[i];
            if (side.surface < 0 || !side.shader)
                continue;
            const ShaderInfo *shader = geometry.surfaces[std::size_t(side.surface)].shader;
            if (shader && !EqualNoCase(shader->name, side.shader->name)) {
                const std::size_t first = std::size_t(bsp.brushes[std::size_t(brush.bspBrush)].firstSide);
                bsp.brushSides[first + i].shaderNum = ShaderNumber(*shader);
            }
        }
}

int BspWriter::EmitLeaf(const MapEntity &entity, const TreeNode &leaf, const Boundsf &bounds) {
    bspLeaf_t record{};
    const bool isSolid = leaf.opaque || (bsp.models.size() > 1 && context_.game.solidModelLeafs);
    // The one leaf of a brush entity has no numbers and gets 0.
    record.cluster = isSolid ? -1 : std::max(leaf.cluster, 0);
    record.area = isSolid ? -1 : std::max(leaf.area, 0);
    SetBounds(bounds, record.mins, record.maxs);
    record.firstBSPLeafBrush = std::int32_t(bsp.leafBrushes.size());
    for (const int brush : leaf.brushes)
        if (const int number = entity.brushes[std::size_t(brush)].bspBrush; number >= 0)
            bsp.leafBrushes.push_back(number);
    record.numBSPLeafBrushes = std::int32_t(bsp.leafBrushes.size()) - record.firstBSPLeafBrush;
    if (!leaf.opaque) {
        record.firstBSPLeafSurface = std::int32_t(bsp.leafSurfaces.size());
        bsp.leafSurfaces.insert(bsp.leafSurfaces.end(), leaf.surfaces.begin(), leaf.surfaces.end());
        record.numBSPLeafSurfaces = std::int32_t(leaf.surfaces.size());
    }
    bsp.leafs.push_back(record);
    return int(bsp.leafs.size()) - 1;
}

/// Appends nodes in depth-first order, front children first.
void BspWriter::EmitNodes(const MapEntity &entity, const Tree &tree) {
    struct Visit {
        int node, parent;
        std::size_t child;
    };
    std::vector<Visit> stack{{tree.head, -1, 0}};
    while (!stack.empty()) {
        const Visit visit = stack.back();
        stack.pop_back();
        const TreeNode &node = tree.nodes[std::size_t(visit.node)];
        int number = 0;
        if (node.IsLeaf()) {
            number = -1 - EmitLeaf(entity, node, node.bounds); // the form in which nodes refer to leafs
        } else {
            number = int(bsp.nodes.size());
            bspNode_t record{};
            record.planeNum = node.planeNum;
            SetBounds(node.bounds, record.mins, record.maxs);
            bsp.nodes.push_back(record);
            stack.push_back({node.children[1], number, 1});
            stack.push_back({node.children[0], number, 0});
        }
        if (visit.parent >= 0)
            bsp.nodes[std::size_t(visit.parent)].children[visit.child] = number;
    }
}

void BspWriter::EmitTree(const MapEntity &entity, const Tree &tree) {
    if (bsp.models.size() > 1) {
        const bspModel_t &model = bsp.models.back();
        Boundsf bounds;
        bounds.Add(Vec3f(model.mins));
        bounds.Add(Vec3f(model.maxs));
        EmitLeaf(entity, tree.nodes[std::size_t(tree.head)], bounds);
        return;
    }
    EmitNodes(entity, tree);
}

void BspWriter::EndModel() {
    bspModel_t &model = bsp.models.back();
    model.numBSPSurfaces = std::int32_t(bsp.drawSurfaces.size()) - model.firstBSPSurface;
    model.numBSPBrushes = std::int32_t(bsp.brushes.size()) - model.firstBSPBrush;
}

void BspWriter::EmitFogs(const Geometry &geometry) {
    for (const MapFog &fog : geometry.fogs) {
        bspFog_t record{};
        record.shader = NameField(fog.shader->name);
        record.brushNum = record.visibleSide = -1;
        if (fog.entity >= 0 && fog.brush >= 0) {
            const Brush &brush = map_.entities[std::size_t(fog.entity)].brushes[std::size_t(fog.brush)];
            record.brushNum = brush.bspBrush;
            record.visibleSide = fog.visibleSide >= 0 ? fog.visibleSide : VisibleSide(brush);
        }
        bsp.fogs.push_back(record);
    }
}

void BspWriter::EmitPlanes() {
    for (int i = 0; i < map_.planes.Count(); ++i) {
        const Plane &plane = map_.planes[i];
        bsp.planes.push_back({Vec3f(plane.normal).Array(), float(plane.dist)});
    }
}

void BspWriter::RemapShaders() {
    for (bspShader_t &shader : bsp.shaders)
        if (const std::string &other = context_.shaders.Get(FieldName(shader.shader)).geometry.remapShader;
            !other.empty())
            shader.shader = NameField(other);
}

// ---- The .srf file: properties of surfaces that the light stage needs and the .bsp cannot hold ----

namespace {

std::string_view KindName(SurfaceKind kind) {
    switch (kind) {
    case SurfaceKind::Face:
        return "Face";
    case SurfaceKind::Patch:
        return "Patch";
    case SurfaceKind::Triangles:
        return "Triangles";
    case SurfaceKind::ForcedMeta:
        return "ForcedMeta";
    case SurfaceKind::Meta:
        return "Meta";
    case SurfaceKind::FogHull:
        return "Foghull";
    case SurfaceKind::Decal:
        return "Decal";
    case SurfaceKind::Flare:
        return "Flare";
    case SurfaceKind::Foliage:
        return "Foliage";
    case SurfaceKind::Shader:
        return "Shader";
    case SurfaceKind::Bad:
        break;
    }
    return "Bad";
}

std::string TripleText(const Vec3f &v) {
    return fmt::format("( {:f} {:f} {:f} )", v.x, v.y, v.z);
}

} // namespace

std::string DefaultSurfaceBlock(const SurfaceSettings &world, int sampleSize) {
    return fmt::format("default\n{{\n\tcastShadows 1\n\treceiveShadows 1\n\tsampleSize {}\n\tambientColor {}\n"
                       "\tlongestCurve {:f}\n}}\n\n",
                       sampleSize, TripleText(world.ambient), 0.0);
}

std::string SurfaceBlock(const DrawSurface &surface, int number, std::string_view shader, const SurfaceSettings &world,
                         int sampleSize) {
    constexpr float kNoAxis = 0.001f; // smaller components are 0
    const SurfaceSettings &settings = surface.settings;
    std::string text =
        fmt::format("{} // ESurfaceType::{} V: {} I: {} {}\n{{\n\tshader {}\n", number, KindName(surface.kind),
                    surface.verts.size(), surface.indexes.size(), surface.planar ? "planar" : "", shader);
    if (surface.parent >= 0)
        text += fmt::format("\tparent {}\n", surface.parent);
    if (settings.entity != 0)
        text += fmt::format("\tentity {}\n", settings.entity);
    if (settings.castShadows != 1)
        text += fmt::format("\tcastShadows {}\n", settings.castShadows);
    if (settings.receiveShadows != 1)
        text += fmt::format("\treceiveShadows {}\n", settings.receiveShadows);
    if (surface.sampleSize != sampleSize)
        text += fmt::format("\tsampleSize {}\n", surface.sampleSize);
    if (settings.ambient != Vec3f{} && settings.ambient != world.ambient)
        text += fmt::format("\tambientColor {}\n", TripleText(settings.ambient));
    if (surface.longestCurve != 0)
        text += fmt::format("\tlongestCurve {:f}\n", surface.longestCurve);
    const Vec3f &axis = surface.lightmapAxis;
    if (std::abs(axis.x) >= kNoAxis || std::abs(axis.y) >= kNoAxis || std::abs(axis.z) >= kNoAxis)
        text += fmt::format("\tlightmapAxis {}\n", TripleText(axis));
    return text + "}\n\n";
}

} // namespace q3
