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
      .help = "Adds a sun that gives the light I, in 8-bit levels, to a surface that faces it",
      .details = "The light of other surfaces is I times the cosine of the angle to the sun. The color R G B is "
                 "divided by its largest component. DEGREES is where the sun stands, counted from +X (0) to +Y (90). "
                 "ELEVATION is its height above the horizon in degrees. SAMPLES suns with I/SAMPLES each, within "
                 "DEVIANCE degrees around the direction, make the edges of shadows soft. The default of SAMPLES is 1, "
                 "and at most 4096 count. Light of the sun passes surfaces that have this shader, or any sky under "
                 "`-onesky`. Several suns add up. The sun takes `q3map_lightStyle` and the second number of "
                 "`q3map_lightmapFilterRadius` from lines before it, but not from lines after it. The option `-sky` "
                 "scales the light, and the key `_noshadersun` of the world turns it off. Also sets surfaceparm sky.",
      .since = "q3map2",
      .example = "1 0.95 0.85 120 45 60 3 16"},
     "light",
     Sun,
     RestOfLine::Directives},
    {{.name = "q3map_sun",
      .aliases = {"sun"},
      .values = "R G B I DEGREES ELEVATION",
      .kind = SettingKind::Number,
      .initial = "none",
      .help = "Adds a sun with sharp shadows, whose values mean the same as those of q3map_sunExt",
      .details = "Also sets surfaceparm sky.",
      .since = "q3map2",
      .example = "1 0.95 0.85 120 45 60"},
     "light",
     Sun,
     RestOfLine::Directives},
    {{.name = "q3map_skyLight",
      .values = "V N [MIN] [MAX] [SAMPLE]",
      .kind = SettingKind::Number,
      .initial = "none",
      .help = "Adds light from the whole sky, which gives an open floor 0.5 V to 0.63 V in 8-bit levels, by N",
      .details = "The light comes from 4(N − 1)² + 1 suns, where N is from 2 to 128. Each sun has V · max(1/4, (MAX − "
                 "MIN)/90) divided by their number. A floor without anything around it gets 0.506 V for N = 2, 0.540 V "
                 "for 4, 0.589 V for 8 and 0.613 V for 16. A wall gets 0.18 V to 0.25 V. MIN and MAX limit the "
                 "elevation of the suns, from −90 to 90 degrees, and default to 0 and 90. With SAMPLE 1, the default, "
                 "the colors are those of the six sky images of `skyParms`, and with 0 that of the shader. The time "
                 "for rays grows in proportion to the number of suns. The option `-sky` scales the light. The filter "
                 "radius and the light style may be set on any line of the shader. Also sets surfaceparm sky.",
      .since = "q3map2",
      .example = "80 5"},
     "light",
     SkyLight},
    {{.name = "skyParms",
      .values = "IMAGES HEIGHT INNER",
      .kind = SettingKind::Text,
      .initial = "none",
      .help = "Names the six images of a sky, IMAGES_up and so on, whose colors q3map_skyLight takes",
      .details =
          "The six images end with `_lf`, `_rt`, `_ft`, `_bk`, `_up` and `_dn`. If one is missing, which is a warning, "
          "sky light has the color of the shader. The image IMAGES_up is also the light image, unless another one is "
          "named. The words `-` and `full` name no images. HEIGHT and INNER are for the engine only.",
      .since = "q3map2",
      .example = "env/mymap/dusk 512 -"},
     "light",
     SkyParms},
});

