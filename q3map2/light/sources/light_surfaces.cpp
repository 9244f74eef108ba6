// GPL-2.0-or-later. Lights that shaders make of surfaces, and texlights of .rad files.
#include "q3map2/light/sources/light_surfaces.h"

#include "common/text/text.h"
#include "libs/math/winding.h"
#include "q3map2/bspfile/light_keys.h"
#include "q3map2/light/scene/surface_table.h"
#include "q3map2/light/sources/hidden_lights.h"
#include "q3map2/light/sources/light_sources.h"
#include "q3map2/light/sources/light_suns.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace q3 {

// ---- Texlights: .rad files ----

namespace {

constexpr std::string_view kTextures = "textures/";

/// Takes the next word off the front of a line; empty at its end.
std::string_view TakeWord(std::string_view &line) {
    while (!line.empty() && IsBlank(line.front()))
        line.remove_prefix(1);
    const auto end = std::size_t(std::find_if(line.begin(), line.end(), IsBlank) - line.begin());
    const std::string_view word = line.substr(0, end);
    line.remove_prefix(end);
    return word;
}

/// Takes `prefix` off the front, ignoring case; whether it was there.
bool TakePrefix(std::string_view &text, std::string_view prefix) {
    if (!StartsWithNoCase(text, prefix))
        return false;
    text.remove_prefix(prefix.size());
    return true;
}

/// Lower case, with '/' between folders.
std::string PlainName(std::string_view name) {
    std::string plain = LowerCase(name);
    std::replace(plain.begin(), plain.end(), '\\', '/');
    return plain;
}

std::string WithoutFileExtension(std::string name) {
    const std::size_t dot = name.find_last_of("./");
    return dot != std::string::npos && name[dot] == '.' ? name.substr(0, dot) : name;
}

std::string MaterialName(std::string_view name) {
    std::string plain = PlainName(name);
    return plain.starts_with(kTextures) ? plain.substr(kTextures.size()) : plain;
}

/// Whether "_-12" or the like ends the name; takes it off.
bool TakeNumberAtEnd(std::string_view &name) {
    const std::size_t bar = name.find_last_of('_');
    if (bar == std::string_view::npos || !StrictInteger(name.substr(bar + 1)))
        return false;
    name = name.substr(0, bar);
    return true;
}

/// Copies of materials that a compiler made for the cube maps of a map, maps/MAP/x/y_X_Y_Z, are named by the original.
/// Empty: it is no such copy.
std::string OriginalName(std::string_view material) {
    constexpr std::string_view kMaps = "maps/";
    if (!material.starts_with(kMaps))
        return {};
    const std::size_t slash = material.find('/', kMaps.size());
    if (slash == std::string_view::npos)
        return {};
    std::string_view name = material.substr(slash + 1);
    for (int axis = 0; axis < 3; ++axis)
        if (!TakeNumberAtEnd(name))
            return {};
    return std::string(name);
}

} // namespace

/// One line of a file without its comment.
struct TexLights::Line {
    std::string_view text, file;
    int number = 0;
    std::string Where() const { return fmt::format("{}:{}", file, number); }
};

void TexLights::Read(std::string_view text, std::string_view file, bool hdr, Log &log) {
    Line line{.text = {}, .file = file};
    while (!text.empty()) {
        const std::size_t end = std::min(text.find('\n'), text.size());
        line.text = text.substr(0, end);
        line.text = line.text.substr(0, line.text.find("//"));
        ++line.number;
        text.remove_prefix(std::min(end + 1, text.size()));
        ReadLine(line, hdr, log);
    }
}

void TexLights::ReadLine(const Line &line, bool hdr, Log &log) {
    std::string_view rest = line.text, word = TakeWord(rest);
    for (const bool ofHdr : {true, false})
        if (TakePrefix(word, ofHdr ? "hdr:" : "ldr:")) {
            if (ofHdr != hdr)
                return;
            if (word.empty())
                word = TakeWord(rest);
            break;
        }
    if (word.empty())
        return;
    if (EqualNoCase(word, "lightscale"))
        return ReadScale({rest, line.file, line.number}, log);
    const bool noShadow = EqualNoCase(word, "noshadow"), textureShadow = EqualNoCase(word, "forcetextureshadow");
    if (!noShadow && !textureShadow)
        return ReadLight({rest, line.file, line.number}, word, hdr, log);
    const std::string_view name = TakeWord(rest);
    if (name.empty())
        log.Warn("line of a .rad file", "{}: {}: expected the name of a {} after it; the line is not used",
                 line.Where(), word, noShadow ? "material" : "model");
    else if (noShadow)
        noShadow_.push_back(WithoutFileExtension(MaterialName(name)));
    else
        textureShadow_.insert(WithoutFileExtension(PlainName(name)));
}

