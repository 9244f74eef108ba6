// GPL-2.0-or-later. Two maps in one.
#include "q3map2/edit/merge_maps.h"

#include "common/error.h"
#include "libs/math/vec.h"
#include "q3map2/bspfile/bsp.h"
#include "q3map2/bspfile/entities.h"
#include "q3map2/bspfile/entity_key.h"
#include "q3map2/bspfile/switchable_lights.h"
#include "q3map2/edit/edit_lumps.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <span>

namespace q3 {

// ---- The surfaces and brushes that leafs list ----

namespace {

/// Boxes are listed in leafs that are this near too. Game units; chosen.
constexpr double kBoxMargin = 1;

} // namespace

LeafLists::LeafLists(const Bsp &bsp) : bsp_(bsp), surfaces_(bsp.leafs.size()), brushes_(bsp.leafs.size()) {
    for (std::size_t i = 0; i < bsp.leafs.size(); ++i) {
        const bspLeaf_t &leaf = bsp.leafs[i];
        const auto surfaces = bsp.leafSurfaces.begin() + leaf.firstBSPLeafSurface;
        const auto brushes = bsp.leafBrushes.begin() + leaf.firstBSPLeafBrush;
        surfaces_[i].assign(surfaces, surfaces + leaf.numBSPLeafSurfaces);
        brushes_[i].assign(brushes, brushes + leaf.numBSPLeafBrushes);
    }
}

std::vector<std::size_t> LeafLists::LeafsIn(const Boundsf &box) const {
    const Vec3d center = (Vec3d(box.mins) + Vec3d(box.maxs)) * 0.5, half = (Vec3d(box.maxs) - Vec3d(box.mins)) * 0.5;
    std::vector<std::size_t> leafs;
    std::vector<BspChild> pending{RootOf(bsp_)};
    while (!pending.empty()) {
        const BspChild child = pending.back();
        pending.pop_back();
        if (child < 0) {
            leafs.push_back(std::size_t(LeafOf(child)));
            continue;
        }
        const bspNode_t &node = bsp_.nodes[std::size_t(child)];
        const bspPlane_t &plane = bsp_.planes[std::size_t(node.planeNum)];
        const Vec3d normal(plane.normal);
        const double distance = Dot(normal, center) - double(plane.dist);
        // Half the extent of the box along the normal, and the margin.
        const double reach =
            std::abs(normal.x) * half.x + std::abs(normal.y) * half.y + std::abs(normal.z) * half.z + kBoxMargin;
        if (distance > -reach)
            pending.push_back(node.children[0]);
        if (distance < reach)
            pending.push_back(node.children[1]);
    }
    return leafs;
}

void LeafLists::AddSurface(int number, const Boundsf &box) {
    if (box.Empty())
        return;
    for (const std::size_t leaf : LeafsIn(box))
        if (bsp_.leafs[leaf].cluster != kSolidCluster)
            surfaces_[leaf].push_back(number);
}

void LeafLists::AddBrush(int number, const Boundsf &box) {
    for (const std::size_t leaf : LeafsIn(box))
        brushes_[leaf].push_back(number);
}

void LeafLists::Store(Bsp &bsp) const {
    bsp.leafSurfaces.clear();
    bsp.leafBrushes.clear();
    for (std::size_t i = 0; i < bsp.leafs.size(); ++i) {
        bspLeaf_t &leaf = bsp.leafs[i];
        leaf.firstBSPLeafSurface = int(bsp.leafSurfaces.size());
        leaf.numBSPLeafSurfaces = int(surfaces_[i].size());
        leaf.firstBSPLeafBrush = int(bsp.leafBrushes.size());
        leaf.numBSPLeafBrushes = int(brushes_[i].size());
        bsp.leafSurfaces.insert(bsp.leafSurfaces.end(), surfaces_[i].begin(), surfaces_[i].end());
        bsp.leafBrushes.insert(bsp.leafBrushes.end(), brushes_[i].begin(), brushes_[i].end());
    }
}

// ---- Two maps merged into one ----

namespace {

constexpr int kNotTaken = -1; ///< number of a record that the merged map does not have
constexpr std::size_t kBoxSides = 6;

/// Adds `added` to a copy of `main`. Each step uses the numbers that the steps before it gave to records.
class Merger {
  public:
    Merger(const NamedBsp &main, const NamedBsp &added, const MergeOptions &options, Log &log)
        : main_(main.bsp), added_(added.bsp), mainName_(main.name), addedName_(added.name), options_(options),
          log_(log), bsp_(main.bsp) {}

