// GPL-2.0-or-later. Brushes and patches of map text, moved relative to the origin of their entity.
#pragma once

#include "q3map2/map/bsp_options.h"
#include "q3map2/map/map.h"
#include "q3map2/map/map_scanner.h"

#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>

namespace q3 {

/// A brush side as the text has it, for stages that write it again.
struct SideText {
    std::string shader; ///< as written, mostly without "textures/"
    std::array<Vec3d, 3> points{};
    bool hasPoints = false;     ///< false: brushDef3
    TextureProjection texture;  ///< from the side's own numbers, before tcGen and -flat
    std::array<int, 3> flags{}; ///< contents (only detail has a meaning), surface flags, value
};

/// A patch as the text has it.
struct PatchText {
    std::string shader;
    std::vector<std::string> header; ///< what follows width and height: flags, or curve tolerances of patchDef3
};

/// Reads brushes and patches whose opening "{" was already read.
class PrimitiveReader {
  public:
    PrimitiveReader(MapScanner &scanner, PlaneTable &planes, const BspContext &context)
        : scanner_(scanner), planes_(planes), context_(context) {}

    /// Reads sides with planes, flags and texture axes; does not check them or make windings. A map may mix brushes of
    /// all forms. `first` is the first token after the "{". `texts`, if given, gets an entry for each side.
    Brush ReadBrush(const std::string &first, std::vector<SideText> *texts = nullptr);
    /// Reads a patch after its keyword, patchDef2 or patchDef3. Empty, after a warning, if the patch is left out.
    std::optional<Patch> ReadPatch(PatchText *text = nullptr);

  private:
    /// Classic or Valve 220; brushDef; brushDef3.
    enum class Form { Axes, Matrix, Plane };
    /// Whether names of shaders may begin with "textures/".
    enum class NameForm { Short, WholeOrShort };
    BrushSide ReadSide(Form form, SideText &text);
    void ReadPoints(BrushSide &side, SideText &text);
    void ReadPlaneNumbers(BrushSide &side);
    std::array<double, 3> ReadVector();
    TextureProjection ReadAxes(const BrushSide &side);
    void ReplaceUnusableProjection(BrushSide &side, const std::string &shader) const;
    void ReadFlags(BrushSide &side, SideText &text);
    std::string ShaderName(const std::string &token, NameForm form) const;
    const ShaderInfo &Shader(const std::string &name);
    void ReadControlPoints(Patch &patch);

    MapScanner &scanner_;
    PlaneTable &planes_;
    const BspContext &context_;
    std::unordered_map<std::string, const ShaderInfo *> shaders_;
};

/// Moves all brushes and patches of the entity; sides get the numbers of their moved planes.
void MoveEntity(MapEntity &entity, const Vec3f &by, PlaneTable &planes);
/// Joins a func_group with the world: undoes the translation by an origin brush and applies the key origin.
void JoinWorld(MapEntity &group, MapEntity &world, PlaneTable &planes, const BspContext &context);

} // namespace q3
