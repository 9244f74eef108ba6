// GPL-2.0-or-later. The bsp stage as a whole: a map source to a .bsp, and brushes as text.
#include "q3map2/geometry/compile_map.h"

#include "common/error.h"
#include "common/text/text.h"
#include "q3map2/bspfile/bspfile_rbsp.h"
#include "q3map2/bspfile/bspx_lumps.h"
#include "q3map2/bspfile/map_keys.h"
#include "q3map2/geometry/effects/decals.h"
#include "q3map2/geometry/effects/fog.h"
#include "q3map2/geometry/effects/surface_effects.h"
#include "q3map2/geometry/emit/bsp_writer.h"
#include "q3map2/geometry/emit/game_entities.h"
#include "q3map2/geometry/faces/draw_surface.h"
#include "q3map2/geometry/faces/face_surfaces.h"
#include "q3map2/geometry/faces/meta.h"
#include "q3map2/geometry/faces/tjunctions.h"
#include "q3map2/geometry/models/models.h"
#include "q3map2/tree/brush_filter.h"
#include "q3map2/tree/flood.h"
#include "q3map2/tree/portals.h"
#include "q3map2/tree/tree.h"
#include "q3map2/tree/visible_sides.h"

#include <algorithm>

namespace q3 {

// ---- Brushes of a map as text (.caulk, fakemap), and limits of engines ----

namespace {

/// Letter of the shader that an editor should apply to a hidden side: 'c' caulk, 'w', 's' and 'l' caulk of liquids, 'n'
/// nodraw, 'N' solid nodraw; '-': leave the side as it is.
char CaulkLetter(const Brush &brush, const BrushSide &side, const Game &game) {
    const bool isSeen = side.visibleHull.size() >= 3 && !side.culled;
    if (isSeen || !side.shader || (side.compileFlags & C_NODRAW) != 0)
        return '-';
    if ((brush.compileFlags & C_LIQUID) != 0)
        for (const std::string_view liquid : {"water", "slime", "lava"})
            if (const SurfaceParm *parm = game.FindParm(liquid); (brush.contentFlags & parm->contentSet) != 0)
                return liquid.front();
    if ((brush.compileFlags & C_SOLID) == 0)
        return 'n';
    return (brush.compileFlags & C_TRANSLUCENT) != 0 ? 'N' : 'c';
}

std::string PointText(const Vec3f &p) {
    return fmt::format("( {:g} {:g} {:g} ) ", p.x, p.y, p.z);
}

} // namespace

std::string CaulkText(const MapEntity &world, const Game &game) {
    std::string text;
    for (const Brush &brush : world.brushes) {
        if (brush.settings.entity != 0 || brush.generated)
            continue;
        text += fmt::format("{} ", brush.primitive);
        for (const BrushSide &side : brush.sides)
            if (!side.bevel && side.winding.size() >= 3)
                text += CaulkLetter(brush, side, game);
        text += '\n';
    }
    return text;
}

std::string FakeMapText(const MapEntity &world, const PlaneTable &planes) {
    constexpr std::string_view kFolder = "textures/";
    std::string text = "{\n\"classname\" \"worldspawn\"\n";
    for (const Brush &brush : world.brushes) {
        text += "{\n";
        for (const BrushSide &side : brush.sides) {
            if (side.bevel || side.planeNum < 0)
                continue;
            const Polygon w = side.winding.size() >= 3 ? side.winding : BasePolygon(planes[side.planeNum]);
            std::string_view name = side.shader ? std::string_view(side.shader->name) : "noshader";
            if (name.starts_with(kFolder))
                name.remove_prefix(kFolder.size());
            text += PointText(w[0]) + PointText(w[1]) + PointText(w[2]) + fmt::format("{} 0 0 0 1 1 0 0 0\n", name);
        }
        text += "}\n";
    }
    return text + "}\n";
}

namespace {

/// Number of entities in text that the program has written: each begins with "{" on a line of its own.
std::size_t CountEntities(std::string_view text) {
    std::size_t count = 0;
    for (std::size_t at = 0; (at = text.find("{\n", at)) != std::string_view::npos; at++)
        count += at == 0 || text[at - 1] == '\n';
    return count;
}

} // namespace

void WarnOfLimits(const Bsp &bsp, const Game &game, Log &log) {
    int lastArea = 0;
    for (const bspLeaf_t &leaf : bsp.leafs)
        lastArea = std::max(lastArea, leaf.area);
    // Those of Quake III: MAX_MAP_... of qfiles.h, MAX_SUBMODELS of its collision code, and five bits of the fog in the
    // sort key of its renderer.
    struct Limit {
        std::string_view records;
        std::size_t count, most;
        std::string_view advice;
    };
    const Limit limits[] = {
        {"models", bsp.models.size(), 256, "make fewer brush entities"},
        {"shaders", bsp.shaders.size(), 1024, "use fewer shaders"},
        {"entities", CountEntities(bsp.entities), 2048,
         "use fewer entities: groups and compiled-in models do not count"},
        {"bytes of entity text", bsp.entities.size(), 262144, "use fewer entities and keys"},
        {"brushes", bsp.brushes.size(), 32768, "use fewer brushes"},
        {"brush sides", bsp.brushSides.size(), 131072, "use fewer or simpler brushes"},
        {"planes", bsp.planes.size(), 131072, "use fewer brushes, and axial ones"},
        {"nodes", bsp.nodes.size(), 131072, "make more brushes detail"},
        {"leafs", bsp.leafs.size(), 131072, "make more brushes detail"},
        {"leaf surfaces", bsp.leafSurfaces.size(), 131072, "make more brushes detail, or use -meta"},
        {"leaf brushes", bsp.leafBrushes.size(), 262144, "make more brushes detail"},
        {"surfaces", bsp.drawSurfaces.size(), 131072, "use -meta"},
        {"draw vertices", bsp.drawVerts.size(), 524288, "use -meta, and simpler models"},
        {"draw indexes", bsp.drawIndexes.size(), 524288, "use simpler models"},
        {"areas", std::size_t(lastArea) + 1, 256, "use fewer area portals"},
        {"fogs", bsp.fogs.size(), std::size_t(game.maxFogs), "use fewer fog brushes"},
    };
    for (const Limit &limit : limits)
        if (limit.count > limit.most)
            log.Warn(limit.records, "{} {}, engines hold {}: {}", limit.count, limit.records, limit.most, limit.advice);
}

// ---- The bsp stage as a whole ----

namespace {

class MapCompiler {
  public:
    MapCompiler(Map &map, const BspContext &context) : map_(map), context_(context), writer_(map, context) {}

