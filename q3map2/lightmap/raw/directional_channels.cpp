// GPL-2.0-or-later. Directional channels of luxels: L1 SH, and light on the RNM basis normals.
#include "q3map2/lightmap/raw/directional_channels.h"

#include "libs/math/rnm_basis.h"

#include <algorithm>
#include <cmath>

namespace q3 {

BasisNormals BasisNormalsOf(const Vec3f &normal, const LuxelTangent &tangent) {
    constexpr float kLeastLength = 1e-4f;
    Vec3f across = Cross(normal, tangent.s);
    if (Length(across) < kLeastLength)
        across = Cross(normal, std::abs(normal.z) > 0.7f ? Vec3f{1, 0, 0} : Vec3f{0, 0, 1});
    across = Normalize(across);
    const Vec3f s = Cross(across, normal), t = across * tangent.side;
    BasisNormals normals;
    for (std::size_t i = 0; i < normals.size(); ++i)
        normals[i] = s * kRnmBasis[i].x + t * kRnmBasis[i].y + normal * kRnmBasis[i].z;
    return normals;
}

ChannelWeights WeightsOf(const Vec3f &w, const DirectionalChannels &channels, const BasisNormals *basis) {
    ChannelWeights weights{};
    if (channels.sh)
        weights = {kDirectedSh0, kDirectedSh1 * w.y, kDirectedSh1 * w.z, kDirectedSh1 * w.x};
    for (std::size_t i = 0; basis && i < DirectionalChannels::kBasis; ++i)
        weights[channels.FirstBasis() + i] = std::max(0.0f, Dot((*basis)[i], w));
    return weights;
}

ChannelWeights UniformWeights(const DirectionalChannels &channels) {
    ChannelWeights weights{};
    if (channels.sh)
        weights[0] = kUniformSh0;
    for (std::size_t i = 0; channels.basis && i < DirectionalChannels::kBasis; ++i)
        weights[channels.FirstBasis() + i] = 1;
    return weights;
}

} // namespace q3