void TexLights::ReadLight(const Line &line, std::string_view name, bool hdr, Log &log) {
    const auto refuse = [&](std::string_view expected) {
        log.Warn("line of a .rad file", "{}: {}: expected {}; the line is not used", line.Where(), name, expected);
    };
    std::vector<double> numbers;
    std::string_view rest = line.text;
    for (std::string_view word = TakeWord(rest); !word.empty(); word = TakeWord(rest)) {
        const std::optional<double> number = StrictNumber(word);
        if (!number)
            return refuse(fmt::format("numbers after the name, not \"{}\"", word));
        numbers.push_back(*number);
    }
    if (numbers.size() != 3 && numbers.size() != 4 && numbers.size() != 8)
        return refuse(fmt::format("a color, R G B, and a brightness, once or twice, not {} numbers", numbers.size()));
    LightQuad quad{0, 0, 0, 255};
    std::copy_n(numbers.begin(), std::min<std::size_t>(numbers.size(), 4), quad.begin());
    // A negative number in the second four means: as the first.
    if (hdr && numbers.size() == 8 && *std::min_element(numbers.begin() + 4, numbers.end()) >= 0)
        std::copy_n(numbers.begin() + 4, 4, quad.begin());
    if (*std::min_element(quad.begin(), quad.end()) < 0)
        return refuse("numbers of at least 0");
    const Vec3d light = LinearColor(quad) * quad[3];
    if (!(MaxComponent(light) <= keys::kMaxIntensity))
        return refuse(fmt::format("light of at most {:g}", keys::kMaxIntensity));
    TexLight &entry = lights_[MaterialName(name)];
    if (!entry.where.empty())
        log.Warn("texlight given twice", "{}: {}: this line counts, not {}", line.Where(), name, entry.where);
    entry = {Vec3f(light), line.Where()};
}

void TexLights::ReadScale(const Line &line, Log &log) {
    std::string_view rest = line.text;
    const std::string_view name = TakeWord(rest);
    const std::optional<double> factor = StrictNumber(TakeWord(rest));
    if (name.empty() || !factor || *factor < 0 || *factor > keys::kMaxIntensity)
        log.Warn("line of a .rad file",
                 "{}: lightscale: expected the name of a material and a factor of at least 0; the line is not used",
                 line.Where());
    else
        SetScale(name, float(*factor));
}

float TexLights::ScaleOf(std::string_view shader) const {
    const auto found = scales_.find(MaterialName(shader));
    return found != scales_.end() ? found->second : 1;
}

void TexLights::SetScale(std::string_view shader, float scale) {
    scales_[MaterialName(shader)] = scale;
}

const TexLight *TexLights::Find(std::string_view shader) const {
    const std::string name = MaterialName(shader);
    auto found = lights_.find(name);
    if (found == lights_.end())
        found = lights_.find(OriginalName(name));
    return found != lights_.end() ? &found->second : nullptr;
}

bool TexLights::CastsNoShadow(std::string_view shader) const {
    const std::string name = MaterialName(shader);
    return std::any_of(noShadow_.begin(), noShadow_.end(),
                       [&](const std::string &part) { return name.find(part) != std::string::npos; });
}

bool TexLights::CastsTextureShadow(std::string_view model) const {
    return textureShadow_.contains(WithoutFileExtension(PlainName(model)));
}

