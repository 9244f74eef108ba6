// GPL-2.0-or-later. The tokenizer that shader scripts, their lists and map text share.
#include "common/text_scan.h"

#include "common/error.h"

#include <algorithm>

namespace q3 {

namespace {

constexpr std::size_t kMaxToken = 1023;
constexpr std::size_t kMaxIncludeDepth = 16;
constexpr int kMaxIncludes = 256; // in all: files that include others twice would multiply
constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";

bool IsBlank(char c) {
    return static_cast<unsigned char>(c) <= 32;
}

} // namespace

TextScanner::TextScanner(std::string text, std::string name, Include include) : include_(std::move(include)) {
    lastName_ = name;
    const std::size_t at = text.starts_with(kByteOrderMark) ? kByteOrderMark.size() : 0;
    files_.push_back({std::move(text), std::move(name), at, 1});
}

std::string TextScanner::Location() const {
    return fmt::format("{}:{}", lastName_, lastLine_);
}

bool TextScanner::Next(std::string &token) {
    return Read(token, true);
}

bool TextScanner::NextOnLine(std::string &token) {
    return Read(token, false);
}

void TextScanner::SkipLine() {
    std::string rest;
    while (Read(rest, false)) {
    }
}

bool TextScanner::Read(std::string &token, bool crossLines) {
    if (pushedBack_) {
        pushedBack_ = false;
        token = last_;
        return true;
    }
    for (;;) {
        File &file = files_.back();
        if (!SkipBlanks(file, crossLines)) {
            if (!crossLines || files_.size() == 1)
                return false;
            files_.pop_back();
            continue;
        }
        Cut(file);
        if (include_ && EqualNoCase(last_, "$include")) {
            OpenInclude();
            continue;
        }
        token = last_;
        return true;
    }
}

/// Moves to the first byte of a token. False: the file, or without crossLines the line, ends first; then the position
/// is before the line's end or its comment.
bool TextScanner::SkipBlanks(File &file, bool crossLines) const {
    const std::string &text = file.text;
    while (file.at < text.size()) {
        const char c = text[file.at];
        const char next = file.at + 1 < text.size() ? text[file.at + 1] : '\0';
        if (IsBlank(c)) {
            if (c == '\n' && !crossLines)
                return false;
            file.line += c == '\n';
            ++file.at;
        } else if (c == ';' || c == '#' || (c == '/' && next == '/')) {
            if (!crossLines)
                return false;
            file.at = std::min(text.find('\n', file.at), text.size());
        } else if (c == '/' && next == '*') {
            const std::size_t close = text.find("*/", file.at + 2);
            const std::size_t end = close == std::string::npos ? text.size() : close + 2;
            const auto lines = std::count(text.begin() + file.at, text.begin() + end, '\n');
            if (lines > 0 && !crossLines)
                return false;
            file.line += int(lines);
            file.at = end;
        } else {
            return true;
        }
    }
    return false;
}

/// Takes the token that starts here into last_.
void TextScanner::Cut(File &file) {
    const std::string &text = file.text;
    std::size_t begin = file.at, end = begin;
    lastName_ = file.name;
    lastLine_ = file.line;
    if (text[begin] == '"') {
        ++begin;
        end = std::min(text.find('"', begin), text.size());
        file.at = std::min(end + 1, text.size());
        file.line += int(std::count(text.begin() + begin, text.begin() + end, '\n'));
    } else {
        while (end < text.size() && !IsBlank(text[end]) && text[end] != ';')
            ++end;
        file.at = end;
    }
    if (end - begin > kMaxToken)
        throw Error("{}: a token of {} bytes, expected at most {} (a quote that is not closed?)", Location(),
                    end - begin, kMaxToken);
    last_.assign(text, begin, end - begin);
}

void TextScanner::OpenInclude() {
    std::string name;
    File &file = files_.back();
    if (SkipBlanks(file, false)) {
        Cut(file);
        name = last_;
    }
    const bool circle =
        std::any_of(files_.begin(), files_.end(), [&](const File &open) { return EqualNoCase(open.name, name); });
    if (circle || files_.size() > kMaxIncludeDepth || ++includeCount_ > kMaxIncludes)
        throw Error("{}: $include {} expected to end, but includes run in a circle, over {} deep or over {} in all",
                    Location(), name, kMaxIncludeDepth, kMaxIncludes);
    if (std::optional<std::string> text = include_(name))
        files_.push_back({std::move(*text), name, 0, 1});
}

} // namespace q3
