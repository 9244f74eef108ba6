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
    {.name = "_sunlight",
     .help = "Use a light_environment with _light, or q3map_sunExt in the shader of the sky",
     .since = "ericw-tools"},
    {.name = "_sunlight_color",
     .help = "Use the color in _light of a light_environment, or that of q3map_sunExt",
     .since = "ericw-tools"},
    {.name = "_sunlight_mangle",
     .aliases = {"_sun_mangle", "sun_mangle"},
     .help = "Use the keys angle and pitch of a light_environment, or the angles of q3map_sunExt",
     .since = "ericw-tools"},
    {.name = "_sunlight_penumbra",
     .help = "Use SunSpreadAngle of a light_environment, or the deviance of q3map_sunExt",
     .since = "ericw-tools"},
    {.name = "_sunlight2",
     .aliases = {"_sunlight3", "_sunlight2_color", "_sunlight3_color"},
     .help = "Use the key _ambient of a light_environment, or q3map_skyLight in the shader of the sky",
     .since = "ericw-tools"},
    {.name = "_bounce", .help = "Use the option -bounce N of the light stage", .since = "ericw-tools"},
    {.name = "_bouncescale", .help = "Use the option -bouncescale F of the light stage", .since = "ericw-tools"},
    {.name = "_bouncecolorscale",
     .help = "Use the option -bouncecolorratio F of the light stage",
     .since = "ericw-tools"},
    {.name = "_dirt",
     .aliases = {"_sunlight_dirt", "_sunlight2_dirt", "_minlight_dirt"},
     .help = "Use the option -dirty of the light stage, for all light of the map",
     .since = "ericw-tools"},
    {.name = "_dirtmode", .help = "Use the options -dirty and -dirtmode of the light stage", .since = "ericw-tools"},
    {.name = "_dirtdepth", .help = "Use the options -dirty and -dirtdepth of the light stage", .since = "ericw-tools"},
    {.name = "_dirtscale", .help = "Use the options -dirty and -dirtscale of the light stage", .since = "ericw-tools"},
    {.name = "_dirtgain", .help = "Use the options -dirty and -dirtgain of the light stage", .since = "ericw-tools"},
    {.name = "_minlight_color", .help = "Use the key _color of worldspawn", .since = "ericw-tools"},
    {.name = "_range", .help = "Use the option -scale of the light stage", .since = "ericw-tools"},
    {.name = "_dist",
     .help = "Use the option -pointscale of the light stage, or brighter lights",
     .since = "ericw-tools"},
    {.name = "_gamma", .help = "Use the option -gamma of the light stage", .since = "ericw-tools"},
    {.name = "_anglescale",
     .aliases = {"_anglesense"},
     .help = "Use the key _anglescale of each light",
     .since = "ericw-tools"},
    {.name = "_surflight_subdivide",
     .help = "Use q3map_lightSubdivide in the shader of the emitting surfaces",
     .since = "ericw-tools"},
});

constexpr std::array kForeignLightKeys = std::to_array<SettingInfo>({
    {.name = "_surface",
     .aliases = {"_surface_offset", "_surface_spotlight", "_surface_radiosity"},
     .help = "Use q3map_surfaceLight in the shader of the surfaces that emit light",
     .since = "ericw-tools"},
    {.name = "mangle", .help = "Use a target, or a light_spot with angle and pitch", .since = "ericw-tools"},
    {.name = "_softangle", .help = "Use the keys _inner_cone and _cone, which are half angles", .since = "ericw-tools"},
    {.name = "_project_texture",
     .aliases = {"_project_mangle", "_project_fov"},
     .help = "Use a surface with surfaceparm lightfilter in front of the light, which colors it by its image",
     .since = "ericw-tools"},
    {.name = "_falloff", .help = "Use the key _radius, the distance at which the light ends", .since = "ericw-tools"},
    {.name = "_distance", .help = "Use the key _radius, the distance at which the light ends", .since = "VRAD"},
    {.name = "_dirt",
     .aliases = {"_dirtscale", "_dirtgain", "_dirt_on_radius", "_dirt_off_radius"},
     .help = "Use the option -dirty of the light stage, for all light of the map",
     .since = "ericw-tools"},
    {.name = "_bouncescale",
     .help = "Use the option -bouncescale F of the light stage, for all light of the map",
     .since = "ericw-tools"},
    {.name = "_sunlight",
     .aliases = {"_sunlight2", "_sunlight3"},
     .help = "Use the class light_environment, or _sun 1 and a target",
     .since = "ericw-tools"},
    {.name = "_sunlight_color", .help = "Use the key _color of the light", .since = "ericw-tools"},
    {.name = "_sunlight_penumbra", .help = "Use the keys _deviance and _samples of the light", .since = "ericw-tools"},
});

