// GPL-2.0-or-later. Streamed JSON files in the layout that map tools exchange. See docs/reference/json.md.
#pragma once

#include "common/files/files.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace q3 {

/// Appends the fewest digits that read back to the same float. Always with fraction or exponent: 1.0, -0.0, 1.5e-7,
/// NaN, Infinity, -Infinity.
void AppendJsonFloat(std::string &text, float value);
/// Appends the text in quotes. Quote, backslash and control bytes are escaped, all other bytes are copied.
void AppendJsonString(std::string &text, std::string_view value);
/// Two lower-case hexadecimal digits per byte.
std::string HexText(std::span<const std::byte> bytes);

/// Writes one file: one member per line, arrays on one line. Errors: those of FileReplacement.
class JsonWriter {
  public:
    /// `file` is the caller's to commit.
    explicit JsonWriter(FileReplacement &file);
    JsonWriter(const JsonWriter &) = delete;
    JsonWriter &operator=(const JsonWriter &) = delete;

    void BeginObject() { Begin('{'); }
    void EndObject() { End('}'); }
    /// A list with one element per line; call Element() before each.
    void BeginList() { Begin('['); }
    void EndList() { End(']'); }
    void Element();
    void Member(std::string_view name);
    /// Member "prefix#index".
    void Member(std::string_view prefix, std::size_t index);

    void Value(std::int32_t value);
    void Value(std::uint8_t value) { Value(std::int32_t(value)); }
    void Value(float value) { AppendJsonFloat(buffer_, value); }
    void Value(std::string_view value) { AppendJsonString(buffer_, value); }
    /// An array on one line.
    template <typename T, std::size_t N> void Value(const std::array<T, N> &values) { Value(std::span(values)); }
    template <typename T, std::size_t N> void Value(std::span<T, N> values) {
        buffer_ += '[';
        for (std::size_t i = 0; i < values.size(); i++) {
            if (i > 0)
                buffer_ += ", ";
            Value(values[i]);
        }
        buffer_ += ']';
    }
    void Value(const std::vector<std::string> &values);

    /// Completes the file, still under its temporary name.
    void Finish();

  private:
    void Begin(char bracket);
    void End(char bracket);
    void Flush();

    FileReplacement &file_;
    std::string buffer_;
    std::vector<std::size_t> counts_; ///< members so far of every open object and list
};

} // namespace q3
