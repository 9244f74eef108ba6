// GPL-2.0-or-later. Reading a shader script and keeping its text, tidied.
#include "q3map2/shader/shader_text.h"

#include <algorithm>

namespace q3 {

bool ShaderTextScanner::NextArgument(std::string_view &token) {
    if (!scanner_.NextOnLine(token))
        return false;
    if (token == "{" || token == "}") {
        scanner_.PushBack();
        return false;
    }
    return Recorded(true, token);
}

void ShaderTextScanner::SkipArguments() {
    for (std::string_view rest; NextArgument(rest);) {
    }
}

bool ShaderTextScanner::BlockFollows() const {
    constexpr std::size_t kReach = 1024; // of comments between the name and the brace
    TextScanner ahead{std::string(scanner_.Unread().substr(0, kReach)), {}};
    std::string_view token;
    return ahead.Next(token) && token == "{";
}

void ShaderTextScanner::Forget() {
    if (!recording_)
        return;
    at_ = beforeLast_;
    text_.resize(at_.size);
}

void ShaderTextScanner::Record() {
    text_.clear();
    recording_ = true;
    at_ = {};
    Write("{");
}

std::string ShaderTextScanner::TakeText() {
    while (at_.depth > 0)
        Write("}");
    recording_ = false;
    return std::move(text_);
}

void ShaderTextScanner::StartLine() {
    if (at_.line != 0)
        text_ += '\n';
    text_.append(std::size_t(at_.depth), '\t');
}

void ShaderTextScanner::Write(std::string_view token) {
    const bool opens = token == "{", closes = token == "}";
    beforeLast_ = {text_.size(), at_.depth, at_.line};
    if (closes && at_.depth == 0)
        return;
    if (opens || closes) {
        at_.depth -= closes ? 1 : 0;
        StartLine();
        text_ += token;
        at_.depth += opens ? 1 : 0;
        text_ += '\n';
        at_.line = 0;
        return;
    }
    const bool quoted = token.empty() || std::any_of(token.begin(), token.end(),
                                                     [](char c) { return static_cast<unsigned char>(c) <= 32; });
    if (at_.line == scanner_.Line())
        text_ += ' ';
    else
        StartLine();
    if (quoted)
        text_ += '"';
    text_ += token;
    if (quoted)
        text_ += '"';
    at_.line = scanner_.Line();
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
