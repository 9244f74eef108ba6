// GPL-2.0-or-later. The files that a stage reads and writes: the map that a word means, files beside it, and what may
// go wrong with them.
#include "q3map2/cli/stage_files.h"

#include "common/error.h"
#include "common/files/files.h"
#include "common/text/text.h"
#include "q3map2/cli/program.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <optional>
#include <set>
#include <system_error>
#include <vector>

namespace q3 {

namespace fs = std::filesystem;

namespace {

constexpr std::array<std::string_view, 11> kMapFileExtensions = {".map", ".bsp",   ".reg", ".ent", ".prt", ".srf",
                                                                 ".lin", ".caulk", ".rad", ".aas", ".html"};

bool IsDirectory(const fs::path &path) {
    std::error_code absent;
    return fs::is_directory(path, absent);
}

bool HasExtension(const fs::path &path, std::string_view extension) {
    return EqualNoCase(path.extension().string(), extension);
}

bool HasMapFileExtension(const fs::path &path) {
    return std::ranges::any_of(kMapFileExtensions,
                               [&](std::string_view extension) { return HasExtension(path, extension); });
}

fs::path Appended(fs::path path, std::string_view extension) {
    path += extension;
    return path;
}

std::vector<fs::path> FilesIn(const fs::path &folder, std::string_view extension) {
    std::vector<fs::path> files;
    for (fs::path &entry : EntriesOf(folder))
        if (HasExtension(entry, extension) && IsFile(entry))
            files.push_back(std::move(entry));
    std::ranges::sort(files);
    return files;
}

/// The file `base` with the extension, in any case.
std::optional<fs::path> FileOf(const fs::path &base, std::string_view extension) {
    if (fs::path exact = Appended(base, extension); IsFile(exact))
        return exact;
    for (fs::path &file : FilesIn(base.parent_path(), extension))
        if (file.stem() == base.filename())
            return std::move(file);
    return std::nullopt;
}

/// Existing files whose names resemble that of `path`, which does not exist.
std::vector<std::string> Proposals(const fs::path &path, std::span<const fs::path> gameFolders) {
    const std::string extension = path.extension().string(), stem = path.stem().string();
    const fs::path here = path.parent_path().lexically_normal();
    std::vector<fs::path> folders{here, here / "maps"};
    for (const fs::path &game : gameFolders)
        if (const fs::path folder = fs::absolute(game / "maps").lexically_normal();
            std::ranges::find(folders, folder) == folders.end())
            folders.push_back(folder);
    std::vector<std::string> names, found;
    for (const fs::path &folder : folders)
        for (const fs::path &file : FilesIn(folder, extension)) {
            names.push_back(file.stem().string());
            if (EqualNoCase(names.back(), stem) && std::ranges::find(found, file.string()) == found.end())
                found.push_back(file.string());
        }
    if (!found.empty())
        return found;
    constexpr std::size_t kTooShort = 2; // letters; to such a stem every short name would be near
    const std::vector<std::string> nearest =
        stem.size() > kTooShort ? NearestNames(stem, names) : std::vector<std::string>();
    for (const fs::path &folder : folders)
        for (const fs::path &file : FilesIn(folder, extension))
            if (std::ranges::find(nearest, file.stem().string()) != nearest.end())
                found.push_back(file.string());
    return found;
}

/// Maps in a folder or, if it has none, in its subfolder maps.
std::vector<fs::path> MapsIn(const fs::path &folder, std::string_view extension) {
    std::vector<fs::path> maps = FilesIn(folder, extension);
    return maps.empty() ? FilesIn(folder / "maps", extension) : maps;
}

} // namespace

fs::path WithExtension(const fs::path &path, std::string_view extension) {
    fs::path result = path;
    if (HasMapFileExtension(path))
        result.replace_extension();
    return Appended(std::move(result), extension);
}

fs::path Beside(const fs::path &map, std::string_view extension) {
    return FileOf(WithExtension(map, ""), extension).value_or(WithExtension(map, extension));
}

fs::path MapPath(const std::string &word, std::string_view extension) {
    fs::path path = fs::absolute(word);
    if (!path.has_filename()) // maps/
        path = path.parent_path();
    if (HasExtension(path, extension) && IsFile(path))
        return path;
    const fs::path base = WithExtension(path, "");
    if (const auto file = FileOf(base, extension))
        return *file;
    if (!HasMapFileExtension(path)) {
        fs::path shorter = path;
        shorter.replace_extension();
        if (const auto file = FileOf(shorter, extension))
            return *file;
        if (IsFile(path))
            return path;
    }
    if (word.find('\\') != std::string::npos) {
        std::string slashes = word;
        std::ranges::replace(slashes, '\\', '/');
        return MapPath(slashes, extension);
    }
    return Appended(base, extension);
}

void RequireMap(const fs::path &path, std::span<const fs::path> gameFolders) {
    if (IsFile(path))
        return;
    const std::string extension = path.extension().string();
    const fs::path folder = IsDirectory(path) ? path : WithExtension(path, "");
    // A lit map may have a folder of its name, with lightmaps.
    if (const auto maps = MapsIn(folder, extension); !maps.empty() || IsDirectory(path))
        throw Error("{} is a folder, expected a map{}", folder.string(),
                    maps.empty() ? std::string() : fmt::format(", such as {}", maps.front().string()));
    std::error_code absent;
    if (fs::exists(path, absent))
        throw Error("{}: cannot read: not a regular file", path.string());
    const std::vector<std::string> found = Proposals(path, gameFolders);
    if (!found.empty())
        throw Error("{} does not exist; did you mean {}?", path.string(), fmt::join(found, " or "));
    if (HasExtension(path, ".bsp"))
        if (const auto source = FileOf(WithExtension(path, ""), ".map"))
            throw Error("{} does not exist, but its source does: q3map2 -bsp {} compiles it", path.string(),
                        source->string());
    if (!IsDirectory(path.parent_path()))
        throw Error("{} does not exist: there is no folder {}", path.string(), path.parent_path().string());
    throw Error("{} does not exist{}", path.string(),
                IsDirectory(folder) ? fmt::format("; {} is a folder", folder.string()) : std::string());
}

fs::path ExistingBsp(const std::string &word, std::span<const fs::path> gameFolders) {
    fs::path path = MapPath(word, ".bsp");
    RequireMap(path, gameFolders);
    return path;
}

// ---- The files of a map, and the options that place them elsewhere ----

namespace {

/// An option that places a file, with its help in each stage; without help the stage does not have it.
struct PlacingOption {
    std::string_view name;
    std::string FilePlaces::*field;
    std::string_view initial, example;
    std::string_view bsp, vis, light;

