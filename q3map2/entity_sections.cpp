// GPL-2.0-or-later. Documentation of the keys of entities.
#include "q3map2/entity_sections.h"

#include "q3map2/bspfile/foreign_keys.h"
#include "q3map2/bspfile/light_curve_keys.h"
#include "q3map2/bspfile/light_style_keys.h"
#include "q3map2/bspfile/object_keys.h"
#include "q3map2/bspfile/surface_keys.h"

namespace q3 {

namespace {

std::vector<SettingSection> OwnKeySections() {
    return {DescribeKeys("Worldspawn: light",
                         "The light stage writes `_q3map2_cmdline`, `_q3map2_version`, `_q3map2_sh` with the value "
                         "`radiance` after `-shradiance`, `_q3map2_tone`, the tone of the lightmaps unless it is "
                         "plain, and `_q3map2_rnm`, `raw` or `rescaled`, after `-rnm`.",
                         keys::kWorldLightKeys),
            DescribeKeys("Worldspawn: switchable lights", "", keys::kStyleWorldKeys),
            DescribeKeys("Worldspawn: macro texture", "", keys::kMacroKeys),
            DescribeKeys("Lights",
                         "Every entity whose class name starts with `light`. A point light of intensity I gives "
                         "7500 I / d² of 255 at distance d, at least 16; a linear one 0.9375 I − d `fade`. Entities of "
                         "the class `lightJunior` shine on the grids only. `_anglescale`, `_filterradius` and "
                         "spawnflag 2 have no meaning for grids.",
                         keys::kLightKeys),
            DescribeKeys("Lights: patterns and switches",
                         "The light stage numbers the styles that these need and writes to worldspawn: "
                         "`_styleNpattern`, the pattern of style N; `_switchN`, the targetnames of the lights of style "
                         "N; `_switchNdark`, 1 if they are dark at first. Lights that stay in the `.bsp` get `style`.",
                         keys::kStyleLightKeys),
            DescribeKeys("Lights: falloff",
                         "Curves other than those of the established program; the first of "
                         "`_fifty_percent_distance`, the three of `_constant_attn`, `_radius` and `delay` counts. The "
                         "page [from_source.md](from_source.md) has the formulas.",
                         keys::kFalloffKeys),
            DescribeKeys("Lights: cones",
                         "The cone of a `light_spot`, and of other lights with one of the first three keys, in place "
                         "of the one that `radius` describes. The light is also multiplied by the cosine to the axis.",
                         keys::kConeKeys),
            DescribeKeys("light_environment",
                         "The sun and the sky light of a map, through any sky: `_light` is the light of the sun on a "
                         "surface that faces it, `pitch`, `angles` and `angle` are where it shines, as for cones. The "
                         "last one of a map counts.",
                         keys::kEnvironmentKeys),
            DescribeKeys("Lights: HDR", "", keys::kHdrLightKeys),
            DescribeKeys("Worldspawn: bsp and vis", "", keys::kWorldKeys),
            DescribeKeys("Entities with brushes or patches, and the world",
                         "The bsp stage writes what these keys say to the `.srf`. The light stage reads the keys of a "
                         "map without one; with a `.srf`, its `castShadows` counts where it is not 0.",
                         keys::kSurfaceKeys),
            DescribeKeys("misc_model", "", keys::kModelKeys),
            DescribeKeys("Static props",
                         "Entities of the classes `misc_model_static` and `prop_static`, and each `misc_model` with "
                         "`_staticprop`, which the light stage lights at their vertices with `-staticproplighting`: "
                         "[static_props.md](static_props.md). They have the keys of misc_model for model, skin, size "
                         "and place too, and `_castShadows` and `_receiveShadows`, whose default is 1.",
                         keys::kPropKeys),
            DescribeKeys("Terrain", "Entities whose surfaces blend layers by a picture.", keys::kTerrainKeys),
            DescribeKeys("Decals", "Entities of the class `_decal`, whose patches are projected onto surfaces.",
                         keys::kDecalKeys),
            DescribeKeys("Sky boxes",
                         "Entities of the class `_skybox`: their area is drawn a second time, enlarged, where sky is.",
                         keys::kSkyBoxKeys),
            DescribeKeys("Flares", "Keys of lights for the bsp stage.", keys::kFlareKeys),
            DescribeKeys("Names and instances", "", keys::kNameKeys)};
}

} // namespace

std::vector<SettingSection> EntitySections() {
    std::vector<SettingSection> sections = OwnKeySections();
    for (SettingSection &section : ForeignKeySections())
        sections.push_back(std::move(section));
    return sections;
}

} // namespace q3
