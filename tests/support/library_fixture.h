// GPL-2.0-or-later. A shader library over a small game folder.
#pragma once

#include "q3map2/shader/shader_library.h"
#include "tests/support/game_folder.h"

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

namespace q3::test {

/// Surface flags of the surfaceparms slick and dust.
inline constexpr std::uint32_t kSlick = 0x2, kDust = 0x40000;

/// Write files into `folder`, then Load.
class LibraryTest : public testing::Test {
  protected:
    void Load(std::string_view game = "quake3") {
        library.reset();
        vfs = std::make_unique<VirtualFileSystem>(out.log);
        vfs->Mount(folder.Root(), "pk3");
        library = std::make_unique<ShaderLibrary>(*vfs, *FindGame(game), options, out.log);
    }
    /// One script with this text, and no list.
    void LoadScript(std::string_view text, std::string_view game = "quake3") {
        folder.Write(fmt::format("{}/test.shader", FindGame(game)->shaderDir), text);
        Load(game);
    }
    /// One shader named `s` with this body.
    const ShaderInfo &LoadShader(std::string_view body, std::string_view game = "quake3") {
        LoadScript(fmt::format("s\n{{\n{}\n}}\n", body), game);
        return Get("s");
    }
    /// With the image and colors that bounced light would see.
    const ShaderInfo &Get(std::string_view name) {
        const ShaderInfo &info = library->Get(name);
        library->ReleaseImages(KeptImages::OfReflectors);
        return info;
    }
    int Warnings(std::string_view kind) const { return out.log.WarningCount(kind); }

    /// A TGA file of width x 1 texels, given as r g b a.
    void WriteTga(std::string_view name, const std::vector<std::array<int, 4>> &texels) const {
        std::string file(18, '\0');     // header
        file[2] = 2;                    // true color, not compressed
        file[12] = char(texels.size()); // width
        file[14] = 1;                   // height
        file[16] = 32;                  // bits a texel
        file[17] = 0x28;                // rows from the top, 8 bits of alpha
        for (const auto &t : texels)
            for (const int channel : {t[2], t[1], t[0], t[3]})
                file += char(channel);
        folder.Write(name, file);
    }

    GameFolder folder;
    KeptLog out;
    ShaderOptions options;
    std::unique_ptr<VirtualFileSystem> vfs;
    std::unique_ptr<ShaderLibrary> library;
};

} // namespace q3::test
