// GPL-2.0-or-later. Self-shadowed bump maps: responses of a height field to the basis of radiosity normal mapping.
#pragma once

#include "common/jobs.h"
#include "libs/math/rnm_basis.h"
#include "q3map2/ssbump/height_field.h"

#include <cstdint>
#include <functional>
#include <vector>

namespace q3 {

/// For each texel with unit normal n the three channels max(0, b_i.n) V_i, 0 to 1; b_i: kRnmBasis. V_i is the share of
/// the light that no height blocks: an integral of max(0, b_i.w) max(0, n.w) over the visible directions w above the
/// plane of the texture, divided by the integral over all of them. Exactly 1 where nothing blocks.
///
/// Visibility comes from the horizon: along each of `rays` azimuths, the steepest slope from the texel to where the
/// ray crosses lines between neighboring texel centers; the integral over elevations is in closed form. `done`: as in
/// JobPool::For, rows finished. Results do not depend on the number of threads.
std::vector<Vec3f> SelfShadowedBump(const HeightField &field, int rays, const JobPool &jobs,
                                    const std::function<void(std::int64_t)> &done = {});

} // namespace q3
