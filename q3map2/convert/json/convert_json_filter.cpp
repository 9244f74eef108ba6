// GPL-2.0-or-later. Turns the JSON that map tools write into JSON that a strict parser takes.
#include "q3map2/convert/json/convert_json_filter.h"

#include "common/error.h"
#include "common/platform/platform.h"

#include <cerrno>
#include <string_view>
#include <system_error>

namespace q3 {

namespace {

constexpr std::size_t kBlockBytes = 1 << 16;
constexpr std::size_t kMaxWord = 16; ///< longer than any word searched for
// Bytes 0x80..0xFF of strings pass the parser as U+10FF80..U+10FFFF, which in UTF-8 are these two bytes, then 0xBE or
// 0xBF, then 0x80..0xBF.
constexpr std::string_view kByteMark = "\xF4\x8F";

bool IsLetter(int c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}

} // namespace

JsonFilter::JsonFilter(const std::filesystem::path &path) : path_(path), file_(OpenFile(path, "rb")) {
    if (!file_)
        throw Error("{}: cannot read: {}", path.string(), std::generic_category().message(errno));
    ReadBlock();
    if (in_.starts_with("\xEF\xBB\xBF"))
        inAt_ = 3;
}

bool JsonFilter::ReadBlock() {
    in_.resize(kBlockBytes);
    inAt_ = 0;
    in_.resize(std::fread(in_.data(), 1, in_.size(), file_.get()));
    if (std::ferror(file_.get()))
        throw Error("{}: cannot read: {}", path_.string(), std::generic_category().message(errno));
    return !in_.empty();
}

bool JsonFilter::Refill() {
    out_.clear();
    at_ = 0;
    while (out_.size() < kBlockBytes && Peek() != kEnd)
        Step();
    return !out_.empty();
}

void JsonFilter::Step() {
    const char c = char(Take());
    if (inString_) {
        StringStep(c);
        return;
    }
    switch (c) {
    case ' ':
    case '\t':
    case '\r':
    case '\n':
        out_ += c;
        return;
    case ',':
        if (heldComma_)
            EmitHeldComma(c);
        heldComma_ = true;
        return;
    case '/':
        if (!SkipComment())
            Emit(c);
        return;
    case '+':
    case '-':
        if (IsLetter(Peek()))
            FilterWord(c);
        else
            Emit(c);
        return;
    case 'N':
    case 'I':
        inAt_--;
        FilterWord(0);
        return;
    case '"':
        inString_ = true;
        [[fallthrough]];
    default:
        Emit(c);
    }
}

void JsonFilter::StringStep(char c) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte >= 0x80) {
        out_.append(kByteMark);
        out_ += char(0xBE | ((byte >> 6) & 1));
        out_ += char(0x80 | (byte & 0x3F));
    } else {
        out_ += c;
    }
    if (escaped_)
        escaped_ = false;
    else if (c == '\\')
        escaped_ = true;
    else if (c == '"')
        inString_ = false;
}

bool JsonFilter::SkipComment() {
    const int kind = Peek();
    if (kind == '/') {
        while (Peek() != kEnd && Peek() != '\n')
            Take();
    } else if (kind == '*') {
        Take();
        for (int last = 0, c = Take(); !(last == '*' && c == '/'); last = c, c = Take()) {
            if (c == kEnd)
                throw Error("{}: a comment is opened with /* and never closed", path_.string());
            // Keeps the line numbers of messages right.
            if (c == '\n')
                out_ += '\n';
        }
    } else {
        return false;
    }
    out_ += ' ';
    return true;
}

void JsonFilter::FilterWord(char sign) {
    std::string word;
    while (IsLetter(Peek()) && word.size() < kMaxWord)
        word += char(Take());
    const bool infinite = word == "Infinity" || word == "Inf";
    const bool number = infinite || word == "NaN";
    const char first = number ? '"' : sign ? sign : word[0];
    EmitHeldComma(first);
    previous_ = first;
    if (number)
        out_ += '"';
    if (sign == '-' || (sign && !number))
        out_ += sign;
    out_ += infinite ? "Infinity" : word;
    if (number)
        out_ += '"';
}

void JsonFilter::Emit(char c) {
    EmitHeldComma(c);
    previous_ = c;
    out_ += c;
}

void JsonFilter::EmitHeldComma(char next) {
    if (!heldComma_)
        return;
    heldComma_ = false;
    const bool closes = next == '}' || next == ']';
    const bool afterValue = std::string_view("[{:,").find(previous_) == std::string_view::npos;
    if (closes && afterValue)
        return;
    out_ += ',';
    previous_ = ',';
}

void JsonFilter::RestoreBytes(std::string &text) {
    std::size_t from = text.find(kByteMark);
    if (from == std::string::npos)
        return;
    std::size_t to = from;
    while (from < text.size()) {
        const bool marked = text.compare(from, kByteMark.size(), kByteMark) == 0 && from + 3 < text.size() &&
                            (text[from + 2] & 0xFE) == 0xBE;
        if (marked) {
            text[to++] = char(0x80 | ((text[from + 2] & 1) << 6) | (text[from + 3] & 0x3F));
            from += 4;
        } else {
            text[to++] = text[from++];
        }
    }
    text.resize(to);
}

} // namespace q3
