// GPL-2.0-or-later. Packages of the Dæmon engine, NAME_VERSION.dpk and folders NAME_VERSION.dpkdir: their names,
// versions, and the file DEPS that names the packages that one needs.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace q3 {

class Log;

/// Extensions of packages as archives and as folders, and the file at their root.
inline constexpr std::string_view kPackageExtension = ".dpk", kPackageFolderExtension = ".dpkdir";
inline constexpr std::string_view kDependencyFile = "DEPS";

struct PackageName {
    std::string name, version; ///< the version is empty: none given
};

/// Of a file or folder name without its extension: what stands before the first '_', and the version behind it, which
/// ends before a second '_'.
PackageName ParsePackageName(std::string_view stem);

/// Below 0: `a` is older than `b`; 0: the same. The order of Debian's version numbers, which Dæmon has: runs of digits
/// as numbers, '~' before the end, letters before other characters.
int CompareVersions(std::string_view a, std::string_view b);

/// Lines `NAME` or `NAME VERSION` of a file DEPS, in order; other lines are warnings. `name` is for messages.
std::vector<PackageName> ParseDependencies(std::string_view text, std::string_view name, Log &log);

} // namespace q3
