// GPL-2.0-or-later. Entity text of .bsp and .map files.
#include "q3map2/bspfile/entities.h"

#include "common/error.h"
#include "common/text/text_scan.h"

#include <algorithm>
#include <charconv>
#include <cmath>

namespace q3 {

namespace {

std::string_view TrimEnd(std::string_view text) {
    while (!text.empty() && IsBlank(text.back()))
        text.remove_suffix(1);
    return text;
}

/// The first 40 characters of a text from a file, without line breaks, for messages.
std::string Shown(std::string_view text) {
    std::string shown(text.substr(0, 40));
    std::ranges::replace_if(
        shown, [](char c) { return IsBlank(c) || c == 127; }, ' ');
    return shown;
}

struct Token {
    enum Kind { Open, Close, Word, Quoted, End } kind = End;
    std::string_view text;
    int line = 1;
};

/// Splits text into braces, words and quoted strings; comments are skipped outside strings.
class Tokenizer {
  public:
    Tokenizer(std::string_view text, std::string_view name, bool isMap)
        : rest_(text.substr(0, text.find('\0'))), name_(name), isMap_(isMap) {}

    Token Next() {
        SkipBlanks();
        Token token{Token::End, {}, line_};
        if (rest_.empty())
            return token;
        if (rest_.front() == '"')
            return Quoted(token);
        if (IsBrace()) {
            token.kind = rest_.front() == '{' ? Token::Open : Token::Close;
            token.text = Take(1);
            return token;
        }
        std::size_t length = 1;
        while (length < rest_.size() && !IsBlank(rest_[length]) && rest_[length] != '"')
            length++;
        token.kind = Token::Word;
        token.text = Take(length);
        if (EqualNoCase(token.text, "$include"))
            Fail(token.line, "$include is not supported in entity text");
        return token;
    }

    [[noreturn]] void Fail(int line, std::string_view text) const { throw Error("{}: line {}: {}", name_, line, text); }

  private:
    std::string_view Take(std::size_t length) {
        const std::string_view taken = rest_.substr(0, length);
        line_ += int(std::ranges::count(taken, '\n'));
        rest_.remove_prefix(taken.size());
        return taken;
    }

    // Texture names may start with a brace: one followed by other letters is part of a word.
    bool IsBrace() const {
        if (rest_.front() != '{' && rest_.front() != '}')
            return false;
        return rest_.size() == 1 || IsBlank(rest_[1]) ||
               std::string_view("{}\"(/;#").find(rest_[1]) != std::string_view::npos;
    }

    Token Quoted(Token token) {
        const std::size_t close = QuotedEnd(rest_, 1, isMap_ ? QuoteEscapes::Quotes : QuoteEscapes::None);
        if (close == rest_.size())
            Fail(line_, "a string is opened here and never closed");
        token.kind = Token::Quoted;
        token.text = Take(close + 1).substr(1, close - 1);
        return token;
    }

    void SkipBlanks() {
        for (;;) {
            std::size_t length = 0;
            while (length < rest_.size() && IsBlank(rest_[length]))
                length++;
            Take(length);
            if (rest_.starts_with("//") || rest_.starts_with(';') || rest_.starts_with('#')) {
                Take(std::min(rest_.find('\n'), rest_.size()));
            } else if (rest_.starts_with("/*")) {
                const std::size_t close = rest_.find("*/", 2);
                if (close == std::string_view::npos)
                    Fail(line_, "a comment is opened here and never closed");
                Take(close + 2);
            } else {
                return;
            }
        }
    }

