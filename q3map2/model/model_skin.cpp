// GPL-2.0-or-later. Shader replacements of models: skin files and _remap keys.
#include "q3map2/model/model_skin.h"

#include "common/files/archive.h"
#include "common/text/text.h"
#include "common/text/text_scan.h"
#include "q3map2/bspfile/bsp_records.h"
#include "q3map2/bspfile/map_keys.h"
#include "q3map2/shader/shader_table.h"

#include <algorithm>

#include <fmt/ranges.h>

namespace q3 {

namespace {

using Replacement = ShaderRemap::Replacement;

bool Matches(const Replacement &remap, std::string_view shader) {
    return remap.from == "*" || EndsWithNoCase(shader, remap.from);
}

std::string_view Trimmed(std::string_view text) {
    while (!text.empty() && (unsigned char)(text.front()) <= ' ')
        text.remove_prefix(1);
    while (!text.empty() && (unsigned char)(text.back()) <= ' ')
        text.remove_suffix(1);
    return text;
}

/// A line "replace FROM TO" or "FROM,TO".
std::optional<Replacement> SkinLine(std::string_view line) {
    if (const std::size_t comma = line.find(','); comma != std::string_view::npos)
        return Replacement{WithoutExtension(PlainName(Trimmed(line.substr(0, comma)))),
                           WithoutExtension(PlainName(Trimmed(line.substr(comma + 1))))};
    TextScanner scanner{std::string(line), "skin"};
    std::string word, from, to;
    if (scanner.Next(word) && EqualNoCase(word, "replace") && scanner.Next(from) && scanner.Next(to))
        return Replacement{WithoutExtension(PlainName(from)), WithoutExtension(PlainName(to))};
    return {};
}

std::vector<Replacement> ReadSkin(std::string_view text) {
    std::vector<Replacement> skin;
    while (!text.empty()) {
        const std::size_t end = std::min(text.find('\n'), text.size());
        if (auto line = SkinLine(Trimmed(text.substr(0, end))); line && !line->from.empty())
            skin.push_back(std::move(*line));
        text.remove_prefix(std::min(end + 1, text.size()));
    }
    return skin;
}

std::optional<std::vector<Replacement>> SkinOf(const Entity &entity, std::string_view who, std::string_view model,
                                               const VirtualFileSystem *vfs, Log &log) {
    const std::string_view skin = keys::kSkin.Text(entity);
    if (skin.empty())
        return {};
    const bool digits = std::all_of(skin.begin(), skin.end(), [](char c) { return c >= '0' && c <= '9'; });
    const std::string name =
        (digits ? std::string(model) : WithoutExtension(model)) + "_" + std::string(skin) + ".skin";
    const auto bytes = vfs == nullptr ? std::nullopt : vfs->Read(name);
    if (!bytes) {
        log.Warn("skin not found", "{}: the skin file {} cannot be read", who, name);
        return {};
    }
    return ReadSkin(AsText(*bytes));
}

/// The _remap keys of the entity as replacements: those with the longest `from` first, "*" last.
std::vector<Replacement> RemapsOf(const Entity &entity, std::string_view who, Log &log) {
    std::vector<Replacement> remaps;
    for (const auto &[key, value] : entity.pairs) {
        if (!StartsWithNoCase(key, keys::kRemapPrefix))
            continue;
        const std::size_t semicolon = value.find(';');
        Replacement remap;
        if (semicolon != std::string::npos)
            remap = {value.substr(0, semicolon), value.substr(semicolon + 1)};
        if (remap.from.empty() || remap.to.empty() || remap.to.size() > kMaxShaderName)
            log.Warn("bad remap", "{}: \"{}\" \"{}\" is ignored: expected FROM;TO, TO with at most {} characters", who,
                     key, value, kMaxShaderName);
        else
            remaps.push_back(std::move(remap));
    }
    std::stable_sort(remaps.begin(), remaps.end(), [](const Replacement &a, const Replacement &b) {
        return (a.from == "*" ? 0 : a.from.size()) > (b.from == "*" ? 0 : b.from.size());
    });
    return remaps;
}

} // namespace

ShaderRemap ShaderRemapOf(const Entity &entity, std::string_view who, std::string_view model,
                          const VirtualFileSystem *vfs, Log &log) {
    auto skin = SkinOf(entity, who, model, vfs, log);
    return {std::move(skin), RemapsOf(entity, who, log)};
}

std::string ShaderRemap::Skinned(std::string_view shader) const {
    if (!skin_)
        return std::string(shader);
    const auto line = std::ranges::find_if(*skin_, [&](const Replacement &r) { return EqualNoCase(r.from, shader); });
    return line == skin_->end() ? std::string() : line->to;
}

std::string ShaderRemap::operator()(std::string_view shader) const {
    std::string name = Skinned(shader);
    if (name.empty() && skin_)
        return name;
    for (const Replacement &remap : remaps_)
        if (Matches(remap, name))
            return WithoutExtension(remap.to);
    return name;
}

void ShaderRemap::WarnOfUnmatched(std::span<const std::string> shaders, std::string_view who, Log &log) const {
    std::vector<std::string> skinned;
    for (const std::string &shader : shaders)
        skinned.push_back(Skinned(shader));
    for (const Replacement &remap : remaps_)
        if (std::ranges::none_of(skinned, [&](const std::string &shader) { return Matches(remap, shader); }))
            log.Warn("remap without match",
                     "{}: _remap \"{};{}\" has no effect: no shader of the model ends with {}; it has {}", who,
                     remap.from, remap.to, remap.from, fmt::join(skinned, ", "));
}

} // namespace q3
