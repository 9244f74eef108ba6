// GPL-2.0-or-later. Texture projections of brush sides: fitted to draw surfaces, and written in the three forms of map
// text.
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

// ---- Texture projections of brush sides, fitted to the draw surfaces that were made from them ----

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

/// How brush sides in map text give their texture projection.
enum class MapForm {
    Classic,   ///< shift, rotation and scale along world axes; cannot shear
    Primitive, ///< brush primitives: a matrix along two axes in the side's plane
    Valve      ///< Valve 220: two free axes, with shift and scale
};

/// What TextureInForm needs of a side.
struct TextureRequest {
    TextureProjection projection;
    Plane plane;  ///< through the points that are written
    Vec3d normal; ///< of the plane in the plane table, by which readers choose texture axes
    const GeometryDirectives &shader;
    std::span<const Vec3d> corners; ///< where coordinates must agree; empty: numbers get all digits
    double tolerance = 1e-6;        ///< largest difference at a corner, texels
};

/// The numbers of a side's texture as text, in the order of the form.
struct TextureWords {
    std::vector<std::string> words;
    double error = 0; ///< largest difference at a corner, texels
};

/// The numbers, with as few digits as the tolerance allows. A projection with constant s or t, which the classic and
/// the Valve form cannot hold, gets default axes and an infinite error.
TextureWords TextureInForm(MapForm form, const TextureRequest &request);
/// For a side whose texture is unknown: `scale` game units a texel, which brush primitives have for images of 64 texels
/// only.
std::vector<std::string> DefaultTexture(MapForm form, const Vec3d &normal, double scale);

/// The number rounded to `decimals`, without an exponent or trailing zeros.
std::string FixedText(double value, int decimals);
/// The shortest text that reads as the same number, without an exponent.
std::string ExactText(double value);
std::string ExactText(float value);

} // namespace q3
