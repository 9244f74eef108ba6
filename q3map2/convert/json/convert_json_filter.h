// GPL-2.0-or-later. Turns the JSON that map tools write into JSON that a strict parser takes.
#pragma once

#include <cstddef>
#include <cstdio>
#include <filesystem>
#include <iterator>
#include <memory>
#include <string>

namespace q3 {

/// Reads a file block by block and changes what strict JSON does not allow: comments become a blank, trailing commas
/// go, bare NaN, Infinity and Inf (with or without sign) become strings, and the bytes 0x80..0xFF of strings, which
/// need not be UTF-8, become code points U+10FF80..U+10FFFF. Line ends stay. Errors: Error naming the file.
class JsonFilter {
  public:
    explicit JsonFilter(const std::filesystem::path &path);

    bool AtEnd() { return at_ == out_.size() && !Refill(); }
    const char &Current() const { return out_[at_]; }
    void Advance() { at_++; }

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
    std::string in_, out_;
    std::size_t inAt_ = 0, at_ = 0;
    bool inString_ = false, escaped_ = false;
    bool heldComma_ = false;
    char previous_ = '['; ///< last byte outside strings that was passed on and is not blank
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

} // namespace q3
