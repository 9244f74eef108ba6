// GPL-2.0-or-later. -cache for bsp: the geometry of an earlier run, if only entities without geometry have changed.
#include "q3map2/stages/geometry_cache.h"

#include "common/error.h"
#include "common/files/vfs.h"
#include "common/text/text.h"
#include "q3map2/bspfile/bspfile.h"
#include "q3map2/bspfile/map_keys.h"
#include "q3map2/geometry/emit/game_entities.h"
#include "q3map2/stages/run_events.h"

#include <algorithm>
#include <set>

namespace q3 {

namespace {

// ---- Entities without geometry ----

/// Names of entities at which decals are aimed, in lower case.
std::set<std::string> TargetsOfDecals(const Map &map) {
    std::set<std::string> names;
    for (const MapEntity &entity : map.entities)
        if (EqualNoCase(entity.pairs.ClassName(), "_decal") && entity.pairs.Has("target"))
            names.insert(LowerCase(entity.pairs.Value("target")));
    return names;
}

/// By MapEntity::number: whether the entity is loose.
std::vector<bool> FindLooseEntities(const Map &map, std::string_view text) {
    std::vector<bool> loose(map.texts.size());
    const std::set<std::string> aims = TargetsOfDecals(map);
    for (std::size_t i = 1; i < map.entities.size(); ++i) {
        const Entity &pairs = map.entities[i].pairs;
        const std::string name = LowerCase(pairs.ClassName());
        const auto [begin, end] = map.texts[std::size_t(map.entities[i].number)];
        const bool hasPrimitives = text.substr(begin, end - begin).find('{') != text.npos;
        loose[std::size_t(map.entities[i].number)] =
            !hasPrimitives && !pairs.Has("model") && name != "_decal" && name != "_skybox" &&
            !name.starts_with("misc_model") && keys::kInstance.Text(pairs).empty() &&
            keys::kCloneName.Text(pairs).empty() && !aims.contains(LowerCase(keys::kTargetName.Text(pairs)));
    }
    return loose;
}

} // namespace

// ---- What an entry depends on and holds ----

struct GeometryCache::Source {
    const Map &map;
    std::vector<bool> loose;
    Hash128 key;    ///< of the settings and the text of all entities that are not loose
    Hash128 places; ///< of their lines, which warnings name

