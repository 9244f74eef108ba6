// GPL-2.0-or-later. Explanations as text for the log.
#include "q3map2/lightmap/explain/explain_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace q3 {

namespace {

/// Lights below this are counted only. Byte scale.
constexpr float kLeastShown = 0.05f;

std::string At(const Vec3f &p) {
    return fmt::format("{:g} {:g} {:g}", std::round(p.x * 100) / 100, std::round(p.y * 100) / 100,
                       std::round(p.z * 100) / 100);
}

std::string At(const Int3 &p) {
    return fmt::format("{} {} {}", p[0], p[1], p[2]);
}

std::string Bytes(const Vec3f &light) {
    return fmt::format("{:.1f} {:.1f} {:.1f}", light.x, light.y, light.z);
}

std::string Bytes(const std::array<std::uint8_t, 3> &bytes) {
    return fmt::format("{} {} {}", bytes[0], bytes[1], bytes[2]);
}

/// " of entity 5, light \"lamp\" (x.map:88)" or " of brush 3 of entity 0 (x.map:12)"; "" if nothing is known.
std::string Of(const SourcePlace &source) {
    if (source.entity < 0)
        return {};
    std::string text = " of ";
    if (source.primitive >= 0)
        text += fmt::format("brush {} of ", source.primitive);
    text += fmt::format("entity {}", source.entity);
    if (!source.className.empty())
        text += ", " + source.className;
    if (!source.targetName.empty())
        text += fmt::format(" \"{}\"", source.targetName);
    return source.location.empty() ? text : fmt::format("{} ({})", text, source.location);
}

std::string KindOf(const LightAccount &light) {
    switch (light.type) {
    case LightType::Point:
        return light.surface >= 0 ? "light of a sprite" : "point light";
    case LightType::Spot:
        return "spotlight";
    case LightType::Area:
        return "surface light";
    case LightType::Sun:
        break;
    }
    return light.parts > 1 ? "sun or sky" : "sun";
}

std::string NameOf(PointState state) {
    switch (state) {
    case PointState::Exterior:
        return "Exterior (far from open space, stays black)";
    case PointState::Open:
        return "Open (lit where it is)";
    case PointState::OnEmitter:
        return "OnEmitter (on a surface light)";
    case PointState::Beside:
        return "Beside (in the plane of a wall)";
    case PointState::Moved:
        return "Moved (lit from the nearest open place)";
    case PointState::Solid:
        return "Solid";
    case PointState::Filled:
        break;
    }
    return "Filled (from points around it)";
}

std::string NameOf(const LightAccount &light) {
    std::string text = light.negative ? "negative " + KindOf(light) : KindOf(light);
    if (light.parts > 1)
        text += fmt::format(" in {} parts", light.parts);
    if (light.surface >= 0)
        text += fmt::format(", surface {}, {}", light.surface, light.shader);
    text += Of(light.source);
    if (light.style != 0)
        text += fmt::format(", style {}", light.style);
    return light.type == LightType::Sun
               ? fmt::format("{}, from {}", text, At(light.origin))
               : fmt::format("{}, at {}, {:.0f} units away", text, At(light.origin), light.distance);
}

std::string TextOf(const Obstacle &obstacle) {
    switch (obstacle.kind) {
    case ObstacleKind::Brush:
        return fmt::format("brush {} of the .bsp, {}{}", obstacle.number, obstacle.shader, Of(obstacle.source));
    case ObstacleKind::Surface:
        return fmt::format("surface {}, {}{}", obstacle.number, obstacle.shader, Of(obstacle.source));
    case ObstacleKind::Prop:
        return fmt::format("part {} of the static props", obstacle.number);
    case ObstacleKind::SeeThrough:
        return "a see-through surface";
    case ObstacleKind::NoSky:
        return "no sky of this light";
    case ObstacleKind::Outside:
        break;
    }
    return "the outside of the map";
}

/// Why a light gives nothing; "" if it arrives.
std::string ReasonOf(const LightAccount &light) {
    switch (light.fate) {
    case LightFate::Arrives:
        return {};
    case LightFate::Blocked:
        return "in shadow";
    case LightFate::InSolid:
        return "it is inside a solid" + (light.inside ? ": " + TextOf(*light.inside) : std::string());
    case LightFate::NotForGrids:
        return "it does not light grids, by its spawnflags";
    case LightFate::NotForSurfaces:
        return "it does not light surfaces, by its spawnflags";
    case LightFate::Styled:
        return "it has a style, which the SH grid cannot hold";
    case LightFate::NotSun:
        return "-sunonly";
    case LightFate::HiddenByVis:
        return "the visibility data hides it from here";
    case LightFate::OutOfReach:
        return "it does not reach so far";
    case LightFate::OutsideCone:
        return "outside of its cone";
    case LightFate::BehindEmitter:
        return "behind the emissive surface";
    case LightFate::FacesAway:
        return "the surface faces away from it";
    case LightFate::TooFaint:
        break;
    }
    return "it gives nothing, or less than its tolerance";
}

class Report {
  public:
    Report(const Explanation &of, const ReportLimits &limits) : of_(of), limits_(limits) {}

