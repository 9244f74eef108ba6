// GPL-2.0-or-later. What the program prints if it crashes.
#include "common/crash_report.h"

#include "common/platform/platform.h"

#include <algorithm>
#include <array>
#include <atomic>

namespace q3 {

namespace {

/// Text of fixed size. Its last byte stays 0, so that it ends even for a signal handler that interrupts Set.
template <std::size_t kSize> class FixedText {
  public:
    void Set(std::string_view text) {
        const std::size_t length = std::min(text.size(), kSize - 1);
        std::copy_n(text.data(), length, text_.data());
        text_[length] = 0;
    }
    std::string_view Get() const { return text_.data(); }

  private:
    std::array<char, kSize> text_{};
};

// Mutable globals, since a signal handler gets no argument.
FixedText<512> versionText;
FixedText<2048> commandText;
FixedText<1024> fileText;

constexpr unsigned kPassesKept = 4;
std::array<FixedText<64>, kPassesKept> passTexts;
std::atomic<unsigned> passCount;

/// A line, if there is something to say.
void WriteFact(std::string_view name, std::string_view fact) {
    if (fact.empty())
        return;
    WriteError(name);
    WriteError(fact);
    WriteError("\n");
}

/// Runs within a signal handler: no allocation, no locks.
void WriteCrashReport(std::string_view fault) {
    WriteError("\n************ CRASH ************\n");
    WriteError(fault);
    WriteError(": this is a bug in the program, not in the map.\n");
    WriteError(versionText.Get());
    WriteFact("command  ", commandText.Get());
    WriteFact("file     ", fileText.Get());
    const unsigned count = passCount.load();
    for (unsigned i = count - std::min(count, kPassesKept); i < count; ++i)
        WriteFact(i + 1 == count ? "in pass  " : "after    ", passTexts[i % kPassesKept].Get());
    WriteError("Please report these lines, if possible with the map: README.md, \"Report a bug\".\n");
}

} // namespace

void InstallCrashReport(std::string_view version) {
    versionText.Set(version);
    SetCrashHandler(WriteCrashReport);
}

void SetCrashCommand(std::string_view command) {
    commandText.Set(command);
}

void SetCrashFile(std::string_view file) {
    fileText.Set(file);
}

void AddCrashPass(std::string_view pass) {
    const unsigned count = passCount.load();
    passTexts[count % kPassesKept].Set(pass);
    passCount.store(count + 1);
}

} // namespace q3
