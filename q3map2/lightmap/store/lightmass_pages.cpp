// GPL-2.0-or-later. -lightmass: L1 SH lightmaps as images in the layout of Unreal's Lightmass.
#include "q3map2/lightmap/store/lightmass_pages.h"

#include "common/files/files.h"
#include "common/image/image.h"
#include "common/text/text.h"
#include "q3map2/lightmap/store/lightmap_store.h"

#include <algorithm>
#include <nlohmann/json.hpp>

namespace q3 {

namespace {

using Json = nlohmann::ordered_json;

constexpr std::string_view kDescription = "lightmass.json";

/// Names of the images of LightmassPage::coefficients.
constexpr std::array<std::string_view, lightmass::kImages> kCoefficientNames = {"hq_color", "hq_direction", "lq_color",
                                                                                "lq_direction"};

/// Encodes layers into pages.
class Encoder {
  public:
    Encoder(const SurfaceInputs &in, const SurfaceLight &surfaces, LightmassPages &out)
        : in_(in), surfaces_(surfaces), out_(out), tone_(StoredTone(in)) {}

    /// Writes to the texels of the layer only.
    LightmassPlace Encode(const LightmapLayer &layer) const {
        const RawLightmap &raw = surfaces_.lightmaps[std::size_t(layer.lightmap)];
        std::vector<lightmass::LuxelLight> luxels;
        for (int y = 0; y < layer.height; ++y)
            for (int x = 0; x < layer.width; ++x)
                luxels.push_back(lightmass::ToCoefficients(Gathered(layer, raw, x, y)));
        const lightmass::Lightmap encoded = lightmass::Quantize(layer.width, layer.height, luxels);
        for (int y = 0; y < layer.height; ++y)
            for (int x = 0; x < layer.width; ++x)
                Put(encoded.luxels[raw.Index(x, y)], layer, x, y);
        for (std::size_t light = 0; light < raw.visibility.size(); ++light)
            PutShadows(raw.visibility[light], light, layer);
        return {.surfaces = raw.surfaces,
                .style = raw.styles[layer.slot],
                .page = layer.page,
                .x = layer.x,
                .y = layer.y,
                .width = layer.width,
                .height = layer.height,
                .hasSkyOcclusion = encoded.hasSkyOcclusion,
                .range = encoded.range};
    }

  private:
    lightmass::GatheredLuxel Gathered(const LightmapLayer &layer, const RawLightmap &raw, int x, int y) const {
        const std::size_t at = raw.Index(x, y);
        const Vec3f least = layer.slot == 0 ? in_.world.minLight : Vec3f{};
        const float scale = ToneMapper::FactorOf(layer.brightness, tone_) / 255;
        lightmass::GatheredLuxel luxel;
        luxel.mapped = layer.Used(at);
        if (!luxel.mapped)
            return luxel;
        luxel.normal = MeanNormal(raw, x, y);
        L1Light l1;
        for (std::size_t i = 0; i < l1.c.size(); ++i)
            l1.c[i] = layer.channels[i][at] * scale;
        luxel.high.AddL1(l1, Max(layer.texels[at], least) * scale, luxel.normal);
        luxel.high.skyOcclusion = raw.skyOcclusion.empty() ? Vec3f{} : raw.skyOcclusion[at];
        luxel.high.unoccluded = raw.unoccluded.empty() ? 1 : raw.unoccluded[at];
        luxel.low = luxel.high;
        return luxel;
    }

    void Put(const lightmass::LuxelBytes &bytes, const LightmapLayer &layer, int x, int y) const {
        LightmassPage &page = out_.pages[std::size_t(layer.page)];
        const std::size_t at = std::size_t(layer.y + y) * std::size_t(page.width) + std::size_t(layer.x + x);
        if (bytes.coverage == 0) // another lightmap may have the texel
            return;
        for (std::size_t image = 0; image < page.coefficients.size(); ++image)
            std::copy_n(bytes.coefficients[image].begin(), 4,
                        page.coefficients[image].begin() + std::ptrdiff_t(4 * at));
        if (!page.skyOcclusion.empty())
            std::copy_n(bytes.skyOcclusion.begin(), 4, page.skyOcclusion.begin() + std::ptrdiff_t(4 * at));
        if (!page.unoccluded.empty())
            page.unoccluded[at] = bytes.unoccluded;
        page.coverage[at] = bytes.coverage;
    }

    void PutShadows(const std::vector<float> &visibility, std::size_t light, const LightmapLayer &layer) const {
        std::vector<lightmass::Visibility> samples;
        for (const float one : visibility)
            samples.push_back({std::max(one, 0.0f), one >= 0});
        const lightmass::VisibilityMap map = lightmass::Quantize(layer.width, layer.height, samples);
        LightmassPage &page = out_.pages[std::size_t(layer.page)];
        for (int y = 0; y < layer.height; ++y)
            for (int x = 0; x < layer.width; ++x)
                if (const std::size_t at = std::size_t(y * layer.width + x);
                    layer.Used(at) && map.luxels[at].coverage != 0)
                    page.shadows[light][std::size_t((layer.y + y) * page.width + layer.x + x)] =
                        map.luxels[at].visibility;
    }

