// GPL-2.0-or-later. Lamps fitted to observed light: intensities by non-negative least squares, positions by
// Gauss-Newton.
#include "q3map2/recover/lamp_fit.h"

#include "q3map2/light/sources/falloff.h"

#include <Eigen/Cholesky>
#include <Eigen/IterativeLinearSolvers>
#include <Eigen/SparseCore>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace q3 {

namespace {

/// Error of stored light by rounding. Byte scale.
constexpr float kNoise = 1;
/// Residuals of more than so many times their noise count by their amount, not by its square (Huber).
constexpr float kOutlier = 2.5f;
/// Weight of a grid point: its bytes are rounded more coarsely, and its light is the sum of two colors.
constexpr float kGridWeight = 0.25f;
/// Least intensity as which a lamp is traced.
constexpr float kLeastIntensity = 10;
/// Damping: a step of this many units, or by its whole strength, of one lamp costs as much as it may gain.
constexpr float kStep = 24;
/// A lamp that gives light to more than one in so many places is moved together with the intensities of all others.
constexpr std::size_t kFarReaching = 8;
/// Shorter moves are not tried. Game units.
constexpr float kLeastMove = 0.05f;
/// Relative damping of normal equations.
constexpr double kRidge = 1e-4;
/// Lamps move by at most this share of the distance at which they give kNearLight, byte scale.
constexpr float kStepShare = 0.25f, kNearLight = 32;

float Mean(const Vec3f &v) {
    return (v.x + v.y + v.z) / 3;
}

} // namespace

LampFit::LampFit(const ObservedMap &map, const LampTracer &tracer, const JobPool &jobs)
    : map_(map), tracer_(tracer), jobs_(jobs), residuals_(map.light.size()), weights_(map.light.size(), 1) {
    FindContrast();
    UpdateResiduals();
    UpdateWeights();
}

/// The greatest light of the places that are lit together: shadow edges between them may be elsewhere.
void LampFit::FindContrast() {
    for (const ObservedLight &light : map_.light)
        contrast_.push_back(MaxComponent(light.stored));
    for (const ObservedLuxels &luxels : map_.lightmaps)
        for (std::size_t b = 0, first = luxels.first; b < luxels.batches.size(); first += luxels.batches[b++].count) {
            const auto from = contrast_.begin() + std::ptrdiff_t(first);
            const auto end = from + std::ptrdiff_t(luxels.batches[b].count);
            std::fill(from, end, *std::max_element(from, end));
        }
}

LampColumn LampFit::Traced(const Lamp &lamp) const {
    Lamp traced = lamp;
    if (lamp.Intensity() < kLeastIntensity)
        traced.intensity = Vec3f{1, 1, 1} * kLeastIntensity;
    return tracer_.Trace(traced);
}

void LampFit::TraceAll(std::span<const std::size_t> which) {
    jobs_.For(std::int64_t(which.size()), [&](std::int64_t i, int) {
        const std::size_t j = which[std::size_t(i)];
        columns_[j] = Traced(lamps_[j]);
    });
}

void LampFit::Add(std::span<const Lamp> added) {
    std::vector<std::size_t> which;
    for (const Lamp &lamp : added) {
        which.push_back(lamps_.size());
        lamps_.push_back(lamp);
    }
    columns_.resize(lamps_.size());
    damping_.resize(lamps_.size(), 0.1f);
    TraceAll(which);
    UpdateResiduals();
}

void LampFit::UpdateResiduals() {
    for (std::size_t i = 0; i < residuals_.size(); ++i)
        residuals_[i] = map_.light[i].stored - map_.light[i].known;
    for (std::size_t j = 0; j < lamps_.size(); ++j)
        for (const LampEntry &entry : columns_[j])
            residuals_[entry.place] -= lamps_[j].intensity * entry.light;
}

Vec3f LampFit::EffectiveResidual(std::size_t place) const {
    const Vec3f &r = residuals_[place];
    return map_.light[place].isBound ? Max(r, Vec3f{}) : r;
}

void LampFit::UpdateWeights() {
    for (std::size_t i = 0; i < weights_.size(); ++i) {
        const float relative = relativeNoise_ * contrast_[i];
        const float noise2 = kNoise * kNoise + relative * relative;
        const Vec3f r = EffectiveResidual(i);
        const float u = 1 / std::max(1.0f, std::sqrt(Dot(r, r) / (3 * noise2)) / kOutlier);
        weights_[i] = (i < map_.firstGrid ? 1 : kGridWeight) * u / noise2;
    }
}

LampFit::Slope LampFit::SlopeOf(const LampColumn &column) const {
    Slope slope;
    for (const auto &[place, light] : column) {
        const float weighted = weights_[place] * light;
        slope.b += EffectiveResidual(place) * weighted;
        slope.a += weighted * light;
    }
    return slope;
}

