// GPL-2.0-or-later. Grids with a tree as engines read them.
#pragma once

#include "libs/shgrid/shgrid.h"
#include "q3map2/bspfile/bspfile_named.h"
#include "q3map2/bspfile/bspfile_sparse.h"
#include "tests/support/light_fixture.h"

#include <vector>

namespace q3::test {

/// A grid through its lump and the reader for engines.
class LumpView {
  public:
    explicit LumpView(std::vector<std::byte> lump) : lump_(std::move(lump)) {
        EXPECT_EQ(shgrid_parse(lump_.data(), lump_.size(), &grid_), SHGRID_OK);
    }
    std::size_t Bytes() const { return lump_.size(); }
    const std::vector<std::byte> &Lump() const { return lump_; }
    const shgrid_grid &Grid() const { return grid_; }
    /// All light as coefficients.
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

/// A sparse grid.
class SparseView : public LumpView {
  public:
    explicit SparseView(const SparseGridSH &grid) : LumpView(EncodeSparseGrid(grid)) {}
};

/// A grid that names lights.
class NamedView : public LumpView {
  public:
    explicit NamedView(const NamedGridSH &grid) : LumpView(EncodeNamedGrid(grid)) {}
    /// The lights that act at a position. styles: brightness of the 64 styles; null: all 1.
    shgrid_lighting LightingAt(const Vec3d &p, const float *styles = nullptr) const {
        const float at[3] = {float(p.x), float(p.y), float(p.z)};
        shgrid_lighting lighting;
        shgrid_lights(&Grid(), at, styles, &lighting);
        return lighting;
    }
    /// Light on a surface with that normal.
    Vec3d Light(const Vec3d &p, const Vec3d &n, const float *styles = nullptr) const {
        const shgrid_lighting lighting = LightingAt(p, styles);
        const float normal[3] = {float(n.x), float(n.y), float(n.z)};
        float rgb[3];
        shgrid_shade(&lighting, normal, rgb);
        return {double(rgb[0]), double(rgb[1]), double(rgb[2])};
    }
    /// Number of lights of a style that act at a position.
    int CountOfStyle(int style, const Vec3d &p) const {
        const shgrid_lighting lighting = LightingAt(p);
        int count = 0;
        for (int i = 0; i < lighting.count; i++)
            count += lighting.direct[i].style == style ? 1 : 0;
        return count;
    }
};

} // namespace q3::test