void ApplyTexLights(const TexLights &lights, SurfaceTable &table, Log &log) {
    std::set<const ShaderInfo *> lit;
    for (SurfaceEntry &entry : table) {
        const ShaderInfo &shader = *entry.shader;
        if (lights.CastsNoShadow(shader.name))
            entry.castShadows = 0;
        entry.lightScale = lights.ScaleOf(shader.name);
        const TexLight *light = lights.Find(shader.name);
        if (!light)
            continue;
        entry.texLight = light->radiance;
        if (lit.insert(&shader).second && shader.surfaceLight > 0)
            log.Print("{}: {} counts, not q3map_surfaceLight {:g}\n", shader.name, light->where, shader.surfaceLight);
    }
    if (!lit.empty())
        log.Count(lit.size(), "shaders that .rad files make emissive");
}

// ---- Lights that shaders make of surfaces ----

namespace {

constexpr float kDefaultSubdivide = 999;              ///< of q3map_lightSubdivide. Game units
constexpr float kOnCut = 0.125f;                      ///< corners this near to a cut count as on it. Game units
constexpr double kMinArea = 1, kMaxArea = 20'000'000; ///< of a piece that emits. Square game units
/// A quad stays whole if its fourth corner is this near to the plane of the others. Game units.
constexpr float kFlatQuad = 0.1f;
/// Radiosity of an emitter of q3map_surfaceLight 1 if LightOptions::areaScale is 1, as in NetRadiant's q3map2. Byte
/// scale.
constexpr float kRadiosityOfOne = 3;
/// The same with the default of areaScale, 1/4.
constexpr float kDefaultRadiosityOfOne = 0.75f;
/// Factor of backsplashFraction in the light of a backsplash, as in NetRadiant's q3map2.
constexpr float kBacksplashScale = 7;
/// Larger values of q3map_surfaceLight count as this: products of them could overflow float.
constexpr float kMaxSurfaceLight = 1e9f;

using Polygon = std::vector<MeshVert>;

/// How a surface shines.
struct SurfaceEmission {
    float value = 0;            ///< as q3map_surfaceLight
    Vec3f color;                ///< largest component 1
    bool hasBacksplash = false; ///< lights its surroundings besides
};

/// By a texlight, else by its shader.
SurfaceEmission EmissionOf(const SurfaceEntry &entry) {
    const ShaderInfo &shader = *entry.shader;
    if (!entry.texLight)
        return {std::min(shader.surfaceLight * entry.lightScale, kMaxSurfaceLight), shader.color,
                shader.backsplashFraction > 0 && (shader.compileFlags & C_SKY) == 0};
    const float largest = MaxComponent(*entry.texLight);
    return {std::min(largest / kDefaultRadiosityOfOne * entry.lightScale, kMaxSurfaceLight),
            largest > 0 ? *entry.texLight / largest : Vec3f{1, 1, 1}, false};
}

/// The style of a light that a shader makes.
int StyleOf(const ShaderInfo &shader, const LightOptions &options) {
    constexpr int kNoStyle = 255; // as in the records of surfaces
    return options.noStyles || shader.lightStyle == kNoStyle ? 0 : shader.lightStyle;
}

MeshVert Lerp(const MeshVert &a, const MeshVert &b, float t) {
    return {a.xyz + (b.xyz - a.xyz) * t, Normalize(a.normal + (b.normal - a.normal) * t), {}};
}

/// Makes the area lights of one shader's polygons.
class AreaLightMaker {
  public:
    AreaLightMaker(const SurfaceEntry &entry, const SurfaceEmission &emission, const LightOptions &options,
                   const BspSpace &space, std::vector<Light> &lights, int &count, Log &log)
        : entry_(entry), shader_(*entry.shader), emission_(emission), options_(options), space_(space), lights_(lights),
          count_(count), log_(log) {}

    void Add(Polygon first) {
        if (!InTheWorld(first))
            return;
        const float limit = PieceSize(first);
        const std::size_t before = lights_.size();
        hidden_ = false;
        std::vector<Polygon> stack;
        stack.push_back(first);
        while (!stack.empty()) {
            const Polygon polygon = std::move(stack.back());
            stack.pop_back();
            if (polygon.size() < 3)
                continue;
            Boundsf box;
            for (const MeshVert &v : polygon)
                box.Add(v.xyz);
            std::size_t axis = 0;
            while (axis < 3 && !(box.maxs[axis] - box.mins[axis] > limit))
                ++axis;
            if (axis == 3) {
                AddLight(polygon, box);
                continue;
            }
            Polygon front, back;
            CutAcrossAxis(polygon, axis, box.Center()[axis], kOnCut, Lerp, front, back);
            stack.push_back(std::move(back));
            stack.push_back(std::move(front));
        }
        if (lights_.size() > before)
            shining_.push_back(std::move(first));
        else if (hidden_)
            covered_.push_back(std::move(first));
    }

