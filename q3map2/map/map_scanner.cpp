// GPL-2.0-or-later. Tokens of map text with their location, and the outline of a map source.
#include "q3map2/map/map_scanner.h"

#include "common/error.h"
#include "common/files/files.h"
#include "common/text/text.h"
#include "q3map2/bspfile/bspfile.h"

#include <algorithm>
#include <filesystem>
#include <span>

namespace q3 {

// ---- Tokens of map text, and messages with their location ----

namespace {

TextScanner::Include IncludeBeside(std::string_view name) {
    return [folder = std::filesystem::path(name).parent_path()](std::string_view file) -> std::optional<std::string> {
        return ReadTextFile(folder / std::filesystem::path(file));
    };
}

} // namespace

std::string PrintableForMessage(std::string_view text) {
    constexpr std::size_t kMaxShown = 64; // bytes
    std::string shown(text.substr(0, kMaxShown));
    std::ranges::replace_if(
        shown, [](char c) { return static_cast<unsigned char>(c) < ' ' || c == 127; }, ' ');
    return shown;
}

void RequireMapSource(std::string_view text, std::string_view name) {
    std::string kind = KindOfSource(text);
    if (kind.empty()) {
        kind = text.starts_with("IBSP") ? "a compiled map" : KindOfFile(std::as_bytes(std::span(text)));
        for (const std::string_view accepted : {kKindEmpty, kKindText, kKindMapSource})
            kind = kind == accepted ? "" : kind;
    }
    if (!kind.empty())
        throw Error("{}: the file is {}; expected a map source of Quake III or of a game of its family", name, kind);
}

MapScanner::MapScanner(std::string_view text, std::string_view name, const BspContext &context)
    : context_(context), scanner_(std::string(text), std::string(name), IncludeBeside(name), TextDialect::MapSource) {}

void MapScanner::Fail(std::string_view text) const {
    if (primitive_ >= 0)
        context_.FailAt(entity_, primitive_, text, Location());
    if (entity_ >= 0)
        throw Error("Entity {}: {}: {}", entity_, Location(), text);
    throw Error("{}: {}", Location(), text);
}

void MapScanner::Warn(std::string_view kind, std::string_view text) const {
    context_.WarnAt(kind, entity_, primitive_, text, Location());
}

/// Adds entity and primitive to errors of the scanner, which name only file and line.
template <typename Read> bool MapScanner::WithMapLocation(Read read) {
    try {
        return read();
    } catch (const Error &error) {
        if (primitive_ >= 0)
            context_.FailAt(entity_, primitive_, error.what(), "");
        throw;
    }
}

bool MapScanner::Next(std::string &token) {
    return WithMapLocation([&] { return scanner_.Next(token); });
}

bool MapScanner::NextOnLine(std::string &token) {
    return WithMapLocation([&] { return scanner_.NextOnLine(token); });
}

bool MapScanner::Value(std::string &token) {
    return WithMapLocation([&] { return scanner_.NextLongOnLine(token); });
}

std::string MapScanner::Need(std::string_view what) {
    std::string token;
    if (!Next(token))
        Fail(fmt::format("the file ends where {} was expected", what));
    return token;
}

std::string MapScanner::NeedOnLine(std::string_view what) {
    std::string token;
    if (!NextOnLine(token))
        Fail(fmt::format("the line ends where {} was expected", what));
    return token;
}

void MapScanner::Expect(std::string_view token) {
    const std::string found = Need(fmt::format("'{}'", token));
    if (found != token)
        Fail(fmt::format("expected '{}', found '{}'", token, PrintableForMessage(found)));
}

double MapScanner::Number() {
    return NumberOf(NeedOnLine("a number"));
}

double MapScanner::NumberOf(const std::string &token) const {
    std::string_view rest = token;
    const std::optional<double> number = TakeNumber(rest);
    const double value = number.value_or(0);
    if (!number || !rest.empty())
        Warn("not a number",
             fmt::format("expected a number, found '{}': it counts as {}", PrintableForMessage(token), value));
    return value;
}

int MapScanner::Integer() {
    return IntegerFromText(NeedOnLine("a whole number"));
}

bool MapScanner::SkipBlock() {
    std::string token;
    for (int depth = 1; depth > 0;) {
        if (!Next(token))
            return false;
        depth += token == "{" ? 1 : token == "}" ? -1 : 0;
    }
    return true;
}

// ---- The outline of a map source: entities with their pairs, brushes and patches ----

namespace {

/// Replaces each \" by an apostrophe. False: there is none.
bool WithApostrophes(std::string &text) {
    constexpr std::string_view kEscaped = "\\\"";
    bool found = false;
    for (std::size_t at = text.find(kEscaped); at != std::string::npos; at = text.find(kEscaped, at + 1)) {
        text.replace(at, kEscaped.size(), "'");
        found = true;
    }
    return found;
}

class EntityReader {
  public:
    EntityReader(MapScanner &scanner, Log &log, MapEntityHandler &handler)
        : scanner_(scanner), log_(log), handler_(handler) {}