    Bsp Run() {
        MergeEntities();
        MergeShaders();
        if (bsp_.planes.size() % 2 == 1) // a plane and its opposite are at 2 i and 2 i + 1
            bsp_.planes.push_back(bsp_.planes.back());
        planeBase_ = Appended(bsp_.planes, added_.planes);
        MergeLightmaps();
        ChooseRecords();
        MergeBrushes();
        MergeFogs();
        MergeSurfaces();
        MergeModels();
        MergeLumps({main_, added_, mainName_, addedName_, bsp_, log_, lightmapBase_, copiedVerts_});
        DropUnfitLumps(bsp_, fmt::format("{} with {}", mainName_, addedName_), log_);
        RecordRnm();
        if (options_.world)
            ListWorldInLeafs();
        ValidateBsp(bsp_, fmt::format("{} with {}", mainName_, addedName_), log_);
        return std::move(bsp_);
    }

  private:
    /// Appends records; returns the number that the first of them gets.
    template <typename Record> static int Appended(std::vector<Record> &to, const std::vector<Record> &from) {
        const int first = int(to.size());
        to.insert(to.end(), from.begin(), from.end());
        return first;
    }

    void MergeEntities();
    void MergeShaders();
    void MergeLightmaps();
    void ChooseRecords();
    void MergeBrushes();
    void MergeFogs();
    void MergeSurfaces();
    void MergeModels();
    void RecordRnm();
    template <typename Record>
    int ExtendWorld(std::vector<Record> &records, int count, std::vector<std::int32_t> &numbers,
                    std::int32_t bspModel_t::*first, std::int32_t bspModel_t::*num);
    void ListWorldInLeafs();
    int SurfaceOf(const bspBrushSide_t &side) const;
    bspDrawSurface_t Renumbered(bspDrawSurface_t surface);
    Boundsf BoxOfBrush(const bspBrush_t &brush) const;
    Boundsf BoxOfSurface(const bspDrawSurface_t &surface) const;

