// GPL-2.0-or-later. The tokenizer that shader scripts, their lists and map text share.
#include "common/text/text_scan.h"

#include "common/error.h"
#include "common/text/text.h"

#include <algorithm>

namespace q3 {

namespace {

constexpr std::size_t kMaxToken = 1023;      ///< bytes: engines have room for 1024 with the NUL
constexpr std::size_t kMaxIncludeDepth = 16; ///< limit of this program, chosen
constexpr int kMaxIncludes = 256; ///< in all; chosen, as the depth limit alone would allow exponentially many
constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF", kInclude = "$include";

/// End of the unquoted token that starts at `begin`. `stop`: a byte that ends it, besides blanks.
std::size_t PlainEnd(const std::string &text, std::size_t begin, char stop) {
    const char *end = text.c_str() + begin;
    while (!IsBlank(*end) && *end != stop) // the 0 after the text is a blank
        ++end;
    return std::size_t(end - text.c_str());
}

/// Whether the rest of a line holds nothing but closed quoted tokens, up to its end, a comment, or the } of an entity
/// on one line. A rest that begins with neither a blank nor a } does not.
bool HasCompleteQuotes(std::string_view line) {
    if (!line.empty() && !IsBlank(line.front()) && line.front() != '}')
        return false;
    for (;;) {
        while (!line.empty() && IsBlank(line.front()))
            line.remove_prefix(1);
        if (line.empty() || line.starts_with("//") || line.starts_with('}'))
            return true;
        const std::size_t end = line.find('"', 1);
        if (line.front() != '"' || end == std::string_view::npos || line[end - 1] == '\\')
            return false;
        line.remove_prefix(end + 1);
    }
}

} // namespace

std::size_t QuotedEnd(std::string_view text, std::size_t begin, QuoteEscapes escapes) {
    for (std::size_t at = begin;; ++at) {
        at = std::min(text.find('"', at), text.size());
        if (escapes == QuoteEscapes::None || at == text.size() || at == begin || text[at - 1] != '\\')
            return at;
        const std::size_t lineEnd = std::min(text.find('\n', at), text.size());
        if (HasCompleteQuotes(text.substr(at + 1, lineEnd - at - 1)))
            return at;
    }
}

std::string TextLocation::Text() const {
    return fmt::format("{}:{}", file, line);
}

TextScanner::TextScanner(std::string text, std::string name, Include include, TextDialect dialect)
    : include_(std::move(include)), dialect_(dialect), maxToken_(kMaxToken) {
    last_.file = names_.emplace_back(std::move(name));
    const std::size_t at = text.starts_with(kByteOrderMark) ? kByteOrderMark.size() : 0;
    files_.push_back({&texts_.emplace_back(std::move(text)), at, last_});
}

bool TextScanner::HasIncludes() const {
    const std::string &text = texts_.front();
    for (std::size_t at = text.find('$'); include_ && at != std::string::npos; at = text.find('$', at + 1))
        if (StartsWithNoCase(std::string_view(text).substr(at), kInclude))
            return true;
    return false;
}

void TextScanner::SkipLine() {
    for (std::string_view rest; Read(rest, Within::Line);) {
    }
}

bool TextScanner::ReadCopy(std::string &token, Within within) {
    std::string_view view;
    const bool got = Read(view, within);
    if (got)
        token = view;
    return got;
}

bool TextScanner::NextLongOnLine(std::string &token) {
    maxToken_ = std::string_view::npos;
    const bool got = ReadCopy(token, Within::Line);
    maxToken_ = kMaxToken;
    return got;
}

bool TextScanner::Read(std::string_view &token, Within within) {
    if (pushedBack_) {
        pushedBack_ = false;
        token = token_;
        return true;
    }
    for (;;) {
        File &file = files_.back();
        if (!SkipBlanks(file, within)) {
            if (within == Within::Line || files_.size() == 1)
                return false;
            files_.pop_back();
            continue;
        }
        ReadToken(file);
        if (include_ && token_.starts_with('$') && EqualNoCase(token_, kInclude)) {
            OpenInclude();
            continue;
        }
        token = token_;
        return true;
    }
}

/// Moves to the first byte of a token. False: the line or the file, as `within` says, ends first; then the position is
/// before the line's end or its comment.
bool TextScanner::SkipBlanks(File &file, Within within) const {
    const std::string_view text = *file.text;
    std::size_t &at = file.at;
    for (;;) {
        for (; at < text.size() && IsBlank(text[at]); ++at)
            if (text[at] == '\n') {
                if (within == Within::Line)
                    return false;
                ++file.location.line;
            }
        if (at >= text.size())
            return false;
        const char c = text[at], next = c == '/' && at + 1 < text.size() ? text[at + 1] : '\0';
        const bool startsComment = (c == ';' || c == '#') && dialect_ != TextDialect::Engine;
        if (startsComment || next == '/') {
            if (within == Within::Line)
                return false;
            at = std::min(text.find('\n', at), text.size());
        } else if (next == '*') {
            const std::size_t close = text.find("*/", at + 2);
            const std::size_t end = close == std::string_view::npos ? text.size() : close + 2;
            const auto lines = std::ranges::count(text.substr(at, end - at), '\n');
            if (lines > 0 && within == Within::Line)
                return false;
            file.location.line += int(lines);
            at = end;
        } else {
            return true;
        }
    }
}

/// Reads the token at the current position into token_ and last_, and moves past it.
void TextScanner::ReadToken(File &file) {
    const std::string &text = *file.text;
    std::size_t begin = file.at, end = begin;
    last_ = file.location;
    quoted_ = text[begin] == '"';
    if (quoted_) {
        ++begin;
        end = QuotedEnd(text, begin, dialect_ == TextDialect::MapSource ? QuoteEscapes::Quotes : QuoteEscapes::None);
        file.at = std::min(end + 1, text.size());
        file.location.line += int(std::count(text.begin() + begin, text.begin() + end, '\n'));
    } else {
        end = PlainEnd(text, begin, dialect_ == TextDialect::Engine ? '\0' : ';');
        file.at = end;
    }
    if (end - begin > maxToken_)
        FailLong(std::string_view(text).substr(begin, end - begin));
    token_ = std::string_view(text).substr(begin, end - begin);
}

void TextScanner::FailLong(std::string_view token) const {
    const bool goesOn = quoted_ && token.find('\n') != std::string_view::npos;
    throw Error("{}: a token of {} bytes, expected at most {}{}", Location(), token.size(), kMaxToken,
                goesOn ? " (a quote that is not closed?)" : "");
}

void TextScanner::OpenInclude() {
    std::string name;
    File &file = files_.back();
    if (SkipBlanks(file, Within::Line)) {
        ReadToken(file);
        name = token_;
    }
    const auto isControl = [](char c) { return static_cast<unsigned char>(c) < ' ' || c == 127; };
    if (std::ranges::any_of(name, isControl)) // a missing quote; messages that name the file would not be one line
        throw Error("{}: $include expected the name of a file on this line", Location());
    const bool circle = std::any_of(files_.begin(), files_.end(),
                                    [&](const File &open) { return EqualNoCase(open.location.file, name); });
    if (circle || files_.size() > kMaxIncludeDepth || ++includeCount_ > kMaxIncludes)
        throw Error("{}: $include {} expected includes that end; these run in a circle, nest over {} deep or are over "
                    "{} in all",
                    Location(), name, kMaxIncludeDepth, kMaxIncludes);
    if (std::optional<std::string> text = include_(name))
        files_.push_back({&texts_.emplace_back(std::move(*text)), 0, {names_.emplace_back(name), 1}});
}

} // namespace q3