    /// Warns of polygons that solids cover as a whole, unless they share a corner, directly or by way of others, with
    /// one that emits. Call it after the last Add.
    void WarnOfCovered() {
        for (std::size_t i = 0; i < shining_.size() && !covered_.empty(); ++i) {
            const auto touches = [&](const Polygon &other) { return ShareCorner(shining_[i], other); };
            std::copy_if(covered_.begin(), covered_.end(), std::back_inserter(shining_), touches);
            std::erase_if(covered_, touches);
        }
        for (const Polygon &polygon : covered_) {
            Boundsf box;
            for (const MeshVert &v : polygon)
                box.Add(v.xyz);
            const Vec3f center = box.Center();
            log_.Warn("surface light in solid",
                      "{}: the surface light at {:g} {:g} {:g}, of entity {}, is covered by a solid and lights "
                      "nothing; move what covers it, or give the face a shader without light",
                      shader_.name, center.x, center.y, center.z, entry_.entity);
        }
    }

  private:
    static bool ShareCorner(const Polygon &a, const Polygon &b) {
        return std::any_of(a.begin(), a.end(), [&](const MeshVert &v) {
            return std::any_of(b.begin(), b.end(), [&](const MeshVert &other) { return v.xyz == other.xyz; });
        });
    }
    bool InTheWorld(const Polygon &polygon) {
        for (const MeshVert &v : polygon)
            if (!IsFinite(v.xyz) || MaxAbsComponent(v.xyz) > kMaxLightCoordinate) {
                log_.Warn("light surface", "{}: a surface light with a corner at {:g} {:g} {:g} is left out",
                          shader_.name, v.xyz.x, v.xyz.y, v.xyz.z);
                return false;
            }
        return true;
    }

    /// Maximum side of a piece's bounding box: q3map_lightSubdivide, or more where that would make too many pieces.
    float PieceSize(const Polygon &polygon) {
        const float wanted = shader_.lightSubdivide > 0 ? shader_.lightSubdivide : kDefaultSubdivide;
        Winding<float> w;
        for (const MeshVert &v : polygon)
            w.push_back(v.xyz);
        const Boundsf box = WindingBounds(w);
        const float least = LeastPieceSize(w);
        if (wanted < least)
            log_.Warn("light subdivision",
                      "{}: q3map_lightSubdivide {:g} is too small for a surface of {:g} units, "
                      "{:g} is used",
                      shader_.name, wanted, double(MaxComponent(box.maxs - box.mins)), least);
        return std::max(wanted, least);
    }

    void AddLight(const Polygon &polygon, const Boundsf &box) {
        Light light;
        Vec3f normal;
        for (const MeshVert &v : polygon) {
            light.polygon.push_back(v.xyz);
            normal += v.normal;
        }
        const double area = WindingArea(light.polygon);
        light.normal = Normalize(normal);
        if (!(area >= kMinArea && area <= kMaxArea) || light.normal == Vec3f{})
            return;
        light.type = LightType::Area;
        light.color = emission_.color;
        light.photons = emission_.value * float(area) * options_.areaScale;
        light.radiosity = emission_.value * kRadiosityOfOne * options_.areaScale;
        light.style = StyleOf(shader_, options_);
        light.noFast = shader_.noFast;
        light.twoSided = shader_.twoSided || (shader_.compileFlags & C_FOG) != 0;
        light.origin = box.Center() + light.normal;
        light.dist = Dot(light.origin, light.normal);
        light.SetShape();
        if (light.style != 0)
            light.label = "light of shader " + shader_.name;
        const std::vector<Light> open = OpenAreaLights(std::move(light), space_);
        hidden_ = hidden_ || open.empty();
        for (const Light &part : open) {
            lights_.push_back(part);
            ++count_;
            if (emission_.hasBacksplash)
                AddBacksplash(part);
        }
    }

