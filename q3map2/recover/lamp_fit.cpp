// GPL-2.0-or-later. Intensities of lamps by non-negative least squares, weights of observed light.
#include "q3map2/recover/lamp_fit.h"

#include <algorithm>
#include <cmath>

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
    for (const ObservedSurface &surface : map_.surfaces)
        for (std::size_t b = 0, first = surface.first; b < surface.batches.size();
             first += surface.batches[b++].count) {
            const auto from = contrast_.begin() + std::ptrdiff_t(first);
            const auto end = from + std::ptrdiff_t(surface.batches[b].count);
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
        AddToResiduals(columns_[j], lamps_[j].intensity * -1.0f);
}

void LampFit::AddToResiduals(const LampColumn &column, const Vec3f &intensity) {
    for (const auto &[place, light] : column)
        residuals_[place] += intensity * light;
}

Vec3f LampFit::EffectiveResidual(std::size_t place) const {
    return map_.light[place].Contradiction(residuals_[place]);
}

Vec3f LampFit::ResidualWithout(std::size_t j, const LampEntry &g) const {
    return map_.light[g.place].Contradiction(residuals_[g.place] + lamps_[j].intensity * g.light);
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
    float squares = 0;
    for (const auto &[place, light] : column) {
        const float weight = weights_[place];
        const Vec3f r = EffectiveResidual(place);
        slope.b += r * (weight * light);
        slope.a += weight * light * light;
        squares += weight * Dot(r, r);
    }
    if (!column.empty())
        slope.noise = std::max(1.0f, squares / (3 * float(column.size())));
    return slope;
}

void LampFit::SolveIntensities(int sweeps) {
    for (int sweep = 0; sweep < sweeps; ++sweep)
        for (std::size_t j = 0; j < lamps_.size(); ++j) {
            const Slope slope = SlopeOf(columns_[j]);
            if (!(slope.a > 0)) {
                lamps_[j].intensity = {};
                continue;
            }
            const Vec3f next = Max(lamps_[j].intensity + slope.b * (1 / slope.a), Vec3f{});
            AddToResiduals(columns_[j], lamps_[j].intensity - next);
            lamps_[j].intensity = next;
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

/// The part of Error at the places of a column.
double LampFit::ErrorAt(const LampColumn &column) const {
    double sum = 0;
    for (const auto &[place, light] : column) {
        const Vec3f r = EffectiveResidual(place);
        sum += double(weights_[place]) * double(Dot(r, r));
    }
    return sum;
}

double LampFit::RmsOfSurfaces() const {
    double sum = 0;
    for (std::size_t i = 0; i < map_.firstGrid; ++i) {
        const Vec3f r = EffectiveResidual(i);
        sum += double(Dot(r, r)) / 3;
    }
    return map_.firstGrid > 0 ? std::sqrt(sum / double(map_.firstGrid)) : 0;
}

void LampFit::Prune(double leastGain) {
    std::vector<Lamp> kept;
    std::vector<LampColumn> keptColumns;
    std::vector<float> keptDamping;
    for (std::size_t j = 0; j < lamps_.size(); ++j) {
        double gain = -ErrorAt(columns_[j]);
        for (const LampEntry &entry : columns_[j]) {
            const Vec3f without = ResidualWithout(j, entry);
            gain += double(weights_[entry.place]) * double(Dot(without, without));
        }
        if (gain <= leastGain * double(SlopeOf(columns_[j]).noise)) {
            AddToResiduals(columns_[j], lamps_[j].intensity);
            continue;
        }
        kept.push_back(lamps_[j]);
        keptDamping.push_back(damping_[j]);
        keptColumns.push_back(std::move(columns_[j]));
    }
    lamps_ = std::move(kept), columns_ = std::move(keptColumns), damping_ = std::move(keptDamping);
}

void LampFit::Merge(float distance) {
    for (std::size_t j = 0; j < lamps_.size(); ++j)
        for (std::size_t k = j + 1; k < lamps_.size(); ++k) {
            if (Length(lamps_[j].origin - lamps_[k].origin) > distance || !(lamps_[k].Strength() > 0) ||
                lamps_[j].cone || lamps_[k].cone)
                continue;
            const float a = lamps_[j].Strength(), b = lamps_[k].Strength();
            const Lamp mean{(lamps_[j].origin * a + lamps_[k].origin * b) / (a + b),
                            lamps_[j].intensity + lamps_[k].intensity};
            LampColumn column = Traced(mean);
            if (column.empty()) // it would be in a solid
                continue;
            lamps_[j] = mean, columns_[j] = std::move(column);
            lamps_[k].intensity = {};
        }
    UpdateResiduals();
}

} // namespace q3
