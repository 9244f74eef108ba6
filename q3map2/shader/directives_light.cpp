// GPL-2.0-or-later. Directives of shader scripts: suns, skies, and surfaces that emit or reflect light.
#include "q3map2/shader/shader_directive.h"

#include "common/text/text.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace q3 {

namespace {

using Words = DirectiveWords;

// Limits of this program, chosen.
constexpr int kMaxSkyIterations = 128, kMinSkyIterations = 2; ///< N of q3map_skyLight, which makes 4 (N - 1)^2 + 1 suns
constexpr std::size_t kMaxSuns = 256; ///< of a shader: a chain of q3map_baseShader adds up its suns

template <typename T> void AddSunOrSkyLight(DirectiveContext &c, std::vector<T> &suns, const T &sun) {
    if (suns.size() < kMaxSuns)
        suns.push_back(sun);
    else
        c.log.Warn("too many suns", "{}: shader {}: more than {} suns, the others are left out", c.location.Text(),
                   c.shader.info.name, kMaxSuns);
    c.ApplyParm("sky");
}

/// The sun takes the light style and filter radius that earlier directives of this shader set.
std::string Sun(DirectiveContext &c, Words words) {
    constexpr double kRadiansPerDegree = std::numbers::pi / 180;
    const double azimuth = double(Number(words[4])) * kRadiansPerDegree,
                 elevation = double(Number(words[5])) * kRadiansPerDegree;
    SunDirective sun;
    sun.color = c.Color(words);
    sun.photons = Number(words[3]);
    sun.direction = Vec3f(
        Vec3d{std::cos(azimuth) * std::cos(elevation), std::sin(azimuth) * std::cos(elevation), std::sin(elevation)});
    if (words.size() == 7)
        c.log.Warn("incomplete shader directive", "{}: shader {}: a sun with a deviance but no samples",
                   c.location.Text(), c.shader.info.name);
    if (words.size() > 7) {
        sun.deviance = float(double(Number(words[6])) * kRadiansPerDegree);
        sun.samples = std::max(1, IntegerFromText(words[7]));
    }
    sun.filterRadius = c.shader.info.lightFilterRadius;
    sun.style = c.shader.info.lightStyle;
    c.shader.lateLines.clear(); // this sun uses them
    AddSunOrSkyLight(c, c.shader.info.suns, sun);
    return {};
}

std::string SkyLight(DirectiveContext &c, Words words) {
    SkyLightDirective sky;
    sky.value = std::max(0.0f, Number(words[0]));
    sky.iterations = std::max(kMinSkyIterations, IntegerFromText(words[1]));
    if (sky.iterations > kMaxSkyIterations) {
        c.log.Warn("sky light iterations", "{}: shader {}: {} sky light iterations are limited to {}",
                   c.location.Text(), c.shader.info.name, sky.iterations, kMaxSkyIterations);
        sky.iterations = kMaxSkyIterations;
    }
    if (words.size() > 2)
        sky.horizonMin = std::clamp(IntegerFromText(words[2]), -90, 90);
    if (words.size() > 3)
        sky.horizonMax = std::clamp(IntegerFromText(words[3]), -90, 90);
    if (words.size() > 4)
        sky.sampleColor = IntegerFromText(words[4]) != 0;
    AddSunOrSkyLight(c, c.shader.info.skyLights, sky);
    return {};
}

std::string SkyParms(DirectiveContext &c, Words words) {
    if (words[0] == "-" || EqualNoCase(words[0], "full"))
        return {};
    c.shader.info.skyImageBase = words[0];
    if (c.shader.lightImage.empty())
        c.shader.lightImage = c.shader.info.skyImageBase + "_up";
    return {};
}

/// Notes the line of a directive that suns before it do not take.
void NoteLate(DirectiveContext &c, std::string_view directive) {
    if (!c.shader.info.suns.empty())
        c.shader.lateLines.push_back({std::string(directive), c.location.Text()});
}

std::string FilterRadius(DirectiveContext &c, Words words) {
    c.shader.info.lightmapFilterRadius = Number(words[0]);
    c.shader.info.lightFilterRadius = Number(words[1]);
    if (c.shader.info.lightmapFilterRadius == 0)
        NoteLate(c, "q3map_lightmapFilterRadius");
    return {};
}

std::string LightStyle(DirectiveContext &c, Words words) {
    c.shader.info.lightStyle = std::clamp(IntegerFromText(words[0]), 0, 255);
    NoteLate(c, "q3map_lightStyle");
    return {};
}

std::string LightImage(DirectiveContext &c, Words words) {
    c.shader.lightImage = WithoutExtension(words[0]);
    c.shader.lightImageGiven = true;
    return {};
}

std::string LightRgb(DirectiveContext &c, Words words) {
    c.shader.info.color = c.Color(words);
    c.shader.colorGiven = true;
    return {};
}

template <float ShaderInfo::*field> std::string SetNumber(DirectiveContext &c, Words words) {
    c.shader.info.*field = Number(words[0]);
    return {};
}

template <bool ShaderInfo::*flag> std::string SetFlag(DirectiveContext &c, Words) {
    c.shader.info.*flag = true;
    return {};
}

std::string LightSubdivide(DirectiveContext &c, Words words) {
    c.shader.info.lightSubdivide = float(IntegerFromText(words[0]));
    return {};
}

std::string Backsplash(DirectiveContext &c, Words words) {
    constexpr float kPercent = 0.01f;
    c.shader.info.backsplashFraction = Number(words[0]) * kPercent;
    c.shader.info.backsplashDistance = Number(words[1]);
    return {};
}

constexpr std::array kSky = std::to_array<ShaderDirective>({
    {{.name = "q3map_sunExt",
      .values = "R G B I DEGREES ELEVATION [DEVIANCE] [SAMPLES]",
      .kind = SettingKind::Number,
      .initial = "none",
      .help = "Adds a sun: a surface that faces it gets I of 255, times the cosine of the angle to it",
      .details = "The color is divided by its largest component. DEGREES are where the sun stands, counted from +X "
                 "(0) to +Y (90); ELEVATION is its height above the horizon. SAMPLES (1, at most 4096) suns of "
                 "I/SAMPLES each, within DEVIANCE degrees around the direction, make the edges of shadows soft. A sun "
                 "shines through surfaces with its own shader; `-onesky` lets it through any sky. Several suns add "
                 "up. It takes `q3map_lightStyle` and the second number of `q3map_lightmapFilterRadius` as the lines "
                 "before it set them: lines after it do not count for it. `-sky` scales it, "
                 "the key `_noshadersun` of the world turns it off."},
     "light",
     Sun,
     RestOfLine::Directives},
    {{.name = "q3map_sun",
      .aliases = {"sun"},
      .values = "R G B I DEGREES ELEVATION",
      .kind = SettingKind::Number,
      .initial = "none",
      .help = "Adds a sun with sharp shadows, as q3map_sunExt does"},
     "light",
     Sun,
     RestOfLine::Directives},
    {{.name = "q3map_skyLight",
      .values = "V N [MIN] [MAX] [SAMPLE]",
      .kind = SettingKind::Number,
      .initial = "none",
      .help = "Adds light from the whole sky: 0.5 V to 0.63 V of 255 on an open floor, by N",
      .details = "The light comes from 4(N − 1)² + 1 suns, where N is from 2 to 128; each has V · max(1/4, (MAX − "
                 "MIN)/90) divided by their number. On a floor without anything around it that is 0.506 V for N = 2, "
                 "0.540 V for 4, 0.589 V for 8 and 0.613 V for 16; a wall gets 0.18 V to 0.25 V. MIN (0) and MAX (90) "
                 "limit the elevation, from −90 to 90 degrees. With SAMPLE 1 (the default) the colors are those of "
                 "the six sky images of `skyParms`, with 0 the color of the shader. Rays cost time in proportion to "
                 "the number of suns. `-sky` scales it. Filter radius and light style count from any line of the "
                 "shader."},
     "light",
     SkyLight},
    {{.name = "skyParms",
      .values = "IMAGES HEIGHT INNER",
      .kind = SettingKind::Text,
      .initial = "none",
      .help = "Names the six images of a sky, IMAGES_up and so on, whose colors q3map_skyLight takes",
      .details = "All six must exist, `_lf _rt _ft _bk _up _dn`, or the sky light has the color of the shader, with a "
                 "warning. IMAGES_up is the light image unless another is named. `-` and `full` name no images."},
     "light",
     SkyParms},
});

constexpr std::array kEmission = std::to_array<ShaderDirective>({
    {{.name = "q3map_surfaceLight",
      .values = "N",
      .kind = SettingKind::Number,
      .initial = "0",
      .help = "Lets surfaces emit light: 0.75 N of 255 on a receiver that sees nothing else",
      .details = "A receiver gets 0.75 N F of the light color, where F is the form factor: the share of its "
                 "hemisphere, weighted by the cosine, that the surface covers. Far from a surface of area A that is "
                 "0.24 N A cos α cos β / d², with the angles α and β of both surfaces to the line between them. So "
                 "surfaceLight 100 on a panel of 256 × 256 units gives 18 at 256 units in front of it. 0 and less "
                 "emit nothing. A nodraw surface is not in the map and emits nothing. `-area` scales it."},
     "light",
     SetNumber<&ShaderInfo::surfaceLight>},
    {{.name = "q3map_lightRGB",
      .values = "R G B",
      .kind = SettingKind::Number,
      .initial = "mean of the light image",
      .help = "Color of the light that the shader emits; divided by its largest component",
      .details = "It is also the color of sky light without sampled images, of flares, and of what a shader without "
                 "an image reflects."},
     "light",
     LightRgb},
    {{.name = "q3map_lightImage",
      .values = "IMAGE",
      .kind = SettingKind::Text,
      .initial = "that of the first stage or of editors",
      .help = "Image whose mean is the color of emitted light, and whose texels filter and reflect light",
      .details = "Without it: the image of the first stage, if no `qer_editorImage` or `implicitMap` stands before "
                 "it; else the editor image, or the image with the shader's name."},
     "light",
     LightImage},
    {{.name = "q3map_lightSubdivide",
      .values = "N",
      .kind = SettingKind::Integer,
      .unit = "game units",
      .initial = "999",
      .help = "Cuts emitting surfaces into pieces of at most this length",
      .details = "Smaller pieces are tested for visibility one by one, so shadows of large panels get smoother and "
                 "the light stage takes longer."},
     "light",
     LightSubdivide},
    {{.name = "q3map_backsplash",
      .values = "PERCENT DISTANCE",
      .kind = SettingKind::Number,
      .initial = "5 23",
      .help = "Lights the wall around an emitting surface by a second, reversed light in front of it",
      .details = "That light stands DISTANCE game units in front of the surface and has 7 · PERCENT/100 of its "
                 "light. PERCENT 0 turns it off; skies have none. The default is that of `-backsplash`."},
     "light",
     Backsplash},
    {{.name = "q3map_lightStyle",
      .values = "N",
      .kind = SettingKind::Integer,
      .initial = "0",
      .range = {0, 255},
      .help = "Light style of the light that the shader emits, and of its flares",
      .details = "0 and 255 are constant light. Suns take the style that lines before them set; sky light and "
                 "emitting surfaces take it from any line."},
     "both",
     LightStyle},
    {{.name = "q3map_bounceScale",
      .aliases = {"q3map_bounce"},
      .values = "F",
      .kind = SettingKind::Number,
      .initial = "1",
      .help = "Factor of the light that surfaces reflect under -bounce; 0 and less reflect nothing",
      .details = "The light image is what is reflected, by `-bouncescale` and `-bouncecolorratio`."},
     "light",
     SetNumber<&ShaderInfo::bounceScale>},
    {{.name = "q3map_noFast",
      .help = "Keeps the faint light of these surfaces, however far away, where -fast would leave it out"},
     "light",
     SetFlag<&ShaderInfo::noFast>},
    {{.name = "q3map_forceSunlight", .help = "Lets suns shine on vertices through everything; luxels are not changed"},
     "light",
     SetFlag<&ShaderInfo::forceSunlight>},
    {{.name = "q3map_lightmapFilterRadius",
      .values = "OWN OTHERS",
      .kind = SettingKind::Number,
      .unit = "game units",
      .initial = "0 0",
      .help = "Blurs light in lightmaps: OWN all light on these surfaces, OTHERS the light of this shader's sky",
      .details = "OTHERS counts for the suns that stand below the line and for all `q3map_skyLight` of the shader. "
                 "Between `q3map_sunExt` and `q3map_skyLight` it blurs the sky light and leaves the shadows of the sun "
                 "sharp. Emitting surfaces (`q3map_surfaceLight`) are not blurred."},
     "light",
     FilterRadius},
});

} // namespace

DirectiveGroup SkyDirectives() {
    return {"Sky and suns",
            "Suns and sky light shine if a drawn surface of the map has the shader. `q3map_sun`, `q3map_sunExt` and "
            "`q3map_skyLight` also set surfaceparm sky.",
            kSky};
}

DirectiveGroup EmissionDirectives() {
    return {"Emitted and reflected light", "", kEmission};
}

void WarnOfLateLines(const ParsedShader &shader, Log &log) {
    for (const LateLine &line : shader.lateLines) {
        const bool usedBySky = !shader.info.skyLights.empty();
        const bool usedBySurface = shader.info.surfaceLight > 0 && line.directive == "q3map_lightStyle";
        if (!usedBySky && !usedBySurface)
            log.Warn("line after q3map_sun",
                     "{}: shader {}: {} has no effect on the sun above it, and nothing else uses it; put it before "
                     "q3map_sun or q3map_sunExt",
                     line.location, shader.info.name, line.directive);
    }
}

} // namespace q3
