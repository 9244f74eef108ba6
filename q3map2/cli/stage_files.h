// GPL-2.0-or-later. The files that a stage reads and writes: the map that a word means, files beside it, and what may
// go wrong with them.
#pragma once

#include "common/arguments.h"
#include "common/files/files.h"
#include "common/settings.h"

#include <cstdint>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace q3 {

class Log;
struct StageContext;

/// Replaces the extension of a map file (.map, .bsp, .prt ...). Any other extension is part of the map's name and
/// stays: ctf.1 becomes ctf.1.bsp.
std::filesystem::path WithExtension(const std::filesystem::path &path, std::string_view extension);

/// WithExtension, or the existing file whose extension differs only in case (x.BSP).
std::filesystem::path Beside(const std::filesystem::path &map, std::string_view extension);

/// Absolute path of the file with that extension that a word of the command line means, whatever extension the word
/// has. If there is no such file: where it would be.
std::filesystem::path MapPath(const std::string &word, std::string_view extension);

/// Throws Error if there is no such file. It says what is there instead, and proposes similar names from the folder of
/// `path` and from the folders maps of `gameFolders`.
void RequireMap(const std::filesystem::path &path, std::span<const std::filesystem::path> gameFolders = {});

/// MapPath of a .bsp that exists. Errors: those of RequireMap.
std::filesystem::path ExistingBsp(const std::string &word, std::span<const std::filesystem::path> gameFolders = {});

// ---- The files of a map, and the options that place them elsewhere ----

/// Where options of a stage say that files of its map are; empty: beside the map.
struct FilePlaces {
    std::string bsp, srf, prt, lin;
};

/// The options of a stage that place files: of "-bsp", "-vis" or "-light".
std::vector<SettingGroup<FilePlaces>> FileSettings(std::string_view stage);

/// Takes them off `arguments`. To be called before the words are copied that the map records: what is in a map does not
/// depend on folders. Errors: a -bspfile that does not end in .bsp.
FilePlaces TakeFilePlaces(std::string_view stage, Arguments &arguments, Log &log);

/// Absolute paths of the files of a map, which need not exist.
struct MapFiles {
    std::filesystem::path map, rad, bsp, srf, prt, lin;
};

/// The files beside `map`, but for those that have other places.
MapFiles FilesOf(const std::filesystem::path &map, const FilePlaces &places = {});

/// For a stage that reads a .bsp: the .bsp that `word` names and the files beside it. With -bspfile, `word` may name
/// the map source instead, and its other files are beside that. Errors: those of RequireMap, for the .bsp and for a
/// word that names neither.
MapFiles FilesOfBsp(const std::string &word, const FilePlaces &places = {},
                    std::span<const std::filesystem::path> gameFolders = {});

/// Errors: two of these files are one.
void RequireDistinct(std::span<const std::filesystem::path> files);

// ---- Checks around a stage ----

/// A stage declares its files before it computes, and checks before it writes that no other program changed them.
class FileGuard {
  public:
    explicit FileGuard(const StageContext &context);
    FileGuard(bool force, Log &log) : log_(log), force_(force) {}

    /// A file that the result depends on, or that the result replaces. To be called before the file is read; the file
    /// may be missing.
    void Reads(const std::filesystem::path &file);
    /// The same for a file that must exist. Errors: it cannot be read.
    void Needs(const std::filesystem::path &file);
    /// A file that the stage will write, and its approximate size; 0: small or unknown. Errors: it cannot be written,
    /// or its disk lacks the space for it and for the files named before on the same disk. With -force, lack of
    /// space is a warning.
    void Writes(const std::filesystem::path &file, std::uint64_t bytes = 0);
    /// The same for files in a folder, which the stage creates if it does not exist.
    void WritesInto(const std::filesystem::path &folder, std::uint64_t bytes = 0);
    /// The files of Reads and Needs, and those of Writes, each in the order of the calls.
    std::vector<std::filesystem::path> InputFiles() const;
    const std::vector<std::filesystem::path> &OutputFiles() const { return outputs_; }
    /// Whether WritesInto was called, so that the files that the stage writes are not known.
    bool WritesIntoFolders() const { return writesIntoFolders_; }

    /// To be called before the first file is written. Errors: a file of Reads has changed; with -force, a warning.
    void CheckUnchanged() const;

  private:
    struct Input {
        std::filesystem::path file;
        FileState state;
    };

    void Reserve(std::filesystem::path folder, std::uint64_t bytes);
    void FailUnlessForced(const std::string &text) const;

    Log &log_;
    bool force_;
    std::vector<Input> inputs_;
    std::vector<std::filesystem::path> outputs_;
    bool writesIntoFolders_ = false;
    std::map<std::uint64_t, std::uint64_t> needed_; ///< bytes, by disk (DiskOf)
};

/// Size of the file; 0: there is none.
std::uint64_t SizeOfFile(const std::filesystem::path &file);

/// Warns if the map source is newer than the .bsp, so that the .bsp lacks its latest changes.
void WarnIfSourceIsNewer(const MapFiles &files, Log &log);

} // namespace q3