    std::string Text() {
        AddPlace();
        if (of_.place.litFrom) {
            Line("Lights at {}. Light on a surface that faces the light, byte scale; visible share:",
                 At(*of_.place.litFrom));
            AddLights(of_.lights);
        }
        if (!of_.grid.empty())
            AddGrid();
        if (!of_.legacy.empty())
            AddLegacy();
        if (of_.luxel)
            AddLuxel(*of_.luxel);
        else
            Line("No lightmapped surface in front of the point is within reach");
        if (of_.bounces)
            Line("Bounced light is not computed here; what is stored has it");
        return std::move(text_);
    }

  private:
    template <typename... Args> void Line(fmt::format_string<Args...> format, Args &&...args) {
        text_ += fmt::format(format, std::forward<Args>(args)...) + '\n';
    }
    void AddPlace();
    void AddLights(const std::vector<LightAccount> &lights);
    void AddNothing(const std::vector<const LightAccount *> &lights);
    void AddGrid();
    void AddGridPoint(const GridPointAccount &point);
    void AddGroups(const GridPointAccount &point);
    void AddLegacy();
    void AddLuxel(const LuxelAccount &luxel);
    void AddSample(const SampleAccount &sample, const Vec3f &normal);

    const Explanation &of_;
    const ReportLimits &limits_;
    std::string text_;
};

void Report::AddPlace() {
    const PlaceAccount &place = of_.place;
    const std::string where = fmt::format("leaf {}, cluster {}, area {}", place.leaf, place.cluster, place.area);
    if (!place.solid)
        return Line("{}: in the open, {}", At(place.point), where);
    Line("{}: in a solid, {}, {}", At(place.point), TextOf(*place.solid), where);
    if (!place.litFrom)
        Line("No open space is within 2 units of it, so no lights are asked for at the point itself");
}

void Report::AddLights(const std::vector<LightAccount> &lights) {
    std::size_t shown = 0, rest = 0;
    Vec3f restLight;
    std::vector<const LightAccount *> nothing;
    for (const LightAccount &light : lights) {
        if (light.fate != LightFate::Arrives && light.fate != LightFate::Blocked) {
            nothing.push_back(&light);
            continue;
        }
        if (shown >= limits_.lights || MaxComponent(light.unshadowed) < kLeastShown) {
            ++rest;
            restLight += light.arriving * (light.negative ? -1.0f : 1.0f);
            continue;
        }
        ++shown;
        Line("  {:7.1f} {:3.0f} %  {}", MaxComponent(light.unshadowed), 100 * light.Visible(), NameOf(light));
        for (const Obstacle &obstacle : light.obstacles)
            Line("                 in the way{}: {}, at {}, {:.0f} units from here",
                 obstacle.fraction < 1 ? fmt::format(" of {:.0f} % of what is lost", 100 * obstacle.fraction) : "",
                 TextOf(obstacle), At(obstacle.at), obstacle.length);
    }
    if (shown == 0)
        Line("  none");
    if (rest > 0)
        Line("  {} more, weaker, of which {} arrives", rest, Bytes(restLight));
    AddNothing(nothing);
}

/// Lights that give nothing, with the reason; those beyond the limit are counted by reason.
void Report::AddNothing(const std::vector<const LightAccount *> &lights) {
    if (lights.empty())
        return;
    Line("  Lights that give nothing here, nearest first:");
    std::map<std::string, int> more;
    for (std::size_t i = 0; i < lights.size(); ++i)
        if (i < limits_.nothing)
            Line("    {}: {}", NameOf(*lights[i]), ReasonOf(*lights[i]));
        else {
            LightAccount plain = *lights[i];
            plain.inside.reset();
            ++more[ReasonOf(plain)];
        }
    for (const auto &[reason, count] : more)
        Line("    {} more: {}", count, reason);
}

void Report::AddGrid() {
    Line("SH grid, corners of the cell. Light: mean over all directions, byte scale:");
    for (const GridPointAccount &point : of_.grid)
        AddGridPoint(point);
}

void Report::AddGridPoint(const GridPointAccount &point) {
    Line("  point {} at {}, {:.0f} % of the blend: {}{}", At(point.point), At(point.position), 100 * point.weight,
         NameOf(point.state), point.solid ? ", in " + TextOf(*point.solid) : "");
    if (point.litFrom)
        Line("    lit from {}, {:.1f} units away: {:.1f}", At(*point.litFrom), Length(*point.litFrom - point.position),
             point.traced);
    if (!point.sources.empty()) {
        const std::size_t others = point.sources.size() - std::min(point.sources.size(), limits_.sources);
        Line("    filled from {} lit points in {}{}:", point.sources.size(),
             point.groups > 1 ? fmt::format("{} groups that do not see each other", point.groups)
                              : std::string("one group"),
             others > 0 ? fmt::format("; {} with less share are not listed", others) : "");
    }
    AddGroups(point);
    for (std::size_t i = 0; i < std::min(point.sources.size(), limits_.sources); ++i) {
        const SourceAccount &source = point.sources[i];
        Line("      {:3.0f} %  group {}, point {} lit from {}: {:.1f}", 100 * source.fraction, source.group + 1,
             At(source.point), At(source.litFrom), source.light);
    }
    Line("    before the fit {:.1f}, after {:.1f}, in the map {}", point.filled, point.fitted,
         point.stored ? fmt::format("{:.1f}", *point.stored) : "none");
}

/// Share and light of each side of the walls around a filled point.
void Report::AddGroups(const GridPointAccount &point) {
    for (int group = 0; group < point.groups && point.groups > 1; ++group) {
        float fraction = 0, light = 0;
        int points = 0;
        for (const SourceAccount &source : point.sources)
            if (source.group == group)
                fraction += source.fraction, light += source.fraction * source.light, ++points;
        Line("      group {}: {} points, {:.0f} % of the value, light {:.1f}", group + 1, points, 100 * fraction,
             fraction > 0 ? light / fraction : 0);
    }
}

void Report::AddLegacy() {
    Line("Legacy grid, corners of the cell. Ambient and directed light, bytes:");
    for (const LegacyPointAccount &point : of_.legacy) {
        const std::string from = !point.litFrom ? std::string("in a solid, not lit")
                                 : *point.litFrom == point.position
                                     ? std::string("lit where it is")
                                     : fmt::format("lit from {}, {:.1f} units away", At(*point.litFrom),
                                                   Length(*point.litFrom - point.position));
        Line("  point {} at {}, {:.0f} % of the blend: {}", At(point.point), At(point.position), 100 * point.weight,
             from);
        const auto both = [](const bspGridPoint_t &p) {
            return fmt::format("{}, {}", Bytes(p.ambient[0]), Bytes(p.directed[0]));
        };
        Line("    direct light {}; in the map {}", both(point.now), point.stored ? both(*point.stored) : "none");
    }
}

void Report::AddLuxel(const LuxelAccount &luxel) {
    Line("Nearest luxel: surface {}, {}{}, {:.1f} units away", luxel.surface, luxel.shader, Of(luxel.source),
         luxel.distance);
    if (luxel.page >= 0)
        Line("  page {}, texel {} {}; center {} on the surface, which faces {}", luxel.page, luxel.texel[0],
             luxel.texel[1], At(luxel.center), At(luxel.normal));
    for (const SampleAccount &sample : luxel.samples)
        AddSample(sample, luxel.normal);
    if (luxel.fromNeighbors)
        Line("  none of its positions is in the open: it takes the mean of its neighbors");
    if (luxel.isInWall)
        Line("  its center is in a wall: it takes the least light of the sides of that wall");
    Line("  dirt {:.2f}, ambient {}", luxel.dirt, Bytes(luxel.ambient));
    Line("  direct light with dirt, before tone mapping {}; in the map {}",
         luxel.direct ? Bytes(*luxel.direct) : "none", luxel.stored ? Bytes(*luxel.stored) : "none");
    Line("  Lights on the luxel, on its own normal, byte scale; visible share:");
    AddLights(luxel.lights);
}

void Report::AddSample(const SampleAccount &sample, const Vec3f &normal) {
    const std::string_view kind = sample.kind == SampleKind::Center ? "position" : "  sample";
    if (sample.position && sample.kind == SampleKind::Center) {
        const Vec3f off = *sample.position - sample.wanted;
        const float lifted = Dot(off, normal), aside = Length(off - normal * lifted);
        Line("  {} {}, lifted {:.1f} units and moved {:.1f} aside: light {}", kind, At(*sample.position), lifted, aside,
             Bytes(sample.light));
    } else if (sample.position)
        Line("  {} {}: light {}", kind, At(*sample.position), Bytes(sample.light));
    else
        Line("  {} {}: not lit, {}", kind, At(sample.wanted),
             sample.solid ? "in or behind " + TextOf(*sample.solid)
                          : std::string("no surface passes there, or its cluster does not see the surface"));
}

} // namespace

std::string ReportOf(const Explanation &explanation, const ReportLimits &limits) {
    return Report(explanation, limits).Text();
}

} // namespace q3
