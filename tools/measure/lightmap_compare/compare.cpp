// GPL-2.0-or-later. Differences of the light of two files of one map.
#include "tools/measure/lightmap_compare/compare.h"

#include "common/error.h"
#include "tools/measure/lightmap_compare/luxel_cover.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace q3::compare {

namespace {

/// Largest difference that counts as close: mean of a surface, largest channel of a sample. Byte scale.
constexpr double kCloseSurface = 2;
constexpr double kCloseSample = 8;
/// Samples below this count as black: rounded coordinates mix in a trace of the next texel. Byte scale.
constexpr double kBlack = 0.5;

void CheckSameMap(const Bsp &a, const Bsp &b) {
    if (a.drawSurfaces.size() != b.drawSurfaces.size())
        throw Error("not the same map: {} and {} surfaces", a.drawSurfaces.size(), b.drawSurfaces.size());
    for (std::size_t i = 0; i < a.drawSurfaces.size(); ++i) {
        const bspDrawSurface_t &x = a.drawSurfaces[i], &y = b.drawSurfaces[i];
        if (x.firstVert != y.firstVert || x.numVerts != y.numVerts || x.firstIndex != y.firstIndex ||
            x.numIndexes != y.numIndexes || x.patchWidth != y.patchWidth)
            throw Error("not the same map: surface {} has {} and {} vertices, {} and {} indexes", i, x.numVerts,
                        y.numVerts, x.numIndexes, y.numIndexes);
    }
    if (a.drawVerts.size() != b.drawVerts.size() || a.drawIndexes != b.drawIndexes)
        throw Error("not the same map: {} and {} vertices, or other triangles", a.drawVerts.size(), b.drawVerts.size());
}

double Degrees(const Vec3d &a, const Vec3d &b) {
    return std::atan2(Length(Cross(a, b)), Dot(a, b)) * 180 / std::numbers::pi;
}

class Comparer {
  public:
    Comparer(const LitMap &a, const LitMap &b, int samples, ShaderLibrary *shaders)
        : a_(a), b_(b), coverA_(a), coverB_(b), samples_(samples), shaders_(shaders) {}

    Comparison Run(std::size_t worstCount) {
        for (std::size_t i = 0; i < a_.Map().drawSurfaces.size(); ++i) {
            const bool inA = a_.PageOf(i) >= 0, inB = b_.PageOf(i) >= 0;
            result_.lightmapped.Add(inA, inB);
            if (inA && inB)
                CompareLightmaps(i);
            if (inA == inB)
                CompareVertices(i, inA ? lightmapVertices_ : VertexSumFor(i));
        }
        result_.lightmaps = lightmaps_.Summary();
        result_.surfaces = surfaces_.Summary();
        result_.directions = directions_.Summary();
        result_.vertices = vertices_.Summary();
        result_.undrawnVertices = undrawnVertices_.Summary();
        result_.unseenVertices = unseenVertices_.Summary();
        result_.lightmapVertices = lightmapVertices_.Summary();
        std::stable_sort(result_.worst.begin(), result_.worst.end(),
                         [](const auto &x, const auto &y) { return x.spread.mean > y.spread.mean; });
        result_.worst.resize(std::min(result_.worst.size(), worstCount));
        return std::move(result_);
    }

