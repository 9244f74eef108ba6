// GPL-2.0-or-later. Tokens of map text with their location, and the outline of a map source.
#pragma once

#include "common/log.h"
#include "common/text/text_scan.h"
#include "q3map2/map/bsp_options.h"
#include "q3map2/map/map.h"

#include <string>
#include <string_view>

namespace q3 {

/// Reads a map source token by token. Errors name file and line, and the entity and primitive given
/// to SetContext.
class MapScanner {
  public:
    /// `name`: name of the file; paths after $include are relative to its folder.
    MapScanner(std::string_view text, std::string_view name, const BspContext &context);

    /// Numbers of the current entity and of the current primitive in it; -1: none.
    void SetContext(int entity, int primitive) { entity_ = entity, primitive_ = primitive; }
    /// The next token, on any line; false at the end.
    bool Next(std::string &token);
    /// The next token of this line; false when there is none.
    bool NextOnLine(std::string &token);
    /// NextOnLine for the value of a key, which may have any length.
    bool Value(std::string &token);
    /// Whether the last token was in quotes.
    bool IsQuoted() const { return scanner_.IsQuoted(); }
    /// The next call returns the last token again.
    void PushBack() { scanner_.PushBack(); }
    /// The next token, on any line. Throws Error, which names `what` as expected, at the end of the text.
    std::string Need(std::string_view what);
    /// The next token of this line. Throws Error at the end of the line.
    std::string NeedOnLine(std::string_view what);
    /// Reads a token. Throws Error if it is not `token`.
    void Expect(std::string_view token);
    /// The next number of this line. Malformed text counts as the number at its start, else 0, after a warning.
    double Number();
    /// The same for a token that was read.
    double NumberOf(const std::string &token) const;
    /// The next whole number of this line; malformed text counts likewise, without a warning.
    int Integer();
    /// Skips to the "}" of a block whose "{" was already read. False if the text ends first.
    bool SkipBlock();
    std::string Location() const { return scanner_.Location(); }
    /// As of TextScanner.
    std::string_view Unread() const { return scanner_.Unread(); }
    bool HasIncludes() const { return scanner_.HasIncludes(); }
    [[noreturn]] void Fail(std::string_view text) const;
    /// Warns of the current primitive, with its location.
    void Warn(std::string_view kind, std::string_view text) const;

  private:
    template <typename Read> bool WithMapLocation(Read read);

    const BspContext &context_;
    TextScanner scanner_;
    int entity_ = -1, primitive_ = -1;
};

/// Throws Error if the text is a map source of another game family, or a file of another known kind.
void RequireMapSource(std::string_view text, std::string_view name);

/// Text from a file for one-line messages: shortened, control characters replaced by blanks.
std::string PrintableForMessage(std::string_view text);

/// Receives what ReadMapEntities finds, in the order of the text. Entities are numbered from 0 in the map, primitives
/// (brushes and patches) from 0 in their entity.
class MapEntityHandler {
  public:
    virtual ~MapEntityHandler() = default;
    virtual void BeginEntity(int entity) = 0;
    virtual void OnPair(const std::string &key, const std::string &value) = 0;
    /// Must read the brush up to its "}". `first`: the token after its "{", already read.
    virtual void OnBrush(int primitive, const std::string &first) = 0;
    /// Must read the patch after its keyword: patchDef3 if it `hasTolerances`, else patchDef2.
    virtual void OnPatch(int primitive, bool hasTolerances) = 0;
    virtual void EndEntity() = 0;
};

/// Reads a whole map source. `name`: of the file, for messages. Warns of text between entities, of missing braces and
/// of terrainDef, which it skips. Errors: no entity, and what is neither a brush nor a patch.
void ReadMapEntities(MapScanner &scanner, std::string_view name, Log &log, MapEntityHandler &handler);

} // namespace q3