    std::string_view rest_, name_;
    bool isMap_; ///< a map source, where quotes may be escaped
    int line_ = 1;
};

void SkipBlock(Tokenizer &tokens, int openLine) {
    for (int depth = 1; depth > 0;) {
        const Token token = tokens.Next();
        if (token.kind == Token::End)
            tokens.Fail(openLine, "'{' is never closed");
        depth += token.kind == Token::Open ? 1 : token.kind == Token::Close ? -1 : 0;
    }
}

void AddPair(Entity &entity, std::string_view key, std::string_view value) {
    key = TrimEnd(key);
    value = TrimEnd(value);
    if (!key.empty() && !value.empty())
        entity.pairs.emplace_back(key, value);
}

/// One entity, after its opening brace. In map source words need no quotes and inner blocks are skipped.
Entity ParseEntity(Tokenizer &tokens, int openLine, bool isMap) {
    const auto isText = [isMap](const Token &token) {
        return token.kind == Token::Quoted || (isMap && token.kind == Token::Word);
    };
    Entity entity;
    for (;;) {
        const Token key = tokens.Next();
        if (key.kind == Token::Close)
            return entity;
        if (key.kind == Token::End)
            tokens.Fail(openLine, "the entity opened here has no closing brace");
        if (key.kind == Token::Open && isMap) {
            SkipBlock(tokens, key.line);
            continue;
        }
        if (!isText(key))
            tokens.Fail(key.line, fmt::format("expected a key in quotes or '}}', found {}", Shown(key.text)));
        const Token value = tokens.Next();
        if (!isText(value))
            tokens.Fail(key.line, fmt::format("the key {} has no value", Shown(key.text)));
        AddPair(entity, key.text, value.text);
    }
}

std::vector<Entity> Parse(std::string_view text, std::string_view name, bool isMap) {
    Tokenizer tokens(text, name, isMap);
    std::vector<Entity> entities;
    for (;;) {
        const Token token = tokens.Next();
        if (token.kind == Token::End)
            return entities;
        if (token.kind != Token::Open)
            tokens.Fail(token.line, fmt::format("expected '{{' to open an entity, found {}", Shown(token.text)));
        entities.push_back(ParseEntity(tokens, token.line, isMap));
    }
}

} // namespace

std::string_view Entity::Value(std::initializer_list<std::string_view> keys) const {
    for (const std::string_view key : keys)
        for (const auto &[name, value] : pairs)
            if (EqualNoCase(name, key)) {
                if (!value.empty())
                    return value;
                break;
            }
    return {};
}

double Entity::Number(std::initializer_list<std::string_view> keys, double fallback) const {
    std::string_view text = Value(keys);
    return TakeNumber(text).value_or(fallback);
}

std::optional<Vec3f> Entity::Vector(std::initializer_list<std::string_view> keys) const {
    std::string_view text = Value(keys);
    Vec3f vector;
    for (std::size_t i = 0; i < 3; i++) {
        const std::optional<double> number = TakeNumber(text);
        if (!number || !std::isfinite(float(*number)))
            return std::nullopt;
        vector[i] = float(*number);
    }
    return vector;
}

void Entity::Set(std::string_view key, std::string_view value) {
    const auto found = std::ranges::find_if(pairs, [key](const auto &pair) { return EqualNoCase(pair.first, key); });
    if (found != pairs.end())
        found->second = value;
    else
        pairs.emplace_back(key, value);
}

void Entity::Erase(std::string_view key) {
    std::erase_if(pairs, [key](const auto &pair) { return EqualNoCase(pair.first, key); });
}

bool IsLight(const Entity &entity) {
    return StartsWithNoCase(entity.ClassName(), "light");
}

std::vector<Entity> ParseEntities(std::string_view text, std::string_view name) {
    return Parse(text, name, false);
}

std::vector<Entity> ParseMapEntities(std::string_view text, std::string_view name) {
    return Parse(text, name, true);
}

std::string QuotedToken(std::string_view text) {
    std::string token(text);
    std::ranges::replace(token, '"', '\'');
    return '"' + token + '"';
}

std::string FormatEntities(const std::vector<Entity> &entities) {
    std::string text;
    for (const Entity &entity : entities) {
        if (entity.pairs.empty())
            continue;
        text += "{\n";
        for (const auto &[key, value] : entity.pairs)
            text += QuotedToken(key) + ' ' + QuotedToken(value) + '\n';
        text += "}\n";
    }
    return text;
}

std::vector<Entity> StoredEntities(std::string_view text, std::string_view name) {
    std::vector<Entity> stored = ParseEntities(text, name);
    if (stored.empty())
        stored.push_back({{{"classname", "worldspawn"}}});
    return stored;
}

Entity StoredWorld(std::string_view text) {
    try {
        const std::vector<Entity> entities = ParseEntities(text, "entities");
        return entities.empty() ? Entity{} : entities.front();
    } catch (const Error &) {
        return {};
    }
}

} // namespace q3
