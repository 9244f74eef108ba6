// GPL-2.0-or-later. The tokenizer that shader scripts, their lists and map text share.
#pragma once

#include "common/text.h"

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace q3 {

/// Cuts text into tokens. White space is every byte up to 32; comments are `;`, `#`, `//` to the end of the line and
/// `/* */`. A quoted token runs to the next quote, without escapes; a plain one to white space or `;`. Braces and
/// parentheses are tokens only when white space surrounds them.
class TextScanner {
  public:
    /// Contents of the file that `$include name` asks for, or nothing.
    using Include = std::function<std::optional<std::string>(std::string_view name)>;

    /// `name` is for messages. Without `include`, "$include" is an ordinary token.
    TextScanner(std::string text, std::string name, Include include = {});

    /// Reads the next token, on whatever line; false at the end. Error: a token over 1023 bytes, includes nested too
    /// deep, in a circle or too many.
    bool Next(std::string &token);
    /// Reads the next token of the current line; false, and nothing read, when the line (or an included file) ends
    /// first or a comment follows.
    bool NextOnLine(std::string &token);
    /// The last token read will be read again. One token of push-back.
    void PushBack() { pushedBack_ = true; }
    /// Reads over what is left of the current line.
    void SkipLine();
    /// Line of the last token read, from 1, in the file that held it.
    int Line() const { return lastLine_; }
    /// "file:line" of the last token read.
    std::string Location() const;

  private:
    struct File {
        std::string text, name;
        std::size_t at = 0;
        int line = 1;
    };

    bool Read(std::string &token, bool crossLines);
    bool SkipBlanks(File &file, bool crossLines) const;
    void Cut(File &file);
    void OpenInclude();

    std::vector<File> files_; ///< the innermost include last
    Include include_;
    int includeCount_ = 0;
    bool pushedBack_ = false;
    std::string last_, lastName_;
    int lastLine_ = 1;
};

} // namespace q3