    const SurfaceInputs &in_;
    const SurfaceLight &surfaces_;
    LightmassPages &out_;
    const ToneOptions tone_;
};

std::string ImageName(int page, std::string_view what) {
    return fmt::format("{}_{}.tga", PageImageName(page), what);
}

/// Calls image(name, channels, bytes) for the images of a page.
template <typename Image> void ForImages(const LightmassPages &pages, const LightmassPage &page, const Image &image) {
    for (std::size_t i = 0; i < page.coefficients.size(); ++i)
        image(std::string(kCoefficientNames[i]), 4, page.coefficients[i]);
    if (!page.skyOcclusion.empty())
        image("sky_occlusion", 4, page.skyOcclusion);
    if (!page.unoccluded.empty())
        image("ao", 1, page.unoccluded);
    image("coverage", 1, page.coverage);
    for (std::size_t i = 0; i < page.shadows.size(); ++i)
        image("shadow_" + pages.shadowLights[i], 1, page.shadows[i]);
}

Json PlaceAsJson(const LightmassPlace &place) {
    return {{"surfaces", place.surfaces},
            {"style", place.style},
            {"page", place.page},
            {"x", place.x},
            {"y", place.y},
            {"width", place.width},
            {"height", place.height},
            {"hasSkyOcclusion", place.hasSkyOcclusion},
            {"multiply", place.range.multiply},
            {"add", place.range.add}};
}

} // namespace

void EncodeLightmass(const SurfaceInputs &in, const SurfaceLight &surfaces, const LightmapLayers &layers,
                     LightmassPages &out) {
    out.shadowLights = in.lightmap.shadowMaps;
    const bool anyDirt = std::any_of(surfaces.lightmaps.begin(), surfaces.lightmaps.end(),
                                     [](const RawLightmap &raw) { return !raw.unoccluded.empty(); });
    for (LightmassPage &page : out.pages) {
        const std::size_t texels = std::size_t(page.width) * std::size_t(page.height);
        for (std::vector<std::uint8_t> &image : page.coefficients)
            image.resize(4 * texels);
        page.skyOcclusion.resize(in.lightmap.skyOcclusion ? 4 * texels : 0);
        page.unoccluded.resize(anyDirt ? texels : 0);
        page.coverage.resize(texels);
        page.shadows.assign(out.shadowLights.size(), std::vector<std::uint8_t>(texels));
    }
    std::vector<const LightmapLayer *> withSH;
    for (const LightmapLayer &layer : layers.layers)
        if (layer.page >= 0 && layer.kinds.sh)
            withSH.push_back(&layer);
    out.places.resize(withSH.size());
    const Encoder encoder(in, surfaces, out);
    in.jobs.For(std::int64_t(withSH.size()),
                [&](std::int64_t i, int) { out.places[std::size_t(i)] = encoder.Encode(*withSH[std::size_t(i)]); });
}

void AddLightmass(const std::filesystem::path &folder, std::string_view mapName, const LightmassPages &stored,
                  FileSet &written, Log &log) {
    if (std::error_code ignored; stored.pages.empty()) {
        if (std::filesystem::exists(folder / kDescription, ignored))
            log.Warn("old directional light", "{}: left by an earlier run; this map was lit without -lightmass",
                     (folder / kDescription).string());
        return;
    }
    written.AddFolder(folder);
    Json pages = Json::array(), places = Json::array();
    std::size_t count = 0;
    for (const LightmassPage &page : stored.pages) {
        Json images = Json::object();
        ForImages(stored, page, [&](const std::string &what, int channels, const std::vector<std::uint8_t> &texels) {
            const std::string file = ImageName(page.file, what);
            written.AddFile(folder / file, EncodeTga(texels, page.width, page.height, channels, TgaRows::TopFirst));
            images[what] = fmt::format("maps/{}/{}", mapName, file);
            ++count;
        });
        pages.push_back(
            {{"lightmapNum", page.number}, {"width", page.width}, {"height", page.height}, {"images", images}});
    }
    for (const LightmassPlace &place : stored.places)
        places.push_back(PlaceAsJson(place));
    const Json json = {{"version", 1},
                       {"coefficients", kCoefficientNames},
                       {"shadowLights", stored.shadowLights},
                       {"pages", pages},
                       {"lightmaps", places}};
    written.AddText(folder / kDescription, json.dump(1) + "\n");
    written.AddLine(log,
                    fmt::format("Wrote {} and {} to {}\n", Counted(count, "images"), kDescription, folder.string()));
}

} // namespace q3
