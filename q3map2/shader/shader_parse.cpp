// GPL-2.0-or-later. From script text to shaders, before any image is read.
#include "q3map2/shader/shader_parse.h"

#include "common/text/text.h"
#include "q3map2/shader/engine_directives.h"
#include "q3map2/shader/shader_color.h"
#include "q3map2/shader/shader_geometry.h"
#include "q3map2/shader/shader_text.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

namespace q3 {

namespace {

constexpr int kMaxSkyIterations = 128;
constexpr std::size_t kMaxSuns = 256; // per shader; a chain of q3map_baseShader adds up its suns
constexpr std::size_t kMaxName = 63;
constexpr int kMaxPageSide = 8192;
constexpr std::string_view kHiddenSuffix = ":q3map"; // hides a definition from the engine

/// Known words that the parser skips without a warning; the light stage looks for style markers in the script text.
constexpr std::array<std::string_view, 6> kDirectivesWithoutEffect = {"q3map_novertexshadows", "q3map_patchshadows",
                                                                      "q3map_rnmmaps",         "q3map_stylemarker",
                                                                      "q3map_stylemarker2",    "q3map_vertexshadows"};

/// Whether the word in lower case equals `lower`.
bool IsWord(std::string_view word, std::string_view lower) {
    return word.size() == lower.size() && (word[0] | 0x20) == lower[0] && EqualNoCase(word, lower);
}

class ScriptParser {
  public:
    ScriptParser(TextScanner &scanner, ShaderTable &table, Log &log)
        : scanner_(scanner), hasIncludes_(scanner.HasIncludes()), table_(table), log_(log) {}

    void ParseScript() {
        for (std::string_view token; scanner_.Next(token);) {
            const std::string name(token);
            std::string_view brace;
            if (!scanner_.Next(brace)) {
                WarnSyntax(name, "the end of the file");
                return;
            }
            if (brace == "{") {
                ParseShaders(name);
            } else {
                WarnSyntax(name, brace);
                scanner_.PushBack(); // perhaps the name of the next shader
            }
        }
    }

  private:
    using Words = std::vector<std::string_view>;
    struct Directive {
        std::string_view name; ///< lower case
        std::size_t required, optional;
        void (ScriptParser::*apply)(const Words &);
        bool moreMayFollow = false; ///< other directives may follow on the line
    };
    static const std::array<Directive, 46> kDirectives;

    void WarnSyntax(std::string_view name, std::string_view found) {
        log_.Warn("shader syntax", "{}: expected {{ after the shader name {}, found {}",
                  scanner_.TokenLocation().Text(), name, found);
    }
    /// A name that was found where it has no place; empty: none.
    using NextShader = std::string;
    void ParseShaders(std::string_view name);
    NextShader ParseShader(std::string_view name);
    NextShader ParseBody(bool &hasStages);
    NextShader ParseStage();
    NextShader MissingBrace(const TextLocation &begin, std::string_view what, std::string_view found);
    bool IsNextShader(std::string_view word) const;
    void FindStageImage(std::string_view name, std::string &image);
    void ParseDirective(std::string_view word);
    void RunDirective(const Directive &directive, std::string_view word);
    void RunDirective(const GeometryDirective &directive, std::string_view word);
    void WarnIncomplete(const TextLocation &location, std::string_view word, std::size_t expected);
    bool ApplyParm(std::string_view name);
    bool NoImageYet() const {
        return shader_->editorImage.empty() && shader_->lightImage.empty() && shader_->implicitImage.empty();
    }
    Vec3f Color(const Words &words) const;
    template <typename T> void AddSunOrSkyLight(std::vector<T> &suns, const T &sun) {
        if (suns.size() < kMaxSuns)
            suns.push_back(sun);
        else
            log_.Warn("too many suns", "{}: shader {}: more than {} suns, the others are left out",
                      scanner_.TokenLocation().Text(), shader_->info.name, kMaxSuns);
        ApplyParm("sky");
    }

