// GPL-2.0-or-later. What a map asks the engine and the game for, where such files come from, and what players have
// already.
#include "q3map2/pk3/map_needs.h"

#include "common/error.h"
#include "common/files/archive.h"
#include "common/files/files.h"
#include "common/platform/platform.h"
#include "common/text/text.h"
#include "common/text/text_scan.h"
#include "q3map2/bspfile/bspfile_ibsp.h"
#include "q3map2/bspfile/entities.h"
#include "q3map2/bspfile/map_keys.h"
#include "q3map2/pk3/engine_scripts.h"

#include <glib.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <system_error>

namespace q3 {

// ---- What a package leaves out because players have it ----

namespace {

/// A block of a list of exclusions.
struct ExclusionBlock {
    std::string_view word;
    std::set<std::string> Exclusions::*names;
};
constexpr std::array<ExclusionBlock, 5> kBlocks = {{{"textures", &Exclusions::textures},
                                                    {"shaders", &Exclusions::shaders},
                                                    {"shaderfiles", &Exclusions::shaderFiles},
                                                    {"sounds", &Exclusions::sounds},
                                                    {"videos", &Exclusions::videos}}};

/// The file without extension, in lower case.
std::string FileKey(std::string_view file) {
    return PathOf(LowerCase(NameInPackage(file))).replace_extension().generic_string();
}

/// A name as the set of such a block has it.
std::string KeyFor(std::set<std::string> Exclusions::*block, std::string_view name) {
    if (block == &Exclusions::shaders)
        return LowerCase(NameInPackage(name));
    if (block == &Exclusions::shaderFiles)
        return std::filesystem::path(FileKey(name)).filename().generic_string();
    return FileKey(name);
}

/// What a message shows of a word: one in quotes may have several lines.
std::string_view FirstLine(std::string_view word) {
    return word.substr(0, word.find_first_of("\r\n"));
}

} // namespace

bool Exclusions::HasTexture(std::string_view image) const {
    return textures.contains(KeyFor(&Exclusions::textures, image));
}
bool Exclusions::HasShader(std::string_view shader) const {
    return shaders.contains(KeyFor(&Exclusions::shaders, shader));
}
bool Exclusions::HasShaderFile(std::string_view script) const {
    return shaderFiles.contains(KeyFor(&Exclusions::shaderFiles, script));
}
bool Exclusions::HasSound(std::string_view sound) const {
    return sounds.contains(KeyFor(&Exclusions::sounds, sound));
}
bool Exclusions::HasVideo(std::string_view video) const {
    return videos.contains(KeyFor(&Exclusions::videos, video));
}

void Exclusions::Add(const Exclusions &other) {
    for (const ExclusionBlock &block : kBlocks)
        (this->*block.names).insert((other.*block.names).begin(), (other.*block.names).end());
}

Exclusions ReadExclusions(std::string text, std::string_view name) {
    TextScanner scanner(std::move(text), std::string(name));
    Exclusions result;
    for (std::string word, entry; scanner.Next(word);) {
        const ExclusionBlock *block = nullptr;
        for (const ExclusionBlock &known : kBlocks)
            if (EqualNoCase(known.word, word))
                block = &known;
        if (block == nullptr)
            throw Error("{}: {} is not one of textures, shaders, shaderfiles, sounds and videos", scanner.Location(),
                        FirstLine(word));
        if (!scanner.Next(entry) || entry != "{")
            throw Error("{}: expected {{ after {}", scanner.Location(), word);
        while (scanner.Next(entry) && entry != "}")
            (result.*block->names).insert(KeyFor(block->names, entry));
        if (entry != "}")
            throw Error("{}: the block {} has no closing brace", scanner.Location(), word);
    }
    return result;
}

// ---- Where files of a package come from ----

namespace fs = std::filesystem;

PackageSource::PackageSource(const VirtualFileSystem &vfs, std::vector<fs::path> folders,
                             const std::vector<std::string> &basePaks)
    : vfs_(vfs), folders_(std::move(folders)) {
    for (const std::string &mask : basePaks)
        basePaks_.push_back(LowerCase(mask));
}

fs::path PackageSource::LooseFile(std::string_view name) const {
    const std::string safe = SafeName(name);
    if (safe.empty())
        return {};
    for (const fs::path &folder : folders_)
        if (IsFile(folder / safe))
            return folder / safe;
    return {};
}

Whereabouts PackageSource::Find(std::string_view name) const {
    if (!LooseFile(name).empty())
        return Whereabouts::NotInBase;
    const std::string location = vfs_.Location(name);
    if (location.empty())
        return Whereabouts::Nowhere;
    const std::size_t inside = location.find(kInArchive);
    if (inside == std::string::npos)
        return Whereabouts::NotInBase;
    const std::string pak = LowerCase(fs::path(location.substr(0, inside)).filename().string());
    const bool isBase = std::ranges::any_of(
        basePaks_, [&](const std::string &mask) { return g_pattern_match_simple(mask.c_str(), pak.c_str()) != FALSE; });
    return isBase ? Whereabouts::InBase : Whereabouts::NotInBase;
}

std::optional<std::vector<std::byte>> PackageSource::Read(std::string_view name) const {
    const fs::path loose = LooseFile(name);
    if (!loose.empty())
        return ReadFile(loose);
    return vfs_.Read(name);
}

std::string PackageSource::Location(std::string_view name) const {
    const fs::path loose = LooseFile(name);
    return loose.empty() ? vfs_.Location(name) : loose.string();
}

std::optional<std::string> PackageSource::ReadText(std::string_view name) const {
    const auto bytes = Read(name);
    if (!bytes)
        return std::nullopt;
    return std::string(AsText(*bytes));
}

std::vector<std::string> PackageSource::List(std::string_view folder, std::string_view extension) const {
    std::vector<std::string> names;
    for (const fs::path &root : folders_) {
        std::vector<std::string> here;
        for (const fs::path &entry : EntriesOf(root / folder))
            if (EndsWithNoCase(entry.filename().string(), extension) && IsFile(entry))
                here.push_back(entry.filename().string());
        std::ranges::sort(here);
        names.insert(names.end(), here.begin(), here.end());
    }
    for (std::string &name : vfs_.List(folder, extension))
        names.push_back(std::move(name));
    std::vector<std::string> unique;
    for (std::string &name : names)
        if (std::ranges::none_of(unique, [&](const std::string &known) { return EqualNoCase(known, name); }))
            unique.push_back(std::move(name));
    return unique;
}

EngineScripts ReadScripts(const PackageSource &source, const Game &game, Log &log) {
    EngineScripts scripts;
    for (const std::string &name : source.List(game.shaderDir, ".shader")) {
        const std::string path = fmt::format("{}/{}", game.shaderDir, name);
        auto text = source.ReadText(path);
        if (!text)
            continue;
        scripts.Read(path, std::move(*text), log);
        const std::string &fault = scripts.Scripts().back().fault;
        if (!fault.empty() && source.Find(path) != Whereabouts::InBase)
            log.Warn("script that engines ignore", "{}: ioquake3 and engines of its family ignore the whole script",
                     fault);
    }
    log.Count(scripts.Scripts().size(), "shader scripts");
    return scripts;
}

// ---- What a map asks the engine and the game for ----

namespace {

bool HasExtension(std::string_view file) {
    const std::size_t dot = file.rfind('.'), slash = file.rfind('/');
    return dot != std::string_view::npos && (slash == std::string_view::npos || dot > slash);
}

class NeedsOfMap {
  public:
    NeedsOfMap(const Bsp &bsp, std::string_view name, MapNeeds &needs) : bsp_(bsp), name_(name), needs_(needs) {}

