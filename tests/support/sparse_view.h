// GPL-2.0-or-later. The sparse SH grid as engines read it.
#pragma once

#include "libs/shgrid/shgrid.h"
#include "q3map2/bspfile/bspfile_sparse.h"
#include "tests/support/light_fixture.h"

#include <vector>

namespace q3::test {

/// A sparse grid through its lump and the reader for engines.
class SparseView {
  public:
    explicit SparseView(const SparseGridSH &grid) : lump_(EncodeSparseGrid(grid)) {
        EXPECT_EQ(shgrid_parse(lump_.data(), lump_.size(), &grid_), SHGRID_OK);
    }
    std::size_t Bytes() const { return lump_.size(); }
    const std::vector<std::byte> &Lump() const { return lump_; }
    Coefficients Sample(const Vec3d &p) const {
        const float at[3] = {float(p.x), float(p.y), float(p.z)};
        shgrid_coeffs read;
        shgrid_sample(&grid_, at, &read);
        Coefficients c;
        for (std::size_t k = 0; k < 9; k++)
            c[k] = {double(read.c[k][0]), double(read.c[k][1]), double(read.c[k][2])};
        return c;
    }

  private:
    std::vector<std::byte> lump_;
    shgrid_grid grid_{};
};

} // namespace q3::test
