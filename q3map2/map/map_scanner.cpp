// GPL-2.0-or-later. Tokens of map text, and messages with their location.
#include "q3map2/map/map_scanner.h"

#include "common/error.h"
#include "common/files/files.h"
#include "q3map2/bspfile/file_kind.h"

#include <algorithm>
#include <filesystem>
#include <span>

namespace q3 {

namespace {

TextScanner::Include IncludeBeside(std::string_view name) {
    return [folder = std::filesystem::path(name).parent_path()](std::string_view file) -> std::optional<std::string> {
        return ReadTextFile(folder / std::filesystem::path(file));
    };
}

} // namespace

std::string PrintableForMessage(std::string_view text) {
    std::string shown(text.substr(0, 64));
    std::ranges::replace_if(
        shown, [](char c) { return static_cast<unsigned char>(c) < ' ' || c == 127; }, ' ');
    return shown;
}

void RequireMapSource(std::string_view text, std::string_view name) {
    std::string kind = KindOfSource(text);
    if (kind.empty()) {
        kind = text.starts_with("IBSP") ? "a compiled map" : KindOfFile(std::as_bytes(std::span(text)));
        for (const std::string_view fine : {kKindEmpty, kKindText, kKindMapSource})
            kind = kind == fine ? "" : kind;
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
    const double value = TakeNumber(rest).value_or(0);
    if (!rest.empty())
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

} // namespace q3
