// GPL-2.0-or-later. Log messages as the XML that editors read (-connect).
#include "q3map2/editors/feedback_xml.h"

#include <glib.h>
#include <libxml/entities.h>

#include <algorithm>
#include <memory>
#include <new>

namespace q3 {

namespace {

/// Leaves room for the elements around the text of a `select`. Bytes.
constexpr std::size_t kMaxSelectText = kMaxPayload - 100;

/// Strings that must not be divided between network messages.
using Pieces = std::vector<std::string>;

/// The text with replacements for what XML cannot hold: U+FFFD for invalid UTF-8, '?' for control characters.
std::string ValidText(std::string_view text) {
    const std::unique_ptr<char, decltype(&g_free)> valid(g_utf8_make_valid(text.data(), gssize(text.size())), g_free);
    std::string result = valid.get();
    std::ranges::replace_if(
        result,
        [](char c) {
            const auto code = static_cast<unsigned char>(c);
            return code == 127 || (code < 32 && c != '\n' && c != '\t');
        },
        '?');
    return result;
}

/// The characters of XML text; an entity such as "&lt;" counts as one.
Pieces Characters(std::string_view xml) {
    Pieces characters;
    while (!xml.empty()) {
        const std::size_t bytes =
            xml.front() == '&' ? xml.find(';') + 1 : std::size_t(g_utf8_next_char(xml.data()) - xml.data());
        characters.emplace_back(xml.substr(0, bytes));
        xml.remove_prefix(bytes);
    }
    return characters;
}

/// The pieces in as few payloads of kMaxPayload bytes as possible.
std::vector<std::string> Packed(const Pieces &pieces) {
    std::vector<std::string> payloads;
    for (const std::string &piece : pieces) {
        if (payloads.empty() || payloads.back().size() + piece.size() > kMaxPayload)
            payloads.emplace_back();
        payloads.back() += piece;
    }
    return payloads;
}

std::string OpeningTag(std::string_view element, LogLevel level) {
    return fmt::format("<{} level=\"{}\">", element, int(level));
}

} // namespace

std::string XmlText(std::string_view text) {
    const std::string valid = ValidText(text);
    const std::unique_ptr<xmlChar, decltype(xmlFree)> encoded(
        xmlEncodeSpecialChars(nullptr, reinterpret_cast<const xmlChar *>(valid.c_str())), xmlFree);
    if (!encoded)
        throw std::bad_alloc();
    return reinterpret_cast<const char *>(encoded.get());
}

std::vector<std::string> MessagePayloads(LogLevel level, std::string_view text) {
    Pieces pieces = Characters(XmlText(text));
    pieces.insert(pieces.begin(), OpeningTag("message", level));
    pieces.emplace_back("</message>");
    return Packed(pieces);
}

std::vector<std::string> MarkPayloads(LogLevel level, std::string_view text, const LogMark &mark) {
    if (mark.line.empty()) {
        std::string cut;
        for (const std::string &character : Characters(XmlText(text))) {
            if (cut.size() + character.size() > kMaxSelectText)
                break;
            cut += character;
        }
        return {fmt::format("{}{}<brush>{} {}</brush></select>", OpeningTag("select", level), cut, mark.entity,
                            mark.primitive)};
    }
    Pieces pieces = Characters(XmlText(text));
    pieces.insert(pieces.begin(), OpeningTag("message", level));
    pieces.emplace_back("<polyline>");
    for (const std::array<float, 3> &p : mark.line)
        pieces.push_back(fmt::format("<point>{:f} {:f} {:f}</point>", p[0], p[1], p[2]));
    pieces.emplace_back("</polyline></message>");
    return Packed(pieces);
}

} // namespace q3
