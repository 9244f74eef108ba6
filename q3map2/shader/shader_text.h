// GPL-2.0-or-later. Reading a shader script and keeping its text, tidied.
#pragma once

#include "common/text_scan.h"

#include <string>

namespace q3 {

/// A scanner that can write down the tokens it reads: without comments, those of one line joined by blanks, braces on
/// lines of their own, indented by tabs.
class ShaderTextScanner {
  public:
    explicit ShaderTextScanner(TextScanner &scanner) : scanner_(scanner) {}

    bool Next(std::string &token);
    bool NextOnLine(std::string &token);
    void SkipLine();
    /// Not while recording.
    void PushBack() { scanner_.PushBack(); }
    std::string Location() const { return scanner_.Location(); }

    /// Starts afresh with an opening brace.
    void Record();
    /// Ends recording; closes braces that are still open.
    std::string TakeText();

  private:
    void Write(const std::string &token);
    void StartLine();

    TextScanner &scanner_;
    bool recording_ = false;
    std::string text_;
    int depth_ = 0, line_ = 0; ///< line_: of the last token in the script; 0: the text ends with a whole line
};

} // namespace q3