  private:
    void CompareLightmaps(std::size_t surface) {
        Differences own;
        SurfaceDifference difference{surface, std::string(a_.ShaderOf(surface)), {}, {}, {}, {}};
        double worst = -1;
        std::size_t count = 0;
        const std::vector<SurfacePoint> points = PointsOn(a_.Map(), surface, samples_);
        for (const SurfacePoint &point : points) {
            if (IsBuried(a_.Map(), surface, point)) {
                ++result_.buried;
                continue;
            }
            if (!coverA_.Covers(surface, point) || !coverB_.Covers(surface, point)) {
                ++result_.uncovered;
                continue;
            }
            const Vec3d x = a_.Light(surface, point), y = b_.Light(surface, point);
            const bool litX = MaxComponent(x) >= kBlack, litY = MaxComponent(y) >= kBlack;
            result_.lit.Add(litX, litY);
            if (!litX || !litY)
                continue;
            own.Add(x, y), lightmaps_.Add(x, y);
            difference.a += x, difference.b += y, ++count;
            if (const double off = Length(x - y); off > worst)
                worst = off, difference.position = a_.Position(point);
            if (a_.Deluxe() && b_.Deluxe())
                directions_.Add(Degrees(a_.Direction(surface, point), b_.Direction(surface, point)));
        }
        if (count == 0)
            return;
        difference.spread = own.Summary();
        difference.a = difference.a / double(count), difference.b = difference.b / double(count);
        surfaces_.Add(difference.spread.mean);
        result_.byArea.Add(AreaOf(a_.Map(), surface) * double(count) / double(points.size()), difference.spread);
        ++result_.surfacesCompared;
        result_.surfacesWithin2 += difference.spread.mean <= kCloseSurface;
        result_.worst.push_back(std::move(difference));
    }

    /// The sum that vertices of a surface without lightmap belong to.
    Differences &VertexSumFor(std::size_t surface) {
        if (IsUndrawn(a_.Map(), surface))
            return undrawnVertices_;
        const bool seen = !shaders_ || DrawsVertexColors(shaders_->Get(a_.ShaderOf(surface)));
        return seen ? vertices_ : unseenVertices_;
    }

    void CompareVertices(std::size_t surface, Differences &differences) const {
        const bspDrawSurface_t &s = a_.Map().drawSurfaces[surface];
        const auto color = [](const LitMap &map, int vertex) {
            const auto &c = map.Map().drawVerts[std::size_t(vertex)].color[0];
            return Vec3d{double(c[0]), double(c[1]), double(c[2])};
        };
        for (int v = s.firstVert; v < s.firstVert + s.numVerts; ++v)
            differences.Add(color(a_, v), color(b_, v));
    }

    const LitMap &a_, &b_;
    const LuxelCover coverA_, coverB_;
    int samples_;
    ShaderLibrary *shaders_;
    Comparison result_;
    Differences lightmaps_, surfaces_, directions_, vertices_, undrawnVertices_, unseenVertices_, lightmapVertices_;
};

std::string Line(std::string_view name, const Spread &s) {
    if (s.count == 0)
        return fmt::format("{}: none\n", name);
    return fmt::format("{}: {}, mean {:.2f}{}, within 8 {:.2f} %, 95th {:.1f}, 99th {:.1f}, worst {:.1f}\n", name,
                       s.count, s.mean, s.bias ? fmt::format(" (A - B {:+.2f})", *s.bias) : "", 100 * s.within8,
                       s.percentile95, s.percentile99, s.worst);
}

nlohmann::json Json(const Spread &s) {
    nlohmann::json json{{"count", s.count},      {"mean", s.mean},        {"within8", s.within8},
                        {"p95", s.percentile95}, {"p99", s.percentile99}, {"worst", s.worst}};
    if (s.bias)
        json["bias"] = *s.bias;
    return json;
}

nlohmann::json Json(const PresenceCounts &s) {
    return {{"both", s.both}, {"onlyA", s.onlyA}, {"onlyB", s.onlyB}, {"neither", s.neither}};
}

nlohmann::json Json(const Vec3d &v) {
    return nlohmann::json::array({v.x, v.y, v.z});
}

} // namespace

void Differences::Add(const Vec3d &a, const Vec3d &b) {
    const Vec3d d = a - b;
    hasColors_ = true;
    sum_ += (std::abs(d.x) + std::abs(d.y) + std::abs(d.z)) / 3;
    signedSum_ += (d.x + d.y + d.z) / 3;
    largest_.push_back(float(std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)})));
}

void Differences::Add(double difference) {
    sum_ += std::abs(difference);
    largest_.push_back(float(std::abs(difference)));
}

void AreaSpread::Add(double ownArea, const Spread &own) {
    if (!(ownArea > 0))
        return;
    area += ownArea;
    mean += (own.mean - mean) * ownArea / area;
    within8 += (own.within8 - within8) * ownArea / area;
}

