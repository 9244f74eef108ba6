// GPL-2.0-or-later. HDR images as ordinary pictures.
#pragma once

#include "common/image/float_image.h"
#include "common/image/image.h"
#include "common/settings.h"

#include <string>
#include <vector>

namespace q3 {

/// Values of the options of -tonemap.
struct ToneMapOptions {
    double exposure = 0;                 ///< stops
    std::string toneOperator = "filmic"; ///< or clamp
    int page = 0;                        ///< of a .bsp
};

/// The options of the -tonemap stage, declared.
std::vector<SettingGroup<ToneMapOptions>> ToneMapSettings();
/// Takes the options of -tonemap off `arguments`.
ToneMapOptions ParseToneMapOptions(Arguments &arguments, Log &log);

/// Colors times 2^exposure, scaled so that their largest channel m becomes min(m, 1) (clamp) or that of a filmic curve,
/// which keeps hue and saturation; then sRGB bytes, rounded. Negative channels and NaN are black.
Image ToneMapped(const FloatImage &image, const ToneMapOptions &options);

} // namespace q3
