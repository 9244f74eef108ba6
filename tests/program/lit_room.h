// GPL-2.0-or-later. A small room that the program compiles and lights.
#pragma once

#include "common/image/float_image.h"
#include "q3map2/bspfile/bspfile.h"
#include "tests/support/run_program.h"

#include <nlohmann/json.hpp>

#include <array>
#include <initializer_list>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace q3::test {

/// Side and area of the game's pages.
inline constexpr int kPageSide = 128;
inline constexpr std::size_t kPageTexels = kPageSide * kPageSide;
inline constexpr Vec3f kUpward{0, 0, 1};

using Keys = std::initializer_list<std::pair<std::string, std::string>>;

/// An entity of a .map file.
std::string EntityText(const Keys &keys);
/// A brush with one texture on all sides.
std::string BoxText(const Vec3f &mins, const Vec3f &maxs, std::string_view texture);
/// A pillar whose section is a square standing on its corner.
std::string DiamondText(const Vec3f &base, float radius, float height, std::string_view texture);

/// How a flat face lies on its lightmap page.
struct LitFace {
    int surface = -1, page = -1; ///< page: lightmapNum
    Vec3f normal, corner;
    Vec3f s, t;                                     ///< texels per unit
    std::array<float, 2> origin{};                  ///< texels, of `corner`
    std::array<float, 2> At(const Vec3f &p) const { ///< texels
        return {origin[0] + Dot(s, p - corner), origin[1] + Dot(t, p - corner)};
    }
    /// Index in a page of that many columns, of the texel whose center is at p. -1: no center is there.
    int TexelAt(const Vec3f &p, int side = 128) const;
};

/// The room is -256 to 256 by -256 to 256 by 0 to 256; luxels of the floor are 16 apart, with centers at multiples of
/// 16. Its floor, walls and ceiling have shaders of these names in textures/test, as have "pillar" and "sky".
class LitRoomTest : public testing::Test {
  protected:
    LitRoomTest();
    /// Compiles the room with these entities beside a player start. worldKeys: of worldspawn; brushes: more of them.
    void Compile(const std::string &entities, const Keys &worldKeys = {}, const std::string &brushes = {},
                 std::string_view ceiling = "test/ceiling");
    /// -light with these options, split at blanks, without grids. Expects success.
    Outcome Light(std::string_view options);
    Outcome Run(std::string_view options);
    /// q3map2 with these words, split at blanks, and the map.
    Outcome RunWords(std::string_view words);

    Bsp Load() const;
    std::vector<std::byte> MapBytes() const;
    std::filesystem::path Beside(std::string_view name) const { return maps_ / "room" / name; }
    /// The files beside the map and their sizes.
    std::map<std::string, std::size_t> Files() const;
    /// lm_NNNN.pfm of a page
    FloatImage Pfm(int page, std::string_view suffix = "") const;
    nlohmann::json Lightmass() const;
    /// Texels of an image of lightmass.json, as many channels as it has.
    std::vector<std::uint8_t> MassImage(int page, std::string_view what, int channels) const;

    /// The only surface with this shader that faces along `normal`.
    LitFace FaceOf(const Bsp &bsp, std::string_view shader, const Vec3f &normal) const;
    /// Centers of luxels of the floor, 16 units from walls.
    static std::vector<Vec3f> FloorPoints();

    GameFolder folder_;
    std::filesystem::path maps_;
};

/// A lamp; light 1 is 7500 at distance 1, byte scale.
std::string Lamp(const Vec3f &at, float light, const Vec3f &color = {1, 1, 1}, const Keys &more = {});

} // namespace q3::test
