// GPL-2.0-or-later. The text of the stream that editors read (-connect).
#include "q3map2/editors/feedback_xml.h"

#include <glib.h>

#include <memory>

namespace q3 {

namespace {

/// Room for the elements around the text of a `select`.
constexpr std::size_t kMaxSelectText = kMaxPayload - 100;

struct FreeText {
    void operator()(char *text) const { g_free(text); }
};

/// What must arrive in one network message.
using Pieces = std::vector<std::string>;

/// The characters of the text, escaped.
Pieces Characters(std::string_view text) {
    const std::unique_ptr<char, FreeText> valid(g_utf8_make_valid(text.data(), gssize(text.size())));
    Pieces characters;
    for (const char *at = valid.get(); *at != 0;) {
        const char *const next = g_utf8_next_char(at);
        const auto first = static_cast<unsigned char>(*at);
        const bool control = first == 127 || (first < 32 && first != '\n' && first != '\t');
        if (control || std::string_view("<>&\"").find(*at) != std::string_view::npos)
            characters.emplace_back(control      ? "?"
                                    : *at == '<' ? "&lt;"
                                    : *at == '>' ? "&gt;"
                                    : *at == '&' ? "&amp;"
                                                 : "&quot;");
        else
            characters.emplace_back(at, next);
        at = next;
    }
    return characters;
}

/// As few payloads as possible.
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
    std::string all;
    for (const std::string &character : Characters(text))
        all += character;
    return all;
}

std::vector<std::string> MessagePayloads(LogLevel level, std::string_view text) {
    Pieces pieces = Characters(text);
    pieces.insert(pieces.begin(), OpeningTag("message", level));
    pieces.emplace_back("</message>");
    return Packed(pieces);
}

std::vector<std::string> MarkPayloads(LogLevel level, std::string_view text, const LogMark &mark) {
    if (mark.line.empty()) {
        std::string cut;
        for (const std::string &character : Characters(text)) {
            if (cut.size() + character.size() > kMaxSelectText)
                break;
            cut += character;
        }
        return {fmt::format("{}{}<brush>{} {}</brush></select>", OpeningTag("select", level), cut, mark.entity,
                            mark.primitive)};
    }
    Pieces pieces{OpeningTag("message", level) + XmlText(text), "<polyline>"};
    for (const std::array<float, 3> &p : mark.line)
        pieces.push_back(fmt::format("<point>{:f} {:f} {:f}</point>", p[0], p[1], p[2]));
    pieces.emplace_back("</polyline></message>");
    return Packed(pieces);
}

} // namespace q3
