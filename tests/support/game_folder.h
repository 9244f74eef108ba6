// GPL-2.0-or-later. A game folder that lives as long as one test.
#pragma once

#include "tests/support/kept_log.h"

#include <minizip/zip.h>

#include <atomic>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace q3::test {

/// A new empty folder, removed at the end.
class GameFolder {
  public:
    GameFolder() {
        std::random_device seed;
        do
            root_ = std::filesystem::temp_directory_path() / fmt::format("q3map2-test-{:08x}{:08x}", seed(), seed());
        while (!std::filesystem::create_directory(root_));
    }
    ~GameFolder() {
        std::error_code ignored;
        std::filesystem::remove_all(root_, ignored);
    }
    GameFolder(const GameFolder &) = delete;
    GameFolder &operator=(const GameFolder &) = delete;

    const std::filesystem::path &Root() const { return root_; }
    /// Separators are those of the system, as in what the program prints.
    std::filesystem::path operator/(std::string_view name) const { return (root_ / name).make_preferred(); }

    void Write(std::string_view name, std::string_view text) const {
        std::filesystem::create_directories((root_ / name).parent_path());
        std::ofstream out(root_ / name, std::ios::binary);
        out.write(text.data(), std::streamsize(text.size()));
        ASSERT_TRUE(out.good()) << name;
    }
    void Write(std::string_view name, const std::vector<std::byte> &bytes) const {
        Write(name, std::string_view(reinterpret_cast<const char *>(bytes.data()), bytes.size()));
    }

    using Entries = std::vector<std::pair<std::string, std::string>>;
    /// An archive with these entries; level 0 stores them as they are.
    void WriteArchive(std::string_view name, const Entries &entries, int level = 9) const {
        std::filesystem::create_directories((root_ / name).parent_path());
        zipFile zip = zipOpen64((root_ / name).string().c_str(), APPEND_STATUS_CREATE);
        ASSERT_NE(zip, nullptr);
        for (const auto &[entry, text] : entries) {
            ASSERT_EQ(zipOpenNewFileInZip64(zip, entry.c_str(), nullptr, nullptr, 0, nullptr, 0, nullptr,
                                            level == 0 ? 0 : Z_DEFLATED, level, 0),
                      ZIP_OK);
            ASSERT_EQ(zipWriteInFileInZip(zip, text.data(), unsigned(text.size())), ZIP_OK);
            ASSERT_EQ(zipCloseFileInZip(zip), ZIP_OK);
        }
        ASSERT_EQ(zipClose(zip, nullptr), ZIP_OK);
    }
    std::string ReadBack(std::string_view name) const {
        std::ifstream in(root_ / name, std::ios::binary);
        return {std::istreambuf_iterator<char>(in), {}};
    }

  private:
    std::filesystem::path root_;
};

} // namespace q3::test