constexpr std::array kForeignBrushKeys = std::to_array<SettingInfo>({
    {.name = "_phong",
     .aliases = {"_phong_angle", "_phong_angle_concave", "_phong_group"},
     .help = "Use the key _shadeangle DEGREES and the option -shade of the light stage, or q3map_shadeAngle in shaders",
     .since = "ericw-tools"},
    {.name = "_lightmap_scale",
     .aliases = {"_lmscale", "lightmap_scale", "_world_units_per_luxel"},
     .help = "Use the key _lightmapsamplesize, game units per luxel, or the factor _lightmapscale",
     .since = "ericw-tools"},
    {.name = "_shadow", .help = "Use the key _castShadows 1", .since = "ericw-tools"},
    {.name = "_shadowself",
     .aliases = {"_selfshadow", "_shadowworldonly"},
     .help = "Use the keys _castShadows and _receiveShadows, with one number above 1 for those that shadow each other",
     .since = "ericw-tools"},
    {.name = "_mirrorinside", .help = "Use cull none or q3map_backShader in the shader", .since = "ericw-tools"},
    {.name = "_surflight_subdivide",
     .help = "Use q3map_lightSubdivide in the shader of the emitting surfaces",
     .since = "ericw-tools"},
});

/// Keys that worldspawn has a meaning for, and entities with brushes do not.
constexpr std::array kForeignModelKeys = std::to_array<SettingInfo>({
    {.name = "_minlight", .help = "Use the key _minlight of worldspawn, for the whole map", .since = "ericw-tools"},
    {.name = "_minlight_color", .help = "Use the key _color of worldspawn, for the whole map", .since = "ericw-tools"},
    {.name = "_dirt",
     .help = "Use q3map_noDirty in the shader, which keeps -dirty off its surfaces",
     .since = "ericw-tools"},
    {.name = "_bounce",
     .help = "Use q3map_bounceScale 0 in the shader, which keeps surfaces from reflecting light",
     .since = "ericw-tools"},
});

void WarnOfKeys(std::span<const SettingInfo> keys, const Entity &entity, std::size_t number, Log &log) {
    for (const SettingInfo &key : keys) {
        const auto &[second, third, fourth, fifth] = key.aliases;
        for (const std::string_view name : {key.name, second, third, fourth, fifth})
            if (!name.empty() && entity.Has(name))
                log.Warn(fmt::format("key {}", name), "entity {} ({}): the key {} \"{}\" has no effect. {}", number,
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
    return {KeySection("Keys of other compilers: worldspawn",
                       "These keys of ericw-tools and Source have no effect, and each entry says what to use instead. "
                       "Such a key is a warning, once in a run. The light stage warns of keys of worldspawn and of "
                       "lights, and the bsp stage of keys of entities with brushes.",
                       kForeignWorldKeys),
            KeySection("Keys of other compilers: lights", "These keys of lights have no effect.", kForeignLightKeys),
            KeySection("Keys of other compilers: entities with brushes",
                       "These keys have no effect on any entity with brushes.", kForeignBrushKeys),
            KeySection("Keys of other compilers: entities with brushes other than worldspawn",
                       "These keys have no effect on entities with brushes other than worldspawn.", kForeignModelKeys)};
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
