// GPL-2.0-or-later. The bytes of a .bsp file, piece by piece. Internal to the folder.
#pragma once

#include "q3map2/bspfile/bsp.h"
#include "q3map2/bspfile/bsp_layout.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string_view>
#include <vector>

namespace q3 {

/// Layout of a file.
struct FilePlan {
    std::size_t slots = 17;
    std::array<FilePart, kNumLumps> lumps{}; ///< only the first `slots` are in the file
    std::uint64_t bspxStart = 0;             ///< position of the BSPX directory, when there is one
    std::vector<FilePart> bspx;
    std::uint64_t size = 0; ///< of the whole file
};

/// Lays out the lumps. `slots` is 17, 18 or 19; an empty slot 17 of a 19-slot file gets offset 0. Errors: a file of
/// 2^31 bytes or more, which no reader could address.
FilePlan PlanFile(std::size_t slots, const std::array<std::uint64_t, kNumLumps> &lengths,
                  std::span<const std::uint64_t> bspxLengths);

/// A .bsp file as a list of memory ranges. Most of them point into the Bsp, which must outlive this.
class BspPieces {
  public:
    using Append = std::function<void(std::span<const std::byte>)>;

    /// Errors: those of WriteBsp.
    BspPieces(const Bsp &bsp, const BspFormat &format);
    std::uint64_t Size() const { return plan_.size; }
    /// Appends all bytes of the file in order.
    void Write(const Append &append) const;

  private:
    using Pieces = std::vector<std::span<const std::byte>>; ///< consecutive ranges of one lump

    void TakeLumps(const Bsp &bsp, const BspFormat &format);
    void TakeBspx(const Bsp &bsp);
    void MakeHeader(int version);
    void MakeDirectory();

    std::array<Pieces, kNumLumps> lumps_;
    std::vector<std::string_view> bspxNames_;
    std::vector<Pieces> bspx_;
    FilePlan plan_;
    std::vector<std::byte> header_, directory_;
    bspCubeHeader_t cubeHeader_;
    bspSparseGridHeader_t sparseHeader_;
};

} // namespace q3
