// GPL-2.0-or-later. Reports how many bytes the SH grid takes in a .bsp, plain and zipped.
#include "q3map2/grid_size_report.h"

#include "common/text/counted.h"
#include "q3map2/light/options/light_options.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <zlib.h>

namespace q3 {

namespace {

/// EstimateDeflated packs up to kMaxPieces pieces of kPieceBytes.
constexpr std::size_t kPieceBytes = std::size_t(1) << 18, kMaxPieces = 16;
/// Grids up to this size never give a warning, whatever their share of the file. Bytes.
constexpr std::uint64_t kSmallGrid = 1000000;

std::size_t DeflatedSize(std::span<const std::byte> data) {
    uLongf size = compressBound(uLong(data.size()));
    std::vector<Bytef> packed(size);
    compress2(packed.data(), &size, reinterpret_cast<const Bytef *>(data.data()), uLong(data.size()),
              Z_BEST_COMPRESSION);
    return size;
}

/// A cell with about twice the volume and the same proportions, in multiples of 8 game units like the grids of maps; in
/// whole units where it is small.
std::array<int, 3> CellForHalfThePoints(const Float3 &cell) {
    constexpr double kStep = 8, kLeastStepped = 32;
    std::array<int, 3> wider{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const double size = double(cell[axis]) * std::cbrt(2.0), step = size < kLeastStepped ? 1 : kStep;
        wider[axis] = int(std::lround(size / step) * std::lround(step));
    }
    return wider;
}

} // namespace

std::uint64_t EstimateDeflated(std::span<const std::byte> data) {
    const std::size_t pieces = (data.size() + kPieceBytes - 1) / kPieceBytes, used = std::min(pieces, kMaxPieces);
    std::uint64_t sampled = 0, packed = 0;
    for (std::size_t i = 0; i < used; ++i) {
        const std::size_t first = i * pieces / used * kPieceBytes;
        const auto piece = data.subspan(first, std::min(kPieceBytes, data.size() - first));
        sampled += piece.size();
        packed += DeflatedSize(piece);
    }
    return sampled == 0 ? 0 : packed * data.size() / sampled;
}

void PrintGridSHSize(const Bsp &bsp, std::uint64_t fileBytes, Log &log) {
    if (bsp.sparseGridSH) {
        const std::vector<std::byte> lump = EncodeSparseGrid(*bsp.sparseGridSH);
        log.Print("Sparse SH grid: {}, {} of the file's {}, about {} zipped\n",
                  Counted((long long)(bsp.sparseGridSH->points.size()), "points"), SizeText(lump.size()),
                  SizeText(fileBytes), SizeText(EstimateDeflated(lump)));
    }
    if (!bsp.gridSH)
        return;
    const LightGridSH &grid = *bsp.gridSH;
    const auto points = std::as_bytes(std::span(grid.points));
    const std::uint64_t bytes = sizeof(grid.header) + points.size();
    const std::array<int, 3> cell = CellForHalfThePoints(grid.header.gridSize);
    log.Print("SH grid: {}, {} of the file's {}, about {} zipped; -gridsh {} {} {} would take about half\n",
              Counted((long long)(grid.points.size()), "points"), SizeText(bytes), SizeText(fileBytes),
              SizeText(EstimateDeflated(points)), cell[0], cell[1], cell[2]);
    const Float3 &size = grid.header.gridSize;
    const double share = double(size[0]) * double(size[1]) * double(size[2]) / std::pow(double(kSmallCellSH), 3);
    if (bytes > kSmallGrid && bytes > fileBytes / 2 && share < 1)
        log.Warn("large SH grid",
                 "the SH grid is {:.0f} % of the file; -shsmall, without another -gridsh, bakes one of {} of its "
                 "size",
                 100 * double(bytes) / double(fileBytes),
                 share < 0.01 ? std::string("less than 1 %") : fmt::format("about {:.0f} %", 100 * share));
}

} // namespace q3