    /// Adds the backsplash: an area light in front of the emitter that faces it and lights its surroundings. No solid
    /// is between the two.
    void AddBacksplash(const Light &light) {
        Light splash = light;
        const Vec3f moved = light.normal * BacksplashDistance(light, shader_.backsplashDistance, space_);
        std::reverse(splash.polygon.begin(), splash.polygon.end());
        for (Vec3f &p : splash.polygon)
            p += moved;
        splash.photons *= kBacksplashScale * shader_.backsplashFraction;
        splash.radiosity *= kBacksplashScale * shader_.backsplashFraction;
        splash.origin = light.origin + moved;
        splash.normal = -light.normal;
        splash.dist = Dot(splash.origin, splash.normal);
        splash.SetShape();
        splash.twoSided = false;
        lights_.push_back(std::move(splash));
    }

    const SurfaceEntry &entry_;
    const ShaderInfo &shader_;
    const SurfaceEmission &emission_;
    const LightOptions &options_;
    const BspSpace &space_;
    std::vector<Light> &lights_;
    int &count_;
    Log &log_;
    bool hidden_ = false;                    ///< a piece of the polygon that is being added has no open part
    std::vector<Polygon> shining_, covered_; ///< polygons with lights; polygons without, which solids cover
};

void AddPatchLights(const Mesh &mesh, const Vec3f &offset, AreaLightMaker &maker) {
    for (int y = 0; y + 1 < mesh.height; ++y)
        for (int x = 0; x + 1 < mesh.width; ++x) {
            auto quad = MeshQuad(mesh, x, y);
            for (MeshVert &v : quad)
                v.xyz += offset;
            const Vec3f normal = Normalize(Cross(quad[2].xyz - quad[0].xyz, quad[1].xyz - quad[0].xyz));
            if (normal != Vec3f{} && std::abs(Dot(normal, quad[3].xyz - quad[0].xyz)) < kFlatQuad)
                maker.Add({quad.begin(), quad.end()});
            else {
                maker.Add({quad[0], quad[1], quad[2]});
                maker.Add({quad[0], quad[2], quad[3]});
            }
        }
}

void AddTriangleLights(const Bsp &bsp, const bspDrawSurface_t &surface, const Vec3f &offset, AreaLightMaker &maker) {
    for (int i = 0; i + 2 < surface.numIndexes; i += 3) {
        Polygon triangle;
        for (int k = 0; k < 3; ++k) {
            const int index = bsp.drawIndexes[std::size_t(surface.firstIndex + i + k)];
            const bspDrawVert_t &v = bsp.drawVerts[std::size_t(surface.firstVert + index)];
            triangle.push_back({Vec3f(v.xyz) + offset, Vec3f(v.normal), {}});
        }
        maker.Add(std::move(triangle));
    }
}

/// An autosprite surface is one point light.
Light SpriteLight(const Bsp &bsp, const bspDrawSurface_t &surface, const ShaderInfo &shader,
                  const SurfaceEmission &emission, const Vec3f &offset, const LightOptions &options) {
    Boundsf box;
    for (int i = 0; i < surface.numVerts; ++i)
        box.Add(Vec3f(bsp.drawVerts[std::size_t(surface.firstVert + i)].xyz) + offset);
    Light light;
    light.origin = surface.numVerts > 0 ? box.Center() : offset;
    light.photons = emission.value * options.pointScale;
    light.color = emission.color;
    light.style = StyleOf(shader, options);
    if (light.style != 0)
        light.label = "light of shader " + shader.name;
    light.noFast = shader.noFast;
    return light;
}

void WarnOfHiddenSprite(const Light &light, const SurfaceEntry &entry, const BspSpace &space, Log &log) {
    Vec3f origin = light.origin;
    if (NudgeIntoOpen(origin, space) >= 0)
        return;
    log.Warn("sprite light in solid",
             "{}: the light of the autosprite surface at {:g} {:g} {:g}, of entity {}, is inside a solid and lights "
             "nothing; move the surface into the open",
             entry.shader->name, light.origin.x, light.origin.y, light.origin.z, entry.entity);
}

/// Numbers the skies that shine and makes the lights of each once.
class SkyLights {
  public:
    SkyLights(const LightOptions &options, const WorldLight &world, ShaderLibrary &library, std::vector<Light> &lights,
              SurfaceLightCounts &counts, Log &log)
        : options_(options), world_(world), library_(library), lights_(lights), counts_(counts), log_(log) {}

