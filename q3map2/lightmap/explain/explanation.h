// GPL-2.0-or-later. Why a point of a map is lit as it is, as a value.
#pragma once

#include "q3map2/light/grid/gridsh_fill.h"
#include "q3map2/light/sources/light_sources.h"

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace q3 {

/// An entity or a brush of the map source.
struct SourcePlace {
    int entity = -1, primitive = -1; ///< numbers in the map source; -1: unknown, or the entity as a whole
    std::string className, targetName;
    std::string location; ///< FILE:LINE; empty: the map source is not there
};

enum class ObstacleKind {
    Brush,      ///< a solid brush
    Surface,    ///< a surface that no brush is behind: a curve, a model
    Prop,       ///< a static prop
    SeeThrough, ///< a surface that takes all light at that texel
    Outside,    ///< solid space that no brush fills: the outside of the map
    NoSky       ///< the ray to a sun or sky ends at no sky of its kind
};

/// Something solid at a point, or in the way of light.
struct Obstacle {
    ObstacleKind kind = ObstacleKind::Outside;
    int number = -1;    ///< of the brush or draw surface in the .bsp
    std::string shader; ///< of the side or the surface
    SourcePlace source;
    Vec3f at;           ///< where a ray meets it
    float length = 0;   ///< of the ray up to there. Game units
    float fraction = 0; ///< of the rays that do not arrive. 0 to 1
};

/// What becomes of the light of a source at a receiver.
enum class LightFate {
    Arrives,        ///< at least a part does
    Blocked,        ///< all of it is in shadow
    InSolid,        ///< the source is in a solid
    NotForGrids,    ///< by its spawnflags it lights no grid
    NotForSurfaces, ///< by its spawnflags it lights surfaces not at all
    Styled,         ///< of another style than 0, which the SH grid cannot hold
    NotSun,         ///< -sunonly
    HiddenByVis,    ///< the visibility data says that no point of the cluster sees it
    OutOfReach,     ///< beyond its envelope
    OutsideCone,    ///< of a spotlight
    BehindEmitter,  ///< of a one-sided area light
    FacesAway,      ///< the surface faces away from it
    TooFaint        ///< it gives nothing, or less than its tolerance
};

/// What a source gives a receiver. Parts of one surface, samples of one sun and lights of one entity count as one.
struct LightAccount {
    LightType type = LightType::Point;
    LightFate fate = LightFate::TooFaint;
    std::string shader; ///< of area lights, suns and skies
    int surface = -1;   ///< draw surface that it is from
    SourcePlace source; ///< of the entity
    int style = 0, parts = 1;
    bool negative = false; ///< subtracts
    Vec3f origin;          ///< of the strongest part; a sun: direction to it
    float distance = 0;    ///< to the strongest part; a sun: 0. Game units
    Vec3f unshadowed;      ///< light on a receiver that faces it, without shadows; on luxels: on theirs. Byte scale
    Vec3f arriving;        ///< the same with shadows
    std::vector<Obstacle> obstacles; ///< what is in the way, the most frequent first
    std::optional<Obstacle> inside;  ///< for InSolid: what it is in
    float Visible() const {
        const float whole = Luminance(unshadowed);
        return whole > 0 ? Luminance(arriving) / whole : 0;
    }
};

/// Where the point is in the tree.
struct PlaceAccount {
    Vec3f point;
    int leaf = -1, cluster = kSolidCluster, area = -1;
    std::optional<Obstacle> solid; ///< what it is in
    std::optional<Vec3f> litFrom;  ///< where the lights below are asked for; none: nowhere near is open space
};

/// A lit point whose light a filled point took.
struct SourceAccount {
    Int3 point{};       ///< coordinates in the grid
    Vec3f litFrom;      ///< its position, or the place in the open that it was moved to
    int group = 0;      ///< visibility group of the filled point that it is in, from 0
    float fraction = 0; ///< of the filled value. 0 to 1
    float light = 0;    ///< as GridPointAccount::traced
};

/// A corner of a cell of the SH grid. Light: mean over all directions of the brightest channel, byte scale.
struct GridPointAccount {
    Int3 point{};            ///< coordinates in the grid
    std::uint32_t index = 0; ///< in the lump
    Vec3f position;
    float weight = 0; ///< in the blend at the point that is explained
    PointState placed = PointState::Exterior, state = PointState::Exterior; ///< before and after filling
    std::optional<Vec3f> litFrom;                                           ///< none: it is filled or black
    int groups = 1;                                                         ///< visibility groups around it
    std::vector<SourceAccount> sources;       ///< of its value, the largest fraction first
    std::optional<Obstacle> solid;            ///< what it is in
    float traced = 0, filled = 0, fitted = 0; ///< after each of these steps of this run
    std::optional<float> stored;              ///< in the lump
};

/// A corner of a cell of the legacy grid.
struct LegacyPointAccount {
    Int3 point{}; ///< coordinates in the grid
    Vec3f position;
    float weight = 0;                     ///< in the blend at the point that is explained
    std::optional<Vec3f> litFrom;         ///< none: it is in a solid
    bspGridPoint_t now{};                 ///< direct light of this run
    std::optional<bspGridPoint_t> stored; ///< in the lump
};

enum class SampleKind {
    Center, ///< of a luxel of the super grid
    Sample  ///< of -samples, beside it
};

/// A position at which a luxel is lit.
struct SampleAccount {
    SampleKind kind = SampleKind::Center;
    Vec3f wanted;                  ///< on the surface, or where the sample was meant to be
    std::optional<Vec3f> position; ///< where it is lit; none: it is not
    std::optional<Obstacle> solid; ///< what it is in, if it is not lit
    Vec3f light;                   ///< arriving there, byte scale
};

/// The luxel nearest to the point.
struct LuxelAccount {
    int surface = -1; ///< draw surface
    std::string shader;
    SourcePlace source;
    Vec3f center, normal; ///< on the surface
    float distance = 0;   ///< from the point to the surface. Game units
    int page = -1;        ///< number of the page; below 0: none
    std::array<int, 2> texel{};
    std::vector<SampleAccount> samples;
    float dirt = 1;
    Vec3f ambient;
    std::optional<Vec3f> direct; ///< of this run with dirt, before tone mapping. Byte scale; none: not used
    bool fromNeighbors = false;  ///< none of its positions is open: it takes the mean of its neighbors
    bool isInWall = false;       ///< its center is in a wall: it takes the least light of the sides (FillWallLuxels)
    std::optional<std::array<std::uint8_t, 3>> stored; ///< in the page
    std::vector<LightAccount> lights;
};

/// All that is known of a point.
struct Explanation {
    PlaceAccount place;
    std::vector<LightAccount> lights; ///< at place.litFrom, strongest first
    std::vector<GridPointAccount> grid;
    std::vector<LegacyPointAccount> legacy;
    std::optional<LuxelAccount> luxel;
    bool bounces = false; ///< the options ask for bounced light, which no number but the stored ones has
};

} // namespace q3
