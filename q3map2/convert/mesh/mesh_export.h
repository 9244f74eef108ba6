// GPL-2.0-or-later. Maps as model files.
#pragma once

#include "q3map2/convert/mesh/mesh_scene.h"

namespace q3 {

/// Writes the map as `output`, x.ase beside x.bsp: names of lightmap images and generated shaders follow from it.
/// Errors: Error, for files that cannot be written.
void WriteAse(const Bsp &bsp, ShaderLibrary &library, const MeshExportOptions &options,
              const std::filesystem::path &output, Log &log);
/// The same as `output`, x.obj, and its materials as x.mtl.
void WriteObj(const Bsp &bsp, ShaderLibrary &library, const MeshExportOptions &options,
              const std::filesystem::path &output, Log &log);

} // namespace q3