Spread Differences::Summary() const {
    Spread s;
    s.count = largest_.size();
    if (s.count == 0)
        return s;
    std::vector<float> sorted = largest_;
    std::sort(sorted.begin(), sorted.end());
    const auto at = [&](double share) { return double(sorted[std::size_t(std::ceil(share * double(s.count))) - 1]); };
    s.mean = sum_ / double(s.count);
    if (hasColors_)
        s.bias = signedSum_ / double(s.count);
    s.within8 =
        double(std::upper_bound(sorted.begin(), sorted.end(), float(kCloseSample)) - sorted.begin()) / double(s.count);
    s.percentile95 = at(0.95), s.percentile99 = at(0.99), s.worst = sorted.back();
    return s;
}

Comparison Compare(const LitMap &a, const LitMap &b, int samplesASurface, std::size_t worstCount,
                   ShaderLibrary *shaders) {
    CheckSameMap(a.Map(), b.Map());
    return Comparer(a, b, samplesASurface, shaders).Run(worstCount);
}

std::string ToText(const Comparison &c) {
    std::string text = fmt::format("surfaces with lightmap in both {}, only in A {}, only in B {}, in neither {}\n",
                                   c.lightmapped.both, c.lightmapped.onlyA, c.lightmapped.onlyB, c.lightmapped.neither);
    text += Line("lightmap samples", c.lightmaps);
    // A sample that is lit in B only is black in A only.
    text += fmt::format("  left out: in solids {}, without a luxel {}, black in A only {}, in B only {}, in both {}\n",
                        c.buried, c.uncovered, c.lit.onlyB, c.lit.onlyA, c.lit.neither);
    text += fmt::format("  by area: mean {:.2f}, within 8 {:.2f} %\n", c.byArea.mean, 100 * c.byArea.within8);
    text += Line("means of surfaces", c.surfaces);
    text += fmt::format("  {} of {} surfaces within 2\n", c.surfacesWithin2, c.surfacesCompared);
    if (c.directions.count > 0)
        text += Line("light directions, degrees", c.directions);
    text += Line("vertex colors without lightmap", c.vertices);
    if (c.undrawnVertices.count > 0)
        text += Line("  left out: those of skies and undrawn surfaces", c.undrawnVertices);
    if (c.unseenVertices.count > 0)
        text += Line("  left out: those that their shader does not draw", c.unseenVertices);
    text += Line("vertex colors with lightmap", c.lightmapVertices);
    for (const SurfaceDifference &one : c.worst)
        text +=
            fmt::format("surface {:5} mean {:6.2f} at ({:.0f} {:.0f} {:.0f}) A {:.0f} {:.0f} {:.0f} B {:.0f} {:.0f} "
                        "{:.0f} {}\n",
                        one.surface, one.spread.mean, one.position.x, one.position.y, one.position.z, one.a.x, one.a.y,
                        one.a.z, one.b.x, one.b.y, one.b.z, one.shader);
    return text;
}

std::string ToJson(const Comparison &c) {
    nlohmann::json worst = nlohmann::json::array();
    for (const SurfaceDifference &one : c.worst)
        worst.push_back({{"surface", one.surface},
                         {"shader", one.shader},
                         {"place", Json(one.position)},
                         {"difference", Json(one.spread)},
                         {"a", Json(one.a)},
                         {"b", Json(one.b)}});
    const nlohmann::json all{
        {"lightmapped", Json(c.lightmapped)},
        {"litSamples", Json(c.lit)},
        {"lightmaps", Json(c.lightmaps)},
        {"byArea", {{"area", c.byArea.area}, {"mean", c.byArea.mean}, {"within8", c.byArea.within8}}},
        {"surfaces", Json(c.surfaces)},
        {"surfacesCompared", c.surfacesCompared},
        {"surfacesWithin2", c.surfacesWithin2},
        {"directions", Json(c.directions)},
        {"vertices", Json(c.vertices)},
        {"undrawnVertices", Json(c.undrawnVertices)},
        {"unseenVertices", Json(c.unseenVertices)},
        {"lightmapVertices", Json(c.lightmapVertices)},
        {"worst", worst}};
    return all.dump(2) + "\n";
}

} // namespace q3::compare
