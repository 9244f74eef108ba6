// GPL-2.0-or-later. What a package leaves out because players have it.
#include "q3map2/pk3/exclusions.h"

#include "common/error.h"
#include "common/platform/platform.h"
#include "common/text/text_scan.h"
#include "q3map2/pk3/wanted_list.h"

#include <array>
#include <filesystem>

namespace q3 {

namespace {

struct Block {
    std::string_view word;
    std::set<std::string> Exclusions::*names;
};
constexpr std::array<Block, 5> kBlocks = {{{"textures", &Exclusions::textures},
                                           {"shaders", &Exclusions::shaders},
                                           {"shaderfiles", &Exclusions::shaderFiles},
                                           {"sounds", &Exclusions::sounds},
                                           {"videos", &Exclusions::videos}}};

std::string FileKey(std::string_view file) {
    return PathOf(LowerCase(PackageName(file))).replace_extension().generic_string();
}

std::string KeyFor(std::set<std::string> Exclusions::*block, std::string_view name) {
    if (block == &Exclusions::shaders)
        return LowerCase(PackageName(name));
    if (block == &Exclusions::shaderFiles)
        return std::filesystem::path(FileKey(name)).filename().generic_string();
    return FileKey(name);
}

} // namespace

bool Exclusions::HasTexture(std::string_view image) const {
    return textures.contains(KeyFor(&Exclusions::textures, image));
}
bool Exclusions::HasShader(std::string_view shader) const {
    return shaders.contains(KeyFor(&Exclusions::shaders, shader));
}
bool Exclusions::HasShaderFile(std::string_view script) const {
    return shaderFiles.contains(KeyFor(&Exclusions::shaderFiles, script));
}
bool Exclusions::HasSound(std::string_view sound) const {
    return sounds.contains(KeyFor(&Exclusions::sounds, sound));
}
bool Exclusions::HasVideo(std::string_view video) const {
    return videos.contains(KeyFor(&Exclusions::videos, video));
}

void Exclusions::Add(const Exclusions &other) {
    for (const Block &block : kBlocks)
        (this->*block.names).insert((other.*block.names).begin(), (other.*block.names).end());
}

Exclusions ReadExclusions(std::string text, std::string_view name) {
    TextScanner scanner(std::move(text), std::string(name));
    Exclusions result;
    for (std::string word, brace; scanner.Next(word);) {
        const Block *block = nullptr;
        for (const Block &known : kBlocks)
            if (EqualNoCase(known.word, word))
                block = &known;
        if (block == nullptr)
            throw Error("{}: {} is not one of textures, shaders, shaderfiles, sounds and videos", scanner.Location(),
                        word);
        if (!scanner.Next(brace) || brace != "{")
            throw Error("{}: expected {{ after {}", scanner.Location(), word);
        while (scanner.Next(brace) && brace != "}")
            (result.*block->names).insert(KeyFor(block->names, brace));
        if (brace != "}")
            throw Error("{}: the block {} has no closing brace", scanner.Location(), word);
    }
    return result;
}

} // namespace q3
