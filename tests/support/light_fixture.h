// GPL-2.0-or-later. Lighting of small scenes in process, and the definition of the SH grid to compare with.
#pragma once

#include "q3map2/lightmap/light_stage.h"
#include "tests/support/game_folder.h"
#include "tests/support/scene/scene_builder.h"

#include <array>
#include <functional>
#include <numbers>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

namespace q3::test {

/// Nine SH coefficients of red, green and blue.
using Coefficients = std::array<Vec3d, 9>;

/// Basis functions at a unit direction, by the formulas of the SH grid's format.
std::array<double, 9> BasisAt(const Vec3d &d);
/// What the convolution with the clamped cosine multiplies coefficient k by.
double Lobe(std::size_t k);
Coefficients operator+(const Coefficients &a, const Coefficients &b);
Coefficients operator*(const Coefficients &a, const Vec3d &s);
/// Light of one direction (unit, to the light), convolved with the clamped cosine. 1 = byte 255.
Coefficients FromDirection(const Vec3d &d, const Vec3d &color);
/// Uniform light that gives every normal `color`.
Coefficients FromEverywhere(const Vec3d &color);
/// A point light of that intensity, the key "light", at p: inverse square, from 16 units on.
Coefficients FromPoint(const Vec3d &p, const Vec3d &light, double intensity, const Vec3d &color = {1, 1, 1});
/// A rectangle corner + [0, 1] u + [0, 1] v that shines to the side of `normal`: by Gauss quadrature. `add` is the
/// light of a hemisphere full of it, byte scale.
Coefficients FromRectangle(const Vec3d &p, const Vec3d &corner, const Vec3d &u, const Vec3d &v, const Vec3d &normal,
                           double add, const Vec3d &color);
/// Light on a matte surface with that normal.
Vec3d Evaluate(const Coefficients &c, const Vec3d &normal);
/// Largest difference of two coefficients in a channel.
double Difference(const Coefficients &a, const Coefficients &b);
/// Largest absolute value of a coefficient in a channel.
double Largest(const Coefficients &c);
bool AllFinite(const Coefficients &c);

/// Whether the segment from a to b passes through the box grown by `margin` on all sides.
bool SegmentMeets(const Vec3d &a, const Vec3d &b, const Boundsf &box, double margin);

/// The SH grid of a lit map.
class GridView {
  public:
    explicit GridView(const Bsp &bsp);
    std::size_t Count() const { return grid_.points.size(); }
    Vec3d Position(std::size_t index) const;
    Coefficients At(std::size_t index) const;
    /// Trilinear blend at a place inside the grid.
    Coefficients Sample(const Vec3d &p) const;
    const LightGridSH &Grid() const { return grid_; }

  private:
    LightGridSH grid_;
};

/// A shader library over a folder of the test's own and the shaders of tests/data/vectors.
class LightTest : public testing::Test {
  protected:
    static constexpr double kExact = 1e-5; ///< relative: float arithmetic

    /// Adds a shader script. Before the first Lit.
    void Script(std::string_view text);
    /// Lights the map with these options. An SH grid is always made.
    Bsp Lit(Bsp bsp, std::string_view options = "", int threads = 1);
    /// The scene goes through the bsp stage first, if its parts allow.
    Bsp Lit(const SceneBuilder &scene, std::string_view options = "", int threads = 1);
    GridView LitGrid(const SceneBuilder &scene, std::string_view options = "") { return GridView(Lit(scene, options)); }
    /// Checks every point of the grid for which `expected` fills in coefficients (true) against them: relative to the
    /// point's largest coefficient, or to 1/255 when that is larger. At least `atLeast` points must have been checked.
    void ExpectPoints(const GridView &grid, double tolerance, int atLeast,
                      const std::function<bool(const Vec3d &, Coefficients &)> &expected);
    /// Whether the last Lit printed that.
    bool Printed(std::string_view text) const { return printed.find(text) != std::string::npos; }

    std::string printed;
    bool surfaces = false; ///< light lightmaps and vertices too
    TexLights texLights;
    LightResult result;
    GameFolder folder;

  private:
    std::string script_;
};

/// A room with walls of shader textures/test/wall.
SceneBuilder Room(const Vec3f &mins = {-250, -186, 4}, const Vec3f &maxs = {250, 186, 252});
SceneShader TestShader(std::string_view name);
/// An entity of these keys and values, in pairs.
Entity MakeEntity(std::string_view className, std::initializer_list<std::pair<std::string, std::string>> keys);
/// True when p is more than `margin` inside the box.
bool Inside(const Vec3d &p, const Boundsf &box, double margin = 1);
inline Boundsf RoomBounds() {
    return {{-250, -186, 4}, {250, 186, 252}};
}
/// Twenty-six directions: of the faces, edges and corners of a cube.
std::vector<Vec3d> Normals();

} // namespace q3::test
