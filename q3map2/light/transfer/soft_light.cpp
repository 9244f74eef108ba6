// GPL-2.0-or-later. Soft shadows on surfaces (-areashadows): how many rays see how much of a light.
#include "q3map2/light/transfer/soft_light.h"

#include "libs/math/sampling.h"
#include "q3map2/light/transfer/light_kernel.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace q3 {

namespace {

std::uint64_t HashOf(const Vec3f &p) {
    const auto bits = [](float value) { return std::uint64_t(std::bit_cast<std::uint32_t>(value)); };
    return HashIndex(bits(p.x) ^ HashIndex(bits(p.y) ^ HashIndex(bits(p.z))));
}

} // namespace

LaneMask SoftBatch::Seeing() const {
    return Vectorize([&]() Q3_INLINE {
        LaneMask sees;
        for (const std::size_t i : kEachLane)
            sees[i] = seen[i] > 0 ? incident.live[i] : 0;
        return sees;
    });
}

LaneMask SoftBatch::Hidden() const {
    return Vectorize([&]() Q3_INLINE {
        LaneMask hides;
        for (const std::size_t i : kEachLane)
            hides[i] = seen[i] < whole[i] ? incident.live[i] : 0;
        return hides;
    });
}

LaneMask SoftBatch::Disagreeing() const {
    return Seeing().Any() && Hidden().Any() ? incident.live : LaneMask{};
}

LaneMask SoftLight::FindInSight(const SurfaceReceiverBatch &receivers) const {
    return InSight(light_, settings_.TracesShadowsOf(light_) || light_.type != LightType::Sun, receivers, counts_);
}

void SoftLight::Cast(RayPacket &rays) const {
    scene_.TraceSurfaceToLight(rays, settings_.receiveShadows, counts_);
}

/// To be called before the first ray with a tint is added.
void SoftLight::SetTinted(SoftBatch &batch) {
    if (!batch.incident.tinted)
        batch.seenColor = {batch.seen, batch.seen, batch.seen};
    batch.incident.tinted = true;
}

void SoftLight::AddRay(const RayPacket &traced, std::size_t ray, std::size_t receiver, float strength, float vector,
                       SoftBatch &batch) {
    batch.incident.filtered[receiver] |= traced.filtered[ray];
    if (traced.tinted)
        SetTinted(batch);
    if (traced.live[ray] == 0)
        return;
    batch.seen[receiver] += strength;
    batch.seenFluence[receiver] += vector;
    batch.seenVector.Set(receiver, batch.seenVector[receiver] + traced.direction[ray] * vector);
    if (batch.incident.tinted) {
        const Vec3f tint = traced.tinted ? traced.tint[ray] : Vec3f{1, 1, 1};
        batch.seenColor.Set(receiver, batch.seenColor[receiver] + tint * strength);
    }
}

/// Adds traced rays of the receivers in `lanes` to the sums.
void SoftLight::Count(const PointRays &to, const LaneMask &lanes, SoftBatch &batch) const {
    Vectorize([&]() Q3_INLINE {
        if (to.rays.tinted)
            SetTinted(batch);
        for (const std::size_t i : kEachLane) {
            const bool arrived = to.rays.live[i] != 0;
            const float vector = arrived ? to.vector[i] : 0;
            batch.whole[i] += lanes[i] != 0 ? to.strength[i] : 0;
            batch.seen[i] += arrived ? to.strength[i] : 0;
            batch.seenFluence[i] += vector;
            batch.seenVector.x[i] += to.rays.direction.x[i] * vector;
            batch.seenVector.y[i] += to.rays.direction.y[i] * vector;
            batch.seenVector.z[i] += to.rays.direction.z[i] * vector;
        }
        if (!batch.incident.tinted)
            return;
        for (std::size_t i = 0; i < batch.receivers->count; ++i) {
            if (lanes[i] == 0 || !(to.strength[i] > 0))
                continue;
            const Vec3f color = (IsColored() ? to.color[i] : Vec3f{1, 1, 1}) * to.strength[i];
            batch.wholeColor.Set(i, batch.wholeColor[i] + color);
            if (to.rays.live[i] != 0)
                batch.seenColor.Set(i, batch.seenColor[i] + (to.rays.tinted ? color * to.rays.tint[i] : color));
        }
    });
}

void SoftLight::CastAndCount(const LaneMask &lanes, PointRays &to, SoftBatch &batch) const {
    for (const std::size_t i : kEachLane)
        to.rays.live[i] &= lanes[i];
    Cast(to.rays);
    for (const std::size_t i : kEachLane)
        batch.incident.filtered[i] |= to.rays.filtered[i];
    Count(to, lanes, batch);
}

bool SoftLight::Start(SurfaceReceiverBatch &receivers, SoftReceivers kind, SoftBatch &batch) const {
    SurfaceIncidentLight &incident = batch.incident;
    batch.receivers = &receivers, batch.kind = kind;
    incident.tinted = IsColored();
    incident.filtered = {};
    incident.live = FindInSight(receivers);
    const int inSight = incident.live.Count();
    if (inSight == 0)
        return false;
    SetUnshadowed(batch);
    counts_.skippedUnlit += std::uint64_t(inSight - incident.live.Count());
    if (!incident.live.Any() || !ApplyFaintSelection(light_, settings_.faint, 1, receivers, incident, counts_))
        return false;
    batch.whole = batch.seen = batch.seenFluence = {};
    batch.seenVector = batch.wholeColor = batch.seenColor = {};
    batch.rays = 0;
    if (!settings_.TracesShadowsOf(light_))
        return true;
    batch.seed = HashOf(receivers.position[0]);
    const int factor = kind == SoftReceivers::Places ? 2 : 1;
    const int rays = FirstRays(Strongest(incident) * MaxAbsComponent(Color()), factor);
    PointRays to;
    for (; batch.rays < rays; ++batch.rays) {
        Aim(batch, std::uint32_t(batch.rays), to);
        CastAndCount(incident.live, to, batch);
    }
    return true;
}

