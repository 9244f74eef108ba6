// GPL-2.0-or-later. Fuzz target bsp: whole compiled maps of all formats. What is read is written again and reads equal.
#include "q3map2/bspfile/bspfile.h"
#include "q3map2/bspfile/entities.h"
#include "q3map2/convert/bsp_info.h"
#include "tests/fuzz/fuzz_target.h"

namespace q3::fuzz {
namespace {

/// How the reader may be called: options of games, and -force.
constexpr BspFormat kBspFormats[] = {
    {}, {.version = 47, .advertisements = true}, {.force = true}, {.lightmapSide = 512}};

/// The format in which the map is written again.
BspFormat FormatOf(const Bsp &bsp, BspFormat format) {
    format.ident = bsp.ident;
    if (format.HasStyleSlots())
        format.version = 1;
    return format;
}

void ReadAndWrite(std::span<const std::byte> file, const BspFormat &format, Log &log) {
    Bsp bsp;
    if (!Accepts([&] { bsp = ReadBsp(file, "x.bsp", format, log); }))
        return;
    const BspFormat writing = FormatOf(bsp, format);
    std::vector<std::byte> again;
    if (!Accepts([&] { again = WriteBsp(bsp, writing); }))
        return;
    MustSucceed("a written map", [&] {
        const Bsp second = ReadBsp(again, "again.bsp", writing, log);
        Require(WriteBsp(second, writing) == again, "a map changes when it is written, read and written");
    });
    MustSucceed("-info", [&] { PrintBspInfo("x.bsp", bsp, file.size(), log); });
    Accepts([&] { StoredEntities(bsp.entities, "x.bsp"); });
    StoredWorld(bsp.entities);
    for (const Vec3f &point : {Vec3f{}, Vec3f{1e30f, -1e30f, 0}, Vec3f{-8, 8, 8}})
        Require(bsp.leafs.empty() || std::size_t(LeafAt(bsp, point)) < bsp.leafs.size(), "no leaf at a point");
}

} // namespace
} // namespace q3::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t *data, std::size_t size) {
    using namespace q3::fuzz;
    Input input(data, size);
    const std::size_t which = input.Choose(std::size(kBspFormats) + 1);
    SilentLog log;
    if (which < std::size(kBspFormats))
        ReadAndWrite(input.Rest(), kBspFormats[which], log);
    else
        for (const bool lumpSwap : {false, true})
            Accepts([&] { q3::PrintAnalysis(input.Rest(), lumpSwap, "x.bsp", log); });
    q3::KindOfFile(input.Rest().first(std::min(q3::kKindBytes, input.Rest().size())));
    return 0;
}