    /// Returns the number of entities.
    int Read() {
        for (; FindEntity(); ++entity_) {
            nextEntityIsOpen_ = false;
            primitive_ = 0;
            handler_.BeginEntity(entity_);
            while (ReadPairOrPrimitive()) {
            }
            handler_.EndEntity();
        }
        return entity_;
    }

  private:
    bool FindEntity();
    bool ReadPairOrPrimitive();
    void ReadPair(std::string key);
    void ReadPrimitive();

    MapScanner &scanner_;
    Log &log_;
    MapEntityHandler &handler_;
    int entity_ = 0, primitive_ = 0;
    /// The "{" of the next entity was already read, because the previous one lacks a "}".
    bool nextEntityIsOpen_ = false;
};

/// Skips to the "{" of the next entity and warns of skipped text. False: end of the map.
bool EntityReader::FindEntity() {
    scanner_.SetContext(-1, -1);
    if (nextEntityIsOpen_)
        return true;
    std::string token;
    bool warned = false;
    while (scanner_.Next(token)) {
        if (token == "{")
            return true;
        if (!warned)
            log_.Warn("text between entities", "{}: expected '{{' of entity {}, found '{}'; skipped to the next '{{'",
                      scanner_.Location(), entity_, PrintableForMessage(token));
        warned = true;
    }
    return false;
}

/// False: the entity ends.
bool EntityReader::ReadPairOrPrimitive() {
    scanner_.SetContext(entity_, -1);
    std::string key;
    if (!scanner_.Next(key)) {
        log_.Warn("entity without end", "{}: the file ends within entity {}, expected '}}'", scanner_.Location(),
                  entity_);
        return false;
    }
    if (key == "}")
        return false;
    if (key == "{") {
        ReadPrimitive();
        return !nextEntityIsOpen_;
    }
    ReadPair(key);
    return true;
}

/// Reads the value of `key`. Escaped quotes become apostrophes: neither games nor the .bsp know escapes.
void EntityReader::ReadPair(std::string key) {
    const auto warn = [&](std::string_view kind, std::string_view text) {
        log_.Warn(kind, "{}: entity {}: {}", scanner_.Location(), entity_, text);
    };
    if (!scanner_.IsQuoted() && key.find('"') != std::string::npos)
        warn("stray quote", fmt::format("expected a key in quotes, found {}: a quote of this line is misplaced or "
                                        "missing",
                                        PrintableForMessage(key)));
    bool escaped = WithApostrophes(key);
    std::string value;
    if (!scanner_.Value(value))
        scanner_.Fail(
            fmt::format("the line ends where the value of the key '{}' was expected", PrintableForMessage(key)));
    escaped |= WithApostrophes(value);
    if (escaped)
        warn("escaped quote", fmt::format("the key '{}' has escaped quotes, which games cannot read: they become "
                                          "apostrophes",
                                          PrintableForMessage(key)));
    handler_.OnPair(key, value);
}

void EntityReader::ReadPrimitive() {
    scanner_.SetContext(entity_, primitive_);
    const std::string first = scanner_.Need("a side of a brush, brushDef or patchDef2");
    if (EqualNoCase(first, "classname")) {
        log_.Warn("missing brace",
                  "{}: '{{' and a class name within entity {}: the next entity starts here, a '}}' is missing",
                  scanner_.Location(), entity_);
        scanner_.PushBack();
        nextEntityIsOpen_ = true;
        return;
    }
    const int primitive = primitive_++;
    if (EqualNoCase(first, "terrainDef")) {
        scanner_.Warn("terrain", "terrainDef is not supported and left out");
        if (!scanner_.SkipBlock())
            scanner_.Fail("the file ends where '}' of the terrain was expected");
    } else if (EqualNoCase(first, "patchDef2") || EqualNoCase(first, "patchDef3")) {
        handler_.OnPatch(primitive, EqualNoCase(first, "patchDef3"));
    } else if (first == "(" || first == "}" || EqualNoCase(first, "brushDef") || EqualNoCase(first, "brushDef3")) {
        handler_.OnBrush(primitive, first);
    } else {
        scanner_.Fail(fmt::format("expected a side of a brush, brushDef, patchDef2 or '}}', found '{}'",
                                  PrintableForMessage(first)));
    }
}

} // namespace

void ReadMapEntities(MapScanner &scanner, std::string_view name, Log &log, MapEntityHandler &handler) {
    if (EntityReader(scanner, log, handler).Read() == 0)
        throw Error("{}: no entity in the map, expected the world as the first", name);
}

} // namespace q3
