// GPL-2.0-or-later. Maps as model files.
#include "q3map2/convert/mesh/mesh_export.h"

#include "common/files/files.h"
#include "q3map2/convert/mesh/mesh_text.h"

namespace q3 {

namespace {

void PrintMeshCounts(const MeshScene &scene, Log &log) {
    std::size_t verts = 0, triangles = 0;
    for (const MeshSurface &surface : scene.surfaces)
        verts += surface.verts.size(), triangles += surface.triangles.size();
    log.Count((long long)(scene.materials.size()), "materials");
    log.Count((long long)(scene.surfaces.size()), "surfaces");
    log.Count((long long)(verts), "vertices");
    log.Count((long long)(triangles), "triangles");
}

void WriteText(const std::filesystem::path &path, const std::string &text, Log &log) {
    log.Print("Writing {}\n", path.string());
    ReplaceTextFile(path, text);
}

} // namespace

void WriteAse(const Bsp &bsp, ShaderLibrary &library, const MeshExportOptions &options,
              const std::filesystem::path &output, Log &log) {
    log.Section("Convert BSP to ASE");
    const MeshScene scene = MakeMeshScene(bsp, library, options, output, log);
    PrintMeshCounts(scene, log);
    WriteText(output, AseText(scene), log);
}

void WriteObj(const Bsp &bsp, ShaderLibrary &library, const MeshExportOptions &options,
              const std::filesystem::path &output, Log &log) {
    log.Section("Convert BSP to OBJ");
    const MeshScene scene = MakeMeshScene(bsp, library, options, output, log);
    PrintMeshCounts(scene, log);
    WriteText(output, ObjText(scene), log);
    auto materials = output;
    materials.replace_extension(".mtl");
    WriteText(materials, MtlText(scene), log);
}

} // namespace q3
