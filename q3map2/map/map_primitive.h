// GPL-2.0-or-later. Brushes and patches of map text.
#pragma once

#include "q3map2/map/map.h"
#include "q3map2/map/map_scanner.h"

#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>

namespace q3 {

/// Reads primitives, each without the "{" of the primitive, which was read.
class PrimitiveReader {
  public:
    PrimitiveReader(MapScanner &scanner, PlaneTable &planes, const BspContext &context)
        : scanner_(scanner), planes_(planes), context_(context) {}

    /// Sides with planes, flags and texture axes, as the text says: neither checked nor with windings. The three
    /// texture forms and brushDef3 may be mixed. `first` is the first token after the "{".
    Brush ReadBrush(const std::string &first);
    /// patchDef2 and patchDef3, whose word was read. Nothing when it is left out, with a warning.
    std::optional<Patch> ReadPatch();

  private:
    enum class Form { Axes, Matrix, Plane };
    BrushSide ReadSide(Form form);
    void ReadPoints(BrushSide &side);
    void ReadPlaneNumbers(BrushSide &side);
    std::array<double, 3> ReadVector();
    TextureProjection ReadAxes(const BrushSide &side);
    void ReadFlags(BrushSide &side);
    std::string ShaderName(const std::string &token, bool complete) const;
    const ShaderInfo &Shader(const std::string &name);
    void ReadControlPoints(Patch &patch);

    MapScanner &scanner_;
    PlaneTable &planes_;
    const BspContext &context_;
    std::unordered_map<std::string, const ShaderInfo *> shaders_;
};

} // namespace q3