void LampFit::SolveIntensities(int sweeps) {
    for (int sweep = 0; sweep < sweeps; ++sweep)
        for (std::size_t j = 0; j < lamps_.size(); ++j) {
            const auto [b, a] = SlopeOf(columns_[j]);
            if (!(a > 0)) {
                lamps_[j].intensity = {};
                continue;
            }
            const Vec3f next = Max(lamps_[j].intensity + b * (1 / a), Vec3f{});
            const Vec3f change = next - lamps_[j].intensity;
            lamps_[j].intensity = next;
            for (const auto &[place, light] : columns_[j])
                residuals_[place] -= change * light;
        }
    UpdateWeights();
}

double LampFit::Error() const {
    double sum = 0;
    for (std::size_t i = 0; i < residuals_.size(); ++i) {
        const Vec3f r = EffectiveResidual(i);
        sum += double(weights_[i]) * double(Dot(r, r));
    }
    return sum;
}

double LampFit::RmsOfLuxels() const {
    double sum = 0;
    for (std::size_t i = 0; i < map_.firstGrid; ++i) {
        const Vec3f r = EffectiveResidual(i);
        sum += double(Dot(r, r)) / 3;
    }
    return map_.firstGrid > 0 ? std::sqrt(sum / double(map_.firstGrid)) : 0;
}

/// Derivatives of the weighted light of places by the positions of lamps, in steps of kStep, and by the logarithms of
/// their strengths: four unknowns a lamp. Visibility counts as constant.
std::vector<LampFit::Term> LampFit::Derivatives() const {
    std::vector<Term> terms;
    for (std::size_t j = 0; j < lamps_.size(); ++j) {
        const float strength = lamps_[j].Strength();
        for (const auto &[place, light] : columns_[j]) {
            if (map_.light[place].isBound && Mean(residuals_[place]) < 0)
                continue;
            // light = c (n . D) / |D|^3 for D from the place to the lamp; c / |D|^2 at grid points.
            const Vec3f offset = lamps_[j].origin - map_.positions[place];
            const float d2 = std::max(Dot(offset, offset), 1.0f);
            Vec3f gradient;
            if (d2 > kNearest * kNearest) {
                gradient = offset * (-(place < map_.firstGrid ? 3 : 2) / d2);
                const Vec3f &normal = map_.normals[place];
                if (const float along = Dot(offset, normal); place < map_.firstGrid && along > 0.05f * std::sqrt(d2))
                    gradient += normal / along;
            }
            const float factor = light * strength * std::sqrt(weights_[place]);
            gradient *= factor * kStep;
            for (std::size_t axis = 0; axis < 3; ++axis)
                terms.emplace_back(int(place), int(4 * j + axis), gradient[axis]);
            terms.emplace_back(int(place), int(4 * j + 3), factor);
        }
    }
    return terms;
}

std::size_t LampFit::DropRedundant(double leastGain, float apart) {
    const std::vector<Term> terms = Derivatives();
    const auto unknowns = Eigen::Index(4 * lamps_.size());
    Eigen::SparseMatrix<float> jacobian(Eigen::Index(residuals_.size()), unknowns);
    jacobian.setFromTriplets(terms.begin(), terms.end());
    const Eigen::SparseMatrix<float> product = jacobian.transpose() * jacobian;
    Eigen::MatrixXd normal = Eigen::MatrixXf(product).cast<double>();
    for (Eigen::Index k = 0; k < unknowns; ++k)
        normal(k, k) += kRidge * normal(k, k) + 1e-3;
    const Eigen::LLT<Eigen::MatrixXd> factors(normal);
    const Eigen::MatrixXd inverse = factors.solve(Eigen::MatrixXd::Identity(unknowns, unknowns));
    std::vector<std::pair<double, std::size_t>> gains;
    for (std::size_t j = 0; j < lamps_.size(); ++j)
        gains.push_back({3 / inverse(Eigen::Index(4 * j + 3), Eigen::Index(4 * j + 3)), j});
    std::ranges::sort(gains);
    std::vector<std::size_t> dropped;
    for (const auto &[gain, j] : gains) {
        if (gain >= leastGain)
            break;
        if (std::ranges::all_of(dropped, [&, j = j](std::size_t other) {
                return Length(lamps_[other].origin - lamps_[j].origin) > apart;
            }))
            dropped.push_back(j);
    }
    for (const std::size_t j : dropped)
        lamps_[j].intensity = {};
    UpdateResiduals();
    Prune(0);
    return dropped.size();
}

