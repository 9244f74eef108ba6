// GPL-2.0-or-later. The lights that a grid can name: those of a pass, with the pieces of each lamp joined.
#pragma once

#include "libs/shgrid/shgrid.h"
#include "q3map2/bspfile/bspfile_named.h"
#include "q3map2/light/grid/probe_integrator.h"
#include "q3map2/light/sources/light_sources.h"

#include <cstdint>
#include <string>
#include <vector>

namespace q3 {

/// The lights of a pass in the form in which a grid names them. The triangles and quads of a lamp become one light with
/// several polygons, and the samples of a sun become one sun with a spread. Const after construction; keeps a
/// reference to the lights.
class LightTable {
  public:
    /// scale: factor of all light that the grid stores (-gridscale).
    LightTable(const std::vector<Light> &lights, float scale);
    LightTable(const LightTable &) = delete; // reader_ points into table_
    LightTable &operator=(const LightTable &) = delete;

    std::size_t Size() const { return table_.lights.size(); }
    /// The records of all lights. A grid keeps only those that its points name.
    const GridLights &Stored() const { return table_; }
    /// The number in the table of the light to which a light of the pass belongs.
    std::uint32_t NumberOf(const Light &light) const { return numberOf_[std::size_t(&light - lights_.data())]; }
    /// The style of a light.
    int Style(std::uint32_t number) const { return table_.lights[number].style; }
    /// The color of a light divided by its largest absolute component.
    Vec3f Tint(std::uint32_t number) const {
        const Vec3f color(table_.lights[number].color);
        const float brightest = MaxAbsComponent(color);
        return brightest > 0 ? color / brightest : color;
    }
    /// The name of a light in messages.
    std::string Label(std::uint32_t number) const;
    /// Whether a cluster may see any part of a light, according to the PVS.
    bool MaySee(std::uint32_t number, int cluster) const;
    /// Unshadowed light from a light at a position: coefficients convolved with the cosine, as shgrid_sample adds them.
    /// 1 = byte 255.
    SHFloats At(std::uint32_t number, const Vec3f &position) const;
    /// The approximate irradiance vector of that light, for a color of MaxAbsComponent(color): Tint has the factors of
    /// the channels. Much faster than At. 1 = byte 255.
    Vec3f RoughVector(std::uint32_t number, const Vec3f &position) const;
    /// Whether a position is in the plane of a polygon of a light and less than its radius from its center. There light
    /// differs from that a hair in front of the plane, or behind it.
    bool HasInPlane(std::uint32_t number, const Vec3f &position) const;

  private:
    void GroupLights();
    void AddRecord(std::vector<std::size_t> members, float scale);

    const std::vector<Light> &lights_;
    std::vector<std::uint32_t> numberOf_;           ///< by light of the pass: its number in the table
    std::vector<std::vector<std::size_t>> members_; ///< by light of the table: its lights of the pass
    GridLights table_;
    shgrid_grid reader_{}; ///< a grid without nodes, through which shgrid.h evaluates lights of the table
};

} // namespace q3
