// GPL-2.0-or-later. Writes the text of map sources, and rewrites sources in another form of texture axes.
#pragma once

#include "q3map2/convert/source/texture_form.h"
#include "q3map2/map/bsp_options.h"
#include "q3map2/map/map.h"

#include <array>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace q3 {

/// A side as it is written.
struct SideWords {
    std::array<std::string, 3> points; ///< "( x y z )"
    std::string shader;                ///< without "textures/"
    std::vector<std::string> texture;  ///< numbers from TextureInForm
    std::array<int, 3> flags{};        ///< contents, surface flags, value
};

/// A patch as it is written.
struct PatchWords {
    std::string shader;              ///< without "textures/"
    bool hasTolerances = false;      ///< patchDef3: the header begins with curve tolerances
    std::vector<std::string> header; ///< what follows width and height
    int width = 0, height = 0;
    std::vector<DrawVert> verts{}; ///< row * width + column
};

/// Collects the text of a map source, in order.
class SourceWriter {
  public:
    explicit SourceWriter(MapForm form);

    void BeginEntity(int number);
    /// Pairs come before brushes and patches. Writes nothing if the key or the value is empty.
    void WritePair(std::string_view key, std::string_view value);
    /// `number` is for the comment above the brush.
    void WriteBrush(int number, std::span<const SideWords> sides);
    void WritePatch(int number, const PatchWords &patch);
    void EndEntity();
    const std::string &Text() const { return text_; }

  private:
    void WriteSide(const SideWords &side);

    MapForm form_;
    std::string text_;
};

/// The name without a leading "textures/", which readers of map text add.
std::string_view WithoutTexturesFolder(std::string_view shader);

/// The text of a map with the texture axes of all sides in one form. Everything else stays: entities, keys, the order
/// and the points of brushes, flags, patches, groups, origin brushes. Warns of textures that the form cannot hold.
/// Errors: those of ReadMap.
std::string ConvertedSource(std::string_view text, std::string_view name, MapForm form, const BspContext &context);

} // namespace q3