bool LampFit::MoveLamps() {
    const std::size_t places = residuals_.size(), unknowns = 4 * lamps_.size();
    std::vector<Term> terms = Derivatives();
    Eigen::VectorXf right = Eigen::VectorXf::Zero(Eigen::Index(places + unknowns));
    for (std::size_t i = 0; i < places; ++i)
        right[Eigen::Index(i)] = Mean(EffectiveResidual(i)) * std::sqrt(weights_[i]);
    // Damping in proportion to the curvature of each unknown (Marquardt).
    std::vector<double> curvature(unknowns);
    for (const Term &term : terms)
        curvature[std::size_t(term.col())] += double(term.value()) * double(term.value());
    for (std::size_t k = 0; k < unknowns; ++k)
        terms.emplace_back(int(places + k), int(k), std::sqrt(damping_[k / 4] * float(curvature[k] + 1)));
    Eigen::SparseMatrix<float> matrix(Eigen::Index(places + unknowns), Eigen::Index(unknowns));
    matrix.setFromTriplets(terms.begin(), terms.end());
    Eigen::LeastSquaresConjugateGradient<Eigen::SparseMatrix<float>> solver;
    solver.setMaxIterations(200);
    solver.setTolerance(1e-4f);
    solver.compute(matrix);
    const Eigen::VectorXf step = solver.solve(right);

    const std::vector<Lamp> oldLamps = lamps_;
    std::vector<LampColumn> oldColumns(lamps_.size()); // of those that move
    std::vector<std::size_t> moved;
    for (std::size_t j = 0; j < lamps_.size(); ++j) {
        Vec3f by{step[Eigen::Index(4 * j)], step[Eigen::Index(4 * j + 1)], step[Eigen::Index(4 * j + 2)]};
        by *= kStep;
        const float farthest = std::max(kStep, kStepShare * tracer_.ReachOf(lamps_[j].Strength(), kNearLight));
        if (const float length = Length(by); length > farthest)
            by *= farthest / length;
        if (Length(by) < kLeastMove) {
            damping_[j] = std::max(1e-3f, damping_[j] / 10); // at rest, or damped too much
            continue;
        }
        lamps_[j].origin += by;
        lamps_[j].intensity *= std::clamp(1 + step[Eigen::Index(4 * j + 3)], 0.5f, 2.0f);
        moved.push_back(j);
    }
    for (const std::size_t j : moved)
        oldColumns[j] = std::move(columns_[j]);
    TraceAll(moved);
    for (const std::size_t j : moved)
        if (columns_[j].empty()) // it would be in a solid
            lamps_[j] = oldLamps[j], columns_[j] = oldColumns[j];
    const double before = Error();
    const std::vector<Vec3f> oldResiduals = residuals_;
    UpdateResiduals();
    const std::vector<float> weights = weights_;
    SolveIntensities(4);
    weights_ = weights; // errors are compared by the same weights
    if (Error() < before) {
        for (const std::size_t j : moved)
            damping_[j] = std::max(1e-3f, damping_[j] / 3);
        UpdateWeights();
        return true;
    }
    const std::vector<Lamp> movedLamps = lamps_;
    lamps_ = oldLamps, residuals_ = oldResiduals;
    bool anyKept = false;
    for (const std::size_t j : moved) {
        lamps_[j].origin = movedLamps[j].origin;
        const bool kept = KeepIfBetter(j, oldLamps[j], oldColumns[j]);
        anyKept |= kept;
        damping_[j] = kept ? std::max(1e-3f, damping_[j] / 3) : std::min(1e4f, damping_[j] * 10);
    }
    return anyKept;
}

/// The lamp has moved: gives it its best intensity there, and takes it back unless the error at its places falls.
bool LampFit::KeepIfBetter(std::size_t j, const Lamp &oldLamp, LampColumn &oldColumn) {
    const auto errorAt = [&](std::uint32_t place) {
        const Vec3f r = EffectiveResidual(place);
        return double(weights_[place]) * double(Dot(r, r));
    };
    const auto errorOf = [&](const LampColumn &column) {
        double sum = 0;
        for (const auto &[place, light] : column)
            sum += errorAt(place);
        return sum;
    };
    const auto add = [&](const LampColumn &column, const Vec3f &intensity) {
        for (const auto &[place, light] : column)
            residuals_[place] -= intensity * light;
    };
    // How much each of the two lowers the error of a map without this lamp.
    const LampColumn &column = columns_[j];
    double gainOfOld = -errorOf(oldColumn);
    add(oldColumn, oldLamp.intensity * -1.0f);
    gainOfOld += errorOf(oldColumn);
    const double without = errorOf(column);
    const auto [b, a] = SlopeOf(column);
    if (a > 0)
        lamps_[j].intensity = Max(b * (1 / a), Vec3f{});
    add(column, lamps_[j].intensity);
    if (a > 0 && without - errorOf(column) > gainOfOld)
        return true;
    add(column, lamps_[j].intensity * -1.0f);
    add(oldColumn, oldLamp.intensity);
    lamps_[j] = oldLamp, columns_[j] = std::move(oldColumn);
    return false;
}

