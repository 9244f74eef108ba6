// GPL-2.0-or-later. Brushes and patches of map text.
#pragma once

#include "q3map2/map/map.h"
#include "q3map2/map/map_scanner.h"

#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>

namespace q3 {

/// Reads brushes and patches whose opening "{" was already read.
class PrimitiveReader {
  public:
    PrimitiveReader(MapScanner &scanner, PlaneTable &planes, const BspContext &context)
        : scanner_(scanner), planes_(planes), context_(context) {}

    /// Reads sides with planes, flags and texture axes; does not check them or make windings. A map may mix brushes of
    /// all forms. `first` is the first token after the "{".
    Brush ReadBrush(const std::string &first);
    /// Reads a patch after its keyword, patchDef2 or patchDef3. Empty, after a warning, if the patch is left out.
    std::optional<Patch> ReadPatch();

  private:
    /// Classic or Valve 220; brushDef; brushDef3.
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
