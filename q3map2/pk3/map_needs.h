// GPL-2.0-or-later. What a map asks the engine and the game for, where such files come from, and what players have
// already.
#pragma once

#include "common/files/vfs.h"
#include "q3map2/bspfile/bspfile.h"
#include "q3map2/pk3/engine_scripts.h"
#include "q3map2/shader/games.h"

#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace q3 {

/// What a package leaves out because players have it. Names are in lower case, those of files without extension, those
/// of scripts without folder too.
struct Exclusions {
    std::set<std::string> textures, shaders, shaderFiles, sounds, videos;

    bool HasTexture(std::string_view image) const;
    bool HasShader(std::string_view shader) const;
    bool HasShaderFile(std::string_view script) const;
    bool HasSound(std::string_view sound) const;
    bool HasVideo(std::string_view video) const;
    /// Whether the list has it as a texture but not as a shader: players have the image, and a script that defines a
    /// shader of that name would replace it.
    bool IsPureTexture(std::string_view name) const { return HasTexture(name) && !HasShader(name); }
    /// Adds the names of another list.
    void Add(const Exclusions &other);
};

/// Blocks `textures { }`, `shaders { }`, `shaderfiles { }`, `sounds { }` and `videos { }` of names. `name` is for
/// messages. Errors: another block, a brace that is missing.
Exclusions ReadExclusions(std::string text, std::string_view name);

// ---- Where files of a package come from ----

/// Where a file is, as far as it matters to a package.
enum class Whereabouts {
    Nowhere,
    InBase,   ///< in an archive that players have
    NotInBase ///< elsewhere: it must be packed
};

/// The folders that the maps are in, then the game's files.
class PackageSource {
  public:
    /// `folders`: those that hold folders maps, scripts and so on. `basePaks`: masks of archives that players have.
    PackageSource(const VirtualFileSystem &vfs, std::vector<std::filesystem::path> folders,
                  const std::vector<std::string> &basePaks);

    Whereabouts Find(std::string_view name) const;
    /// Nothing if there is no such file or, with a warning, it is damaged.
    std::optional<std::vector<std::byte>> Read(std::string_view name) const;
    /// Where Read finds it, for messages: a file, or an archive and the name in it. Empty: nowhere.
    std::string Location(std::string_view name) const;
    /// The same as Read, as text.
    std::optional<std::string> ReadText(std::string_view name) const;
    /// Names in the folder that end so, each once, sorted: first those of the maps' folders.
    std::vector<std::string> List(std::string_view folder, std::string_view extension) const;

  private:
    /// Empty: not in the maps' folders.
    std::filesystem::path LooseFile(std::string_view name) const;

    const VirtualFileSystem &vfs_;
    std::vector<std::filesystem::path> folders_;
    std::vector<std::string> basePaks_; ///< lower case
};

/// All shader scripts of the game. Prints their number.
EngineScripts ReadScripts(const PackageSource &source, const Game &game, Log &log);

/// Shaders, sounds and models that maps name.
struct MapNeeds {
    WantedList shaders, sounds, models;
    WantedList externalPages; ///< lightmaps that engines load by number, with folder and .tga
};

/// Adds the needs of a map: shaders of surfaces that are drawn, of fogs and remappings, and its level shot; music and
/// sounds of entities; models that entities show in the game, which the compiler has not built in. Sounds that the
/// game's code knows by name, and the level shot, are not required. `name`: of the map, without folder and extension.
void AddNeeds(const Bsp &bsp, std::string_view name, const Game &game, MapNeeds &needs);

/// Shaders of all surfaces of an MD3 model, as engines look them up; nothing for other formats and damaged files.
std::vector<std::string> ShadersOfMd3(std::span<const std::byte> file);
/// Shaders of a skin: what stands after the comma of each line.
std::vector<std::string> ShadersOfSkin(std::string_view text);

} // namespace q3
