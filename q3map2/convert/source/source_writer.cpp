// GPL-2.0-or-later. Writes the text of map sources.
#include "q3map2/convert/source/source_writer.h"

#include "common/text/text.h"

#include <fmt/ranges.h>

#include <algorithm>

namespace q3 {

namespace {

constexpr std::string_view FormName(MapForm form) {
    switch (form) {
    case MapForm::Primitive:
        return "map_bp";
    case MapForm::Valve:
        return "map_220";
    default:
        return "map";
    }
}

/// The shader name, in quotes if readers would otherwise take only a part of it.
std::string NameToken(std::string_view name) {
    const bool cut = name.empty() || std::ranges::any_of(name, [](char c) { return IsBlank(c) || c == ';'; });
    return cut ? fmt::format("\"{}\"", name) : std::string(name);
}

} // namespace

std::string_view WithoutTextures(std::string_view shader) {
    constexpr std::string_view folder = "textures/";
    return StartsWithNoCase(shader, folder) ? shader.substr(folder.size()) : shader;
}

SourceWriter::SourceWriter(MapForm form)
    : form_(form), text_(fmt::format("// Made by q3map2-sh -convert -format {}\n", FormName(form))) {}

void SourceWriter::BeginEntity(int number) {
    text_ += fmt::format("// entity {}\n{{\n", number);
}

void SourceWriter::WritePair(std::string_view key, std::string_view value) {
    if (!key.empty() && !value.empty())
        text_ += fmt::format("\t\"{}\" \"{}\"\n", key, value);
}

void SourceWriter::WriteSide(const SideWords &side) {
    const std::vector<std::string> &t = side.texture;
    const std::string name = NameToken(side.shader);
    text_ += fmt::format("\t\t{} ", fmt::join(side.points, " "));
    if (form_ == MapForm::Primitive)
        text_ += fmt::format("( ( {} {} {} ) ( {} {} {} ) ) {}", t[0], t[1], t[2], t[3], t[4], t[5], name);
    else if (form_ == MapForm::Valve)
        text_ += fmt::format("{} [ {} {} {} {} ] [ {} {} {} {} ] 0 {} {}", name, t[0], t[1], t[2], t[3], t[4], t[5],
                             t[6], t[7], t[8], t[9]);
    else
        text_ += fmt::format("{} {}", name, fmt::join(t, " "));
    text_ += fmt::format(" {}\n", fmt::join(side.flags, " "));
}

void SourceWriter::WriteBrush(int number, std::span<const SideWords> sides) {
    const bool wrapped = form_ == MapForm::Primitive;
    text_ += fmt::format("\t// brush {}\n\t{{\n{}", number, wrapped ? "\tbrushDef\n\t{\n" : "");
    for (const SideWords &side : sides)
        WriteSide(side);
    text_ += wrapped ? "\t}\n\t}\n\n" : "\t}\n\n";
}

void SourceWriter::WritePatch(int number, const PatchWords &patch) {
    text_ += fmt::format("\t// patch {}\n\t{{\n\t\t{}\n\t\t{{\n\t\t\t{}\n", number,
                         patch.hasTolerances ? "patchDef3" : "patchDef2", NameToken(patch.shader));
    text_ += fmt::format("\t\t\t( {} {} {} )\n\t\t\t(\n", patch.width, patch.height, fmt::join(patch.header, " "));
    for (int column = 0; column < patch.width; ++column) {
        text_ += "\t\t\t\t(";
        for (int row = 0; row < patch.height; ++row) {
            const DrawVert &v = patch.verts[std::size_t(row) * std::size_t(patch.width) + std::size_t(column)];
            text_ += fmt::format(" ( {} {} {} {} {} )", ExactText(v.xyz.x), ExactText(v.xyz.y), ExactText(v.xyz.z),
                                 ExactText(v.st[0]), ExactText(v.st[1]));
        }
        text_ += " )\n";
    }
    text_ += "\t\t\t)\n\t\t}\n\t}\n\n";
}

void SourceWriter::EndEntity() {
    text_ += "}\n\n";
}

} // namespace q3