    /// Number of the sky; -1, under -onesky: its suns shine through any sky.
    int Add(const SurfaceEntry &entry) {
        const ShaderInfo &shader = *entry.shader;
        const auto known = numbers_.find(&shader);
        if (known != numbers_.end())
            return known->second;
        const int number = options_.oneSky ? -1 : next_++;
        numbers_[&shader] = number;
        if (!world_.noShaderSun)
            for (const SunDirective &sun : shader.suns)
                AddSuns(entry, MakeSuns(sun, number, options_));
        for (const SkyLightDirective &sky : shader.skyLights)
            AddSuns(entry, MakeSky(SkyLightSuns(sky, shader, library_, log_), number));
        return number;
    }

  private:
    /// The lights of a sky: its directions are samples of one light.
    std::vector<Light> MakeSky(std::span<const SunDirective> directions, int number) const {
        std::vector<Light> sky;
        for (const SunDirective &direction : directions)
            for (Light &light : MakeSuns(direction, number, options_)) {
                light.sample = int(sky.size());
                sky.push_back(std::move(light));
            }
        return sky;
    }
    void AddSuns(const SurfaceEntry &entry, std::vector<Light> suns) {
        for (Light &light : suns) {
            light.photons *= entry.lightScale;
            if (light.style != 0)
                light.label = "sun or sky of shader " + entry.shader->name;
            lights_.push_back(std::move(light));
            ++counts_.skyLights;
        }
    }

    const LightOptions &options_;
    const WorldLight &world_;
    ShaderLibrary &library_;
    std::vector<Light> &lights_;
    SurfaceLightCounts &counts_;
    Log &log_;
    std::map<const ShaderInfo *, int> numbers_;
    int next_ = 0;
};

} // namespace

bool IsCollisionOnly(const Bsp &bsp, const SurfaceTable &table, std::size_t surface, std::uint32_t noDraw) {
    const bspDrawSurface_t &drawn = bsp.drawSurfaces[surface];
    const bspShader_t &record = bsp.shaders[std::size_t(drawn.shaderNum)];
    return drawn.surfaceType == MST_PATCH && (record.surfaceFlags & noDraw) != 0 &&
           (table[surface].shader->compileFlags & C_NODRAW) == 0;
}

std::vector<Light> SurfaceLights(const BspSpace &space, SurfaceTable &table, const LightOptions &options,
                                 const WorldLight &world, ShaderLibrary &library, SurfaceLightCounts &counts,
                                 Log &log) {
    const Bsp &bsp = space.Map();
    std::vector<Light> lights;
    SkyLights skies(options, world, library, lights, counts, log);
    std::size_t withSurface = 0; // number of lights whose surface is set
    const auto setSurface = [&](std::size_t surface) {
        for (; withSurface < lights.size(); ++withSurface)
            lights[withSurface].surface = int(surface);
    };
    for (std::size_t i = 0; i < table.size(); setSurface(i), ++i) { // after each surface, also one that is left early
        SurfaceEntry &entry = table[i];
        const ShaderInfo &shader = *entry.shader;
        if (!shader.suns.empty() || !shader.skyLights.empty())
            entry.skyIndex = skies.Add(entry);
        const SurfaceEmission emission = EmissionOf(entry);
        if (!(emission.value > 0) || IsCollisionOnly(bsp, table, i, options.noDrawSurfaceFlags))
            continue;
        const bspDrawSurface_t &surface = bsp.drawSurfaces[i];
        if (shader.autosprite) {
            lights.push_back(SpriteLight(bsp, surface, shader, emission, entry.origin, options));
            WarnOfHiddenSprite(lights.back(), entry, space, log);
            continue;
        }
        AreaLightMaker maker(entry, emission, options, space, lights, counts.areaLights, log);
        if (surface.surfaceType == MST_PATCH)
            AddPatchLights(TessellatePatch(bsp, surface, entry.longestCurve), entry.origin, maker);
        else if (surface.surfaceType == MST_PLANAR || surface.surfaceType == MST_TRIANGLE_SOUP)
            AddTriangleLights(bsp, surface, entry.origin, maker);
        maker.WarnOfCovered();
    }
    return lights;
}

} // namespace q3
