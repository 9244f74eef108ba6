// GPL-2.0-or-later. Light at the vertices of static props, as a lump and as files beside the map.
#pragma once

#include "common/files/files.h"
#include "q3map2/bspfile/prop_light.h"
#include "q3map2/light/grid/grid_bricks.h"
#include "q3map2/light/props/static_props.h"
#include "q3map2/lightmap/raw/lightmaps.h"

#include <cstddef>
#include <filesystem>
#include <functional>
#include <vector>

namespace q3 {

/// Bounced light of style 0 for props. Both members are safe from several threads, or empty.
struct PropBounce {
    /// On a vertex, byte scale.
    std::function<Vec3f(const Vec3f &position, const Vec3f &normal, bool twoSided)> irradiance;
    const IndirectLight *indirect = nullptr; ///< for props that ignore normals
};

/// Light at the vertices of one prop.
struct PropVertexLight {
    std::size_t prop = 0;       ///< in StaticProps::props
    std::uint32_t modelCrc = 0; ///< Crc32 of the model file
    /// [mesh][vertex], unit scale; a mesh that the skin leaves out is empty. With the tone of vertices as VertexLightOf
    /// has it: the factors of shader and options, at least the world's minvertexlight, nothing else.
    std::vector<std::vector<Vec3f>> meshes;
};

/// Lights the props that have vertexLight: the direct light of `lights`, prepared by SetupEnvelopes for surfaces, of
/// style 0; ambient light, dirt and floodlight as at vertices of surfaces; bounced light.
std::vector<PropVertexLight> LightProps(const SurfaceInputs &in, const StaticProps &props, std::vector<Light> lights,
                                        const PropBounce &bounce, ContributionCounts &counts);

/// The lump of that light; nothing without props.
std::optional<PropLight> PackPropLight(const StaticProps &props, const std::vector<PropVertexLight> &light);

/// The light of a prop as a file of Source: head, meshes, then from the next multiple of 512 on four bytes a vertex,
/// blue, green, red and 255. A byte is 127.5 * light^(1 / 2.2), at most 255.
std::vector<std::byte> EncodeVhv(const PropVertexLight &light);

/// Writes FOLDER/sp_N.vhv for prop N of the lump, from 0, and FOLDER/proplight.raw: three little-endian floats for each
/// color of the lump, unit scale. Errors: Error for files that cannot be written.
void AddPropFiles(const std::filesystem::path &folder, const std::vector<PropVertexLight> &light, FileSet &written,
                  Log &log);

} // namespace q3
