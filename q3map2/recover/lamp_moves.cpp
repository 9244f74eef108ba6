// GPL-2.0-or-later. Positions of lamps by Gauss-Newton, positions and cones by search, and lamps that others can
// replace.
#include "q3map2/recover/lamp_fit.h"

#include "q3map2/light/sources/falloff.h"

#include <Eigen/Cholesky>
#include <Eigen/IterativeLinearSolvers>
#include <Eigen/SparseCore>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

namespace q3 {

namespace {

/// Unit of positions in the least-squares problem, so that they and logarithms of strengths are about equally large.
/// Game units.
constexpr float kStep = 24;
/// Damping after a step that was taken, and after one that was not: factors, and limits.
constexpr float kEase = 1 / 3.0f, kTighten = 10, kLeastDamping = 1e-3f, kMostDamping = 1e4f;
/// A lamp that gives light to more than one in so many places is moved together with the intensities of all others.
constexpr std::size_t kFarReaching = 8;
/// Shorter moves are not tried. Game units.
constexpr float kLeastMove = 0.05f;
/// Relative damping of normal equations.
constexpr double kRidge = 1e-4;
/// Lamps move by at most this share of the distance at which they give kNearLight, byte scale.
constexpr float kStepShare = 0.25f, kNearLight = 32;
/// A cone is tilted by step / kTiltUnits radians, and its radius changed by that share.
constexpr float kTiltUnits = 96;
/// Gauss-Newton steps of a spotlight in one search, at most.
constexpr int kTurnsOfCones = 8;
/// Of each lamp, the normal matrix of so many others that it shares most light with is inverted.
constexpr std::size_t kNeighbors = 48;

/// A unit vector at a right angle to the axis.
Vec3f SideOf(const Vec3f &axis) {
    return Normalize(Cross(axis, std::abs(axis.z) < 0.7f ? Vec3f{0, 0, 1} : Vec3f{1, 0, 0}));
}

} // namespace

/// Derivatives of the weighted light of places by the positions of lamps, in steps of kStep, and by the logarithms of
/// their strengths: four unknowns a lamp. Visibility and cones count as constant.
Eigen::SparseMatrix<float> LampFit::Jacobian() const {
    Eigen::SparseMatrix<float> jacobian(Eigen::Index(residuals_.size()), Eigen::Index(4 * lamps_.size()));
    Eigen::VectorXi sizes(jacobian.cols());
    for (Eigen::Index k = 0; k < sizes.size(); ++k)
        sizes[k] = int(columns_[std::size_t(k / 4)].size());
    jacobian.reserve(sizes);
    for (std::size_t j = 0; j < lamps_.size(); ++j) {
        const float strength = lamps_[j].Strength();
        for (const auto &[place, light] : columns_[j]) {
            if (!map_.light[place].Contradicts(MeanOfChannels(residuals_[place])))
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
                jacobian.insert(Eigen::Index(place), Eigen::Index(4 * j + axis)) = gradient[axis];
            jacobian.insert(Eigen::Index(place), Eigen::Index(4 * j + 3)) = factor;
        }
    }
    jacobian.makeCompressed();
    return jacobian;
}

// ---- Levenberg-Marquardt ----

/// The damped Gauss-Newton step of all unknowns, by the normal equations.
std::vector<float> LampFit::BestStep() const {
    const auto jacobian = Jacobian();
    Eigen::VectorXf right(Eigen::Index(residuals_.size()));
    for (std::size_t i = 0; i < residuals_.size(); ++i)
        right[Eigen::Index(i)] = MeanOfChannels(EffectiveResidual(i)) * std::sqrt(weights_[i]);
    const Eigen::VectorXd gradient = (jacobian.transpose() * right).cast<double>();
    Eigen::SparseMatrix<double> normal = Eigen::SparseMatrix<float>(jacobian.transpose() * jacobian).cast<double>();
    // Damping in proportion to the curvature of each unknown (Marquardt).
    for (Eigen::Index k = 0; k < normal.rows(); ++k) {
        double &curvature = normal.coeffRef(k, k);
        curvature += double(damping_[std::size_t(k / 4)]) * (curvature + 1);
    }
    Eigen::ConjugateGradient<Eigen::SparseMatrix<double>, Eigen::Lower | Eigen::Upper> solver;
    solver.setMaxIterations(200);
    solver.setTolerance(1e-4);
    solver.compute(normal);
    const Eigen::VectorXd step = solver.solve(gradient);
    return {step.begin(), step.end()};
}

/// Takes the step, within limits. Returns the lamps that moved.
std::vector<std::size_t> LampFit::Step(const std::vector<float> &step) {
    std::vector<std::size_t> moved;
    for (std::size_t j = 0; j < lamps_.size(); ++j) {
        Vec3f by{step[4 * j], step[4 * j + 1], step[4 * j + 2]};
        by *= kStep;
        const float farthest = std::max(kStep, kStepShare * tracer_.ReachOf(lamps_[j].Strength(), kNearLight));
        if (const float length = Length(by); length > farthest)
            by *= farthest / length;
        if (Length(by) < kLeastMove) {
            damping_[j] = std::max(kLeastDamping, damping_[j] / kTighten); // at rest, or damped too much
            continue;
        }
        lamps_[j].origin += by;
        lamps_[j].intensity *= std::clamp(1 + step[4 * j + 3], 0.5f, 2.0f);
        moved.push_back(j);
    }
    return moved;
}

void LampFit::MoveLamps() {
    if (lamps_.empty())
        return;
    const std::vector<Lamp> oldLamps = lamps_;
    const std::vector<std::size_t> moved = Step(BestStep());
    std::vector<LampColumn> oldColumns(lamps_.size()); // of those that move
    for (const std::size_t j : moved)
        oldColumns[j] = std::move(columns_[j]);
    TraceAll(moved);
    for (const std::size_t j : moved)
        if (columns_[j].empty()) // it would be in a solid
            lamps_[j] = oldLamps[j], columns_[j] = oldColumns[j];
    const double before = Error();
    const std::vector<Vec3f> oldResiduals = residuals_;
    const std::vector<float> weights = weights_;
    UpdateResiduals();
    SolveIntensities(4);
    const auto ease = [&](std::size_t j) { damping_[j] = std::max(kLeastDamping, damping_[j] * kEase); };
    weights_ = weights; // errors are compared by the same weights
    if (Error() < before) {
        for (const std::size_t j : moved)
            ease(j);
        UpdateWeights();
        return;
    }
    // Not all together: each by itself.
    const std::vector<Lamp> movedLamps = lamps_;
    lamps_ = oldLamps, residuals_ = oldResiduals;
    for (const std::size_t j : moved) {
        lamps_[j].origin = movedLamps[j].origin;
        if (KeepIfBetter(j, oldLamps[j], oldColumns[j], 0))
            ease(j);
        else
            damping_[j] = std::min(kMostDamping, damping_[j] * kTighten);
    }
}

// ---- One lamp at a time ----

/// The lamp has changed: gives it its best intensity, and takes the change back unless the error at its places falls by
/// more than leastGain times the noise.
bool LampFit::KeepIfBetter(std::size_t j, const Lamp &oldLamp, LampColumn &oldColumn, double leastGain) {
    // How much each of the two lowers the error of a map without this lamp.
    const LampColumn &column = columns_[j];
    double gainOfOld = -ErrorAt(oldColumn);
    AddToResiduals(oldColumn, oldLamp.intensity);
    gainOfOld += ErrorAt(oldColumn);
    const double without = ErrorAt(column);
    const Slope slope = SlopeOf(column);
    if (slope.a > 0) {
        lamps_[j].intensity = Max(slope.b * (1 / slope.a), Vec3f{});
        AddToResiduals(column, lamps_[j].intensity * -1.0f);
        const double noise = leastGain != 0 ? double(SlopeOf(column).noise) : 0;
        if (without - ErrorAt(column) > gainOfOld + leastGain * noise)
            return true;
        AddToResiduals(column, lamps_[j].intensity);
    }
    AddToResiduals(oldColumn, oldLamp.intensity * -1.0f);
    lamps_[j] = oldLamp, columns_[j] = std::move(oldColumn);
    return false;
}

/// Puts a lamp in the place of number j if the error of the whole map falls: others that overlap it change too.
bool LampFit::KeepIfBetterForAll(std::size_t j, const Lamp &lamp, LampColumn column) {
    const std::vector<Lamp> oldLamps = lamps_;
    const std::vector<Vec3f> oldResiduals = residuals_;
    const std::vector<float> oldWeights = weights_;
    const double before = Error();
    AddToResiduals(columns_[j], lamps_[j].intensity);
    AddToResiduals(column, lamps_[j].intensity * -1.0f);
    const Vec3f intensity = lamps_[j].intensity;
    lamps_[j] = lamp, lamps_[j].intensity = intensity;
    std::swap(columns_[j], column);
    SolveIntensities(4);
    weights_ = oldWeights;
    if (Error() < before)
        return true;
    lamps_ = oldLamps, residuals_ = oldResiduals;
    std::swap(columns_[j], column);
    return false;
}

bool LampFit::Replace(std::size_t j, const Lamp &lamp, double leastGain) {
    LampColumn column = Traced(lamp);
    if (column.empty())
        return false;
    const Lamp oldLamp = lamps_[j];
    std::swap(columns_[j], column);
    lamps_[j] = lamp;
    return KeepIfBetter(j, oldLamp, column, leastGain);
}

/// Lamp number j moved along each axis; with a cone also tilted to each side, wider and narrower.
std::vector<Lamp> LampFit::TrialsOf(std::size_t j, float step) const {
    const Lamp &lamp = lamps_[j];
    constexpr std::array<Vec3f, 3> kAxes{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    std::vector<Lamp> trials;
    for (const Vec3f &axis : kAxes)
        for (const float sign : {1.0f, -1.0f}) {
            trials.push_back(lamp);
            trials.back().origin += axis * (sign * step);
        }
    if (!lamp.cone)
        return trials;
    const float share = step / kTiltUnits;
    const Vec3f &axis = lamp.cone->axis;
    const Vec3f side = SideOf(axis), up = Cross(side, axis);
    for (const Vec3f &to : {side, up})
        for (const float sign : {1.0f, -1.0f}) {
            trials.push_back(lamp);
            trials.back().cone->axis = Normalize(axis + to * (sign * share));
        }
    for (const float factor : {1 + share, 1 / (1 + share)}) {
        trials.push_back(lamp);
        trials.back().cone->radiusByDist = std::max(lamp.cone->radiusByDist * factor, kLeastRadiusByDist);
    }
    return trials;
}

/// Puts the first of TrialsOf in the place of lamp number j for which the error falls.
void LampFit::TryAround(std::size_t j, float step) {
    const std::vector<Lamp> trials = TrialsOf(j, step);
    std::vector<LampColumn> columns(trials.size());
    jobs_.For(std::int64_t(trials.size()),
              [&](std::int64_t i, int) { columns[std::size_t(i)] = Traced(trials[std::size_t(i)]); });
    const bool isFarReaching = columns_[j].size() > residuals_.size() / kFarReaching;
    for (std::size_t i = 0; i < trials.size(); ++i) {
        if (columns[i].empty())
            continue;
        if (isFarReaching) {
            if (KeepIfBetterForAll(j, trials[i], std::move(columns[i])))
                return;
            continue;
        }
        const Lamp oldLamp = lamps_[j];
        LampColumn oldColumn = std::move(columns_[j]);
        lamps_[j] = trials[i], columns_[j] = std::move(columns[i]);
        if (KeepIfBetter(j, oldLamp, oldColumn, 0))
            return;
    }
}

/// A spotlight changed in its six parameters: position in units of kStep, tilts to two sides in radians, and the
/// logarithm of its width.
Lamp LampFit::Changed(const Lamp &lamp, const std::array<float, 6> &by) {
    Lamp changed = lamp;
    changed.origin += Vec3f{by[0], by[1], by[2]} * kStep;
    const Vec3f &axis = lamp.cone->axis;
    const Vec3f side = SideOf(axis), up = Cross(side, axis);
    changed.cone->axis = Normalize(axis + side * by[3] + up * by[4]);
    const float width = lamp.cone->radiusByDist * std::exp(std::clamp(by[5], -1.0f, 1.0f));
    changed.cone->radiusByDist = std::max(width, kLeastRadiusByDist);
    return changed;
}

/// One damped Gauss-Newton step of a spotlight alone, with derivatives by differences, so that the rim of the cone
/// counts. Returns whether the error fell.
bool LampFit::MoveCone(std::size_t j) {
    constexpr std::array<float, 6> kDifferences{0.1f, 0.1f, 0.1f, 0.02f, 0.02f, 0.03f};
    constexpr int kTries = 6;
    constexpr std::size_t kParameters = 7; // the last is the logarithm of the strength
    std::array<LampColumn, 6> columns;
    jobs_.For(6, [&](std::int64_t i, int) {
        std::array<float, 6> by{};
        by[std::size_t(i)] = kDifferences[std::size_t(i)];
        columns[std::size_t(i)] = Traced(Changed(lamps_[j], by));
    });
    std::map<std::uint32_t, std::array<float, kParameters>> rows; // derivatives, by place
    for (const auto &[place, light] : columns_[j]) {
        std::array<float, kParameters> &row = rows[place];
        for (std::size_t k = 0; k < columns.size(); ++k)
            row[k] -= light / kDifferences[k];
        row[6] = light;
    }
    for (std::size_t k = 0; k < columns.size(); ++k)
        for (const auto &[place, light] : columns[k])
            rows[place][k] += light / kDifferences[k];
    using Matrix = Eigen::Matrix<double, kParameters, kParameters>;
    using Vector = Eigen::Vector<double, kParameters>;
    Matrix normal = Matrix::Zero();
    Vector right = Vector::Zero();
    for (const auto &[place, row] : rows) {
        if (!map_.light[place].Contradicts(MeanOfChannels(residuals_[place])))
            continue;
        const Vector derivatives = Eigen::Map<const Eigen::Vector<float, kParameters>>(row.data()).cast<double>() *
                                   double(lamps_[j].Strength());
        normal += double(weights_[place]) * derivatives * derivatives.transpose();
        right += double(weights_[place]) * double(MeanOfChannels(EffectiveResidual(place))) * derivatives;
    }
    double damping = 1e-3;
    for (int attempt = 0; attempt < kTries; ++attempt, damping *= 10) {
        Matrix damped = normal;
        damped.diagonal() += damping * normal.diagonal() + Vector::Constant(1e-6);
        const Vector step = damped.ldlt().solve(right);
        std::array<float, 6> by{};
        for (std::size_t k = 0; k < by.size(); ++k)
            by[k] = float(step[Eigen::Index(k)]);
        if (Replace(j, Changed(lamps_[j], by), 0))
            return true;
    }
    return false;
}

void LampFit::Search(float step) {
    std::vector<std::size_t> order(lamps_.size());
    std::iota(order.begin(), order.end(), std::size_t(0));
    std::ranges::stable_sort(order, std::greater(), [&](std::size_t j) { return lamps_[j].Strength(); });
    for (const std::size_t j : order)
        TryAround(j, step);
    for (const std::size_t j : order)
        for (int turn = 0; lamps_[j].cone && turn < kTurnsOfCones && MoveCone(j); ++turn) {
        }
    UpdateWeights();
}

// ---- How well each lamp is known ----

/// Elements of the inverse of the normal matrix, by lamp.
std::vector<LampFit::Variance> LampFit::Variances() const {
    if (lamps_.empty()) // Eigen compresses no matrix without columns
        return {};
    const auto jacobian = Jacobian();
    const Eigen::SparseMatrix<float> normal = jacobian.transpose() * jacobian;
    // How much light two lamps share: the element of their strengths.
    std::vector<std::vector<std::pair<float, std::size_t>>> shared(lamps_.size());
    for (std::size_t j = 0; j < lamps_.size(); ++j)
        for (Eigen::SparseMatrix<float>::InnerIterator it(normal, Eigen::Index(4 * j + 3)); it; ++it)
            if (it.row() % 4 == 3 && it.row() != it.col())
                shared[j].push_back({-it.value(), std::size_t(it.row() / 4)});
    std::vector<Variance> variances(lamps_.size());
    jobs_.For(std::int64_t(lamps_.size()), [&](std::int64_t number, int) {
        const auto j = std::size_t(number);
        std::ranges::sort(shared[j]);
        shared[j].resize(std::min(shared[j].size(), kNeighbors));
        std::vector<std::size_t> lamps{j};
        for (const auto &[weight, other] : shared[j])
            lamps.push_back(other);
        const auto size = Eigen::Index(4 * lamps.size());
        Eigen::MatrixXd part(size, size);
        for (Eigen::Index row = 0; row < size; ++row)
            for (Eigen::Index column = 0; column < size; ++column)
                part(row, column) = double(normal.coeff(Eigen::Index(4 * lamps[std::size_t(row / 4)]) + row % 4,
                                                        Eigen::Index(4 * lamps[std::size_t(column / 4)]) + column % 4));
        part.diagonal() = part.diagonal() * (1 + kRidge) + Eigen::VectorXd::Constant(size, 1e-3);
        const Eigen::LLT<Eigen::MatrixXd> factors(part);
        if (factors.info() != Eigen::Success)
            return; // unknown, so the lamp counts as needed
        const Eigen::MatrixXd inverse = factors.solve(Eigen::MatrixXd::Identity(size, 4));
        const Eigen::Index rest = size - 3; // without the position of the lamp itself
        const Eigen::MatrixXd atRest =
            part.bottomRightCorner(rest, rest).llt().solve(Eigen::MatrixXd::Identity(rest, 1));
        variances[j] = {inverse.topLeftCorner(3, 3).trace(), inverse(3, 3), atRest(0, 0)};
    });
    return variances;
}

std::vector<LampFit::Spread> LampFit::Spreads() const {
    std::vector<Spread> spreads;
    const std::vector<Variance> variances = Variances();
    for (std::size_t j = 0; j < lamps_.size(); ++j) {
        // The three channels, each with the noise of the places, are three measurements of the mean.
        const double noise = double(SlopeOf(columns_[j]).noise) / 3;
        spreads.push_back(
            {kStep * float(std::sqrt(noise * variances[j].position)), float(std::sqrt(noise * variances[j].strength))});
    }
    return spreads;
}

std::size_t LampFit::DropRedundant(double leastGain, float apart) {
    const std::vector<Variance> variances = Variances();
    std::vector<std::pair<double, std::size_t>> gains;
    for (std::size_t j = 0; j < lamps_.size(); ++j)
        gains.push_back({3 / variances[j].strengthAtRest / double(SlopeOf(columns_[j]).noise), j});
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

} // namespace q3