    void AddSurfaces(const Game &game) {
        const std::string why = fmt::format("surfaces of {}", name_);
        const std::uint32_t noDraw = game.NoDrawSurfaceFlags();
        for (const bspDrawSurface_t &surface : bsp_.drawSurfaces) {
            const bspShader_t &shader = bsp_.shaders[std::size_t(surface.shaderNum)];
            if ((shader.surfaceFlags & noDraw) == 0)
                needs_.shaders.Add(FieldName(shader.shader), why);
        }
        for (const bspFog_t &fog : bsp_.fogs)
            needs_.shaders.Add(FieldName(fog.shader), fmt::format("a fog of {}", name_));
        if (!bsp_.lightmaps.empty() || !bsp_.lightmapsE5bgr9.empty())
            return;
        for (std::int64_t page = 0; page < bsp_.NamedPages(); ++page)
            needs_.externalPages.Add(fmt::format("maps/{}/lm_{:04}.tga", name_, page),
                                     fmt::format("lightmaps of {}", name_));
    }

    void AddEntities() {
        const std::vector<Entity> entities = StoredEntities(bsp_.entities, name_);
        for (std::size_t i = 0; i < entities.size(); ++i) {
            const std::string why = fmt::format("entity {} of {}, {}", i, name_, entities[i].ClassName());
            if (i == 0)
                AddWorld(entities[i], why);
            AddSounds(entities[i], why);
            AddModels(entities[i], why);
            needs_.shaders.Add(entities[i].Value("targetShaderNewName"), why);
        }
    }

  private:
    void AddWorld(const Entity &world, const std::string &why) {
        for (const auto &[key, value] : world.pairs)
            if (const std::size_t at = value.find(';');
                StartsWithNoCase(key, "vertexremapshader") && at != std::string::npos)
                needs_.shaders.Add(std::string_view(value).substr(at + 1), why);
        std::string_view rest = world.Value("music"); // intro and loop
        while (!rest.empty()) {
            const std::size_t end = std::min(rest.find_first_of(" \t"), rest.size());
            AddSound(rest.substr(0, end), why, Need::Required);
            rest.remove_prefix(std::min(end + 1, rest.size()));
        }
    }