    void SurfaceParmLine(const Words &words);
    void Cull(const Words &words);
    void DeformVertexes(const Words &words) { ApplyDeform(shader_->info, words); }
    const std::string &ImplicitImage(const Words &words);
    void ImplicitMap(const Words &words) { shader_->info.implicitMap = ImplicitImage(words); }
    void ImplicitMask(const Words &words) { shader_->info.implicitMask = ImplicitImage(words); }
    void ImplicitBlend(const Words &words) { shader_->info.implicitBlend = ImplicitImage(words); }
    void SkyParms(const Words &words);
    void EditorImage(const Words &words) { shader_->editorImage = WithoutExtension(words[0]); }
    void LightImage(const Words &words) { shader_->lightImage = WithoutExtension(words[0]); }
    void LightRgb(const Words &words);
    void SurfaceLight(const Words &words) { shader_->info.surfaceLight = Number(words[0]); }
    void LightSubdivide(const Words &words);
    void Backsplash(const Words &words);
    void LightStyle(const Words &words) { shader_->info.lightStyle = std::clamp(IntegerFromText(words[0]), 0, 255); }
    void BounceScale(const Words &words) { shader_->info.bounceScale = Number(words[0]); }
    void NoFast(const Words &) { shader_->info.noFast = true; }
    void ForceSunlight(const Words &) { shader_->info.forceSunlight = true; }
    void VertexScale(const Words &words);
    void FilterRadius(const Words &words);
    void Sun(const Words &words);
    void SkyLight(const Words &words);
    void BaseShader(const Words &words);
    void DeprecateShader(const Words &words) { shader_->replacement = words[0]; }
    void Material(const Words &words);
    void VertexLighting(const Words &) { ApplyParm("pointlight"); }

    LightmapDirectives &Lightmap() { return shader_->info.lightmap; }
    void SampleSize(const Words &words) { Lightmap().sampleSize = std::max(0, IntegerFromText(words[0])); }
    void SampleOffset(const Words &words) { Lightmap().sampleOffset = Number(words[0]); }
    void LightmapAxis(const Words &words);
    void LightmapSize(const Words &words);
    void LightmapBrightness(const Words &words);
    void Mergable(const Words &) { Lightmap().mergable = true; }
    void SplotchFix(const Words &) { Lightmap().splotchFix = true; }
    void NoDirt(const Words &) { Lightmap().noDirt = true; }
    void NoVertexLight(const Words &) { Lightmap().noVertexLight = true; }
    void ShadeAngle(const Words &words) { Lightmap().shadeAngle = Number(words[0]); }
    void Terrain(const Words &) { ApplyTerrain(shader_->info); }
    void Rnm(const Words &) { Lightmap().rnm = true; }
    void NoRnm(const Words &) { Lightmap().rnm = false; }
    void NormalImage(const Words &words) { Lightmap().normalImage = WithoutExtension(words[0]); }
    void SsbumpImage(const Words &words) { Lightmap().ssbumpImage = WithoutExtension(words[0]); }
    void MacroTexture(const Words &words) { Lightmap().macroImage = WithoutExtension(words[0]); }
    void FloodLight(const Words &words);

