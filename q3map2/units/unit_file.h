// GPL-2.0-or-later. Files of unit results: whole, and checked by hash when they are read.
#pragma once

#include "common/files/files.h"
#include "q3map2/units/unit_store.h"

#include <filesystem>
#include <string>

namespace q3 {

/// What the results of a file are of.
struct UnitFileHeader {
    std::string stage; ///< "-light"
    std::string text;  ///< what the file is, for messages
    Hash128 inputs;    ///< of everything that the results depend on
    std::int32_t round = 1;
    PartNumber part; ///< 1 of 1: all results of the round
    bool operator==(const UnitFileHeader &) const = default;
};

struct UnitFile {
    UnitFileHeader header;
    std::vector<UnitResult> results;
    MappedFile storage; ///< of the results, if the file was read
};

/// Replaces the file as a whole. Numbers are little-endian as in memory. Errors: those of FileReplacement.
void WriteUnitFile(const std::filesystem::path &path, const UnitFile &file);
/// Errors: Error naming the file, if it cannot be read, is of another kind or version, or is damaged.
UnitFile ReadUnitFile(const std::filesystem::path &path);

} // namespace q3