    std::string_view HelpIn(std::string_view stage) const {
        return stage == "-bsp" ? bsp : stage == "-vis" ? vis : light;
    }
};

constexpr PlacingOption kPlacingOptions[] = {
    {"-bspfile", &FilePlaces::bsp, "x.bsp", "build/mymap.bsp",
     "Writes the compiled map to FILE, which -onlyents reads too", "Reads and writes this compiled map",
     "Reads and writes this compiled map, and writes images and shaders next to it"},
    {"-srffile", &FilePlaces::srf, "x.srf", "build/mymap.srf", "Writes the settings of surfaces, for -light, to FILE",
     "", "Reads the settings of surfaces, which the bsp stage wrote, from FILE"},
    {"-prtfile", &FilePlaces::prt, "x.prt", "build/mymap.prt", "Writes the portals, for -vis, to FILE",
     "Reads the portals from FILE, which is deleted without -saveprt", ""},
    {"-linfile", &FilePlaces::lin, "x.lin", "build/mymap.lin", "Writes the line that shows a leak to FILE", "", ""},
};

} // namespace

std::vector<SettingGroup<FilePlaces>> FileSettings(std::string_view stage) {
    SettingGroup<FilePlaces> group{
        "Places of files",
        "These options are for builds that keep sources and results apart. FILE is a path, absolute or from the "
        "current folder, and its folder must exist. Files that no option names are next to the map of the command "
        "line. The worldspawn key `_q3map2_cmdline` does not record these options.",
        {}};
    for (const PlacingOption &option : kPlacingOptions)
        if (!option.HelpIn(stage).empty())
            group.settings.push_back({{.name = option.name,
                                       .values = "FILE",
                                       .initial = option.initial,
                                       .help = option.HelpIn(stage),
                                       .since = "q3map2",
                                       .example = option.example},
                                      option.field});
    return {group};
}

FilePlaces TakeFilePlaces(std::string_view stage, Arguments &arguments, Log &log) {
    FilePlaces places;
    TakeSettings(FileSettings(stage), places, arguments, log);
    if (!places.bsp.empty() && !HasExtension(places.bsp, ".bsp"))
        throw Error("-bspfile {}: expected a name that ends in .bsp", places.bsp);
    return places;
}

MapFiles FilesOf(const fs::path &map, const FilePlaces &places) {
    const auto placed = [&](const std::string &place, std::string_view extension) {
        return place.empty() ? Beside(map, extension) : fs::absolute(place).lexically_normal();
    };
    return {.map = Beside(map, ".map"),
            .rad = Beside(map, ".rad"),
            .bsp = placed(places.bsp, ".bsp"),
            .srf = placed(places.srf, ".srf"),
            .prt = placed(places.prt, ".prt"),
            .lin = placed(places.lin, ".lin")};
}

MapFiles FilesOfBsp(const std::string &word, const FilePlaces &places, std::span<const fs::path> gameFolders) {
    const fs::path beside = MapPath(word, ".bsp"), source = MapPath(word, ".map");
    if (places.bsp.empty()) {
        RequireMap(beside, gameFolders);
        MapFiles files = FilesOf(beside, places);
        files.bsp = beside; // keeps the extension of `word`
        return files;
    }
    MapFiles files = FilesOf(IsFile(source) ? source : beside, places);
    RequireMap(files.bsp);
    if (!IsFile(beside))
        RequireMap(source, gameFolders);
    return files;
}

void RequireDistinct(std::span<const fs::path> files) {
    std::set<fs::path> known;
    for (const fs::path &file : files)
        if (!known.insert(fs::weakly_canonical(file)).second)
            throw Error("{}: two files of this run would have this name", file.string());
}

// ---- FileGuard ----

FileGuard::FileGuard(const StageContext &context) : FileGuard(context.options.force, context.log) {}

void FileGuard::Reads(const fs::path &file) {
    inputs_.push_back({file, FileState::Of(file)});
}

void FileGuard::Needs(const fs::path &file) {
    const InputFile opened(file);
    Reads(file);
}

void FileGuard::Writes(const fs::path &file, std::uint64_t bytes) {
    RequireWritable(file);
    if (std::ranges::find(outputs_, file) == outputs_.end())
        outputs_.push_back(file);
    Reserve(fs::absolute(file).parent_path(), bytes);
}

void FileGuard::WritesInto(const fs::path &folder, std::uint64_t bytes) {
    RequireFolder(folder);
    writesIntoFolders_ = true;
    Reserve(fs::absolute(folder), bytes);
}

/// Adds `bytes` to what the stage needs on the disk of the folder. A new file is complete before it replaces the old
/// one, so the space of the old one does not count as free.
void FileGuard::Reserve(fs::path folder, std::uint64_t bytes) {
    std::error_code failed;
    while (!fs::exists(folder, failed) && folder.has_relative_path())
        folder = folder.parent_path();
    const std::uint64_t needed = needed_[DiskOf(folder)] += bytes;
    const fs::space_info space = fs::space(folder, failed);
    if (!failed && needed > 0 && space.available < needed)
        FailUnlessForced(fmt::format(
            "{}: cannot write: {} are free on this disk, and about {} are needed; free some space or choose another "
            "folder",
            folder.string(), SizeText(space.available), SizeText(needed)));
}

void FileGuard::FailUnlessForced(const std::string &text) const {
    if (!force_)
        throw Error("{}", text);
    log_.Warn("files", "{}", text);
}

std::vector<fs::path> FileGuard::InputFiles() const {
    std::vector<fs::path> files;
    for (const Input &input : inputs_)
        files.push_back(input.file);
    return files;
}

void FileGuard::CheckUnchanged() const {
    for (const Input &input : inputs_)
        if (const FileState now = FileState::Of(input.file); now != input.state)
            FailUnlessForced(fmt::format(
                "{} was {} while this run was working, by another run or another program: the result {} made "
                "from the old file{}",
                input.file.string(), now.exists ? "written" : "removed", force_ ? "is" : "would be",
                force_ ? "" : ", so nothing is written. Run again, or write it anyway with -force"));
}

std::uint64_t SizeOfFile(const fs::path &file) {
    std::error_code failed;
    const std::uintmax_t size = fs::file_size(file, failed);
    return failed ? 0 : size;
}

void WarnIfSourceIsNewer(const MapFiles &files, Log &log) {
    const FileState map = FileState::Of(files.map), bsp = FileState::Of(files.bsp);
    if (map.exists && bsp.exists && map.stamp.written > bsp.stamp.written)
        log.Warn("newer map source",
                 "{} is newer than {}: changes since then, other than those of light entities, are not in the .bsp; "
                 "compile the map again with -bsp",
                 files.map.string(), files.bsp.filename().string());
}

} // namespace q3
