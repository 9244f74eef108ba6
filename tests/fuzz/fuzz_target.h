// GPL-2.0-or-later. What the fuzz targets share: what a clean refusal is, values taken from the input, scratch files.
#pragma once

#include "common/error.h"
#include "common/log.h"

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <filesystem>
#include <fstream>
#include <span>
#include <string>
#include <string_view>

/// One input of a target. Each source here defines it once; libFuzzer calls it, or replay_main.cpp.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t *data, std::size_t size);

namespace q3::fuzz {

// ---- What counts as a finding ----

/// Ends the process: the input is a finding.
[[noreturn]] inline void Fail(std::string_view text) {
    std::fprintf(stderr, "fuzz target: %.*s\n", int(text.size()), text.data());
    std::abort();
}

inline void Require(bool holds, std::string_view text) {
    if (!holds)
        Fail(text);
}

/// Runs a reader. True: it took the input. False: it refused it with an Error of one line. Anything else that it throws
/// is a finding.
template <typename Read> bool Accepts(const Read &read) {
    try {
        read();
        return true;
    } catch (const Error &error) {
        const std::string_view text = error.what();
        Require(!text.empty(), "an error without text");
        Require(text.find('\n') == text.npos, fmt::format("an error of several lines: {}", text));
        return false;
    } catch (const std::exception &error) {
        Fail(fmt::format("an exception that is no Error: {}", error.what()));
    }
}

/// Runs what must take the output of the program itself.
template <typename Run> void MustSucceed(std::string_view what, const Run &run) {
    try {
        run();
    } catch (const std::exception &error) {
        Fail(fmt::format("{}: {}", what, error.what()));
    }
}

// ---- Input ----

/// Takes values off the start of an input. Values behind its end are 0.
class Input {
  public:
    Input(const std::uint8_t *data, std::size_t size) : rest_(data, size) {}

    template <typename T> T Take() {
        T value{};
        const std::size_t bytes = std::min(sizeof(T), rest_.size());
        if (bytes > 0)
            std::memcpy(&value, rest_.data(), bytes);
        rest_ = rest_.subspan(bytes);
        return value;
    }
    /// A byte as a number below `count`; letters of seeds that begin with one count from 'a'.
    std::size_t Choose(std::size_t count) { return (std::size_t(Take<std::uint8_t>()) + 256 * count - 'a') % count; }
    std::span<const std::byte> Rest() const { return std::as_bytes(rest_); }
    std::string_view Text() const { return {reinterpret_cast<const char *>(rest_.data()), rest_.size()}; }

  private:
    std::span<const std::uint8_t> rest_;
};

// ---- Surroundings of a reader ----

/// A log that prints nothing. Warnings are formatted all the same.
class SilentLog : public Log {
  public:
    SilentLog() : Log(Log::Nowhere(), true) {}
};

/// An empty folder for readers that want a path, in memory where TMPDIR is. Removed at the end.
class ScratchFolder {
  public:
    ScratchFolder() {
        std::string name = (std::filesystem::temp_directory_path() / "q3fuzz-XXXXXX").string();
        if (mkdtemp(name.data()) == nullptr)
            Fail("no temporary folder");
        path_ = name;
    }
    ~ScratchFolder() {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }
    ScratchFolder(const ScratchFolder &) = delete;
    ScratchFolder &operator=(const ScratchFolder &) = delete;

    std::filesystem::path Write(std::string_view name, std::span<const std::byte> bytes) const {
        const std::filesystem::path file = path_ / name;
        std::filesystem::create_directories(file.parent_path());
        std::ofstream out(file, std::ios::binary);
        out.write(reinterpret_cast<const char *>(bytes.data()), std::streamsize(bytes.size()));
        Require(out.good(), "cannot write a temporary file");
        return file;
    }
    std::filesystem::path Write(std::string_view name, std::string_view text) const {
        return Write(name, std::as_bytes(std::span(text)));
    }
    const std::filesystem::path &Path() const { return path_; }

  private:
    std::filesystem::path path_;
};

} // namespace q3::fuzz
