// GPL-2.0-or-later. Declaration of entity keys: names, default, range and help.
#include "q3map2/bspfile/entity_key.h"

#include "common/settings.h"
#include "common/text/text.h"

#include <fmt/format.h>

#include <array>
#include <optional>
#include <span>

namespace q3 {

// ---- Keys that are declared ----

namespace {

/// How much of a value is shown in messages.
constexpr std::size_t kShownChars = 80;

/// What is wrong with the text of a number key; empty: nothing.
std::string FaultOf(const EntityKey &key, std::string_view text) {
    const std::size_t required = key.info.MinValues(), most = key.info.MaxValues();
    std::size_t count = 0;
    for (; count < most; ++count) {
        const std::optional<double> number = TakeNumber(text);
        if (!number)
            break;
        if (!key.info.range.Contains(*number)) {
            return fmt::format("expected a number {}; {:.12g} is used", key.info.range.Text(),
                               key.info.range.Clamp(*number));
        }
    }
    if (count < required)
        return required == 1 ? "expected a number" : fmt::format("expected {} numbers", required);
    if (text.find_first_not_of(" \t") != std::string_view::npos)
        return fmt::format("\"{}\" after the number{} is not read", text.substr(0, 40), count == 1 ? "" : "s");
    return {};
}

} // namespace

std::string_view EntityKey::Text(const Entity &entity) const {
    const auto &[second, third, fourth, fifth] = info.aliases; // unused aliases are empty and match no key
    return entity.Value({info.name, second, third, fourth, fifth});
}

double EntityKey::Number(const Entity &entity, double fallback) const {
    std::string_view text = Text(entity);
    return info.range.Clamp(TakeNumber(text).value_or(fallback));
}

std::optional<Vec3f> EntityKey::Vector(const Entity &entity) const {
    const auto &[second, third, fourth, fifth] = info.aliases;
    return entity.Vector({info.name, second, third, fourth, fifth});
}

std::string EntityKey::InitialText() const {
    if (!info.initial.empty() || info.kind == SettingKind::Text)
        return std::string(info.initial);
    return SettingText(initial);
}

void WarnOfBadKeys(const Entity &entity, std::size_t number, std::span<const EntityKey> keys, Log &log) {
    for (const EntityKey &key : keys) {
        if (key.info.kind == SettingKind::Text || key.info.kind == SettingKind::Flag || !key.Given(entity))
            continue;
        if (const std::string fault = FaultOf(key, key.Text(entity)); !fault.empty())
            log.Warn("bad value of a key", "entity {} ({}): {} \"{}\": {}", number, entity.ClassName(), key.info.name,
                     key.Text(entity).substr(0, kShownChars), fault);
    }
}

SettingSection DescribeKeys(std::string_view title, std::string_view intro, std::span<const EntityKey> keys) {
    SettingSection section{title, intro, {}};
    for (const EntityKey &key : keys)
        section.entries.push_back({key.info, key.InitialText()});
    return section;
}

// ---- Keys of maps for other compilers that have no effect here, and what to write instead ----

namespace {

/// `help` is what to write instead.
constexpr std::array kForeignWorldKeys = std::to_array<SettingInfo>({
    {.name = "_sunlight", .help = "A light_environment with _light, or q3map_sunExt in the shader of the sky"},
    {.name = "_sunlight_color", .help = "The color in _light of a light_environment, or that of q3map_sunExt"},
    {.name = "_sunlight_mangle",
     .aliases = {"_sun_mangle", "sun_mangle"},
     .help = "The keys angle and pitch of a light_environment, or the angles of q3map_sunExt"},
    {.name = "_sunlight_penumbra", .help = "SunSpreadAngle of a light_environment, or the deviance of q3map_sunExt"},
    {.name = "_sunlight2",
     .aliases = {"_sunlight3", "_sunlight2_color", "_sunlight3_color"},
     .help = "The key _ambient of a light_environment, or q3map_skyLight in the shader of the sky"},
    {.name = "_bounce", .help = "The option -bounce N of the light stage"},
    {.name = "_bouncescale", .help = "The option -bouncescale F of the light stage"},
    {.name = "_bouncecolorscale", .help = "The option -bouncecolorratio F of the light stage"},
    {.name = "_dirt",
     .aliases = {"_sunlight_dirt", "_sunlight2_dirt", "_minlight_dirt"},
     .help = "The option -dirty of the light stage, for all light of the map"},
    {.name = "_dirtmode", .help = "The options -dirty and -dirtmode of the light stage"},
    {.name = "_dirtdepth", .help = "The options -dirty and -dirtdepth of the light stage"},
    {.name = "_dirtscale", .help = "The options -dirty and -dirtscale of the light stage"},
    {.name = "_dirtgain", .help = "The options -dirty and -dirtgain of the light stage"},
    {.name = "_minlight_color", .help = "The key _color of worldspawn"},
    {.name = "_range", .help = "The option -scale of the light stage"},
    {.name = "_dist", .help = "The option -pointscale of the light stage, or brighter lights"},
    {.name = "_gamma", .help = "The option -gamma of the light stage"},
    {.name = "_anglescale", .aliases = {"_anglesense"}, .help = "The key _anglescale of each light"},
    {.name = "_surflight_subdivide", .help = "q3map_lightSubdivide in the shader of the emitting surfaces"},
});

constexpr std::array kForeignLightKeys = std::to_array<SettingInfo>({
    {.name = "_surface",
     .aliases = {"_surface_offset", "_surface_spotlight", "_surface_radiosity"},
     .help = "q3map_surfaceLight in the shader of the surfaces that emit light"},
    {.name = "mangle", .help = "A target, or a light_spot with angle and pitch"},
    {.name = "_softangle", .help = "The keys _inner_cone and _cone, which are half angles"},
    {.name = "_project_texture",
     .aliases = {"_project_mangle", "_project_fov"},
     .help = "A surface with surfaceparm lightfilter in front of the light, which colors it by its image"},
    {.name = "_falloff", .help = "The key _radius, the distance at which the light ends"},
    {.name = "_distance", .help = "The key _radius, the distance at which the light ends"},
    {.name = "_dirt",
     .aliases = {"_dirtscale", "_dirtgain", "_dirt_on_radius", "_dirt_off_radius"},
     .help = "The option -dirty of the light stage, for all light of the map"},
    {.name = "_bouncescale", .help = "The option -bouncescale F of the light stage, for all light of the map"},
    {.name = "_sunlight",
     .aliases = {"_sunlight2", "_sunlight3"},
     .help = "The class light_environment, or _sun 1 and a target"},
    {.name = "_sunlight_color", .help = "The key _color of the light"},
    {.name = "_sunlight_penumbra", .help = "The keys _deviance and _samples of the light"},
});

constexpr std::array kForeignBrushKeys = std::to_array<SettingInfo>({
    {.name = "_phong",
     .aliases = {"_phong_angle", "_phong_angle_concave", "_phong_group"},
     .help = "The key _shadeangle DEGREES and the option -shade of the light stage, or q3map_shadeAngle in shaders"},
    {.name = "_lightmap_scale",
     .aliases = {"_lmscale", "lightmap_scale", "_world_units_per_luxel"},
     .help = "The key _lightmapsamplesize, game units per luxel, or the factor _lightmapscale"},
    {.name = "_shadow", .help = "The key _castShadows 1"},
    {.name = "_shadowself",
     .aliases = {"_selfshadow", "_shadowworldonly"},
     .help = "The keys _castShadows and _receiveShadows, with one number above 1 for those that shadow each other"},
    {.name = "_mirrorinside", .help = "cull none or q3map_backShader in the shader"},
    {.name = "_surflight_subdivide", .help = "q3map_lightSubdivide in the shader of the emitting surfaces"},
});

/// Keys that worldspawn has a meaning for, and entities with brushes do not.
constexpr std::array kForeignModelKeys = std::to_array<SettingInfo>({
    {.name = "_minlight", .help = "The key _minlight of worldspawn, for the whole map"},
    {.name = "_minlight_color", .help = "The key _color of worldspawn, for the whole map"},
    {.name = "_dirt", .help = "q3map_noDirty in the shader keeps -dirty off its surfaces"},
    {.name = "_bounce", .help = "q3map_bounceScale 0 in the shader keeps surfaces from reflecting light"},
});

void WarnOfKeys(std::span<const SettingInfo> keys, const Entity &entity, std::size_t number, Log &log) {
    for (const SettingInfo &key : keys) {
        const auto &[second, third, fourth, fifth] = key.aliases;
        for (const std::string_view name : {key.name, second, third, fourth, fifth})
            if (!name.empty() && entity.Has(name))
                log.Warn(fmt::format("key {}", name),
                         "entity {} ({}): the key {} \"{}\" has no effect here; instead: {}", number,
                         entity.ClassName(), name, entity.Value(name).substr(0, kShownChars), key.help);
    }
}

SettingSection KeySection(std::string_view title, std::string_view intro, std::span<const SettingInfo> keys) {
    SettingSection section{title, intro, {}};
    for (const SettingInfo &key : keys)
        section.entries.push_back({key, ""});
    return section;
}

} // namespace

void WarnOfForeignKeys(const Entity &entity, std::size_t number, KeyOwner owner, Log &log) {
    switch (owner) {
    case KeyOwner::World:
        return WarnOfKeys(kForeignWorldKeys, entity, number, log);
    case KeyOwner::Light:
        return WarnOfKeys(kForeignLightKeys, entity, number, log);
    case KeyOwner::Brushes:
        WarnOfKeys(kForeignBrushKeys, entity, number, log);
        if (number != 0)
            WarnOfKeys(kForeignModelKeys, entity, number, log);
    }
}

std::vector<SettingSection> ForeignKeySections() {
    return {
        KeySection("Keys of other compilers: worldspawn",
                   "Keys of ericw-tools and Source that have no effect here, with what to write instead. A key of this "
                   "kind is a warning, once in a run: of the light stage for worldspawn and lights, of the bsp stage "
                   "for entities with brushes.",
                   kForeignWorldKeys),
        KeySection("Keys of other compilers: lights", "", kForeignLightKeys),
        KeySection("Keys of other compilers: entities with brushes", "", kForeignBrushKeys),
        KeySection("Keys of other compilers: entities with brushes other than worldspawn", "", kForeignModelKeys)};
}

// ---- Keys of worldspawn that tell readers of a .bsp how it was lit ----

std::string PatternKey(int style) {
    return fmt::format("_style{}pattern", style);
}

std::string SwitchKey(int style) {
    return fmt::format("_switch{}", style);
}

std::string DarkKey(int style) {
    return fmt::format("_switch{}dark", style);
}

int StyleOfKey(std::string_view key, std::string_view beginning, std::string_view end) {
    constexpr int kLargestOfKeys = 254; // 0 and 255 stand for constant light
    if (key.size() <= beginning.size() + end.size() || !StartsWithNoCase(key, beginning) || !EndsWithNoCase(key, end))
        return -1;
    key = key.substr(beginning.size(), key.size() - beginning.size() - end.size());
    const std::optional<int> number = StrictInteger(key);
    return number && *number > 0 && *number <= kLargestOfKeys ? *number : -1;
}

bool IsStyleKey(std::string_view key) {
    return StyleOfKey(key, "_style", "pattern") > 0 || StyleOfKey(key, "_switch", "") > 0 ||
           StyleOfKey(key, "_switch", "dark") > 0;
}

} // namespace q3
