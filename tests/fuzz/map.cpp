// GPL-2.0-or-later. Fuzz target map: map sources. Converted to another form of texture axes, they can be read again.
#include "q3map2/bspfile/bspfile.h"
#include "q3map2/bspfile/entities.h"
#include "q3map2/convert/source/source_writer.h"
#include "q3map2/map/map_parse.h"
#include "tests/fuzz/fuzz_target.h"

namespace q3::fuzz {
namespace {

constexpr std::string_view kMapShaders = R"(
textures/w { surfaceparm water surfaceparm trans }
textures/f { surfaceparm fog surfaceparm nonsolid fogparms ( 1 1 1 ) 512 }
textures/o { surfaceparm origin surfaceparm nodraw surfaceparm nonsolid }
textures/a { surfaceparm areaportal surfaceparm structural surfaceparm trans surfaceparm nodraw }
textures/g { q3map_globaltexture }
textures/t { q3map_tcGen ivector ( 128 0 0 ) ( 0 0 256 ) }
textures/v { q3map_rgbMod volume q3map_rgbMod set ( 1 0 0 ) surfaceparm trans surfaceparm nonsolid }
)";

/// The game files of all inputs.
class MapGame {
  public:
    MapGame() {
        folder_.Write("scripts/m.shader", kMapShaders);
        vfs_.Mount(folder_.Path(), "pk3");
    }
    const VirtualFileSystem &Files() const { return vfs_; }

  private:
    ScratchFolder folder_;
    SilentLog log_;
    VirtualFileSystem vfs_{log_};
};

void ReadSource(std::string_view text, const VirtualFileSystem &files) {
    SilentLog log;
    ShaderOptions shaderOptions;
    shaderOptions.imageSizes = true;
    const Game &game = *FindGame("quake3");
    ShaderLibrary shaders(files, game, shaderOptions, log);
    BspOptions options;
    const BspContext context{options, game, shaders, log, &files};
    Map map;
    if (!Accepts([&] { map = ReadMap(text, "x.map", context); }))
        return;
    for (const MapEntity &entity : map.entities)
        for (const Brush &brush : entity.brushes)
            for (const BrushSide &side : brush.sides)
                Require(side.planeNum >= -1, "a side without a plane");
    for (const MapForm form : {MapForm::Classic, MapForm::Primitive, MapForm::Valve}) {
        std::string converted;
        if (Accepts([&] { converted = ConvertedSource(text, "x.map", form, context); }))
            MustSucceed("a converted source", [&] { ReadMap(converted, "x.map", context); });
    }
}

} // namespace
} // namespace q3::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t *data, std::size_t size) {
    using namespace q3::fuzz;
    static const MapGame game; // made once: inputs only read it
    const std::string_view text = Input(data, size).Text();
    ReadSource(text, game.Files());
    Accepts([&] { q3::ParseMapEntities(text, "x.map"); });
    q3::KindOfSource(text);
    return 0;
}
