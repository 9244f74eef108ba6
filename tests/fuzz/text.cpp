// GPL-2.0-or-later. Fuzz target text: small text files, .prt, .srf, .rad, entities, DEPS, lists of exclusions, skins.
// What is read from .prt and entity text is written again and reads equal.
#include "common/files/dependencies.h"
#include "common/files/vfs.h"
#include "q3map2/bspfile/entities.h"
#include "q3map2/bspfile/entity_key.h"
#include "q3map2/bspfile/prtfile.h"
#include "q3map2/light/scene/surface_table.h"
#include "q3map2/light/sources/light_surfaces.h"
#include "q3map2/model/model_load.h"
#include "q3map2/pk3/map_needs.h"
#include "tests/fuzz/fuzz_target.h"
#include "tests/support/sample_bsp.h"

namespace q3::fuzz {
namespace {

// ---- Portal files ----

std::string PortalText(const PortalFile &file) {
    std::string text = fmt::format("PRT1\n{}\n{}\n{}\n", file.clusters, file.portals.size(), file.faces.size());
    const auto add = [&](const PrtWinding &winding, std::string_view clusters) {
        text += fmt::format("{} {}", winding.numPoints, clusters);
        for (const Vec3f &p : file.Points(winding))
            text += fmt::format(" ({:.9g} {:.9g} {:.9g} )", p.x, p.y, p.z);
        text += '\n';
    };
    for (const PrtWinding &portal : file.portals)
        add(portal, fmt::format("{} {} {}", portal.clusters[0], portal.clusters[1],
                                (portal.isHint ? kPrtHintFlag : 0) | (portal.isSky ? kPrtSkyFlag : 0)));
    for (const PrtWinding &face : file.faces)
        add(face, fmt::format("{}", face.clusters[0]));
    return text;
}

void ReadPortals(std::string_view text) {
    PortalFile file;
    if (!Accepts([&] { file = ParsePortalFile(text, "x.prt"); }))
        return;
    const std::string written = PortalText(file);
    MustSucceed("a written portal file", [&] {
        Require(PortalText(ParsePortalFile(written, "x.prt")) == written, "portals change when they are written");
    });
}

// ---- Files that the light stage reads ----

void ReadSurfaces(std::string_view text) {
    SilentLog log;
    const Bsp bsp = test::SampleBsp();
    const VirtualFileSystem files(log);
    ShaderLibrary library(files, *FindGame("quake3"), ShaderOptions{}, log);
    Accepts([&] { MakeSurfaceTable(bsp, StoredEntities(bsp.entities, "x.bsp"), text, "x.srf", library, log); });
}

void ReadTexLights(std::string_view text) {
    SilentLog log;
    for (const bool hdr : {false, true}) {
        TexLights lights;
        Accepts([&] {
            lights.Read(text, "x.rad", hdr, log);
            lights.Read(text, "y.rad", hdr, log);
        });
        for (const auto &[name, light] : lights.All())
            Require(lights.Find(name) != nullptr && IsFinite(light.radiance), "light of a material");
        lights.CastsNoShadow("textures/a/b");
        lights.CastsTextureShadow("models/a/b.md3");
    }
}

// ---- Entities ----

void ReadEntityText(std::string_view text) {
    std::vector<Entity> entities;
    if (!Accepts([&] { entities = ParseEntities(text, "x.bsp"); }))
        return;
    const std::string written = FormatEntities(entities); // with apostrophes in place of quotes
    MustSucceed("written entities", [&] {
        Require(FormatEntities(ParseEntities(written, "x.bsp")) == written, "entities change when they are written");
    });
    for (const Entity &entity : entities) {
        IsLight(entity);
        for (const auto &[key, value] : entity.pairs)
            entity.Number({key}), entity.Vector({key}), entity.Flag(key);
    }
}

// ---- Packages and skins ----

void ReadDependencies(std::string_view text) {
    SilentLog log;
    std::vector<PackageName> names;
    Accepts([&] { names = ParseDependencies(text, "DEPS", log); });
    for (const PackageName &a : names)
        for (const PackageName &b : names)
            Require((CompareVersions(a.version, b.version) < 0) == (CompareVersions(b.version, a.version) > 0),
                    "versions have no order");
}

void ReadExclusionList(std::string_view text) {
    Accepts([&] {
        const Exclusions list = ReadExclusions(std::string(text), "x.exclude");
        list.HasTexture(text.substr(0, 64)), list.HasShaderFile(text.substr(0, 64));
    });
}

/// The text is a skin file, and its lines are _remap keys.
void ReadSkinFile(std::string_view text) {
    SilentLog log;
    ScratchFolder folder;
    folder.Write("models/a_s.skin", text);
    VirtualFileSystem files(log);
    files.Mount(folder.Path(), "pk3");
    Entity entity;
    entity.Set("skin", "s");
    entity.Set("_remap", text.substr(0, text.find('\n')));
    Accepts([&] {
        const ShaderRemap remap = ShaderRemapOf(entity, "entity 1", "models/a.md3", &files, log);
        remap(text.substr(0, 32)), remap("models/a");
        const std::string shaders[] = {"models/a", std::string(text.substr(0, 32))};
        remap.WarnOfUnmatched(shaders, "entity 1", log);
        ShaderOfMaterial(text, "models/a.md3");
    });
}

} // namespace
} // namespace q3::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t *data, std::size_t size) {
    using namespace q3::fuzz;
    constexpr void (*kReaders[])(std::string_view) = {
        ReadPortals, ReadSurfaces, ReadTexLights, ReadEntityText, ReadDependencies, ReadExclusionList, ReadSkinFile};
    Input input(data, size);
    kReaders[input.Choose(std::size(kReaders))](input.Text());
    return 0;
}
