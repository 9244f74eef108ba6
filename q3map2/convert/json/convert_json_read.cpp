// GPL-2.0-or-later. Reads the records of JSON files one by one, from the dialects that map tools write.
#include "q3map2/convert/json/convert_json_read.h"

#include "common/error.h"
#include "common/platform/platform.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <limits>
#include <string_view>
#include <system_error>

namespace q3 {

// ---- Turns the JSON that map tools write into JSON that a strict parser takes ----

namespace {

constexpr std::size_t kBlockBytes = 1 << 16; ///< of a read
constexpr std::size_t kMaxWord = 16;         ///< longer than any word searched for
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
    outAt_ = 0;
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
    const bool isInfinity = word == "Infinity" || word == "Inf";
    const bool isNumber = isInfinity || word == "NaN";
    const char first = isNumber ? '"' : sign ? sign : word[0];
    EmitHeldComma(first);
    previous_ = first;
    if (isNumber)
        out_ += '"';
    if (sign == '-' || (sign && !isNumber))
        out_ += sign;
    out_ += isInfinity ? "Infinity" : word;
    if (isNumber)
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
    // After anything but a value the parser gets the comma and reports it.
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

// ---- Reads the records of a JSON file one by one ----

namespace {

constexpr std::size_t kMaxDepth = 16;      ///< of nested objects and arrays in a record
constexpr std::size_t kMaxNodes = 1 << 20; ///< values of a record
constexpr std::size_t kMaxShown = 120;     ///< bytes of a text in a message

/// NaN and infinities as the filter spells them.
bool SpecialNumber(std::string_view text, float &value) {
    const bool minus = text.starts_with('-');
    const std::string_view word = text.substr(minus ? 1 : 0);
    if (word == "Infinity")
        value = std::numeric_limits<float>::infinity();
    else if (word == "NaN")
        value = std::numeric_limits<float>::quiet_NaN();
    else
        return false;
    value = minus ? -value : value;
    return true;
}

/// Receives the tokens of nlohmann's parser and builds one record at a time.
class RecordBuilder {
  public:
    RecordBuilder(const std::filesystem::path &path, std::span<const std::string_view> lists,
                  const std::function<void(const JsonRecord &)> &record)
        : lists_(lists), deliver_(record) {
        record_.file = path.string();
    }

    bool null() { return Scalar(JsonNode::Other); }
    bool boolean(bool) { return Scalar(JsonNode::Other); }
    bool number_integer(std::int64_t value) {
        JsonNode &node = Add(JsonNode::Integer);
        node.integer = value;
        node.real = float(value);
        return Done();
    }
    bool number_unsigned(std::uint64_t value) {
        JsonNode &node = Add(value <= INT64_MAX ? JsonNode::Integer : JsonNode::Real);
        node.integer = std::int64_t(value);
        node.real = float(value);
        return Done();
    }
    // The double is not used: rounding twice could miss the nearest float.
    bool number_float(double value, const std::string &token) {
        JsonNode &node = Add(JsonNode::Real);
        const auto result = std::from_chars(token.data(), token.data() + token.size(), node.real);
        if (result.ec == std::errc::result_out_of_range &&
            std::abs(value) < 1) // too near to 0 for a float; others are too large
            node.real = float(value);
        else if (result.ec != std::errc())
            node.kind = JsonNode::Other;
        return Done();
    }
    bool string(std::string &text) {
        JsonNode &node = Add(JsonNode::Text);
        node.special = SpecialNumber(text, node.real);
        if (!node.special)
            JsonFilter::RestoreBytes(text);
        node.textAt = record_.chars.size();
        node.textLength = text.size();
        record_.chars += text;
        return Done();
    }
    bool binary(nlohmann::json::binary_t &) { return false; }
    bool start_object(std::size_t) {
        if (depth_ == 0) {
            depth_ = 1;
            return true;
        }
        return Open(JsonNode::Object);
    }
    bool start_array(std::size_t) {
        if (depth_ == 1 && open_.empty() && std::ranges::find(lists_, record_.name) != lists_.end()) {
            record_.inList = true;
            listedCount_ = 0;
            depth_ = 2;
            return true;
        }
        return Open(JsonNode::Array);
    }
    bool end_object() {
        if (open_.empty()) {
            depth_ = 0;
            return true;
        }
        return CloseNode();
    }
    bool end_array() {
        if (open_.empty()) {
            record_.inList = false;
            depth_ = 1;
            return true;
        }
        return CloseNode();
    }
    bool key(std::string &name) {
        JsonFilter::RestoreBytes(name);
        if (open_.empty()) {
            record_.name = name;
        } else {
            keyAt_ = record_.chars.size();
            keyLength_ = name.size();
            record_.chars += name;
        }
        return true;
    }
    bool parse_error(std::size_t, const std::string &, const nlohmann::detail::exception &error) {
        std::string_view what = error.what();
        what.remove_prefix(std::min(what.size(), what.find("] ") == what.npos ? 0 : what.find("] ") + 2));
        const std::string location = record_.name.empty() ? "" : "at or after " + record_.Label() + ": ";
        throw Error("{}: {}not valid JSON: {}", record_.file, location, ShownText(what));
    }

