// GPL-2.0-or-later. Where files of a package come from.
#include "q3map2/pk3/package_source.h"

#include "common/files/archive.h"
#include "common/files/files.h"
#include "common/text/text.h"

#include <glib.h>

#include <algorithm>
#include <system_error>

namespace q3 {

namespace fs = std::filesystem;

namespace {

bool EndsNoCase(std::string_view name, std::string_view end) {
    return name.size() >= end.size() && EqualNoCase(name.substr(name.size() - end.size()), end);
}

} // namespace

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
    for (const fs::path &folder : folders_) {
        std::error_code absent;
        if (fs::is_regular_file(folder / safe, absent))
            return folder / safe;
    }
    return {};
}

Whereabouts PackageSource::Find(std::string_view name) const {
    if (!LooseFile(name).empty())
        return Whereabouts::Here;
    const std::string location = vfs_.Location(name);
    if (location.empty())
        return Whereabouts::Nowhere;
    const std::size_t inside = location.find(" :: "); // in an archive
    if (inside == std::string::npos)
        return Whereabouts::Here;
    const std::string pak = LowerCase(fs::path(location.substr(0, inside)).filename().string());
    const bool isBase = std::ranges::any_of(
        basePaks_, [&](const std::string &mask) { return g_pattern_match_simple(mask.c_str(), pak.c_str()) != FALSE; });
    return isBase ? Whereabouts::InBase : Whereabouts::Here;
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
        std::error_code failed, unknown;
        for (fs::directory_iterator at(root / folder, failed), end; !failed && at != end; at.increment(failed))
            if (at->is_regular_file(unknown) && EndsNoCase(at->path().filename().string(), extension))
                here.push_back(at->path().filename().string());
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
    log.Count((long long)(scripts.Scripts().size()), "shader scripts");
    return scripts;
}

} // namespace q3
