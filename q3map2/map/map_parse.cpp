// GPL-2.0-or-later. The reader of map sources: text to entities, and settings of surfaces from their keys.
#include "q3map2/map/map_parse.h"

#include "q3map2/bspfile/entity_key.h"
#include "q3map2/bspfile/light_keys.h"
#include "q3map2/bspfile/map_keys.h"
#include "q3map2/map/index_map.h"
#include "q3map2/map/map_brush.h"
#include "q3map2/map/map_patch.h"
#include "q3map2/map/map_primitive.h"
#include "q3map2/map/map_scanner.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

namespace q3 {

// ---- Map text to entities ----

namespace {

std::string_view TrimEnd(std::string_view text) {
    while (!text.empty() && static_cast<unsigned char>(text.back()) <= ' ')
        text.remove_suffix(1);
    return text;
}

/// Reads one map, entity by entity.
class MapReader : public MapEntityHandler {
  public:
    MapReader(std::string_view text, std::string_view name, const BspContext &context)
        : context_(context), textSize_(text.size()), scanner_(text, name, context),
          primitives_(scanner_, map_.planes, context) {
        map_.name = name;
        map_.planes = PlaneTable(context.options.normalEpsilon, context.options.distanceEpsilon);
        map_.entities.reserve(EntityEstimate(text));
    }

    Map Read() {
        hasTexts_ = !scanner_.HasIncludes();
        ReadMapEntities(scanner_, map_.name, context_.log, *this);
        for (MapEntity &entity : map_.entities)
            FinishPatches(entity.patches);
        PrintCounts();
        return std::move(map_);
    }

  private:
    static std::size_t EntityEstimate(std::string_view text);
    void BeginEntity(int entity) override;
    void OnPair(const std::string &key, const std::string &value) override;
    void OnBrush(int primitive, const std::string &first) override;
    void OnPatch(int primitive, bool hasTolerances) override;
    void EndEntity() override;
    void AddBrush(MapEntity &entity, Brush brush);
    bool CheckPlanes(Brush &brush) const;
    bool IsWanted(const Brush &brush) const;
    void TakeOrigin(MapEntity &entity, const Brush &brush);
    void KeepLargestAreaPortal(Brush &brush) const;
    void Warn(const Brush &brush, std::string_view kind, std::string_view text) const;
    void FinishEntity(MapEntity &entity);
    void DropAreaPortals(MapEntity &entity) const;
    void FinishWorld(const MapEntity &world);
    void WarnOfSecondWorld(const MapEntity &entity) const;
    void ApplyPatchKeys(MapEntity &entity) const;
    void PrintCounts() const;