    ShaderTextScanner scanner_;
    bool hasIncludes_;
    ShaderTable &table_;
    Log &log_;
    std::unique_ptr<ParsedShader> shader_;
    Words words_;                   ///< arguments of the current directive
    bool incomplete_ = false;       ///< the directive before lacks arguments, which may stand on the next line
    const char *bodyEnd_ = nullptr; ///< where the next shader begins within this one; null: it does not
};

using Self = ScriptParser;
const std::array<Self::Directive, 46> Self::kDirectives = {{
    {"surfaceparm", 1, 0, &Self::SurfaceParmLine},
    {"cull", 1, 0, &Self::Cull},
    {"deformvertexes", 1, 8, &Self::DeformVertexes},
    {"implicitmap", 1, 0, &Self::ImplicitMap},
    {"implicitmask", 1, 0, &Self::ImplicitMask},
    {"implicitblend", 1, 0, &Self::ImplicitBlend},
    {"skyparms", 3, 0, &Self::SkyParms},
    {"qer_editorimage", 1, 0, &Self::EditorImage},
    {"sun", 6, 0, &Self::Sun, true},
    {"q3map_sun", 6, 0, &Self::Sun, true},
    {"q3map_sunext", 6, 2, &Self::Sun, true},
    {"q3map_skylight", 2, 3, &Self::SkyLight},
    {"q3map_lightimage", 1, 0, &Self::LightImage},
    {"q3map_lightrgb", 3, 0, &Self::LightRgb},
    {"q3map_surfacelight", 1, 0, &Self::SurfaceLight},
    {"q3map_lightsubdivide", 1, 0, &Self::LightSubdivide},
    {"q3map_backsplash", 2, 0, &Self::Backsplash},
    {"q3map_lightstyle", 1, 0, &Self::LightStyle},
    {"q3map_bounce", 1, 0, &Self::BounceScale},
    {"q3map_bouncescale", 1, 0, &Self::BounceScale},
    {"q3map_nofast", 0, 0, &Self::NoFast},
    {"q3map_forcesunlight", 0, 0, &Self::ForceSunlight},
    {"q3map_vertexscale", 1, 0, &Self::VertexScale},
    {"q3map_lightmapfilterradius", 2, 0, &Self::FilterRadius},
    {"q3map_baseshader", 1, 0, &Self::BaseShader},
    {"q3map_deprecateshader", 1, 0, &Self::DeprecateShader},
    {"q3map_material", 1, 0, &Self::Material},
    {"q3map_onlyvertexlighting", 0, 0, &Self::VertexLighting},
    {"q3map_lightmapsamplesize", 1, 0, &Self::SampleSize},
    {"q3map_lightmapsampleoffset", 1, 0, &Self::SampleOffset},
    {"q3map_lightmapaxis", 1, 0, &Self::LightmapAxis},
    {"q3map_lightmapsize", 2, 0, &Self::LightmapSize},
    {"q3map_lightmapbrightness", 1, 0, &Self::LightmapBrightness},
    {"q3map_lightmapgamma", 1, 0, &Self::LightmapBrightness},
    {"q3map_lightmapmergable", 0, 0, &Self::Mergable},
    {"q3map_splotchfix", 0, 0, &Self::SplotchFix},
    {"q3map_nodirty", 0, 0, &Self::NoDirt},
    {"q3map_novertexlight", 0, 0, &Self::NoVertexLight},
    {"q3map_shadeangle", 1, 0, &Self::ShadeAngle},
    {"q3map_terrain", 0, 0, &Self::Terrain},
    {"q3map_normalimage", 1, 0, &Self::NormalImage},
    {"q3map_ssbumpimage", 1, 0, &Self::SsbumpImage},
    {"q3map_macrotexture", 1, 0, &Self::MacroTexture},
    {"q3map_rnm", 0, 0, &Self::Rnm},
    {"q3map_nornm", 0, 0, &Self::NoRnm},
    {"q3map_floodlight", 6, 0, &Self::FloodLight},
}};

/// A shader and, as long as each lacks its closing brace, those that follow it.
void ScriptParser::ParseShaders(std::string_view name) {
    for (NextShader next = ParseShader(name); !next.empty();) {
        std::string_view brace;
        scanner_.Next(brace); // IsNextShader has seen it
        next = ParseShader(std::exchange(next, {}));
    }
}

/// Returns the name of the shader that begins within this one.
ScriptParser::NextShader ScriptParser::ParseShader(std::string_view name) {
    const bool isHidden = name.ends_with(kHiddenSuffix);
    if (isHidden)
        name.remove_suffix(kHiddenSuffix.size());
    if (name.size() > kMaxName)
        log_.Warn("long shader name", "{}: shader name {} is longer than the {} bytes that a map can hold",
                  scanner_.TokenLocation().Text(), name, kMaxName);
    shader_.reset(new ParsedShader(table_.MakeDefault(name))); // constructs the default on the heap, without a copy
    shader_->info.defined = true;
    bool hasStages = false;
    const char *bodyBegin = scanner_.Unread().data();
    if (hasIncludes_)
        scanner_.Record();
    bodyEnd_ = nullptr;
    NextShader next = ParseBody(hasStages);
    if (!Lightmap().normalImage.empty() && !Lightmap().ssbumpImage.empty())
        log_.Warn("two normal maps", "{}: shader {}: q3map_normalImage and q3map_ssbumpImage, the latter is not used",
                  scanner_.TokenLocation().Text(), name);
    shader_->info.scriptText.clear(), shader_->body.reset();
    // A hidden definition without stages only holds directives for the compiler. The engine draws another definition
    // of the same name, so this text is not kept.
    if (isHidden && !hasStages)
        scanner_.TakeText();
    else if (hasIncludes_)
        shader_->info.scriptText = scanner_.TakeText();
    else
        shader_->body.emplace(bodyBegin, bodyEnd_ ? bodyEnd_ : scanner_.Unread().data());
    table_.Define(std::move(shader_));
    return next;
}

/// Up to the closing brace.
ScriptParser::NextShader ScriptParser::ParseBody(bool &hasStages) {
    const TextLocation begin = scanner_.TokenLocation();
    incomplete_ = false;
    for (std::string_view word; scanner_.Next(word);) {
        if (word == "}")
            return {};
        if (!incomplete_ && IsNextShader(word))
            return MissingBrace(begin, "the shader", word);
        if (word == "{") {
            incomplete_ = false;
            hasStages = true;
            if (NextShader next = ParseStage(); !next.empty())
                return next;
        } else {
            ParseDirective(word);
        }
    }
    return MissingBrace(begin, "the shader", {});
}

/// Warns that what began at `begin` does not end. `found`: the name of the next shader, which is returned; empty: the
/// file ends.
ScriptParser::NextShader ScriptParser::MissingBrace(const TextLocation &begin, std::string_view what,
                                                    std::string_view found) {
    log_.Warn("missing brace in a script", "{}: shader {}: a '}}' is missing: {} that begins in line {} has no end{}",
              scanner_.TokenLocation().Text(), shader_->info.name, what, begin.line,
              found.empty() ? " before that of the file" : fmt::format(" before shader {}", found));
    if (found.empty())
        return {};
    scanner_.Forget();
    if (!hasIncludes_)
        bodyEnd_ = found.data() - (found.data()[-1] == '"' ? 1 : 0);
    return NextShader(found);
}

/// Whether the word is the name of a shader whose brace follows, so that the shader before it lacks its own.
bool ScriptParser::IsNextShader(std::string_view word) const {
    const std::size_t slash = word.find_first_of("/\\", 1);
    return slash != std::string_view::npos && slash + 1 < word.size() && WithoutExtension(word) == word &&
           scanner_.BlockFollows();
}

void ScriptParser::FindStageImage(std::string_view name, std::string &image) {
    const bool builtIn = !name.empty() && (name[0] == '$' || name[0] == '*');
    shader_->builtInImage |= builtIn;
    if (image.empty() && !name.empty() && !builtIn)
        image = WithoutExtension(name);
}

/// Reads names of images only. Blocks do not nest, and line ends have no meaning here but where a brace is missing.
ScriptParser::NextShader ScriptParser::ParseStage() {
    static constexpr std::array<std::string_view, 6> kImageWords = {"map",          "clampmap", "animmap",
                                                                    "clampanimmap", "mapcomp",  "mapnocomp"};
    // Keywords of ioquake3's and OpenJK's second renderers, Daemon and ETXreaL; also the word after `stage`.
    static constexpr std::array<std::string_view, 5> kNormalMapWords = {"normalmap", "bumpmap", "normalheightmap",
                                                                        "normalparallaxmap", "parallaxmap"};
    const TextLocation begin = scanner_.TokenLocation();
    std::string_view word;
    std::string image; // the first of the stage
    NextShader next;
    bool afterStage = false, isNormalMap = false;
    int line = begin.line;
    while (scanner_.Next(word) && word != "}") {
        const bool isFirstOfLine = scanner_.TokenLocation().line != line;
        line = scanner_.TokenLocation().line;
        if (word == "{")
            MissingBrace(begin, "the stage", {});
        if (isFirstOfLine && IsNextShader(word)) {
            next = MissingBrace(begin, "the stage", word);
            break;
        }
        const bool isNormalMapWord = std::any_of(kNormalMapWords.begin(), kNormalMapWords.end(),
                                                 [&](std::string_view normals) { return IsWord(word, normals); });
        shader_->info.normalMapStage |= isNormalMapWord;
        isNormalMap |= isNormalMapWord && afterStage;
        afterStage = IsWord(word, "stage");
        const auto known = std::find_if(kImageWords.begin(), kImageWords.end(),
                                        [&](std::string_view one) { return IsWord(word, one); });
        if (known == kImageWords.end())
            continue;
        const int arguments = known->ends_with("animmap") ? 2 : 1; // a rate, then the first frame
        bool more = true;
        for (int i = 0; i < arguments && more && word != "}"; ++i)
            more = scanner_.Next(word);
        line = scanner_.TokenLocation().line;
        if (!more || word == "}")
            break;
        FindStageImage(word, image);
    }
    if (NoImageYet() && !isNormalMap) // the image of `stage normalMap` has no color
        shader_->lightImage = image;
    return next;
}

void ScriptParser::ParseDirective(std::string_view word) {
    const bool afterIncomplete = std::exchange(incomplete_, false);
    const std::string key = LowerCase(word);
    const auto found = std::find_if(kDirectives.begin(), kDirectives.end(),
                                    [&](const Directive &directive) { return directive.name == key; });
    if (found != kDirectives.end())
        return RunDirective(*found, word);
    if (const GeometryDirective *directive = FindGeometryDirective(key))
        return RunDirective(*directive, word);
    constexpr std::string_view kPrefix = "q3map_";
    const bool mayBeArgument = afterIncomplete && !key.starts_with(kPrefix);
    const auto isKnown = [&] {
        if (!key.starts_with(kPrefix))
            return IsEngineDirective(key);
        return std::ranges::find(kDirectivesWithoutEffect, key) != kDirectivesWithoutEffect.end() ||
               ApplyParm(key.substr(kPrefix.size()));
    };
    if (!isKnown() && !mayBeArgument)
        log_.Warn("unknown shader directive", "{}: shader {}: unknown directive {}{}", scanner_.TokenLocation().Text(),
                  shader_->info.name, word,
                  scanner_.BlockFollows() ? "; if it is the name of a shader, a '}' is missing before it" : "");
    scanner_.SkipArguments();
}

void ScriptParser::RunDirective(const Directive &directive, std::string_view word) {
    const TextLocation location = scanner_.TokenLocation();
    words_.clear();
    for (std::string_view next; words_.size() < directive.required + directive.optional && scanner_.NextArgument(next);)
        words_.emplace_back(next);
    if (words_.size() < directive.required)
        WarnIncomplete(location, word, directive.required);
    else
        (this->*directive.apply)(words_);
    if (!directive.moreMayFollow)
        scanner_.SkipArguments();
}

void ScriptParser::RunDirective(const GeometryDirective &directive, std::string_view word) {
    const TextLocation location = scanner_.TokenLocation();
    words_.clear();
    for (std::string_view next; words_.size() < directive.required + directive.optional && scanner_.NextArgument(next);)
        if (next != "(" && next != ")")
            words_.emplace_back(next);
    if (words_.size() < directive.required) {
        WarnIncomplete(location, word, directive.required);
    } else if (const std::string fault = directive.apply(shader_->info, words_, table_.Options(), table_.GameRules());
               !fault.empty()) {
        log_.Warn("shader directive", "{}: shader {}: {}: {}", location.Text(), shader_->info.name, word, fault);
    }
    scanner_.SkipArguments();
}

void ScriptParser::WarnIncomplete(const TextLocation &location, std::string_view word, std::size_t expected) {
    incomplete_ = true;
    log_.Warn("incomplete shader directive", "{}: shader {}: {} with {} arguments, expected {}", location.Text(),
              shader_->info.name, word, words_.size(), expected);
}

bool ScriptParser::ApplyParm(std::string_view name) {
    const SurfaceParm *parm = table_.GameRules().FindParm(name);
    if (!parm)
        return false;
    ShaderInfo &info = shader_->info;
    info.contentFlags = (info.contentFlags & ~parm->contentClear) | parm->contentSet;
    info.surfaceFlags = (info.surfaceFlags & ~parm->surfaceClear) | parm->surfaceSet;
    info.compileFlags = (info.compileFlags & ~parm->compileClear) | parm->compileSet;
    return true;
}

/// Three numbers as a light color.
Vec3f ScriptParser::Color(const Words &words) const {
    Vec3f color{Number(words[0]), Number(words[1]), Number(words[2])};
    if (table_.Options().sRgbColor)
        color = {LinearFromSrgb(color.x), LinearFromSrgb(color.y), LinearFromSrgb(color.z)};
    return NormalizeColor(color);
}

void ScriptParser::SurfaceParmLine(const Words &words) {
    if (!ApplyParm(words[0]))
        log_.Warn("unknown surfaceparm", "{}: shader {}: unknown surfaceparm {}", scanner_.TokenLocation().Text(),
                  shader_->info.name, words[0]);
}

void ScriptParser::Cull(const Words &words) {
    const std::string side = LowerCase(words[0]);
    if (side == "none" || side == "disable" || side == "twosided")
        shader_->info.twoSided = true;
}

const std::string &ScriptParser::ImplicitImage(const Words &words) {
    return shader_->implicitImage = words[0] == "-" ? shader_->info.name : WithoutExtension(words[0]);
}

void ScriptParser::SkyParms(const Words &words) {
    if (words[0] == "-" || EqualNoCase(words[0], "full"))
        return;
    shader_->info.skyImageBase = words[0];
    if (shader_->lightImage.empty())
        shader_->lightImage = shader_->info.skyImageBase + "_up";
}

void ScriptParser::LightRgb(const Words &words) {
    shader_->info.color = Color(words);
    shader_->colorGiven = true;
}

void ScriptParser::LightSubdivide(const Words &words) {
    shader_->info.lightSubdivide = float(IntegerFromText(words[0]));
}

void ScriptParser::Backsplash(const Words &words) {
    shader_->info.backsplashFraction = Number(words[0]) * 0.01f;
    shader_->info.backsplashDistance = Number(words[1]);
}

void ScriptParser::VertexScale(const Words &words) {
    shader_->info.vertexScale =
        float(std::clamp(double(shader_->info.vertexScale) * double(Number(words[0])), -kMaxNumber, kMaxNumber));
}

void ScriptParser::FilterRadius(const Words &words) {
    shader_->info.lightmapFilterRadius = Number(words[0]);
    shader_->info.lightFilterRadius = Number(words[1]);
}

/// r g b intensity degrees elevation [deviance samples]. The sun takes the light style and filter radius that earlier
/// directives of this shader set.
void ScriptParser::Sun(const Words &words) {
    constexpr double kRadians = std::numbers::pi / 180;
    const double azimuth = double(Number(words[4])) * kRadians, elevation = double(Number(words[5])) * kRadians;
    SunDirective sun;
    sun.color = Color(words);
    sun.photons = Number(words[3]);
    sun.direction = Vec3f(
        Vec3d{std::cos(azimuth) * std::cos(elevation), std::sin(azimuth) * std::cos(elevation), std::sin(elevation)});
    if (words.size() == 7)
        log_.Warn("incomplete shader directive", "{}: shader {}: a sun with a deviance but no samples",
                  scanner_.TokenLocation().Text(), shader_->info.name);
    if (words.size() > 7) {
        sun.deviance = float(double(Number(words[6])) * kRadians);
        sun.samples = std::max(1, IntegerFromText(words[7]));
    }
    sun.filterRadius = shader_->info.lightFilterRadius;
    sun.style = shader_->info.lightStyle;
    AddSunOrSkyLight(shader_->info.suns, sun);
}

/// value iterations [horizon_min horizon_max [sample_color]]
void ScriptParser::SkyLight(const Words &words) {
    SkyLightDirective sky;
    sky.value = std::max(0.0f, Number(words[0]));
    sky.iterations = std::max(2, IntegerFromText(words[1]));
    if (sky.iterations > kMaxSkyIterations) {
        log_.Warn("sky light iterations", "{}: shader {}: {} sky light iterations are limited to {}",
                  scanner_.TokenLocation().Text(), shader_->info.name, sky.iterations, kMaxSkyIterations);
        sky.iterations = kMaxSkyIterations;
    }
    if (words.size() > 2)
        sky.horizonMin = std::clamp(IntegerFromText(words[2]), -90, 90);
    if (words.size() > 3)
        sky.horizonMax = std::clamp(IntegerFromText(words[3]), -90, 90);
    if (words.size() > 4)
        sky.sampleColor = IntegerFromText(words[4]) != 0;
    AddSunOrSkyLight(shader_->info.skyLights, sky);
}

void ScriptParser::LightmapAxis(const Words &words) {
    static constexpr std::array<Vec3f, 3> kAxes = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    const std::size_t axis = words[0].size() == 1 ? std::string_view("xyz").find(LowerCase(words[0])) : kAxes.size();
    if (axis >= kAxes.size())
        log_.Warn("lightmap axis", "{}: shader {}: q3map_lightmapAxis {}, expected x, y or z",
                  scanner_.TokenLocation().Text(), shader_->info.name, words[0]);
    Lightmap().axis = axis < kAxes.size() ? kAxes[axis] : Vec3f{};
}

void ScriptParser::LightmapSize(const Words &words) {
    const std::array<int, 2> size = {IntegerFromText(words[0]), IntegerFromText(words[1])};
    const bool good = std::all_of(size.begin(), size.end(), [](int side) {
        return side >= 2 && side <= kMaxPageSide && std::has_single_bit(unsigned(side));
    });
    if (!good)
        log_.Warn("lightmap page size",
                  "{}: shader {}: q3map_lightmapSize {} {}, expected powers of two from 2 to {}; not used",
                  scanner_.TokenLocation().Text(), shader_->info.name, words[0], words[1], kMaxPageSide);
    Lightmap().pageSize = good ? size : std::array<int, 2>{};
}

void ScriptParser::LightmapBrightness(const Words &words) {
    const double product = double(Lightmap().brightness) * double(Number(words[0]));
    Lightmap().brightness = product < 0 ? 1 : float(std::min(product, kMaxNumber));
}

/// r g b distance intensity directionScale
void ScriptParser::FloodLight(const Words &words) {
    Lightmap().floodColor = Color(words);
    Lightmap().floodDistance = Number(words[3]);
    Lightmap().floodIntensity = Number(words[4]);
    Lightmap().floodDirectionScale = Number(words[5]);
}

/// Starts over from a shader defined earlier: directives before this one are lost, the name stays.
void ScriptParser::BaseShader(const Words &words) {
    const ParsedShader *base = table_.Find(words[0], log_);
    std::string name = std::move(shader_->info.name);
    *shader_ = base ? *base : table_.MakeDefault({});
    shader_->info.name = std::move(name);
    shader_->info.defined = true;
}

void ScriptParser::Material(const Words &words) {
    if (!ApplyParm("*mat_" + std::string(words[0])))
        log_.Warn("unknown material", "{}: shader {}: unknown material {}", scanner_.TokenLocation().Text(),
                  shader_->info.name, words[0]);
}

} // namespace

void ParseShaderScript(TextScanner &scanner, ShaderTable &table, Log &log) {
    ScriptParser(scanner, table, log).ParseScript();
}

} // namespace q3
