// GPL-2.0-or-later. Reads the records of JSON files one by one, from the dialects that map tools write.
#pragma once

#include "common/error.h"

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <iterator>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace q3 {

/// Reads a file block by block and changes what strict JSON does not allow: comments become a blank, trailing commas
/// go, bare NaN, Infinity and Inf (with or without sign) become strings, and the bytes 0x80..0xFF of strings, which
/// need not be UTF-8, become code points U+10FF80..U+10FFFF. Line ends stay. Errors: Error naming the file.
class JsonFilter {
  public:
    explicit JsonFilter(const std::filesystem::path &path);

    bool AtEnd() { return outAt_ == out_.size() && !Refill(); }
    const char &Current() const { return out_[outAt_]; }
    void Advance() { outAt_++; }

    /// Undoes the change of bytes in one string.
    static void RestoreBytes(std::string &text);

  private:
    struct Close {
        void operator()(std::FILE *file) const { std::fclose(file); }
    };
    static constexpr int kEnd = -1;

    bool Refill();
    int Peek() {
        if (inAt_ == in_.size() && !ReadBlock())
            return kEnd;
        return static_cast<unsigned char>(in_[inAt_]);
    }
    int Take() {
        const int c = Peek();
        if (c != kEnd)
            inAt_++;
        return c;
    }
    bool ReadBlock();
    void Step();
    void StringStep(char c);
    bool SkipComment();
    void FilterWord(char sign); ///< sign: already taken from the input; 0: none
    void Emit(char c);
    void EmitHeldComma(char next);

    std::filesystem::path path_;
    std::unique_ptr<std::FILE, Close> file_;
    std::string in_, out_;             ///< a block of the file, and what it became
    std::size_t inAt_ = 0, outAt_ = 0; ///< position in each
    bool inString_ = false, escaped_ = false;
    bool heldComma_ = false; ///< a comma was read that is passed on unless a bracket closes
    char previous_ = '[';    ///< last byte outside strings that was passed on and is not blank
};

/// Input iterator over the filtered text; the default value is the end.
class JsonFilterIterator {
  public:
    using iterator_category = std::input_iterator_tag;
    using value_type = char;
    using difference_type = std::ptrdiff_t;
    using pointer = const char *;
    using reference = const char &;

    JsonFilterIterator() = default;
    explicit JsonFilterIterator(JsonFilter &filter) : filter_(&filter) {}

    reference operator*() const { return filter_->Current(); }
    JsonFilterIterator &operator++() {
        filter_->Advance();
        return *this;
    }
    void operator++(int) { filter_->Advance(); }
    bool operator==(const JsonFilterIterator &other) const { return IsEnd() == other.IsEnd(); }

  private:
    bool IsEnd() const { return !filter_ || filter_->AtEnd(); }

    JsonFilter *filter_ = nullptr;
};

/// One value of a record; the children of objects and arrays follow it.
struct JsonNode {
    /// Other: null, true, false, and numbers too large for a float.
    enum Kind : std::uint8_t { Object, Array, Integer, Real, Text, Other };
    Kind kind = Other;
    std::size_t nameAt = 0, nameLength = 0; ///< of a member, in JsonRecord::chars
    std::size_t next = 0;                   ///< index of the node after this one and its descendants
    std::size_t count = 0;                  ///< children
    std::int64_t integer = 0;
    float real = 0;       ///< of Integer, Real and special Text
    bool special = false; ///< Text that spells NaN or an infinity, in quotes or bare
    std::size_t textAt = 0, textLength = 0;
};

/// A member of the top-level object, or an element of its list. Valid during the call it is passed to.
struct JsonRecord {
    std::string file;            ///< path, for messages
    std::string name;            ///< of the top-level member
    bool inList = false;         ///< an element of the list `name`
    std::size_t index = 0;       ///< among the top-level members, or among the elements of the list
    std::vector<JsonNode> nodes; ///< the first is the record itself
    std::string chars;           ///< names and texts

    std::string_view Name(const JsonNode &node) const {
        return std::string_view(chars).substr(node.nameAt, node.nameLength);
    }
    std::string_view Text(const JsonNode &node) const {
        return std::string_view(chars).substr(node.textAt, node.textLength);
    }
    /// Index in `nodes` of the member of that name, 0 when there is none. Error when there are two.
    std::size_t Find(std::size_t object, std::string_view member) const;
    /// Name or name[index], fit for a message.
    std::string Label() const;
    /// Throws "file: label: text".
    [[noreturn]] void Fail(std::string_view text) const;
};

/// Calls `record` for every member of the top-level object in the order of the file; if the member `list` is an array,
/// for every element of it. Memory use does not grow with the number of records. Errors: Error naming file and member:
/// no such file, not JSON, no object, nested too deep.
void ReadJsonRecords(const std::filesystem::path &path, std::string_view list,
                     const std::function<void(const JsonRecord &)> &record);
/// The same for a file with several such lists.
void ReadJsonRecords(const std::filesystem::path &path, std::span<const std::string_view> lists,
                     const std::function<void(const JsonRecord &)> &record);

/// Text of a file, shortened to one line for messages.
std::string ShownText(std::string_view text);

} // namespace q3