/// Gives receivers whose rays all went to points below their horizon the mean share of the batch; all of the light, if
/// there are no others.
void SoftLight::FillUntried(SoftBatch &batch) {
    LaneMask untried{};
    float whole = 0, seen = 0;
    Vec3f wholeColor, seenColor;
    for (std::size_t i = 0; i < batch.receivers->count; ++i) {
        if (batch.incident.live[i] == 0)
            continue;
        untried.Set(i, !(batch.whole[i] > 0));
        whole += batch.whole[i], seen += batch.seen[i];
        wholeColor += batch.wholeColor[i], seenColor += batch.seenColor[i];
    }
    if (!(whole > 0))
        whole = seen = 1, wholeColor = seenColor = {1, 1, 1};
    for (unsigned lanes = untried.Bits(); lanes != 0; lanes &= lanes - 1) {
        const auto i = std::size_t(std::countr_zero(lanes));
        batch.whole[i] = whole, batch.seen[i] = seen;
        batch.wholeColor.Set(i, wholeColor), batch.seenColor.Set(i, seenColor);
        batch.seenVector.Set(i, batch.vector[i] * seen), batch.seenFluence[i] = batch.fluence[i] * seen;
    }
}

/// Multiplies the strengths by the shares, and sets vectors, fluences and tints to those of the light that arrives.
/// Receivers that see nothing are live no longer.
void SoftLight::SetShares(SoftBatch &batch) const {
    Vectorize([&]() Q3_INLINE {
        SurfaceIncidentLight &incident = batch.incident;
        if (incident.tinted)
            for (std::size_t i = 0; i < batch.receivers->count; ++i) {
                if (incident.live[i] == 0 || batch.seen[i] <= 0)
                    continue;
                const Vec3f seen = batch.seenColor[i] / batch.seen[i];
                if (!IsColored()) {
                    incident.tint.Set(i, seen);
                    continue;
                }
                const Vec3f of = batch.wholeColor[i] / batch.whole[i], all = batch.color[i] / incident.strength[i];
                Vec3f tint;
                for (std::size_t channel = 0; channel < 3; ++channel)
                    tint[channel] = of[channel] > 0 ? all[channel] * seen[channel] / of[channel] : all[channel];
                incident.tint.Set(i, tint);
            }
        for (const std::size_t i : kEachLane) {
            const float seen = batch.seen[i], whole = batch.whole[i], divisor = whole > 0 ? whole : 1;
            incident.live[i] = seen > 0 ? incident.live[i] : 0;
            const bool partly = seen < whole;
            const float scale = 1 / (seen > 0 ? seen : 1);
            batch.vector.x[i] = partly ? batch.seenVector.x[i] * scale : batch.vector.x[i];
            batch.vector.y[i] = partly ? batch.seenVector.y[i] * scale : batch.vector.y[i];
            batch.vector.z[i] = partly ? batch.seenVector.z[i] * scale : batch.vector.z[i];
            batch.fluence[i] = partly ? batch.seenFluence[i] * scale : batch.fluence[i];
            incident.strength[i] *= std::min(1.0f, seen / divisor);
        }
    });
}

/// Sets `direction` to that of the light which arrives, and `directions`.
void SoftLight::SetDirections(SoftBatch &batch) const {
    Vectorize([&]() Q3_INLINE {
        SurfaceIncidentLight &incident = batch.incident;
        LightDirections &to = incident.directions;
        for (const std::size_t i : kEachLane) {
            const float vx = batch.vector.x[i], vy = batch.vector.y[i], vz = batch.vector.z[i];
            const auto [x, y, z, length] = DirectionOf(vx, vy, vz);
            incident.direction.x[i] = x, incident.direction.y[i] = y, incident.direction.z[i] = z;
            incident.undirected[i] = length > 0 ? 0 : -1;
            to.vector.x[i] = vx, to.vector.y[i] = vy, to.vector.z[i] = vz;
            const float directed = vx * batch.normal.x[i] + vy * batch.normal.y[i] + vz * batch.normal.z[i];
            to.uniform[i] = std::max(0.0f, 1 - directed);
            to.spread[i] = length > 0 ? batch.fluence[i] / length : 1;
        }
    });
}

void SoftLight::Finish(SoftBatch &batch, const LaneMask &doubtful) const {
    if (settings_.TracesShadowsOf(light_)) {
        LaneMask asking = doubtful;
        for (const std::size_t i : kEachLane)
            asking[i] |= batch.whole[i] > 0 ? 0 : batch.incident.live[i];
        CastMoreRays(batch, asking);
        FillUntried(batch);
        SetShares(batch);
    } else if (IsColored())
        for (std::size_t i = 0; i < batch.receivers->count; ++i)
            if (batch.incident.live[i] != 0)
                batch.incident.tint.Set(i, batch.color[i] / batch.incident.strength[i]);
    SetDirections(batch);
}

void SoftLight::Evaluate(SurfaceReceiverBatch &receivers, SurfaceIncidentLight &incident) const {
    SoftBatch batch;
    const bool any = Start(receivers, SoftReceivers::Places, batch);
    if (any)
        Finish(batch, batch.Disagreeing());
    incident = batch.incident;
    if (!any)
        incident.live = {};
}

} // namespace q3
