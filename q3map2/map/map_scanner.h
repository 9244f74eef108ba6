// GPL-2.0-or-later. Tokens of map text, and messages with their location.
#pragma once

#include "common/text/text_scan.h"
#include "q3map2/map/bsp_context.h"
#include "q3map2/map/map.h"

#include <string>
#include <string_view>

namespace q3 {

/// Reads a map source token by token. Errors name file and line, and the entity and primitive given
/// to SetContext.
class MapScanner {
  public:
    /// `name` is the file's; files that $include names are relative to its folder.
    MapScanner(std::string_view text, std::string_view name, const BspContext &context);

    /// Numbers of the entity and of the primitive in it that are being read; -1: none.
    void SetContext(int entity, int primitive) { entity_ = entity, primitive_ = primitive; }
    /// The next token, on any line; false at the end.
    bool Next(std::string &token);
    /// The next token of this line; false when there is none.
    bool NextOnLine(std::string &token);
    void PushBack() { scanner_.PushBack(); }
    /// The next token, on any line. Error, with `what` as what was expected, at the end of the text.
    std::string Need(std::string_view what);
    /// The next token of this line.
    std::string NeedOnLine(std::string_view what);
    /// Reads a token. Error if it is another one.
    void Expect(std::string_view token);
    /// Numbers of this line. What is not a number is 0, after a warning.
    double Number();
    double NumberOf(const std::string &token) const;
    int Integer();
    /// Reads on to the "}" that closes a block whose "{" was read. False when the text ends first.
    bool SkipBlock();
    std::string Location() const { return scanner_.Location(); }
    [[noreturn]] void Fail(std::string_view text) const;
    /// The primitive that is being read is left out, or is not what it should be.
    void Warn(std::string_view kind, std::string_view text) const;

  private:
    template <typename Read> bool Guarded(Read read);

    const BspContext &context_;
    TextScanner scanner_;
    int entity_ = -1, primitive_ = -1;
};

/// Text from a file, shortened and without control characters, for one-line messages.
std::string Shown(std::string_view text);

} // namespace q3