    const BspContext &context_;
    Map map_;
    const std::size_t textSize_;
    MapScanner scanner_;
    PrimitiveReader primitives_;
    bool hasTexts_ = false; ///< Map::texts is filled
    MapEntity entity_;      ///< the one that is read
};

/// Estimates the number of entities from the "classname" keys.
std::size_t MapReader::EntityEstimate(std::string_view text) {
    constexpr std::string_view kWord = "\"classname\"";
    std::size_t count = 1;
    for (std::size_t at = text.find(kWord); at != std::string_view::npos; at = text.find(kWord, at + kWord.size()))
        ++count;
    return count;
}

void MapReader::BeginEntity(int entity) {
    entity_ = {};
    entity_.number = entity;
    entity_.location = scanner_.Location();
    context_.places->Set(entity, -1, entity_.location);
    if (hasTexts_)
        map_.texts.push_back({textSize_ - scanner_.Unread().size(), 0});
}

void MapReader::EndEntity() {
    if (hasTexts_)
        map_.texts.back().end = textSize_ - scanner_.Unread().size();
    FinishEntity(entity_);
}

void MapReader::OnPair(const std::string &key, const std::string &value) {
    constexpr std::size_t kMaxValue = 1023; // bytes; the longest token that engines read
    constexpr std::string_view kTrenchBroom = "_tb_";
    const std::string_view trimmedKey = TrimEnd(key), trimmedValue = TrimEnd(value);
    if (trimmedKey.empty() || trimmedValue.empty())
        return;
    if (trimmedValue.size() > kMaxValue) {
        if (!trimmedKey.starts_with('_'))
            scanner_.Fail(fmt::format("the value of the key '{}' has {} bytes; engines read at most {}{}",
                                      PrintableForMessage(trimmedKey), trimmedValue.size(), kMaxValue,
                                      trimmedValue.find('\n') == std::string_view::npos
                                          ? ""
                                          : ": is a quote missing at the end of this line?"));
        context_.log.Warn(
            "long key",
            "{}: entity {}: the value of the key '{}' has {} bytes, more than the {} that engines read: the key "
            "is left out",
            scanner_.Location(), entity_.number, PrintableForMessage(trimmedKey), trimmedValue.size(), kMaxValue);
        return;
    }
    if (!StartsWithNoCase(trimmedKey, kTrenchBroom)) // notes of an editor: layers, groups, folders of the mapper
        entity_.pairs.pairs.emplace_back(trimmedKey, trimmedValue);
}

void MapReader::OnBrush(int primitive, const std::string &first) {
    context_.places->Set(entity_.number, primitive, scanner_.Location());
    Brush brush = primitives_.ReadBrush(first);
    brush.settings.entity = entity_.number;
    brush.primitive = primitive;
    AddBrush(entity_, std::move(brush));
}

void MapReader::OnPatch(int primitive, bool) {
    context_.places->Set(entity_.number, primitive, scanner_.Location());
    std::optional<Patch> patch = primitives_.ReadPatch();
    if (!patch || context_.options.noCurves)
        return;
    patch->primitive = primitive;
    entity_.patches.push_front(std::move(*patch));
}

void MapReader::Warn(const Brush &brush, std::string_view kind, std::string_view text) const {
    context_.WarnAt(kind, brush.settings.entity, brush.primitive, text);
}

/// Removes sides that have no plane or repeat one. False: the brush is to be ignored.
bool MapReader::CheckPlanes(Brush &brush) const {
    std::vector<BrushSide> kept;
    for (BrushSide &side : brush.sides) {
        if (side.planeNum < 0) {
            Warn(brush, "degenerate plane", "degenerate plane: its points are collinear");
            continue;
        }
        const auto hasPlane = [&kept](int number) {
            return std::ranges::any_of(kept, [&](const BrushSide &other) { return other.planeNum == number; });
        };
        if (hasPlane(OppositePlane(side.planeNum))) {
            Warn(brush, "mirrored plane", "mirrored plane: the brush is left out");
            return false;
        }
        if (hasPlane(side.planeNum))
            Warn(brush, "duplicate plane", "duplicate plane: the later side is left out");
        else
            kept.push_back(std::move(side));
    }
    brush.sides = std::move(kept);
    return !brush.sides.empty();
}

bool MapReader::IsWanted(const Brush &brush) const {
    const BspOptions &options = context_.options;
    return !(options.noDetail && brush.detail) && !(options.noWater && (brush.compileFlags & C_LIQUID)) &&
           !(options.noHint && (brush.compileFlags & C_HINT));
}

void MapReader::AddBrush(MapEntity &entity, Brush brush) {
    if (!CheckPlanes(brush))
        return;
    SetBrushContents(brush, context_);
    if (!IsWanted(brush))
        return;
    if (!MakeBrushWindings(brush, map_.planes)) {
        const Vec3f size = brush.bounds.maxs - brush.bounds.mins;
        if (IsInsideOut(brush, map_.planes))
            Warn(brush, "brush inside out",
                 "the brush is inside out: the points of its sides are in the wrong order, so that every side faces "
                 "inwards and the brush encloses nothing; it is left out. The three points of a side must be clockwise "
                 "as seen from outside");
        else if (!brush.bounds.Empty() && size.x > 0 && size.y > 0 && size.z > 0)
            Warn(brush, "brush outside the world",
                 fmt::format("the brush reaches beyond {:.0f} units from the origin, or is open: it is left out",
                             kMaxWorldCoord));
        else
            Warn(brush, "empty brush",
                 "the brush is open, encloses nothing or is thinner than 0.1 units: it is left out");
        return;
    }
    if (brush.compileFlags & C_ORIGIN) {
        TakeOrigin(entity, brush);
        return;
    }
    if (brush.compileFlags & C_AREAPORTAL)
        KeepLargestAreaPortal(brush);
    if (!context_.options.autoCaulk) // the .caulk file numbers sides as in the map source
        AddBrushBevels(brush, map_.planes, context_.options.bevelSnap, context_.game.bevelSurfaceFlags);
    if (brush.contentShader && brush.contentShader->geometry.IsColorVolume())
        entity.colorVolumes.push_back(std::move(brush));
    else if (brush.opaque)
        entity.brushes.push_front(std::move(brush));
    else
        entity.brushes.push_back(std::move(brush));
}

void MapReader::TakeOrigin(MapEntity &entity, const Brush &brush) {
    if (entity.number == 0) {
        Warn(brush, "origin brush in the world", "an origin brush in the world has no effect");
        return;
    }
    if (entity.brushOrigin != Vec3f{})
        Warn(brush, "second origin brush", "a second origin brush of the entity: the last one counts");
    entity.brushOrigin = brush.bounds.Center();
}

/// Only one side of an area portal brush can be the portal.
void MapReader::KeepLargestAreaPortal(Brush &brush) const {
    BrushSide *largest = nullptr;
    bool several = false;
    for (BrushSide &side : brush.sides) {
        if (!(side.compileFlags & C_AREAPORTAL))
            continue;
        several = several || largest;
        if (!largest || WindingArea(side.winding) > WindingArea(largest->winding))
            largest = &side;
    }
    if (!several)
        return;
    Warn(brush, "area portal sides", "several sides are area portals: only the largest is used");
    for (BrushSide &side : brush.sides)
        if (&side != largest)
            side.compileFlags &= ~C_AREAPORTAL;
}

void MapReader::DropAreaPortals(MapEntity &entity) const {
    std::erase_if(entity.brushes, [this](const Brush &brush) {
        const bool isPortal = (brush.compileFlags & C_AREAPORTAL) != 0;
        if (isPortal)
            context_.WarnAt("area portal outside the world", brush.settings.entity, brush.primitive,
                            "an area portal outside worldspawn is left out");
        return isPortal;
    });
}

void MapReader::ApplyPatchKeys(MapEntity &entity) const {
    if (!entity.brushes.empty() || !entity.patches.empty()) {
        WarnOfBadKeys(entity.pairs, std::size_t(entity.number), keys::kSurfaceKeys, context_.log);
        WarnOfForeignKeys(entity.pairs, std::size_t(entity.number), KeyOwner::Brushes, context_.log);
    }
    const bool takesWorldKeys = EqualNoCase(entity.pairs.ClassName(), "func_group") && !map_.entities.empty();
    const auto giver = [&](const EntityKey &key) -> const Entity & { // the entity whose key counts
        return takesWorldKeys && !key.Given(entity.pairs) ? map_.entities.front().pairs : entity.pairs;
    };
    const bool meta = context_.options.patchMeta || keys::kPatchMeta.Flag(giver(keys::kPatchMeta));
    const int subdivide = keys::kPatchSubdivide.Integer(giver(keys::kPatchSubdivide));
    const int quality = keys::kPatchQuality.Integer(giver(keys::kPatchQuality));
    int subdivisions = std::max(subdivide, 0);
    if (quality > 0)
        subdivisions = std::max(1, (subdivide > 0 ? subdivide : context_.options.subdivisions) / quality);
    for (Patch &patch : entity.patches) {
        patch.patchMeta = meta;
        patch.patchSubdivisions = subdivisions;
    }
}

void MapReader::FinishWorld(const MapEntity &world) {
    const BspOptions &options = context_.options;
    if (!EqualNoCase(world.pairs.ClassName(), "worldspawn"))
        context_.log.Warn("first entity", "{}: the first entity is '{}', expected worldspawn; it is taken as the world",
                          map_.name, PrintableForMessage(world.pairs.ClassName()));
    WarnOfBadKeys(world.pairs, 0, keys::kWorldKeys, context_.log);
    WarnOfBadKeys(world.pairs, 0, keys::kWorldLightKeys, context_.log);
    WarnOfBadKeys(world.pairs, 0, keys::kStyleWorldKeys, context_.log);
    WarnOfBadKeys(world.pairs, 0, keys::kMacroKeys, context_.log);
    const std::string_view cel = keys::kCelShader.Text(world.pairs);
    if (!cel.empty())
        map_.defaultCelShader = &context_.shaders.Get(fmt::format("textures/{}", cel));
    else if (!options.celShader.empty())
        map_.defaultCelShader = &context_.shaders.Get(options.celShader);
    std::string_view text = keys::kBlockSize.Text(world.pairs);
    constexpr double kMaxBlock = 4 * kMaxWorldCoord; // game units; twice the width of the world
    std::vector<int> sizes;
    while (sizes.size() < 3) {
        const std::optional<double> number = TakeNumber(text);
        if (!number)
            break;
        sizes.push_back(int(std::clamp(*number, 0.0, kMaxBlock)));
    }
    if (sizes.size() == 3)
        map_.blockSize = {sizes[0], sizes[1], sizes[2]};
    else if (!sizes.empty())
        map_.blockSize.fill(sizes[0]);
}

/// Games drop entities of this class, with their brushes.
void MapReader::WarnOfSecondWorld(const MapEntity &entity) const {
    std::vector<std::string> keys;
    for (const auto &[key, value] : entity.pairs.pairs)
        if (!EqualNoCase(key, "classname"))
            keys.push_back(PrintableForMessage(key));
    const bool isEmpty = entity.brushes.empty() && entity.patches.empty() && entity.colorVolumes.empty();
    context_.log.Warn("second worldspawn", "{}: a second worldspawn, which games drop: {}{}", entity.MessagePrefix(),
                      isEmpty ? "it is left out" : "its brushes and patches join the world",
                      keys.empty() ? std::string()
                                   : fmt::format("; of its keys ({}) only those that func_group has too apply to them",
                                                 fmt::join(keys, ", ")));
}

void MapReader::FinishEntity(MapEntity &entity) {
    const bool isWorld = entity.number == 0;
    const bool isSecondWorld = !isWorld && EqualNoCase(entity.pairs.ClassName(), "worldspawn");
    const bool isGroup = isSecondWorld || (!isWorld && EqualNoCase(entity.pairs.ClassName(), "func_group"));
    if (isSecondWorld) {
        WarnOfSecondWorld(entity);
        entity.pairs.Set("classname", "func_group");
        entity.pairs.Erase("origin");
    }
    if (!isWorld && EqualNoCase(entity.pairs.ClassName(), "group_info"))
        return;
    if (isWorld)
        FinishWorld(entity);
    if (!isWorld && !isGroup)
        DropAreaPortals(entity);
    const auto originKey = [&] { return entity.pairs.Vector({"origin"}).value_or(Vec3f{}); };
    if (entity.brushOrigin != Vec3f{}) {
        const Vec3f sum = originKey() + entity.brushOrigin;
        entity.pairs.Set("origin", fmt::format("{:f} {:f} {:f}", sum.x, sum.y, sum.z));
        MoveEntity(entity, -entity.brushOrigin, map_.planes);
    }
    entity.origin = originKey();
    SurfaceSettings settings = SettingsOf(entity, map_, context_);
    // JoinWorld moves the primitives of groups by the origin.
    settings.indexMap = ReadIndexMap(entity, isGroup ? entity.origin : Vec3f{}, context_);
    const auto finish = [&](Brush &brush) {
        brush.settings = settings;
        brush.textureOrigin = entity.brushOrigin;
    };
    std::ranges::for_each(entity.brushes, finish);
    std::ranges::for_each(entity.colorVolumes, finish);
    for (Patch &patch : entity.patches)
        patch.settings = settings;
    ApplyPatchKeys(entity);
    if (isGroup)
        JoinWorld(entity, map_.World(), map_.planes, context_);
    else
        map_.entities.push_back(std::move(entity));
}

void MapReader::PrintCounts() const {
    long long detail = 0, patches = 0, boxBevels = 0, edgeBevels = 0, areaPortals = 0;
    for (const MapEntity &entity : map_.entities) {
        patches += (long long)(entity.patches.size());
        for (const Brush &brush : entity.brushes) {
            detail += brush.detail;
            areaPortals += (brush.compileFlags & C_AREAPORTAL) != 0;
            for (std::size_t i = 0; i < brush.sides.size(); ++i) // the first six are the axial ones
                (i < 6 ? boxBevels : edgeBevels) += brush.sides[i].bevel;
        }
    }
    const std::size_t worldBrushes = map_.entities.front().brushes.size();
    context_.log.VerboseCount(worldBrushes, "total world brushes");
    context_.log.VerboseCount(detail, "detail brushes");
    context_.log.VerboseCount(patches, "patches");
    context_.log.VerboseCount(boxBevels, "boxbevels");
    context_.log.VerboseCount(edgeBevels, "edgebevels");
    context_.log.VerboseCount(map_.entities.size(), "entities");
    context_.log.VerboseCount(map_.planes.Count(), "planes");
    context_.log.VerboseCount(areaPortals, "areaportals");
}

} // namespace

Map ReadMap(std::string_view text, std::string_view name, const BspContext &context) {
    RequireMapSource(text, name);
    return MapReader(text, name, context).Read();
}

// ---- Settings of the surfaces of an entity, from its keys ----

namespace {

constexpr float kMaxColor = 1e6f; ///< byte scale: far above any light, and products do not overflow

Vec3f AmbientOf(const Entity &pairs) {
    const float ambient = std::clamp(float(keys::kAmbient.Number(pairs)), -kMaxColor, kMaxColor);
    Vec3f color = keys::kWorldColor.Vector(pairs).value_or(Vec3f{1, 1, 1});
    for (std::size_t i = 0; i < 3; ++i)
        color[i] = std::clamp(color[i], -kMaxColor, kMaxColor);
    return color * ambient;
}

} // namespace

SurfaceSettings SettingsOf(const MapEntity &entity, const Map &map, const BspContext &context) {
    const Entity &pairs = entity.pairs;
    const bool isWorld = entity.number == 0;
    SurfaceSettings settings;
    settings.entity = entity.number;
    const bool casts = isWorld || EqualNoCase(pairs.ClassName(), "func_group");
    settings.castShadows = keys::kCastShadows.Integer(pairs, casts ? 1 : 0);
    settings.receiveShadows = keys::kReceiveShadows.Integer(pairs);
    settings.sampleSize = keys::kSampleSize.Integer(pairs);
    settings.lightmapScale = float(keys::kLightmapScale.Number(pairs, 0));
    settings.shadeAngle = float(keys::kShadeAngle.Number(pairs));
    settings.ambient = AmbientOf(pairs);
    if (settings.ambient == Vec3f{} && !isWorld && !map.entities.empty())
        settings.ambient = AmbientOf(map.entities.front().pairs);
    const std::string_view cel = keys::kCelShader.Text(pairs);
    settings.celShader = cel.empty() ? map.defaultCelShader : &context.shaders.Get(fmt::format("textures/{}", cel));
    return settings;
}

} // namespace q3