std::size_t LampFit::Search(float step) {
    constexpr std::array<Vec3f, 6> kDirections{{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}}};
    std::vector<std::size_t> order(lamps_.size());
    std::iota(order.begin(), order.end(), std::size_t(0));
    std::ranges::stable_sort(order, std::greater(), [&](std::size_t j) { return lamps_[j].Strength(); });
    std::size_t moved = 0;
    for (const std::size_t j : order) {
        std::array<LampColumn, kDirections.size()> columns;
        const Lamp start = lamps_[j];
        jobs_.For(std::int64_t(kDirections.size()), [&](std::int64_t i, int) {
            Lamp lamp = start;
            lamp.origin += kDirections[std::size_t(i)] * step;
            columns[std::size_t(i)] = Traced(lamp);
        });
        const bool isFarReaching = columns_[j].size() > residuals_.size() / kFarReaching;
        for (std::size_t i = 0; i < columns.size(); ++i) {
            if (columns[i].empty())
                continue;
            const Vec3f origin = start.origin + kDirections[i] * step;
            if (isFarReaching ? KeepIfBetterForAll(j, origin, std::move(columns[i]))
                              : KeepIfBetterAt(j, origin, std::move(columns[i]))) {
                ++moved;
                break;
            }
        }
    }
    UpdateWeights();
    return moved;
}

bool LampFit::KeepIfBetterAt(std::size_t j, const Vec3f &origin, LampColumn column) {
    const Lamp oldLamp = lamps_[j];
    LampColumn oldColumn = std::move(columns_[j]);
    lamps_[j].origin = origin, columns_[j] = std::move(column);
    return KeepIfBetter(j, oldLamp, oldColumn);
}

/// The same for a lamp that many others overlap: these change too.
bool LampFit::KeepIfBetterForAll(std::size_t j, const Vec3f &origin, LampColumn column) {
    const std::vector<Lamp> oldLamps = lamps_;
    const std::vector<Vec3f> oldResiduals = residuals_;
    const std::vector<float> oldWeights = weights_;
    const double before = Error();
    for (const auto &[place, light] : columns_[j])
        residuals_[place] += lamps_[j].intensity * light;
    for (const auto &[place, light] : column)
        residuals_[place] -= lamps_[j].intensity * light;
    lamps_[j].origin = origin;
    std::swap(columns_[j], column);
    SolveIntensities(4);
    weights_ = oldWeights;
    if (Error() < before)
        return true;
    lamps_ = oldLamps, residuals_ = oldResiduals;
    std::swap(columns_[j], column);
    return false;
}

void LampFit::Prune(double leastGain) {
    std::vector<Lamp> kept;
    std::vector<LampColumn> keptColumns;
    std::vector<float> keptDamping;
    for (std::size_t j = 0; j < lamps_.size(); ++j) {
        // What its light alone explains: the weighted squares of its own light at most.
        double gain = 0;
        for (const auto &[place, light] : columns_[j]) {
            const Vec3f own = lamps_[j].intensity * light, r = EffectiveResidual(place);
            gain += double(weights_[place]) * double(Dot(own + r, own + r) - Dot(r, r));
        }
        if (gain <= leastGain) {
            for (const auto &[place, light] : columns_[j])
                residuals_[place] += lamps_[j].intensity * light;
            continue;
        }
        kept.push_back(lamps_[j]);
        keptDamping.push_back(damping_[j]);
        keptColumns.push_back(std::move(columns_[j]));
    }
    lamps_ = std::move(kept), columns_ = std::move(keptColumns), damping_ = std::move(keptDamping);
}

void LampFit::Merge(float distance) {
    std::vector<std::size_t> changed;
    for (std::size_t j = 0; j < lamps_.size(); ++j)
        for (std::size_t k = j + 1; k < lamps_.size(); ++k) {
            if (Length(lamps_[j].origin - lamps_[k].origin) > distance || !(lamps_[k].Strength() > 0))
                continue;
            const float a = lamps_[j].Strength(), b = lamps_[k].Strength();
            lamps_[j].origin = (lamps_[j].origin * a + lamps_[k].origin * b) / (a + b);
            lamps_[j].intensity += lamps_[k].intensity;
            lamps_[k].intensity = {};
            if (changed.empty() || changed.back() != j)
                changed.push_back(j);
        }
    TraceAll(changed);
    UpdateResiduals();
}

} // namespace q3
