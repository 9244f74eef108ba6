// GPL-2.0-or-later. A map from above with the errors of a grid on it.
#pragma once

#include "tools/measure/shbench/causes.h"

#include <filesystem>
#include <string>
#include <vector>

namespace q3::bench {

/// What a cell of the view shows.
enum class TopViewGround : std::uint8_t {
    Solid,     ///< or outside, at all heights
    Elsewhere, ///< open only at another height in the range of the positions
    Open,      ///< open at the view's height
    Step       ///< edge of something under open space
};

/// A position, error in bytes.
struct TopViewDot {
    Vec3f position;
    double error = 0;
};

/// Everything that the picture shows.
struct ErrorTopView {
    std::string title, subtitle, errorName; ///< errorName: heading of the color scale
    std::vector<TopViewDot> dots;
    struct Ring {
        std::size_t dot = 0;
        Cause cause{};
    };
    std::vector<Ring> rings; ///< numbered from 1, in this order
    std::vector<Vec3f> lights;
    std::size_t suns = 0; ///< lights without a place
    std::array<CauseShare, kCauses> shares{};
    Boundsf area;              ///< what is drawn; z: the heights of the positions
    float height = 0;          ///< z of the view
    double fullScaleError = 1; ///< error at the end of the color scale
    int columns = 0, rows = 0;
    std::vector<TopViewGround> ground; ///< row by row, north first
};

/// Where the area is in the picture, in picture units: pixels of an SVG, two pixels of a PNG. y down.
struct TopViewFrame {
    double x = 0, y = 0, width = 0, height = 0;
    double scale = 1; ///< picture units per game unit
};
TopViewFrame FrameOf(const Boundsf &area);

/// Results of one setting.
struct TopViewInputs {
    const Truth &truth;
    const std::vector<PositionErrors> &errors;
    const std::vector<Cause> &causes;
    const std::vector<WorstPosition> &worst;
    WorstBy by = WorstBy::Reference;
    std::string grid, setting; ///< "SH grid", and name and options of the setting
};
/// The view is at the median height of the worst positions.
ErrorTopView MakeErrorTopView(const BenchMap &map, const TopViewInputs &in, const JobPool &jobs);

/// Display color of an error at `share` (0..1) of the scale.
Vec3f ErrorColor(double share);

/// Errors: a name that ends in neither .png nor .svg, a file that cannot be written.
void WriteErrorTopView(const ErrorTopView &view, const std::filesystem::path &file);

} // namespace q3::bench