  private:
    bool Scalar(JsonNode::Kind kind) {
        Add(kind);
        return Done();
    }

    JsonNode &Add(JsonNode::Kind kind) {
        if (depth_ == 0)
            throw Error("{}: expected an object", record_.file);
        if (open_.empty()) {
            record_.nodes.clear();
            record_.chars.clear();
            keyLength_ = 0;
            record_.index = record_.inList ? listedCount_++ : memberCount_++;
        } else {
            record_.nodes[open_.back()].count++;
        }
        if (record_.nodes.size() >= kMaxNodes)
            record_.Fail(fmt::format("more than {} values", kMaxNodes));
        JsonNode &node = record_.nodes.emplace_back();
        node.kind = kind;
        node.nameAt = keyAt_;
        node.nameLength = keyLength_;
        keyLength_ = 0;
        return node;
    }

    bool Open(JsonNode::Kind kind) {
        Add(kind);
        if (open_.size() >= kMaxDepth)
            record_.Fail(fmt::format("objects and arrays are nested deeper than {}", kMaxDepth));
        open_.push_back(record_.nodes.size() - 1);
        return true;
    }

    bool CloseNode() {
        record_.nodes[open_.back()].next = record_.nodes.size();
        open_.pop_back();
        if (open_.empty())
            deliver_(record_);
        return true;
    }

    bool Done() {
        record_.nodes.back().next = record_.nodes.size();
        if (open_.empty())
            deliver_(record_);
        return true;
    }

    std::span<const std::string_view> lists_;
    const std::function<void(const JsonRecord &)> &deliver_;
    JsonRecord record_;
    std::vector<std::size_t> open_;                 ///< objects and arrays of the record that are not closed
    std::size_t depth_ = 0;                         ///< 0: outside, 1: in the top-level object, 2: in the list
    std::size_t memberCount_ = 0, listedCount_ = 0; ///< records so far
    std::size_t keyAt_ = 0, keyLength_ = 0;         ///< name of the next value, in JsonRecord::chars
};

} // namespace

std::size_t JsonRecord::Find(std::size_t object, std::string_view member) const {
    std::size_t found = 0;
    for (std::size_t at = object + 1; at < nodes[object].next; at = nodes[at].next) {
        if (Name(nodes[at]) != member)
            continue;
        if (found != 0)
            Fail(fmt::format("{} is given twice", member));
        found = at;
    }
    return found;
}

std::string JsonRecord::Label() const {
    return inList ? fmt::format("{}[{}]", ShownText(name), index) : ShownText(name);
}

void JsonRecord::Fail(std::string_view text) const {
    throw Error("{}: {}: {}", file, Label(), text);
}

void ReadJsonRecords(const std::filesystem::path &path, std::string_view list,
                     const std::function<void(const JsonRecord &)> &record) {
    ReadJsonRecords(path, std::span(&list, list.empty() ? 0 : 1), record);
}

void ReadJsonRecords(const std::filesystem::path &path, std::span<const std::string_view> lists,
                     const std::function<void(const JsonRecord &)> &record) {
    JsonFilter filter(path);
    RecordBuilder builder(path, lists, record);
    nlohmann::json::sax_parse(JsonFilterIterator(filter), JsonFilterIterator(), &builder);
}

std::string ShownText(std::string_view text) {
    std::string shown(text.substr(0, kMaxShown));
    std::ranges::replace_if(
        shown, [](char c) { return static_cast<unsigned char>(c) < ' ' || c == 127; }, ' ');
    if (text.size() > kMaxShown)
        shown += "...";
    return shown;
}

} // namespace q3
