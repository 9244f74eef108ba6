// GPL-2.0-or-later. How far shown light is from the reference.
#include "tools/measure/shbench/errors.h"

#include "libs/sh/sh.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace q3::bench {

namespace {

double Percentile(std::vector<float> &values, double share) {
    if (values.empty())
        return 0;
    const auto at = std::min(values.size() - 1, std::size_t(share * double(values.size())));
    std::nth_element(values.begin(), values.begin() + std::ptrdiff_t(at), values.end());
    return double(values[at]);
}

/// Displayed light, mean over positions, normals and channels.
double MapMean(const Truth &truth) {
    double sum = 0;
    for (const TruthPoint &point : truth.points)
        sum += MeanDisplayed(point.light);
    return truth.points.empty() ? 0 : sum / double(truth.points.size());
}

} // namespace

NormalLight ProjectedLight(const TruthPoint &point) {
    NormalLight light;
    for (std::size_t i = 0; i < kNormals; ++i) {
        const SHVector basis = SHBasis(Normals()[i]);
        Vec3d sum;
        for (std::size_t k = 0; k < 9; ++k)
            sum += Vec3d(point.projection[k]) * basis[k];
        light[i] = Max(Vec3f(sum), Vec3f{});
    }
    return light;
}

double MeanDisplayed(const NormalLight &light) {
    double sum = 0;
    for (const Vec3f &rgb : light)
        sum += Displayed(rgb.x) + Displayed(rgb.y) + Displayed(rgb.z);
    return sum / double(3 * kNormals);
}

double FloorError(const Truth &truth) {
    double sum = 0;
    for (const TruthPoint &point : truth.points) {
        const NormalLight projected = ProjectedLight(point);
        for (std::size_t i = 0; i < kNormals; ++i)
            for (std::size_t channel = 0; channel < 3; ++channel) {
                const double difference = Displayed(projected[i][channel]) - Displayed(point.light[i][channel]);
                sum += difference * difference;
            }
    }
    return truth.points.empty() ? 0 : std::sqrt(sum / double(truth.points.size() * kNormals * 3));
}

ShownErrors MeasureErrors(const Truth &truth, const ShownLight &shown) {
    ShownErrors errors;
    if (truth.points.empty())
        return errors;
    const double mean = MapMean(truth);
    double squares = 0, gridSquares = 0, unclampedSquares = 0, referenceSquares = 0;
    std::size_t leaks = 0;
    std::vector<float> differences;
    differences.reserve(truth.points.size() * kNormals * 3);
    for (const TruthPoint &point : truth.points) {
        const NormalLight light = shown(point.position), projected = ProjectedLight(point);
        for (std::size_t i = 0; i < kNormals; ++i)
            for (std::size_t channel = 0; channel < 3; ++channel) {
                const float value = light[i][channel], reference = point.light[i][channel];
                const double difference = Displayed(value) - Displayed(reference);
                const double toProjection = Displayed(value) - Displayed(projected[i][channel]);
                const double unclamped = double(value) - double(reference);
                differences.push_back(float(std::abs(difference)));
                squares += difference * difference, gridSquares += toProjection * toProjection;
                unclampedSquares += unclamped * unclamped, referenceSquares += double(reference) * double(reference);
            }
        leaks += IsLeak(MeanDisplayed(point.light), MeanDisplayed(light), mean) ? 1 : 0;
    }
    const double count = double(differences.size());
    errors.rmse = std::sqrt(squares / count);
    errors.grid = std::sqrt(gridSquares / count);
    errors.relative = referenceSquares > 0 ? std::sqrt(unclampedSquares / referenceSquares) : 0;
    errors.leak = double(leaks) / double(truth.points.size());
    errors.percentile95 = Percentile(differences, 0.95);
    errors.percentile99 = Percentile(differences, 0.99);
    return errors;
}

PositionErrors ErrorsAt(const TruthPoint &point, const NormalLight &shown, const NormalLight &projected) {
    PositionErrors sums;
    for (std::size_t i = 0; i < kNormals; ++i)
        for (std::size_t channel = 0; channel < 3; ++channel) {
            const double value = Displayed(shown[i][channel]), projection = Displayed(projected[i][channel]),
                         reference = Displayed(point.light[i][channel]);
            sums.shown += (value - reference) * (value - reference);
            sums.floor += (projection - reference) * (projection - reference);
            sums.grid += (value - projection) * (value - projection);
        }
    const auto rms = [](double sum) { return std::sqrt(sum / double(kNormals * 3)); };
    return {rms(sums.shown), rms(sums.floor), rms(sums.grid)};
}

std::vector<PositionErrors> ErrorsByPlace(const Truth &truth, const ShownLight &shown) {
    std::vector<PositionErrors> all;
    for (const TruthPoint &point : truth.points)
        all.push_back(ErrorsAt(point, shown(point.position), ProjectedLight(point)));
    return all;
}

double ErrorOf(const PositionErrors &errors, WorstBy by) {
    return by == WorstBy::Reference ? errors.shown : errors.grid;
}

std::vector<WorstPosition> WorstPositions(const Truth &truth, const ShownLight &shown, std::size_t count, WorstBy by) {
    const std::vector<PositionErrors> errors = ErrorsByPlace(truth, shown);
    std::vector<std::size_t> order(errors.size());
    std::iota(order.begin(), order.end(), std::size_t(0));
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return ErrorOf(errors[a], by) > ErrorOf(errors[b], by); });
    order.resize(std::min(order.size(), count));
    std::vector<WorstPosition> worstPlaces;
    for (const std::size_t p : order) {
        const TruthPoint &point = truth.points[p];
        const NormalLight light = shown(point.position), projected = ProjectedLight(point);
        const NormalLight &against = by == WorstBy::Reference ? point.light : projected;
        WorstPosition worst{p, 0, -1, {}};
        for (std::size_t i = 0; i < kNormals; ++i)
            for (std::size_t channel = 0; channel < 3; ++channel) {
                const double error = std::abs(Displayed(light[i][channel]) - Displayed(against[i][channel]));
                if (error > worst.error)
                    worst = {p, i, error, light[i]};
            }
        worstPlaces.push_back(worst);
    }
    return worstPlaces;
}

} // namespace q3::bench
