// GPL-2.0-or-later. Maps to JSON folders and back.
#pragma once

#include "common/error.h"
#include "q3map2/convert/json/convert_json.h"
#include "tests/support/small_bsp.h"

#include <gtest/gtest.h>

#include <string>
#include <string_view>

namespace q3::test {

/// Unpacks a map to a temporary folder of JSON files and packs it again.
class JsonTest : public testing::Test {
  protected:
    void Unpack(const Bsp &bsp) { UnpackJson(bsp, Quake3(), folder_.Path(), log_.log); }
    Bsp Pack(const PackJsonOptions &options = {}) { return PackJson(folder_.Path(), Quake3(), options, log_.log); }
    void ExpectSame(const Bsp &bsp) {
        Unpack(bsp);
        EXPECT_EQ(Bytes(Pack()), Bytes(bsp));
    }
    /// The message of the Error that packing throws.
    std::string PackError() {
        try {
            Pack();
        } catch (const Error &error) {
            return error.what();
        }
        return "no error";
    }
    std::string Text(std::string_view file) const {
        std::ifstream stream(folder_.Path() / file);
        return {std::istreambuf_iterator<char>(stream), {}};
    }
    /// Unpacks `bsp`, replaces the first `from` by `to` in a file, and returns PackError.
    std::string FaultAfter(const Bsp &bsp, std::string_view file, std::string_view from, std::string_view to) {
        Unpack(bsp);
        std::string text = Text(file);
        const std::size_t at = text.find(from);
        EXPECT_NE(at, std::string::npos) << from;
        text.replace(at, from.size(), to);
        std::ofstream(folder_.Path() / file, std::ios::binary) << text;
        return PackError();
    }

    TempFolder folder_;
    KeptLog log_;
};

} // namespace q3::test
