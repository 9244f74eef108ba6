// GPL-2.0-or-later. Reading a shader script and keeping its text, tidied.
#pragma once

#include "common/text/text_scan.h"

#include <string>
#include <string_view>

namespace q3 {

/// A scanner that can record the tokens it reads as tidy text: without comments, tokens of a line joined by blanks,
/// braces on lines of their own, indented by tabs.
class ShaderTextScanner {
  public:
    explicit ShaderTextScanner(TextScanner &scanner) : scanner_(scanner) {}

    /// As TextScanner.
    bool Next(std::string_view &token) { return Recorded(scanner_.Next(token), token); }
    bool NextOnLine(std::string_view &token) { return Recorded(scanner_.NextOnLine(token), token); }
    void SkipLine();
    /// Not while recording.
    void PushBack() { scanner_.PushBack(); }
    const TextLocation &TokenLocation() const { return scanner_.TokenLocation(); }
    std::string_view Unread() const { return scanner_.Unread(); }

    /// Starts a new recording with an opening brace.
    void Record();
    /// Ends recording; closes braces that are still open.
    std::string TakeText();

  private:
    bool Recorded(bool got, std::string_view token) {
        if (got && recording_)
            Write(token);
        return got;
    }
    void Write(std::string_view token);
    void StartLine();

    TextScanner &scanner_;
    bool recording_ = false;
    std::string text_;
    int depth_ = 0, line_ = 0; ///< line_: script line of the last token; 0 after a line break
};

/// The text of a shader, tidied. `body`: what follows its opening brace, without includes.
std::string TidyBody(std::string_view body);

} // namespace q3
