// GPL-2.0-or-later. Streamed JSON files in the layout that map tools exchange.
#include "q3map2/convert/json/convert_json_write.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>

namespace q3 {

namespace {

constexpr std::size_t kFlushBytes = 1 << 18; ///< text is written to the file in blocks of at least this size
constexpr std::size_t kIndent = 4;           ///< blanks
// Numbers from 1e-6 up to 21 digits before the point are written without an exponent: ECMA-262, Number::toString.
constexpr int kMaxPlainDigits = 21, kMinPlainPoint = -6;
constexpr std::string_view kHexDigits = "0123456789abcdef";

template <typename Integer> void AppendInteger(std::string &text, Integer value) {
    std::array<char, 24> digits;
    const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr;
    text.append(digits.data(), end);
}

/// Digits without point or leading zeros, and the position of the point: value = 0.DIGITS * 10^point.
void AppendDigits(std::string &text, std::string_view digits, int point) {
    const int count = int(digits.size());
    if (point > kMaxPlainDigits || point <= kMinPlainPoint) {
        text += digits[0];
        if (count > 1)
            text.append(".").append(digits.substr(1));
        text += 'e';
        AppendInteger(text, point - 1);
    } else if (point <= 0) {
        text.append("0.").append(std::size_t(-point), '0').append(digits);
    } else if (point >= count) {
        text.append(digits).append(std::size_t(point - count), '0').append(".0");
    } else {
        text.append(digits.substr(0, std::size_t(point))).append(".").append(digits.substr(std::size_t(point)));
    }
}

} // namespace

void AppendJsonFloat(std::string &text, float value) {
    if (std::isnan(value)) {
        text += "NaN";
        return;
    }
    if (std::signbit(value))
        text += '-';
    if (std::isinf(value)) {
        text += "Infinity";
        return;
    }
    if (value == 0) {
        text += "0.0";
        return;
    }
    std::array<char, 32> spelled; // d.ddde+xx
    char *const last =
        std::to_chars(spelled.data(), spelled.data() + spelled.size(), std::abs(value), std::chars_format::scientific)
            .ptr;
    const std::string_view all(spelled.data(), std::size_t(last - spelled.data()));
    const std::size_t mark = all.find('e');
    int exponent = 0;
    std::from_chars(spelled.data() + mark + (all[mark + 1] == '+' ? 2 : 1), last, exponent);
    std::size_t count = 1;
    for (std::size_t i = 2; i < mark; i++)
        spelled[count++] = spelled[i];
    AppendDigits(text, {spelled.data(), count}, exponent + 1);
}

void AppendJsonString(std::string &text, std::string_view value) {
    text += '"';
    for (const char c : value) {
        const auto byte = static_cast<unsigned char>(c);
        if (c == '"' || c == '\\') {
            text += '\\';
            text += c;
        } else if (byte >= 0x20) {
            text += c;
        } else if (const auto named = std::string_view("\b\t\n\f\r").find(c); named != std::string_view::npos) {
            text += '\\';
            text += "btnfr"[named];
        } else {
            fmt::format_to(std::back_inserter(text), "\\u{:04X}", byte);
        }
    }
    text += '"';
}

std::string HexText(std::span<const std::byte> bytes) {
    std::string text;
    text.reserve(2 * bytes.size());
    for (const std::byte value : bytes) {
        text += kHexDigits[std::size_t(value >> 4)];
        text += kHexDigits[std::size_t(value & std::byte(15))];
    }
    return text;
}

JsonWriter::JsonWriter(FileReplacement &file) : file_(file) {
    buffer_.reserve(kFlushBytes + (kFlushBytes >> 2));
}

void JsonWriter::Element() {
    if (counts_.back()++ > 0)
        buffer_ += ',';
    buffer_ += '\n';
    buffer_.append(kIndent * counts_.size(), ' ');
    if (buffer_.size() >= kFlushBytes)
        Flush();
}

void JsonWriter::Member(std::string_view name) {
    Element();
    AppendJsonString(buffer_, name);
    buffer_ += ": ";
}

void JsonWriter::Member(std::string_view prefix, std::size_t index) {
    Element();
    buffer_.append("\"").append(prefix).append("#");
    AppendInteger(buffer_, index);
    buffer_ += "\": ";
}

void JsonWriter::Value(std::int32_t value) {
    AppendInteger(buffer_, value);
}

void JsonWriter::Value(const std::vector<std::string> &values) {
    buffer_ += '[';
    for (std::size_t i = 0; i < values.size(); i++) {
        if (i > 0)
            buffer_ += ", ";
        AppendJsonString(buffer_, values[i]);
    }
    buffer_ += ']';
}

void JsonWriter::Begin(char bracket) {
    buffer_ += bracket;
    counts_.push_back(0);
}

void JsonWriter::End(char bracket) {
    const bool any = counts_.back() > 0;
    counts_.pop_back();
    if (any) {
        buffer_ += '\n';
        buffer_.append(kIndent * counts_.size(), ' ');
    }
    buffer_ += bracket;
}

void JsonWriter::Flush() {
    file_.Append(std::as_bytes(std::span(buffer_)));
    buffer_.clear();
}

void JsonWriter::Finish() {
    Flush();
    file_.Finish();
}

} // namespace q3
