// GPL-2.0-or-later. Compiled maps made of axis-aligned boxes, for tests and the demo.
//
// Scenes of brushes alone have a map source (MapText), which the tests of lighting compile. Build is for scenes that no
// map source can produce: given visibility, surfaces without brushes, patches or soups with exact points, one cluster
// for many leafs.
#pragma once

#include "libs/math/vec.h"
#include "q3map2/bspfile/bspfile.h"
#include "q3map2/bspfile/entities.h"

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace q3 {

/// One entry of the shader lump; two uses with the same three values share an entry.
struct SceneShader {
    std::string name; ///< at most 63 bytes
    std::uint32_t surfaceFlags = 0, contentFlags = 1;
    bool operator==(const SceneShader &) const = default;
};

/// Sides of a box, in the order of a brush's first six sides.
enum class BoxFace { MinusX, PlusX, MinusY, PlusY, MinusZ, PlusZ };

enum class BoxKind {
    Structural, ///< splits the tree, fills leafs with solid
    Detail      ///< a brush and faces in otherwise open leafs
};

/// How open leafs become clusters, and what is in the visibility lump.
struct SceneVisibility {
    bool clusterPerLeaf = true; ///< false: one cluster for all open leafs
    bool writeLump = false;
    /// Whether the first cluster (by its bounds) sees the second; unset: everything does. A cluster always sees itself.
    std::function<bool(const Boundsf &, const Boundsf &)> sees{};
};

/// Collects boxes, surfaces and entities; Build makes the map. Units: game units. Bounds are (mins, maxs). Errors:
/// Error that names the part, for numbers that are not finite, an empty box, a bad index or patch size, a long shader
/// name.
class SceneBuilder {
  public:
    static constexpr float kWallThickness = 16;

    /// The room: six structural walls are added around it, and only this space can be open. Required.
    void SetInterior(const Vec3f &mins, const Vec3f &maxs, const SceneShader &walls);
    /// Sets the shader of the inner face of one wall; `wall` is its side of the room.
    void SetWallShader(BoxFace wall, const SceneShader &shader);
    /// Adds a box and returns its number for SetFaceShader. Boxes may overlap and touch.
    int AddBox(const Vec3f &mins, const Vec3f &maxs, const SceneShader &shader, BoxKind kind = BoxKind::Structural);
    void SetFaceShader(int box, BoxFace face, const SceneShader &shader);

    /// Control points row by row; the front is along (next column) x (next row). Width and height odd, 3..31.
    void AddPatch(int width, int height, std::span<const Vec3f> points, const SceneShader &shader);
    /// A flat surface without a brush; corners clockwise seen from the front.
    void AddQuad(const std::array<Vec3f, 4> &corners, const SceneShader &shader);
    /// A triangle soup without a brush; triangles clockwise seen from the front, vertex normals averaged by area.
    void AddTriangles(std::span<const Vec3f> points, std::span<const std::int32_t> indexes, const SceneShader &shader);

    void SetWorldKey(std::string_view key, std::string_view value) { world_.Set(key, value); }
    void AddEntity(const Entity &entity) { entities_.push_back(entity); }
    /// A brush entity: the box is a model of its own and `entity` gets the key model.
    void AddInlineModel(const Vec3f &mins, const Vec3f &maxs, const SceneShader &shader, const Entity &entity);

    void SetVisibility(const SceneVisibility &visibility) { visibility_ = visibility; }

    /// A map that passes ValidateBsp. Errors: no SetInterior, no open space left.
    Bsp Build() const;

    /// Whether MapText can express the scene: boxes at multiples of 1/8 with shaders of the folder textures whose flags
    /// are plain, no loose surfaces, no visibility, no entity outside.
    bool HasMapText() const;
    /// The scene as a map source, with an info_null in each separate open space. Error: not HasMapText.
    std::string MapText() const;

    /// Parts as Build sees them.
    struct Box {
        Boundsf bounds;
        SceneShader shader; ///< of the brush
        std::array<SceneShader, 6> faces;
        BoxKind kind = BoxKind::Structural;
    };
    struct Surface {
        SceneShader shader;
        BspSurfaceType type = MST_PLANAR;
        std::vector<bspDrawVert_t> verts;
        std::vector<std::int32_t> indexes;
        int patchWidth = 0, patchHeight = 0;
    };

  private:
    Boundsf interior_;
    std::vector<Box> walls_, boxes_, models_;
    std::vector<Surface> surfaces_;
    Entity world_{{{"classname", "worldspawn"}}};
    std::vector<Entity> entities_;
    SceneVisibility visibility_;
};

} // namespace q3
