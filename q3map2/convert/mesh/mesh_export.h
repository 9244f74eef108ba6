// GPL-2.0-or-later. Maps as model files: Wavefront, and the ASCII scene format of 3D Studio Max.
#pragma once

#include "q3map2/convert/mesh/mesh_scene.h"

#include <string>

namespace q3 {

/// The scene in the ASCII scene format of 3D Studio Max (.ase), an object a surface. Lines end with CR LF.
std::string AseText(const MeshScene &scene);
/// The scene as a Wavefront model (.obj) with y up, a group a surface. It names NAME.mtl, the text of MtlText.
std::string ObjText(const MeshScene &scene);
/// The materials of the scene for ObjText, those of equal name once.
std::string MtlText(const MeshScene &scene);

/// Writes the map as `output`, x.ase beside x.bsp: names of lightmap images and generated shaders follow from it.
/// Errors: Error, for files that cannot be written.
void WriteAse(const Bsp &bsp, ShaderLibrary &library, const MeshExportOptions &options,
              const std::filesystem::path &output, Log &log);
/// The same as `output`, x.obj, and its materials as x.mtl.
void WriteObj(const Bsp &bsp, ShaderLibrary &library, const MeshExportOptions &options,
              const std::filesystem::path &output, Log &log);

} // namespace q3
