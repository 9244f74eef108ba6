// GPL-2.0-or-later. Radiosity: bounced light on surfaces.
#pragma once

#include "q3map2/lightmap/bounce/bounce_gather.h"
#include "q3map2/lightmap/bounce/radiosity_solver.h"
#include "q3map2/lightmap/raw/lightmaps.h"

#include <algorithm>
#include <map>

namespace q3 {

/// How much bounced light of a style a surface receives.
struct StyleEnergy {
    double sum = 0; ///< sum of luminance over receivers, byte scale
    float most = 0; ///< largest channel at any receiver, byte scale
};
StyleEnergy EnergyOf(std::span<const Vec3f> light);

/// Bounced light of one style on a surface. Light: a container with the light of all its receivers.
template <typename Light> struct BouncedStyle {
    std::uint8_t style;
    StyleEnergy energy;
    Light light;
    std::size_t slot = kStyles; ///< set by ClaimSlots; kStyles: none
};

/// The slot that holds the style already, else a free one, else kStyles: ClaimSlots for one style.
std::size_t ClaimSlot(std::uint8_t style, const StyleEnergy &energy, Styles &styles, std::vector<std::string> &dropped);

/// Assigns slots of a surface to styles. Styles of its direct light keep their slots; free slots go to styles with at
/// least 1/16 byte of light at some receiver, in descending order of light. Appends to `dropped` the names of styles
/// for which no slot is left.
template <typename Light>
void ClaimSlots(std::vector<BouncedStyle<Light>> &found, Styles &styles, std::vector<std::string> &dropped) {
    std::stable_sort(found.begin(), found.end(),
                     [](const auto &a, const auto &b) { return a.energy.sum > b.energy.sum; });
    for (BouncedStyle<Light> &one : found)
        one.slot = ClaimSlot(one.style, one.energy, styles, dropped);
}

/// Bounced light in two stages. The solver finds the radiosity of all emitters, style by style: in bounce k,
/// B_k = rho E_k, and E_(k+1) is the irradiance due to B_k. A final gathering of the sum over bounces then lights
/// luxels, vertices and grid points, so they agree; shadow rays sample the brightest emitters (BrightEmitters).
/// rho of a white texture is 187.5 * 3 / 255 * 0.25 = 0.55 at -bouncescale 1, as in NetRadiant's q3map2, or 1 with
/// -reflectivity linear; at most 0.99.
class Bounces {
  public:
    /// Call after the direct pass. Keeps references.
    Bounces(const SurfaceInputs &in, const SurfaceLight &surfaces);

    /// Solves for the radiosity due to the light of the direct pass. Call once. False: no surface reflects light.
    bool Solve(const SurfaceLight &surfaces);
    /// Gathers the light of all bounces at luxels and adds it to their raw lightmaps.
    void AddToLuxels(SurfaceLight &surfaces) const;
    /// The same for vertices of surfaces without lightmaps; adds to VertexLight::sum.
    void AddToVertices(SurfaceLight &surfaces) const;
    /// Bounced light of style 0 at a receiver that is no luxel or vertex of the map, such as a vertex of a prop. Call
    /// after Solve. Safe from several threads. twoSided: the receiver is lit from both sides.
    Vec3f IrradianceAt(const Vec3f &position, const Vec3f &normal, bool twoSided) const;
    /// Bounced light of style 0 at points in the open; null if there is none. Call after Solve. The result keeps
    /// references to this object.
    std::unique_ptr<IndirectLight> ForPoints() const;
    /// The same for each other style that has some.
    std::vector<StyledIndirect> StyledForPoints() const;

    /// Number of gather rays of all luxels.
    std::uint64_t Rays() const { return gather_.Rays(); }

  private:
    /// Radiosity of a style, summed over bounces.
    struct StyleRadiosity {
        Emission rest; ///< the part that is gathered; shadow rays sample the other part, `bright`
        std::unique_ptr<const BrightEmitters> bright;
    };
    static std::vector<std::uint8_t> UsedStyles(const SurfaceLight &surfaces);
    std::unique_ptr<const FaintPatches> MakePatches(const SurfaceLight &surfaces) const;
    Emission FirstBounce(const SurfaceLight &surfaces, std::uint8_t style) const;
    Emission AllBounces(const RadiositySolver &solver, Emission first) const;
    std::vector<BouncedStyle<BounceEstimate>> LightOnLuxels(std::size_t lightmap, const RawLightmap &raw) const;
    std::vector<Vec3f> LightOnVertices(const SurfaceLight &surfaces, const StyleRadiosity &radiosity,
                                       std::size_t surface) const;
    Vec3f IrradianceOf(const StyleRadiosity &radiosity, const Vec3f &position, const Vec3f &normal, bool twoSided,
                       std::uint64_t seed) const;
    std::unique_ptr<IndirectLight> PointsLitBy(const StyleRadiosity &radiosity) const;

    const SurfaceInputs &in_;
    EmitterIndex emitters_;
    BounceScene scene_;
    std::unique_ptr<const FaintPatches> patches_; // under -fast; else null
    BounceGather gather_;
    std::map<std::uint8_t, StyleRadiosity> byStyle_;
};

} // namespace q3