    Source(const Map &m, std::string_view text, const Hash128 &settings) : map(m), loose(FindLooseEntities(m, text)) {
        KeyBuilder keys("geometry"), lines("lines");
        keys.Add(settings.low, settings.high);
        keys.AddText(map.name);
        std::size_t counted = 0;
        std::ptrdiff_t line = 0;
        for (std::size_t number = 0; number < loose.size(); ++number) {
            if (loose[number])
                continue;
            const auto [begin, end] = map.texts[number];
            line += std::ranges::count(text.substr(counted, begin - counted), '\n');
            counted = begin;
            keys.Add(std::uint64_t(number)); // messages and the .srf name it
            keys.AddText(text.substr(begin, end - begin));
            lines.Add(std::int64_t(line));
        }
        key = keys.Key(), places = lines.Key();
    }
};

namespace {

/// Results of an entry.
const Hash128 kBsp = HashOf("bsp"), kRest = HashOf("rest");

/// An entry but for the .bsp.
struct KeptRest {
    std::vector<std::string> requests;
    Hash128 answers; ///< of the files of the game, to the requests
    Hash128 places;
    std::uint8_t hasWarnings = 0;
    std::vector<FloodRegions> trees;
    std::int32_t idleAreaPortals = 0;
    std::string surfaceFile, portalFile;
    std::span<const std::byte> events;
};

std::vector<std::byte> BytesOf(const KeptRest &rest) {
    UnitWriter writer;
    writer.PutTexts(rest.requests);
    writer.Put(rest.answers), writer.Put(rest.places), writer.Put(rest.hasWarnings);
    writer.Put(std::uint64_t(rest.trees.size()));
    for (const FloodRegions &tree : rest.trees)
        writer.PutAll(tree.nodes), writer.PutAll(tree.flooded);
    writer.Put(rest.idleAreaPortals);
    writer.PutText(rest.surfaceFile), writer.PutText(rest.portalFile);
    writer.PutAll(rest.events);
    return writer.Take();
}

/// Nothing: the bytes are of another kind.
std::optional<KeptRest> ReadRest(std::span<const std::byte> bytes) {
    UnitReader reader(bytes);
    KeptRest rest;
    reader.GetTexts(rest.requests);
    reader.Get(rest.answers), reader.Get(rest.places), reader.Get(rest.hasWarnings);
    std::uint64_t trees = 0;
    reader.Get(trees);
    for (std::uint64_t i = 0; i < trees && reader.Fits(); ++i) {
        FloodRegions &tree = rest.trees.emplace_back();
        reader.GetAll(tree.nodes), reader.GetAll(tree.flooded);
    }
    reader.Get(rest.idleAreaPortals);
    reader.GetText(rest.surfaceFile), reader.GetText(rest.portalFile);
    reader.GetView(rest.events);
    return reader.IsComplete() ? std::optional(std::move(rest)) : std::nullopt;
}

bool FloodSameRegions(const Map &map, const std::vector<FloodRegions> &trees) {
    return !trees.empty() &&
           std::ranges::all_of(trees, [&](const FloodRegions &tree) { return FloodsSameRegions(tree, map); });
}

} // namespace

// ---- Finding and keeping geometry ----

std::optional<CompiledMap> GeometryCache::Find(const Source &source, const BspContext &context) {
    const std::optional<UnitFile> entry = cache_->Read(source.key);
    if (!entry || entry->results.size() != 2 || entry->results[0].key != kBsp || entry->results[1].key != kRest)
        return std::nullopt;
    std::optional<KeptRest> rest = ReadRest(entry->results[1].bytes);
    if (!rest || (rest->hasWarnings != 0 && rest->places != source.places) ||
        vfs_.AnswersTo(rest->requests) != rest->answers || !FloodSameRegions(source.map, rest->trees))
        return std::nullopt;
    CompiledMap compiled;
    try {
        Log silent([](LogLevel, std::string_view) {}); // the stage says what is wrong with the file that it writes
        compiled.bsp = ReadBsp(entry->results[0].bytes, "the geometry in the cache", format_, silent);
    } catch (const Error &) { // beyond a limit of this program's reader
        return std::nullopt;
    }
    vfs_.AddRequests(rest->requests);
    compiled.surfaceFile = std::move(rest->surfaceFile);
    compiled.portalFile = std::move(rest->portalFile);
    compiled.idleAreaPortals = rest->idleAreaPortals;
    RunEvents::Replay(rest->events, context.log);
    WarnOfEntitiesInSolid(rest->trees.front(), source.map, context);
    context.log.Print("Only entities without geometry have changed: the geometry is taken from the cache\n");
    return compiled;
}

void GeometryCache::Keep(const Source &source, const CompiledMap &compiled, RunEvents &events) const {
    const bool isSealed = !compiled.abandoned && !compiled.portalFile.empty();
    if (!isSealed || !vfs_.ReadFilesAreUnchanged())
        return;
    KeptRest rest;
    rest.requests = vfs_.Requests();
    rest.answers = vfs_.AnswersTo(rest.requests);
    rest.places = source.places;
    rest.hasWarnings = events.HasWarnings() ? 1 : 0;
    rest.trees = compiled.regions;
    rest.idleAreaPortals = compiled.idleAreaPortals;
    rest.surfaceFile = compiled.surfaceFile, rest.portalFile = compiled.portalFile;
    const std::vector<std::byte> eventBytes = events.Take();
    rest.events = eventBytes;
    const std::vector<std::byte> restBytes = BytesOf(rest);
    try {
        const std::vector<std::byte> bsp = WriteBsp(compiled.bsp, format_);
        UnitFile entry;
        entry.header.stage = "-bsp";
        entry.header.text = "the geometry of a map";
        entry.results = {{kBsp, bsp}, {kRest, restBytes}};
        cache_->Write(source.key, entry);
    } catch (const Error &) {
        // No file can be made of this map, which the stage says when it writes it.
    }
}

CompiledMap GeometryCache::Compile(Map &map, std::string_view text, const BspContext &context) {
    // -flares makes surfaces of lights.
    if (!cache_ || map.texts.empty() || context.options.flares || context.options.autoCaulk)
        return CompileMap(map, context);
    const Source source(map, text, settings_);
    return CompileMap(map, context, [&](Map &numbered, BspContext inner) {
        if (std::optional<CompiledMap> known = Find(source, context))
            return std::move(*known);
        inner.findsRegions = true;
        RunEvents events(context.log, {kEntityInSolid, kLightInDetail}); // Find prints them
        CompiledMap compiled = CompileGeometry(numbered, inner);
        Keep(source, compiled, events);
        return compiled;
    });
}

} // namespace q3