    void AddSounds(const Entity &entity, const std::string &why) {
        constexpr int kBouncePad = 1; // spawnflag of target_push, which has another sound then
        if (const std::string_view noise = entity.Value("noise");
            !noise.starts_with('*')) // '*': a sound of the player model
            AddSound(noise, why, Need::Required);
        // Sounds that the game code plays.
        if (EqualNoCase(entity.ClassName(), "func_plat")) {
            AddSound("sound/movers/plats/pt1_strt.wav", why, Need::Optional);
            AddSound("sound/movers/plats/pt1_end.wav", why, Need::Optional);
        }
        if (EqualNoCase(entity.ClassName(), "target_push") &&
            (IntegerFromText(entity.Value("spawnflags")) & kBouncePad) == 0)
            AddSound("sound/misc/windfly.wav", why, Need::Optional);
    }

    void AddSound(std::string_view sound, const std::string &why, Need need) {
        if (!sound.empty())
            needs_.sounds.Add(std::string(sound) + (HasExtension(sound) ? "" : ".wav"), why, need);
    }

    /// misc_model has become part of the world, and games ignore the entity, unless it is a static prop. Of other
    /// classes only some read `model`.
    void AddModels(const Entity &entity, const std::string &why) {
        const auto isFile = [](std::string_view model) { return !model.empty() && !model.starts_with('*'); };
        const bool isPassedOver = EqualNoCase(entity.ClassName(), "misc_model") && !keys::kStaticProp.Flag(entity);
        if (const auto model = entity.Value("model"); isFile(model) && !isPassedOver)
            needs_.models.Add(model, why,
                              StartsWithNoCase(entity.ClassName(), "misc_") ? Need::Required : Need::Optional);
        if (const auto model = entity.Value("model2"); isFile(model))
            needs_.models.Add(model, why);
        if (const auto skin = entity.Value("skin"); skin.ends_with(".skin"))
            needs_.models.Add(skin, why);
    }

    const Bsp &bsp_;
    std::string_view name_;
    MapNeeds &needs_;
};

// MD3: a header with the offset of the first surface, surfaces with offsets of their shaders and of the next surface,
// shaders made of a name and an index. Offsets in bytes.
constexpr std::size_t kHeadBytes = 108, kSurfaceCountAt = 84, kSurfacesAt = 100;
constexpr std::size_t kSurfaceBytes = 108, kShaderCountAt = 76, kShadersAt = 92, kSurfaceEndAt = 104;
constexpr std::size_t kShaderBytes = 68, kShaderNameBytes = 64;
constexpr std::uint32_t kMostSurfaces = 1024, kMostShaders = 256; // limits of this program, chosen, for damaged files

} // namespace

std::vector<std::string> ShadersOfMd3(std::span<const std::byte> file) {
    const auto word = [&](std::size_t at) { return LoadRecord<std::uint32_t>(file, at); };
    const auto fits = [&](std::size_t at, std::size_t size) { return at <= file.size() && size <= file.size() - at; };
    std::vector<std::string> shaders;
    if (!fits(0, kHeadBytes) || std::memcmp(file.data(), "IDP3", 4) != 0)
        return shaders;
    std::size_t surface = word(kSurfacesAt);
    for (std::uint32_t i = 0; i < std::min(word(kSurfaceCountAt), kMostSurfaces) && fits(surface, kSurfaceBytes); ++i) {
        const std::size_t first = surface + word(surface + kShadersAt);
        for (std::uint32_t k = 0; k < std::min(word(surface + kShaderCountAt), kMostShaders); ++k) {
            const std::size_t at = first + k * kShaderBytes;
            if (!fits(at, kShaderBytes))
                break;
            const auto name = LoadRecord<std::array<char, kShaderNameBytes>>(file, at);
            const std::string_view all(name.data(), name.size());
            shaders.emplace_back(all.substr(0, all.find('\0')));
        }
        surface += word(surface + kSurfaceEndAt);
    }
    return shaders;
}

std::vector<std::string> ShadersOfSkin(std::string_view text) {
    std::vector<std::string> shaders;
    while (!text.empty()) {
        const std::size_t end = std::min(text.find_first_of("\r\n"), text.size());
        std::string_view line = text.substr(0, end);
        text.remove_prefix(std::min(end + 1, text.size()));
        const std::size_t comma = line.find(',');
        if (comma == std::string_view::npos || comma + 1 >= line.size())
            continue;
        line.remove_prefix(std::min(line.find_first_not_of(" \t", comma + 1), line.size()));
        if (!line.empty())
            shaders.emplace_back(line);
    }
    return shaders;
}

void AddNeeds(const Bsp &bsp, std::string_view name, const Game &game, MapNeeds &needs) {
    NeedsOfMap map(bsp, name, needs);
    map.AddSurfaces(game);
    map.AddEntities();
    needs.shaders.Add(fmt::format("levelshots/{}", name), fmt::format("the loading screen of {}", name),
                      Need::Optional);
}

} // namespace q3