    const Bsp &main_, &added_;
    std::string_view mainName_, addedName_;
    const MergeOptions &options_;
    Log &log_;
    Bsp bsp_;
    int planeBase_ = 0, fogBase_ = 0, lightmapBase_ = 0;
    /// Numbers in the merged map, or kNotTaken, by number in the added one.
    std::vector<int> shaders_, surfaces_, brushes_;
    std::map<int, int> styles_;                ///< of switchable lights: in the merged map, by that in the added one
    int worldSurfaces_ = 0, worldBrushes_ = 0; ///< records of the added world that join the main one
    /// First number in the merged map of runs of vertices and indexes of the added one, by first number and count.
    std::map<std::pair<int, int>, int> vertRuns_, indexRuns_;
    std::vector<std::pair<int, int>> copiedVerts_; ///< LumpMerge::vertRuns
};

/// Renames targets and targetnames of the added map that the main map has too: name_0 or the next that is free.
void GiveOtherNames(const std::vector<Entity> &main, std::vector<Entity> &added) {
    constexpr std::string_view kKeys[] = {"target", "targetname"};
    std::set<std::string> inMain, taken; // lower case
    const auto collect = [&](const std::vector<Entity> &entities, std::set<std::string> &names) {
        for (const Entity &entity : entities)
            for (const std::string_view key : kKeys)
                if (entity.Has(key))
                    names.insert(LowerCase(entity.Value(key)));
    };
    collect(main, inMain);
    collect(added, taken);
    taken.insert(inMain.begin(), inMain.end());
    std::map<std::string, std::string> renamed; // by lower-case name
    for (Entity &entity : added)
        for (const std::string_view key : kKeys) {
            const std::string name(entity.Value(key));
            if (name.empty() || !inMain.contains(LowerCase(name)))
                continue;
            std::string &other = renamed[LowerCase(name)];
            for (int number = 0; other.empty(); ++number)
                if (std::string free = fmt::format("{}_{}", name, number); taken.insert(LowerCase(free)).second)
                    other = std::move(free);
            entity.Set(key, other);
        }
}

/// Styles of the surfaces of a map.
std::set<int> StylesOf(const Bsp &bsp) {
    std::set<int> styles;
    for (const bspDrawSurface_t &surface : bsp.drawSurfaces)
        for (const Styles *some : {&surface.lightmapStyles, &surface.vertexStyles})
            styles.insert(some->begin(), some->end());
    return styles;
}

/// Gives the switchable lights of the added map the style that lights of their name have in the main map, or else one
/// that is not in `taken`. Returns the new styles by the old ones. Errors: too many.
std::map<int, int> GiveOtherStyles(const std::vector<Entity> &main, std::set<int> taken, std::vector<Entity> &added) {
    std::map<SwitchGroup, int> styleOf; // of a group, in the merged map
    for (const Entity &light : main)
        if (const int style = SwitchStyle(light); style != 0) {
            styleOf.emplace(GroupOfNumbered(light), style);
            taken.insert(style);
        }
    std::map<int, int> changed;
    for (Entity &light : added) {
        const int old = SwitchStyle(light);
        if (old == 0)
            continue;
        int &style = styleOf[GroupOfNumbered(light)];
        for (int free = kFirstSwitchStyle; style == 0; ++free) {
            if (free > kLastStyle)
                throw Error("the maps have more than {} groups of switchable lights, engines of these games have no "
                            "more styles for them",
                            kSwitchStyleCount);
            if (taken.insert(free).second)
                style = free;
        }
        changed[old] = style;
        light.Set("style", fmt::format("{}", style));
    }
    return changed;
}

void Merger::MergeEntities() {
    std::vector<Entity> all = StoredEntities(main_.entities, mainName_),
                        added = StoredEntities(added_.entities, addedName_);
    added.erase(added.begin());
    for (Entity &entity : added)
        if (const std::string_view model = entity.Value("model"); model.starts_with('*'))
            entity.Set("model", fmt::format("*{}", IntegerFromText(model.substr(1)) + int(main_.models.size()) - 1));
    if (options_.fixNames)
        GiveOtherNames(all, added);
    if (main_.ident != kIbspIdent)
        styles_ = GiveOtherStyles(all, StylesOf(main_), added);
    all.insert(all.end(), added.begin(), added.end());
    bsp_.entities = FormatEntities(all);
}

/// Shaders that both maps have become one.
void Merger::MergeShaders() {
    const auto same = [](const bspShader_t &a, const bspShader_t &b) {
        return EqualNoCase(FieldName(a.shader), FieldName(b.shader)) && a.surfaceFlags == b.surfaceFlags &&
               a.contentFlags == b.contentFlags;
    };
    for (const bspShader_t &shader : added_.shaders) {
        const auto found = std::ranges::find_if(bsp_.shaders, [&](const bspShader_t &s) { return same(s, shader); });
        shaders_.push_back(int(found - bsp_.shaders.begin()));
        if (found == bsp_.shaders.end())
            bsp_.shaders.push_back(shader);
    }
}

/// Pages of the second map follow those of the first.
void Merger::MergeLightmaps() {
    constexpr std::size_t kTexelBytes = 3; // RGB
    const bool hdrOnly = main_.lightmaps.empty() && added_.lightmaps.empty();
    const auto pages = [&](const Bsp &bsp) {
        return int(hdrOnly ? bsp.lightmapsE5bgr9.size() * kTexelBytes / LightmapPageBytes(bsp.lightmapSide)
                           : bsp.LightmapPages());
    };
    const auto used = [](const Bsp &bsp) { return int(std::min<std::int64_t>(bsp.NamedPages(), INT32_MAX / 2)); };
    const bool mainIsExternal = used(main_) > pages(main_), addedIsExternal = used(added_) > pages(added_);
    lightmapBase_ = mainIsExternal ? used(main_) : pages(main_);
    bsp_.lightmaps.insert(bsp_.lightmaps.end(), added_.lightmaps.begin(), added_.lightmaps.end());
    if (mainIsExternal || addedIsExternal)
        log_.Warn("external lightmaps",
                  "lightmaps are external files, which are not copied: the merged map looks for the pages of "
                  "the first map from lm_0000 on, and for those of the second from lm_{:04} on, in the folder of its "
                  "own name",
                  lightmapBase_);
}

/// The worldspawn key that tells how basis maps are stored.
void Merger::RecordRnm() {
    if (!bsp_.rnm && !main_.rnm)
        return;
    std::vector<Entity> all = StoredEntities(bsp_.entities, mainName_);
    all.front().Erase(kRnmKey);
    if (bsp_.rnm)
        all.front().Set(kRnmKey, RnmStorageWord(bsp_.rnm->header.storage));
    bsp_.entities = FormatEntities(all);
}

/// Where the records of one kind, surfaces or brushes, are in the two maps.
struct RecordRanges {
    int count = 0;                       ///< in the added map
    int worldFirst = 0, worldCount = 0;  ///< of its world
    int mainCount = 0, mainWorldEnd = 0; ///< in the main map; one past the last of its world
};

/// Number in the merged map of each record of the added one, or kNotTaken. Records of the world are taken with
/// MergeOptions::world, and then follow the world of the main map, or if `alwaysTaken` has them; all others are taken.
std::vector<int> NumbersInMerged(const RecordRanges &ranges, const MergeOptions &options,
                                 const std::vector<bool> &alwaysTaken) {
    std::vector<int> numbers(std::size_t(ranges.count), kNotTaken);
    int next = ranges.mainCount + (options.world ? ranges.worldCount : 0);
    for (int i = 0; i < ranges.count; ++i) {
        const bool isOfWorld = i >= ranges.worldFirst && i < ranges.worldFirst + ranges.worldCount;
        if (isOfWorld && options.world)
            numbers[std::size_t(i)] = ranges.mainWorldEnd + (i - ranges.worldFirst);
        else if (!isOfWorld || alwaysTaken[std::size_t(i)])
            numbers[std::size_t(i)] = next++;
    }
    return numbers;
}

/// Gives numbers to the surfaces and brushes that are taken: the world's go to the end of the world of the first map.
void Merger::ChooseRecords() {
    std::vector<bool> isOfFog(added_.brushes.size());
    for (const bspFog_t &fog : added_.fogs)
        if (fog.brushNum >= 0)
            isOfFog[std::size_t(fog.brushNum)] = true;
    const bspModel_t &world = added_.models[0], &mainWorld = main_.models[0];
    worldSurfaces_ = options_.world ? world.numBSPSurfaces : 0;
    worldBrushes_ = options_.world ? world.numBSPBrushes : 0;
    surfaces_ = NumbersInMerged({.count = int(added_.drawSurfaces.size()),
                                 .worldFirst = world.firstBSPSurface,
                                 .worldCount = world.numBSPSurfaces,
                                 .mainCount = int(main_.drawSurfaces.size()),
                                 .mainWorldEnd = mainWorld.firstBSPSurface + mainWorld.numBSPSurfaces},
                                options_, std::vector<bool>(added_.drawSurfaces.size()));
    brushes_ = NumbersInMerged({.count = int(added_.brushes.size()),
                                .worldFirst = world.firstBSPBrush,
                                .worldCount = world.numBSPBrushes,
                                .mainCount = int(main_.brushes.size()),
                                .mainWorldEnd = mainWorld.firstBSPBrush + mainWorld.numBSPBrushes},
                               options_, isOfFog);
}

/// Makes room for `count` records in front of record `at`, and raises the numbers that refer to records behind.
template <typename Record>
void InsertRoom(std::vector<Record> &records, int at, int count, std::vector<std::int32_t> &numbers) {
    records.insert(records.begin() + at, std::size_t(count), Record{});
    for (std::int32_t &number : numbers)
        number += number >= at ? count : 0;
}

/// Inserts `count` empty records after the world's, adds them to the world model and renumbers the other models.
/// `first` and `num`: the members of a model that hold its range of these records. `numbers`: references of leafs to
/// the records, renumbered too. Returns the number of the first new record.
template <typename Record>
int Merger::ExtendWorld(std::vector<Record> &records, int count, std::vector<std::int32_t> &numbers,
                        std::int32_t bspModel_t::*first, std::int32_t bspModel_t::*num) {
    const int at = main_.models[0].*first + main_.models[0].*num;
    InsertRoom(records, at, count, numbers);
    for (std::size_t i = 1; i < bsp_.models.size(); ++i)
        bsp_.models[i].*first += bsp_.models[i].*first >= at ? count : 0;
    bsp_.models[0].*num += count;
    return at;
}

/// Stores a record under its number; extends the vector if needed.
template <typename Record> void PutAt(std::vector<Record> &records, int number, const Record &record) {
    records.resize(std::max(records.size(), std::size_t(number) + 1));
    records[std::size_t(number)] = record;
}

void Merger::MergeBrushes() {
    const int at = ExtendWorld(bsp_.brushes, worldBrushes_, bsp_.leafBrushes, &bspModel_t::firstBSPBrush,
                               &bspModel_t::numBSPBrushes);
    for (bspFog_t &fog : bsp_.fogs)
        fog.brushNum += fog.brushNum >= at ? worldBrushes_ : 0;
    for (std::size_t i = 0; i < added_.brushes.size(); ++i) {
        if (brushes_[i] == kNotTaken)
            continue;
        bspBrush_t brush = added_.brushes[i];
        const auto sides =
            std::span(added_.brushSides).subspan(std::size_t(brush.firstSide), std::size_t(brush.numSides));
        brush.firstSide = int(bsp_.brushSides.size());
        brush.shaderNum = shaders_[std::size_t(brush.shaderNum)];
        for (const bspBrushSide_t &side : sides)
            bsp_.brushSides.push_back(
                {side.planeNum + planeBase_, shaders_[std::size_t(side.shaderNum)], SurfaceOf(side)});
        PutAt(bsp_.brushes, brushes_[i], brush);
    }
}

/// The draw surface of a side of the added map, by its number in the merged one.
int Merger::SurfaceOf(const bspBrushSide_t &side) const {
    const bool known = side.surfaceNum >= 0 && std::size_t(side.surfaceNum) < surfaces_.size();
    return known ? surfaces_[std::size_t(side.surfaceNum)] : kNotTaken; // both -1 where there is none
}

void Merger::MergeFogs() {
    fogBase_ = int(bsp_.fogs.size());
    for (bspFog_t fog : added_.fogs) {
        if (fog.brushNum >= 0)
            fog.brushNum = brushes_[std::size_t(fog.brushNum)];
        bsp_.fogs.push_back(fog);
    }
}

/// A surface of the second map with numbers of the merged one. Copies its vertices and indexes; surfaces that share
/// them go on sharing.
bspDrawSurface_t Merger::Renumbered(bspDrawSurface_t surface) {
    const auto copied = [](auto &runs, auto &to, const auto &from, int first, int count) {
        const auto [at, isNew] = runs.try_emplace({first, count}, int(to.size()));
        if (isNew)
            to.insert(to.end(), from.begin() + first, from.begin() + first + count);
        return at->second;
    };
    surface.shaderNum = shaders_[std::size_t(surface.shaderNum)];
    surface.fogNum += surface.fogNum >= 0 ? fogBase_ : 0;
    for (std::int32_t &page : surface.lightmapNum)
        page = page < 0 ? page : int(std::min<std::int64_t>(std::int64_t(page) + lightmapBase_, INT32_MAX));
    for (Styles *styles : {&surface.lightmapStyles, &surface.vertexStyles})
        for (std::uint8_t &style : *styles)
            if (const auto changed = styles_.find(style); changed != styles_.end())
                style = std::uint8_t(changed->second);
    if (!vertRuns_.contains({surface.firstVert, surface.numVerts}))
        copiedVerts_.emplace_back(surface.firstVert, surface.numVerts);
    surface.firstVert = copied(vertRuns_, bsp_.drawVerts, added_.drawVerts, surface.firstVert, surface.numVerts);
    surface.firstIndex =
        copied(indexRuns_, bsp_.drawIndexes, added_.drawIndexes, surface.firstIndex, surface.numIndexes);
    return surface;
}

void Merger::MergeSurfaces() {
    const int at = ExtendWorld(bsp_.drawSurfaces, worldSurfaces_, bsp_.leafSurfaces, &bspModel_t::firstBSPSurface,
                               &bspModel_t::numBSPSurfaces);
    for (bspBrushSide_t &side : std::span(bsp_.brushSides).first(main_.brushSides.size()))
        side.surfaceNum += side.surfaceNum >= at ? worldSurfaces_ : 0;
    for (std::size_t i = 0; i < added_.drawSurfaces.size(); ++i)
        if (surfaces_[i] != kNotTaken)
            PutAt(bsp_.drawSurfaces, surfaces_[i], Renumbered(added_.drawSurfaces[i]));
}

void Merger::MergeModels() {
    const auto moved = [](const std::vector<int> &numbers, int first, int count, std::string_view name) {
        if (count == 0)
            return 0;
        for (int i = 0; i < count; ++i)
            if (numbers[std::size_t(first)] == kNotTaken ||
                numbers[std::size_t(first + i)] != numbers[std::size_t(first)] + i)
                throw Error("{}: an inline model shares surfaces or brushes with the world", name);
        return numbers[std::size_t(first)];
    };
    for (std::size_t i = 1; i < added_.models.size(); ++i) {
        bspModel_t model = added_.models[i];
        model.firstBSPSurface = moved(surfaces_, model.firstBSPSurface, model.numBSPSurfaces, addedName_);
        model.firstBSPBrush = moved(brushes_, model.firstBSPBrush, model.numBSPBrushes, addedName_);
        bsp_.models.push_back(model);
    }
}

/// Every brush begins with the six sides of its box, in the order -x +x -y +y -z +z.
Boundsf Merger::BoxOfBrush(const bspBrush_t &brush) const {
    Boundsf box;
    Vec3f mins, maxs;
    for (std::size_t i = 0; i < kBoxSides; ++i) {
        const bspBrushSide_t &side = bsp_.brushSides[std::size_t(brush.firstSide) + i];
        const bspPlane_t &plane = bsp_.planes[std::size_t(side.planeNum)];
        (i % 2 == 0 ? mins : maxs)[i / 2] = i % 2 == 0 ? -plane.dist : plane.dist;
    }
    box.Add(mins);
    box.Add(maxs);
    return box;
}

/// A curve lies within its control points.
Boundsf Merger::BoxOfSurface(const bspDrawSurface_t &surface) const {
    Boundsf box;
    for (int i = 0; i < surface.numVerts; ++i)
        box.Add(Vec3f(bsp_.drawVerts[std::size_t(surface.firstVert + i)].xyz));
    if (surface.surfaceType == MST_FLARE)
        box.Add(Vec3f(surface.lightmapOrigin));
    return box;
}

void Merger::ListWorldInLeafs() {
    LeafLists lists(bsp_);
    const bspModel_t &world = bsp_.models[0];
    for (int i = world.firstBSPSurface + world.numBSPSurfaces - worldSurfaces_;
         i < world.firstBSPSurface + world.numBSPSurfaces; ++i)
        lists.AddSurface(i, BoxOfSurface(bsp_.drawSurfaces[std::size_t(i)]));
    for (int i = world.firstBSPBrush + world.numBSPBrushes - worldBrushes_;
         i < world.firstBSPBrush + world.numBSPBrushes; ++i)
        lists.AddBrush(i, BoxOfBrush(bsp_.brushes[std::size_t(i)]));
    lists.Store(bsp_);
}

} // namespace

Bsp MergeMaps(const NamedBsp &main, const NamedBsp &added, const MergeOptions &options, Log &log) {
    if (main.bsp.ident != added.bsp.ident)
        throw Error("{} is {}, but {} is {}: maps of two formats cannot be merged", main.name, main.bsp.ident,
                    added.name, added.bsp.ident);
    if (main.bsp.lightmapSide != added.bsp.lightmapSide)
        throw Error("{} has lightmap pages of {} texels, but {} of {}: light one of them with the key "
                    "_lightmapimagesize of the other",
                    main.name, main.bsp.lightmapSide, added.name, added.bsp.lightmapSide);
    return Merger(main, added, options, log).Run();
}

} // namespace q3
