// GPL-2.0-or-later. Errors of both grids of a map by position, as the file .sherror.json for the viewer.
#include "tools/measure/shbench/error_list.h"

#include <nlohmann/json.hpp>

#include <cmath>

namespace q3::bench {

namespace {

double Rounded(double value, double stepsPerUnit) {
    return std::round(value * stepsPerUnit) / stepsPerUnit;
}

} // namespace

std::vector<double> ShownErrorsByPlace(const Truth &truth, const ShownLight &shown) {
    std::vector<double> all;
    for (const PositionErrors &errors : ErrorsByPlace(truth, shown))
        all.push_back(errors.shown);
    return all;
}

std::string ErrorListJson(std::string_view map, const Truth &truth, const ErrorList &errors) {
    constexpr double kPositionSteps = 10, kErrorSteps = 100;
    nlohmann::ordered_json positions = nlohmann::ordered_json::array();
    for (std::size_t i = 0; i < truth.points.size(); ++i) {
        const Vec3f &p = truth.points[i].position;
        nlohmann::ordered_json row = nlohmann::ordered_json::array();
        for (const float coordinate : {p.x, p.y, p.z})
            row.push_back(Rounded(double(coordinate), kPositionSteps));
        row.push_back(Rounded(errors.sh[i], kErrorSteps));
        row.push_back(errors.legacy.empty() ? nlohmann::ordered_json()
                                            : nlohmann::ordered_json(Rounded(errors.legacy[i], kErrorSteps)));
        positions.push_back(std::move(row));
    }
    const nlohmann::ordered_json all = {{"format", "q3map2-sh errors"},
                                        {"version", 1},
                                        {"map", fmt::format("maps/{}.bsp", map)},
                                        {"unit", "displayed bytes"},
                                        {"setting", errors.setting},
                                        {"options", errors.options},
                                        {"positions", std::move(positions)}};
    return all.dump() + "\n";
}

} // namespace q3::bench
