// GPL-2.0-or-later. The lights that a grid can name: those of a pass, with the pieces of one lamp joined.
#pragma once

#include "libs/shgrid/shgrid.h"
#include "q3map2/bspfile/bspfile_named.h"
#include "q3map2/light/grid/probe_integrator.h"
#include "q3map2/light/sources/light_sources.h"

#include <cstdint>
#include <string>
#include <vector>

namespace q3 {

/// The lights of a pass as a grid names them. Triangles and quads of one lamp are one light with several polygons, the
/// samples of one sun one sun. Const after construction. Keeps a reference to the lights.
class LightTable {
  public:
    /// scale: of all light that the grid stores (-gridscale).
    LightTable(const std::vector<Light> &lights, float scale);
    LightTable(const LightTable &) = delete; // the reader points into it
    LightTable &operator=(const LightTable &) = delete;

    std::size_t Size() const { return table_.lights.size(); }
    /// The table that is written.
    const GridLights &Stored() const { return table_; }
    /// Number of the light of the table that a light of the pass belongs to.
    std::uint32_t NumberOf(const Light &light) const { return numberOf_[std::size_t(&light - lights_.data())]; }
    /// Style of a light of the table.
    int Style(std::uint32_t number) const { return table_.lights[number].style; }
    /// Its color over the brightest channel of that.
    Vec3f Tint(std::uint32_t number) const {
        const Vec3f color(table_.lights[number].color);
        const float brightest = MaxAbsComponent(color);
        return brightest > 0 ? color / brightest : color;
    }
    /// What messages call it.
    std::string Label(std::uint32_t number) const;
    /// Whether some of it may be seen from a cluster, by visibility data.
    bool MaySee(std::uint32_t number, int cluster) const;
    /// What it gives at a position without shadows: coefficients convolved with the cosine, as shgrid_sample adds them.
    /// 1 = byte 255.
    SHFloats At(std::uint32_t number, const Vec3f &position) const;
    /// About the irradiance vector of At, of its brightest channel, in a fraction of the time.
    Vec3f RoughVector(std::uint32_t number, const Vec3f &position) const;

  private:
    void Join();
    void AddRecord(std::vector<std::size_t> members, float scale);

    const std::vector<Light> &lights_;
    std::vector<std::uint32_t> numberOf_;           ///< by light of the pass
    std::vector<std::vector<std::size_t>> members_; ///< by light of the table: lights of the pass
    GridLights table_;
    shgrid_grid reader_{}; ///< of the table alone
};

} // namespace q3
