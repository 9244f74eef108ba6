// GPL-2.0-or-later. Texture projections of brush sides, fitted to the draw surfaces that were made from them.
#pragma once

#include "libs/math/winding.h"
#include "q3map2/bspfile/bsp.h"
#include "q3map2/map/map.h"

#include <array>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

namespace q3 {

class ShaderLibrary;

/// Undoes the shader's transform of texture coordinates; a singular one is left in.
std::array<double, 2> WithoutTexMod(const std::array<float, 2> &st, const GeometryDirectives &shader);

/// The triangles of a model's planar and triangle surfaces, by shader.
class TextureSamples {
  public:
    /// `bsp` must be valid. Points within `epsilon` game units of a triangle's edge count as on it.
    TextureSamples(const Bsp &bsp, std::size_t model, ShaderLibrary &shaders, double epsilon);

    /// The projection of the side with this plane and winding, in the model's coordinates. Nothing if no triangle with
    /// the shader covers any of it.
    std::optional<TextureProjection> Find(std::string_view shader, const GeometryDirectives &directives,
                                          const Plane &plane, const Winding<double> &winding) const;

  private:
    struct Triangle {
        std::array<Vec3d, 3> xyz;
        std::array<std::array<double, 2>, 3> st;
        Vec3d normal; ///< unit
        double area;  ///< square game units
        Boundsd box;
    };
    /// A triangle that covers a part of a side.
    struct Cover {
        const Triangle *triangle;
        double area;   ///< of that part
        bool isInside; ///< the side covers nearly all of the triangle: made from this side
    };
    void Add(const Bsp &bsp, const bspDrawSurface_t &surface, const GeometryDirectives &directives);
    std::vector<Cover> Covering(std::span<const Triangle> triangles, const Plane &plane, const Winding<double> &winding,
                                double farthest) const;

    double epsilon_;
    std::unordered_map<std::string, std::vector<Triangle>> triangles_; ///< by name in lower case
};

} // namespace q3