constexpr std::array kEmission = std::to_array<ShaderDirective>({
    {{.name = "q3map_surfaceLight",
      .values = "N",
      .kind = SettingKind::Number,
      .initial = "0",
      .help = "Makes surfaces emit light that gives 0.75 N, in 8-bit levels, to a receiver that sees nothing else",
      .details = "A receiver gets 0.75 N F times the light color. F is the form factor, which is the fraction of the "
                 "receiver's hemisphere that the surface covers, weighted by the cosine. Far from a surface of area A "
                 "the light is 0.24 N A cos α cos β / d². The angles α and β are those of both surfaces to the line "
                 "between them. So 100 on a panel of 256 × 256 units gives 18 at 256 units in front of it, and 2000 "
                 "gives 359. A value of 0 or less emits nothing. A nodraw surface is not in the map, so it emits "
                 "nothing. The option `-area` scales the light.",
      .since = "q3map2",
      .example = "2000"},
     "light",
     SetNumber<&ShaderInfo::surfaceLight>},
    {{.name = "q3map_lightRGB",
      .values = "R G B",
      .kind = SettingKind::Number,
      .initial = "mean of the light image",
      .help = "Sets the color of the light that the shader emits, which is divided by its largest component",
      .details = "It is also the color of sky light without sampled images, of flares, and of what a shader without an "
                 "image reflects.",
      .since = "q3map2",
      .example = "1 0.8 0.5"},
     "light",
     LightRgb},
    {{.name = "q3map_lightImage",
      .values = "IMAGE",
      .kind = SettingKind::Text,
      .initial = "that of the first stage or of editors",
      .help =
          "Names the light image, whose mean is the color of emitted light and whose texels filter and reflect light",
      .details = "Without this line it is the image of the first stage, if no `qer_editorImage` or `implicitMap` comes "
                 "before the stage. Otherwise it is the editor image or the image with the shader's name.",
      .since = "q3map2",
      .example = "textures/mymap/panel_glow"},
     "light",
     LightImage},
    {{.name = "q3map_lightSubdivide",
      .values = "N",
      .kind = SettingKind::Integer,
      .unit = "game units",
      .initial = "999",
      .help = "Cuts emitting surfaces into pieces of at most this length",
      .details = "Each piece is tested for visibility, so small pieces make the shadows of large panels smoother and "
                 "the light stage slower.",
      .since = "q3map2",
      .example = "128"},
     "light",
     LightSubdivide},
    {{.name = "q3map_backsplash",
      .values = "PERCENT DISTANCE",
      .kind = SettingKind::Number,
      .initial = "5 23",
      .help = "Lights the wall around an emitting surface by a second, reversed light in front of it",
      .details = "That light is DISTANCE game units in front of the surface and has 7 · PERCENT/100 of its light. A "
                 "PERCENT of 0 turns it off. Skies have none. The option `-backsplash` changes the default.",
      .since = "q3map2",
      .example = "0 0"},
     "light",
     Backsplash},
    {{.name = "q3map_lightStyle",
      .values = "N",
      .kind = SettingKind::Integer,
      .initial = "0",
      .range = {0, 255},
      .help = "Sets the light style of the light that the shader emits, and of its flares",
      .details = "The styles 0 and 255 are constant light. Suns take the style that lines before them set, while sky "
                 "light and emitting surfaces take it from any line.",
      .since = "q3map2",
      .example = "2"},
     "both",
     LightStyle},
    {{.name = "q3map_bounceScale",
      .aliases = {"q3map_bounce"},
      .values = "F",
      .kind = SettingKind::Number,
      .initial = "1",
      .help = "Multiplies the light that surfaces reflect under -bounce, where 0 and less reflect nothing",
      .details = "Surfaces reflect the color of their light image, scaled by `-bouncescale` and mixed with gray by "
                 "`-bouncecolorratio`.",
      .since = "q3map2",
      .example = "0.5"},
     "light",
     SetNumber<&ShaderInfo::bounceScale>},
    {{.name = "q3map_noFast",
      .help = "Keeps the faint light of these surfaces, however far away, where -fast would leave it out",
      .since = "q3map2"},
     "light",
     SetFlag<&ShaderInfo::noFast>},
    {{.name = "q3map_forceSunlight",
      .help = "Lets the light of suns reach vertices through everything, but not luxels",
      .since = "q3map2"},
     "light",
     SetFlag<&ShaderInfo::forceSunlight>},
    {{.name = "q3map_lightmapFilterRadius",
      .values = "OWN OTHERS",
      .kind = SettingKind::Number,
      .unit = "game units",
      .initial = "0 0",
      .help = "Blurs lightmaps: OWN for all light on these surfaces, OTHERS for the light of this shader's sky",
      .details = "OTHERS applies to suns on later lines and to every `q3map_skyLight` of the shader. Between "
                 "`q3map_sunExt` and `q3map_skyLight`, this line blurs the sky light and leaves the shadows of the sun "
                 "sharp. Light of emitting surfaces (`q3map_surfaceLight`) is not blurred by OTHERS.",
      .since = "q3map2",
      .example = "0 8"},
     "light",
     FilterRadius},
});

} // namespace

DirectiveGroup SkyDirectives() {
    return {"Sky and suns",
            "Suns and sky light need a drawn surface of the map that has the shader. The directives `q3map_sun`, "
            "`q3map_sunExt` and `q3map_skyLight` also set surfaceparm sky.",
            kSky};
}

DirectiveGroup EmissionDirectives() {
    return {"Emitted and reflected light", "These directives set the light that surfaces emit and reflect.", kEmission};
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
