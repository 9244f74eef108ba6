// GPL-2.0-or-later. Reading a shader script and keeping its text, tidied.
#include "q3map2/shader/shader_text.h"

#include <algorithm>

namespace q3 {

void ShaderTextScanner::SkipLine() {
    for (std::string_view rest; NextOnLine(rest);) {
    }
}

void ShaderTextScanner::Record() {
    text_.clear();
    recording_ = true;
    depth_ = line_ = 0;
    Write("{");
}

std::string ShaderTextScanner::TakeText() {
    while (depth_ > 0)
        Write("}");
    recording_ = false;
    return std::move(text_);
}

void ShaderTextScanner::StartLine() {
    if (line_ != 0)
        text_ += '\n';
    text_.append(std::size_t(depth_), '\t');
}

void ShaderTextScanner::Write(std::string_view token) {
    const bool opens = token == "{", closes = token == "}";
    if (closes && depth_ == 0)
        return;
    if (opens || closes) {
        depth_ -= closes ? 1 : 0;
        StartLine();
        text_ += token;
        depth_ += opens ? 1 : 0;
        text_ += '\n';
        line_ = 0;
        return;
    }
    const bool quoted = token.empty() || std::any_of(token.begin(), token.end(),
                                                     [](char c) { return static_cast<unsigned char>(c) <= 32; });
    if (line_ == scanner_.Line())
        text_ += ' ';
    else
        StartLine();
    if (quoted)
        text_ += '"';
    text_ += token;
    if (quoted)
        text_ += '"';
    line_ = scanner_.Line();
}

std::string TidyBody(std::string_view body) {
    TextScanner scanner{std::string(body), {}};
    ShaderTextScanner text(scanner);
    text.Record();
    for (std::string_view token; text.Next(token);) {
    }
    return text.TakeText();
}

} // namespace q3