    CompiledMap Compile();

  private:
    /// False: the compile ends here (-leaktest, -autocaulk).
    bool CompileWorld();
    void CompileModel(MapEntity &entity);
    Sealing Seal(Tree &tree, SolidWarnings warnings);
    bool ReportLeak(const Tree &tree);
    void ReportAreaPortals(const Tree &tree);
    Tree MakeTree(std::vector<TreeFace> faces);
    void ShapeSurfaces(MapEntity &entity, std::size_t first);
    void EmitModel(MapEntity &entity, Tree &tree, std::size_t first);

    Map &map_;
    const BspContext &context_;
    BspWriter writer_;
    Geometry geometry_;
    std::vector<DecalProjector> decals_;
    CompiledMap result_;
};

Tree MapCompiler::MakeTree(std::vector<TreeFace> faces) {
    Tree tree = BuildTree(std::move(faces), map_.blockSize, map_.planes, context_);
    MakePortals(tree, map_.planes, context_);
    FilterStructuralBrushes(map_.World(), tree, map_.planes, context_);
    return tree;
}

/// Floods the tree. If the map is sealed, or _ignoreleaks is set, makes the leafs outside opaque.
Sealing MapCompiler::Seal(Tree &tree, SolidWarnings warnings) {
    Sealing sealing = FloodEntities(tree, map_, context_, warnings);
    if (context_.findsRegions)
        result_.regions.push_back(FloodRegionsOf(tree, map_.planes));
    if (sealing == Sealing::Empty)
        throw Error("{}: no entity is in open space, so the inside of the map cannot be told from the outside; the map "
                    "needs one, such as info_player_start, and not in a solid",
                    map_.name);
    const Entity &world = map_.World().pairs;
    if (keys::kIgnoreLeaks.Flag(world))
        sealing = Sealing::Sealed;
    if (sealing == Sealing::Sealed)
        FillOutside(tree, context_);
    return sealing;
}

/// Reports the leak. False if the compile ends here (-leaktest).
bool MapCompiler::ReportLeak(const Tree &tree) {
    result_.leakLine = LeakLine(tree, map_);
    LogMark trail;
    for (const Vec3f &p : result_.leakLine)
        trail.line.push_back({p.x, p.y, p.z});
    context_.log.Print("**********************\n******* leaked *******\n**********************\n");
    const std::string shown =
        context_.leakFile.empty() ? "" : fmt::format("; {} is the line through the hole", context_.leakFile);
    if (const int entity = LeakedEntity(tree); entity >= 0) {
        const MapEntity &reached = map_.entities[std::size_t(entity)];
        const std::string cause =
            fmt::format("the {} at {} {} {} can be reached from outside the map", reached.pairs.ClassName(),
                        reached.origin.x, reached.origin.y, reached.origin.z);
        context_.log.Warn("leak", "{}: {}{}", reached.MessagePrefix(), cause, shown);
        context_.log.Mark(LogLevel::Warning, fmt::format("Entity {}, Brush 0: {}", reached.number, cause),
                          {.entity = reached.number, .primitive = 0, .line = {}});
    } else {
        context_.log.Warn("leak", "{}: the map leaks{}", map_.name, shown);
    }
    // Sent last: the editor closes the connection after the trail.
    context_.log.Mark(LogLevel::Error, "MAP LEAKED\n", trail);
    result_.abandoned = context_.options.leakTest;
    if (result_.abandoned)
        context_.log.Print("--- MAP LEAKED, ABORTING LEAKTEST ---\n");
    return !result_.abandoned;
}

/// Warns of area portals with one area on both sides, which have no effect when a game closes them.
void MapCompiler::ReportAreaPortals(const Tree &tree) {
    const MapEntity &world = map_.World();
    const std::vector<int> idle = IdleAreaPortals(tree, world);
    for (const int number : idle) {
        const Brush &brush = world.brushes[std::size_t(number)];
        const Vec3d center = (Vec3d(brush.bounds.mins) + Vec3d(brush.bounds.maxs)) * 0.5;
        context_.WarnAt(
            "areaportal without effect", brush.settings.entity, brush.primitive,
            fmt::format("the areaportal at {:g} {:g} {:g} separates nothing: both of its sides are in one "
                        "area. Close the gap next to it, or the other way around it, with structural brushes "
                        "or one more areaportal",
                        center.x, center.y, center.z));
    }
    result_.idleAreaPortals = int(idle.size());
}

bool MapCompiler::CompileWorld() {
    MapEntity &world = map_.World();
    writer_.BeginModel(world);
    MakePatchSurfaces(world, geometry_, map_.planes, context_);
    Tree tree = MakeTree(StructuralFaces(world, context_));
    const Sealing sealing = Seal(tree, SolidWarnings::Print);
    if (sealing == Sealing::Leaked && !ReportLeak(tree))
        return false;
    CullSides(world, map_.planes, context_);
    const SideParts parts = ClipSidesIntoTree(world, tree, map_.planes, context_);
    MakeFaceSurfaces(world, geometry_, map_.planes, context_, parts);
    ApplyIndexedTerrain(geometry_, 0, context_);
    if (context_.options.autoCaulk) {
        result_.caulkFile = CaulkText(world, context_.game);
        return false;
    }
    tree = MakeTree(VisibleFaces(world, context_));
    if (tree.nodes[std::size_t(tree.head)].IsLeaf())
        throw Error("{}: no structural brush is seen from where the entities stand, and engines load no map without a "
                    "node: at least the walls around the map must be structural",
                    map_.name);
    Seal(tree, SolidWarnings::Omit); // they were printed for the first tree
    const int clusters = NumberClusters(tree, context_.options.deep);
    if (sealing == Sealing::Sealed)
        result_.portalFile = PortalFileText(tree, clusters);
    const int areas = FloodAreas(tree);
    if (sealing == Sealing::Sealed) // through a leak, everything is one area
        ReportAreaPortals(tree);
    context_.log.VerboseCount(clusters, "clusters");
    context_.log.VerboseCount(areas, "areas");
    AddEntityModels(map_, world, geometry_, context_);
    AddShaderModels(world, geometry_, 0, map_.planes, context_);
    writer_.EmitBrushes(world);
    FilterDetailBrushes(world, tree, map_.planes, context_);
    FogWorldSurfaces(map_, geometry_, map_.planes, context_);
    ShapeSurfaces(world, 0);
    if (context_.options.debugPortals)
        MakePortalSurfaces(tree, geometry_, context_);
    MakeFogHull(map_, geometry_, context_);
    MakeFlares(map_, geometry_, context_);
    EmitModel(world, tree, 0);
    return true;
}

void MapCompiler::CompileModel(MapEntity &entity) {
    writer_.BeginModel(entity);
    const std::size_t first = geometry_.surfaces.size();
    Boundsf bounds;
    for (const Brush &brush : entity.brushes)
        bounds.Add(brush.bounds);
    Tree tree = SingleLeafTree(bounds);
    MakePatchSurfaces(entity, geometry_, map_.planes, context_);
    CullSides(entity, map_.planes, context_);
    const SideParts parts = ClipSidesIntoTree(entity, tree, map_.planes, context_);
    MakeFaceSurfaces(entity, geometry_, map_.planes, context_, parts);
    ApplyIndexedTerrain(geometry_, first, context_);
    AddEntityModels(map_, entity, geometry_, context_);
    AddShaderModels(entity, geometry_, first, map_.planes, context_);
    writer_.EmitBrushes(entity);
    std::vector<int> &brushes = tree.nodes[std::size_t(tree.head)].brushes;
    for (int i = 0; i < int(entity.brushes.size()); ++i)
        brushes.push_back(i);
    // Leafs hold brushes in reverse order, detail brushes first.
    std::stable_partition(brushes.begin(), brushes.end(),
                          [&](int i) { return !entity.brushes[std::size_t(i)].detail; });
    std::reverse(brushes.begin(), brushes.end());
    ShapeSurfaces(entity, first);
    EmitModel(entity, tree, first);
}

/// Takes the surfaces from `first` on through all steps that change or add surfaces before they are written.
void MapCompiler::ShapeSurfaces(MapEntity &entity, std::size_t first) {
    if (!context_.options.noSubdivide)
        SubdivideFaces(entity, geometry_, first, map_.planes, context_);
    if (!context_.options.noTJunctions)
        FixTJunctions(geometry_, first, context_);
    ClassifySurfaces(geometry_, first, map_.planes, context_);
    const std::size_t derived = geometry_.surfaces.size();
    MakeDerivedSurfaces(geometry_, first, context_);
    ClassifySurfaces(geometry_, derived, map_.planes, context_);
    const std::size_t added = geometry_.surfaces.size();
    ApplyDecals(decals_, geometry_, first, context_, entity.origin);
    MakePatchMeshes(entity, geometry_, first, context_);
    ClassifySurfaces(geometry_, added, map_.planes, context_);
    MakeMetaSurfaces(geometry_, first, map_.planes, context_);
}

void MapCompiler::EmitModel(MapEntity &entity, Tree &tree, std::size_t first) {
    writer_.EmitSurfaces(entity, tree, geometry_, first);
    writer_.EmitTree(entity, tree);
    writer_.EndModel();
}

CompiledMap MapCompiler::Compile() {
    Log &log = context_.log;
    decals_ = CollectDecals(map_, context_);
    if (!context_.options.noFog)
        geometry_.fogs = CollectFogs(map_, context_, geometry_.defaultFog);
    if (!CompileWorld())
        return std::move(result_);
    const bool wasVerbose = log.IsVerbose();
    log.SetVerbose(wasVerbose && context_.options.verboseEntities);
    for (MapEntity &entity : map_.entities)
        if (entity.model > 0)
            CompileModel(entity);
    log.SetVerbose(wasVerbose);
    WarnOfLostDecals(decals_, context_);
    writer_.EmitFogs(geometry_);
    if (context_.options.skyFix)
        writer_.EmitSkyImages();
    writer_.EmitPlanes();
    writer_.RemapShaders();
    writer_.bsp.ident = context_.game.bspIdent;
    result_.bsp = std::move(writer_.bsp);
    result_.surfaceFile = std::move(writer_.surfaceFile);
    return std::move(result_);
}

} // namespace

CompiledMap CompileGeometry(Map &map, const BspContext &context) {
    return MapCompiler(map, context).Compile();
}

CompiledMap CompileMap(Map &map, const BspContext &context, const GeometryMaker &makeGeometry) {
    if (map.entities.empty())
        throw Error("{}: no entities, expected at least the world", map.name);
    NumberEntities(map, context);
    CompiledMap compiled = makeGeometry(map, context);
    if (compiled.abandoned || context.options.autoCaulk)
        return compiled;
    Bsp &bsp = compiled.bsp;
    bsp.entities = GameEntities(map, context);
    if (bsp.ident == kFbspIdent)
        bsp.lightmapSide = FbspLightmapSide(StoredWorld(bsp.entities));
    WarnOfLimits(bsp, context.game, context.log);
    return compiled;
}

} // namespace q3
