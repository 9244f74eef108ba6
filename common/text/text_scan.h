// GPL-2.0-or-later. The tokenizer that shader scripts, their lists and map text share.
#pragma once

#include "common/text/text.h"

#include <cstddef>
#include <deque>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace q3 {

/// A line of a file.
struct TextLocation {
    std::string_view file;
    int line = 1;

    /// "file:line".
    std::string Text() const;
};

/// Which bytes are special. Engine: `;` and `#` are ordinary bytes. MapSource: \" within a quoted token is part of it,
/// see QuotedEnd.
enum class TextDialect { Compiler, Engine, MapSource };

/// Whether a backslash within a quoted token has a meaning.
enum class QuoteEscapes { None, Quotes };

/// Offset of the closing quote of the token whose first byte after the opening quote is at `begin`, or of the end of
/// the text. With QuoteEscapes::Quotes, \" is a quote within the token, except where the rest of the line is empty or
/// whole quoted tokens: there it is a backslash and the closing quote, as in "C:\dir\".
std::size_t QuotedEnd(std::string_view text, std::size_t begin, QuoteEscapes escapes);

/// Cuts text into tokens. White space is every byte up to 32; comments are `;`, `#`, `//` to the end of the line and
/// `/* */`. A quoted token runs to the next quote, without escapes; a plain one to white space or `;`. Braces and
/// parentheses are tokens only when white space surrounds them. TextDialect has what other readers do differently.
class TextScanner {
  public:
    /// Contents of the file that `$include name` asks for, or nothing.
    using Include = std::function<std::optional<std::string>(std::string_view name)>;

    /// `name` is for messages. Without `include`, "$include" is an ordinary token.
    TextScanner(std::string text, std::string name, Include include = {}, TextDialect dialect = TextDialect::Compiler);
    TextScanner(TextScanner &&) = default;

    /// Reads the next token, on this or a later line; false at the end. Error: a token over 1023 bytes, includes nested
    /// too deep, in a circle or too many.
    bool Next(std::string &token) { return ReadCopy(token, Within::File); }
    /// The same without a copy: the token is valid as long as the scanner.
    bool Next(std::string_view &token) { return Read(token, Within::File); }
    /// Reads the next token of the current line; false, and nothing read, when the line (or an included file) ends
    /// first or a comment follows.
    bool NextOnLine(std::string &token) { return ReadCopy(token, Within::Line); }
    bool NextOnLine(std::string_view &token) { return Read(token, Within::Line); }
    /// NextOnLine for a token that may have any length.
    bool NextLongOnLine(std::string &token);
    /// Whether the last token stood in quotes.
    bool IsQuoted() const { return quoted_; }
    /// The next read returns the last token again. One token of push-back.
    void PushBack() { pushedBack_ = true; }
    /// Skips the rest of the current line.
    void SkipLine();
    /// Line of the last token read, from 1, in the file that held it.
    int Line() const { return last_.line; }
    /// Location of the last token read, valid as long as the scanner.
    const TextLocation &TokenLocation() const { return last_; }
    /// "file:line" of the last token read.
    std::string Location() const { return last_.Text(); }
    /// The text after the last token, in the file that held it.
    std::string_view Unread() const { return std::string_view(*files_.back().text).substr(files_.back().at); }
    /// Whether the file has includes, so that not all tokens are in its own text. To be called before the first token.
    bool HasIncludes() const;

  private:
    struct File {
        const std::string *text;
        std::size_t at = 0;
        TextLocation location;
    };

    /// How far a read may go for the next token.
    enum class Within { Line, File };

    bool ReadCopy(std::string &token, Within within);
    bool Read(std::string_view &token, Within within);
    bool SkipBlanks(File &file, Within within) const;
    void ReadToken(File &file);
    [[noreturn]] void FailLong(std::string_view token) const;
    void OpenInclude();

    std::deque<std::string> names_, texts_; ///< of all files so far; locations and tokens refer to them
    std::vector<File> files_;               ///< the innermost include last
    Include include_;
    TextDialect dialect_;
    std::size_t maxToken_;
    int includeCount_ = 0;
    bool pushedBack_ = false, quoted_ = false;
    std::string_view token_; ///< the last one
    TextLocation last_;
};

} // namespace q3
