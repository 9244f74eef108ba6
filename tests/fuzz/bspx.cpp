// GPL-2.0-or-later. Fuzz target bspx: each BSPX lump by itself. What is read is written again and reads equal, and
// engines read it too.
#include "libs/ambientcubes/ambient_cubes.h"
#include "libs/shgrid/shgrid.h"
#include "libs/staticprops/staticprops.h"
#include "q3map2/bspfile/bspfile.h"
#include "q3map2/bspfile/bspfile_named.h"
#include "q3map2/bspfile/bspfile_sparse.h"
#include "q3map2/bspfile/bspx_lumps.h"
#include "q3map2/bspfile/prop_light.h"
#include "tests/fuzz/fuzz_target.h"

namespace q3::fuzz {
namespace {

ByteSource SourceOf(std::span<const std::byte> bytes) {
    return {bytes.size(), [bytes](std::uint64_t at, std::span<std::byte> into) {
                Require(at <= bytes.size() && into.size() <= bytes.size() - at, "a read outside the file");
                std::memcpy(into.data(), bytes.data() + at, into.size());
            }};
}

/// A map that some lumps fit: three leafs, four vertices, a page of lightmaps of one light, two entities.
Bsp MapOfLumps() {
    Bsp bsp;
    bsp.entities = "{\n\"classname\" \"worldspawn\"\n}\n{\n\"classname\" \"misc_model\"\n\"model\" \"a.md3\"\n}\n";
    bsp.leafs.resize(3);
    bsp.drawVerts.resize(4);
    bsp.lightmaps.resize(kLightmapPageBytes);
    return bsp;
}

std::vector<std::byte> ReadAndWriteLump(const BspxRow &row, std::span<const std::byte> lump, Bsp &bsp, Log &log) {
    const ByteSource file = SourceOf(lump);
    const BspxSource from{file, {0, std::int64_t(lump.size())}, row.name, "x.bsp", log};
    std::vector<std::byte> bytes;
    if (Accepts([&] { row.read(from, bsp); }) && row.has(bsp))
        MustSucceed("a lump that was read", [&] { bytes = row.write(bsp).Bytes(); });
    return bytes;
}

/// Engines must read what this program takes.
void RequireEngineReads(BspxId id, std::span<const std::byte> lump, const Bsp &bsp) {
    shgrid_grid grid;
    ambient_cubes cubes;
    staticprops_light props;
    const std::vector<std::byte> leafs(bsp.leafs.size() * AMBIENT_CUBES_BSP_LEAF_BYTES);
    switch (id) {
    case BspxId::LightGridSH:
    case BspxId::SparseGridSH:
    case BspxId::NamedGridSH:
        Require(shgrid_parse(lump.data(), lump.size(), &grid) == SHGRID_OK, "engines do not read the grid");
        break;
    case BspxId::AmbientCubes:
        Require(ambient_cubes_parse(lump.data(), lump.size(), leafs.data(), leafs.size(), &cubes) == AMBIENT_CUBES_OK,
                "engines do not read the cubes");
        break;
    case BspxId::PropLight:
        Require(staticprops_parse(lump.data(), lump.size(), &props) == STATICPROPS_OK, "engines do not read the props");
        break;
    default:
        break;
    }
}

/// A lump that the reader took; it may still not fit the map, or contradict itself.
void CheckLump(const BspxRow &row, Bsp &bsp, Log &log) {
    if (row.misfit != nullptr)
        row.misfit(bsp);
    const bool isSound = row.check == nullptr || Accepts([&] { row.check(bsp, "x.bsp"); });
    DropUnfitLumps(bsp, "x.bsp", log);
    if (!isSound || !row.has(bsp))
        return;
    RequireEngineReads(row.id, row.write(bsp).Bytes(), bsp);
    if (bsp.sparseGridSH)
        MustSucceed("a sparse grid", [&] {
            DequantizePoints(*bsp.sparseGridSH), CountSparseLevels(*bsp.sparseGridSH);
            Require(DecodeSparseGrid(EncodeSparseGrid(*bsp.sparseGridSH)) == *bsp.sparseGridSH, "another sparse grid");
        });
    if (bsp.namedGridSH)
        MustSucceed("a grid that names lights", [&] {
            Require(DecodeNamedGrid(EncodeNamedGrid(*bsp.namedGridSH)) == *bsp.namedGridSH, "another named grid");
        });
    if (bsp.propLight)
        MustSucceed("light of props", [&] {
            const std::vector<std::byte> bytes = EncodePropLight(*bsp.propLight);
            Require(EncodePropLight(DecodePropLight(bytes)) == bytes, "other light of props");
        });
}

} // namespace
} // namespace q3::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t *data, std::size_t size) {
    using namespace q3::fuzz;
    Input input(data, size);
    const q3::BspxRow &row = q3::BspxRows()[input.Choose(q3::kBspxIdCount)];
    SilentLog log;
    q3::Bsp bsp = MapOfLumps();
    const std::vector<std::byte> bytes = ReadAndWriteLump(row, input.Rest(), bsp, log);
    if (row.has(bsp)) {
        q3::Bsp again = MapOfLumps();
        Require(ReadAndWriteLump(row, bytes, again, log) == bytes, "a lump changes when it is written and read");
        CheckLump(row, bsp, log);
    }
    return 0;
}
