// GPL-2.0-or-later. Entities: ordered key and value pairs, as in the entity lump and in .map files.
#pragma once

#include "common/text/text.h"
#include "libs/math/vec.h"

#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace q3 {

/// One entity. Keys are case-insensitive; duplicates are kept and a look-up finds the first.
struct Entity {
    std::vector<std::pair<std::string, std::string>> pairs;

    /// Value of the first of `keys` that is present and not empty, else "".
    std::string_view Value(std::initializer_list<std::string_view> keys) const;
    std::string_view Value(std::string_view key) const { return Value({key}); }
    bool Has(std::string_view key) const { return !Value(key).empty(); }
    /// atof rules: leading blanks, stops at the first bad character; garbage and non-finite values give `fallback`.
    double Number(std::initializer_list<std::string_view> keys, double fallback = 0) const;
    /// True when the text starts with 1.
    bool Flag(std::string_view key) const { return Value(key).starts_with('1'); }
    /// Three finite numbers at the start of the text, else nothing.
    std::optional<Vec3f> Vector(std::initializer_list<std::string_view> keys) const;
    std::string_view ClassName() const { return Value("classname"); }
    /// Replaces the first pair of that key or appends one.
    void Set(std::string_view key, std::string_view value);
    /// Removes all pairs of that key.
    void Erase(std::string_view key);
};

/// Whether the class of the entity begins with "light".
bool IsLight(const Entity &entity);

/// Parses entity lump text: quoted pairs in braces. `name` is for messages. Errors: unbalanced braces, missing strings.
std::vector<Entity> ParseEntities(std::string_view text, std::string_view name);
/// Entities of a compiled map: those of ParseEntities, and a worldspawn if there is none. Errors: of ParseEntities.
std::vector<Entity> StoredEntities(std::string_view text, std::string_view name);
/// The first entity of a compiled map, worldspawn. Has no keys if there is no entity, or if the text is bad, of which
/// ReadBsp has warned.
Entity StoredWorld(std::string_view text);
/// The text in quotes. Quotes in it become apostrophes, since there is no escape that games know.
std::string QuotedToken(std::string_view text);
/// The text form that map compilers write: one pair per line, "\n" line ends, no final NUL.
std::string FormatEntities(const std::vector<Entity> &entities);
/// Entities of .map source text: pairs only, brushes and patches are skipped.
std::vector<Entity> ParseMapEntities(std::string_view text, std::string_view name);

} // namespace q3
