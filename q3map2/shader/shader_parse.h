// GPL-2.0-or-later. From script text to shaders, before any image is read.
#pragma once

#include "common/text/text_scan.h"
#include "q3map2/shader/shader_table.h"

#include <cstddef>
#include <string>
#include <string_view>

namespace q3 {

/// A scanner that can record the tokens it reads as tidy text: without comments, tokens of a line joined by blanks,
/// braces on lines of their own, indented by tabs.
class ShaderTextScanner {
  public:
    explicit ShaderTextScanner(TextScanner &scanner) : scanner_(scanner) {}

    /// As TextScanner.
    bool Next(std::string_view &token) {
        const bool got = scanner_.Next(token);
        if (got)
            RecordToken(token);
        return got;
    }
    /// The next word of the line, unless it is a brace: as in engines, a brace ends the directive, and the next read
    /// returns it.
    bool NextArgument(std::string_view &token);
    /// Skips the rest of a directive.
    void SkipArguments();
    /// Whether a block begins after the last token, on this line or after blank ones.
    bool BlockFollows() const;
    /// Not while recording.
    void PushBack() { scanner_.PushBack(); }
    const TextLocation &TokenLocation() const { return scanner_.TokenLocation(); }
    std::string_view Unread() const { return scanner_.Unread(); }

    /// Starts a new recording with an opening brace.
    void Record();
    /// Removes the last token from the recording.
    void Forget();
    /// Ends recording; closes braces that are still open.
    std::string TakeText();

  private:
    void RecordToken(std::string_view token) {
        if (recording_)
            Write(token);
    }
    void Write(std::string_view token);
    void StartLine();

    TextScanner &scanner_;
    bool recording_ = false;
    std::string text_;
    /// A state of the recording.
    struct Place {
        std::size_t size = 0; ///< bytes of text_
        int depth = 0;        ///< braces that are open
        int line = 0;         ///< of the last token in the script; 0: the recording is at the start of a line
    };
    Place at_, beforeLast_; ///< now, and before the last token
};

/// The text of a shader, tidied. `body`: what follows its opening brace, without includes.
std::string TidyBody(std::string_view body);

/// Reads all shaders of one script into the table. Mistakes in the script are warnings with their line. Errors:
/// those of the scanner; the shaders before them are in the table.
void ParseShaderScript(TextScanner &scanner, ShaderTable &table, Log &log);

} // namespace q3
