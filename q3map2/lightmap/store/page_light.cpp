// GPL-2.0-or-later. Light of lightmap pages in full range: HDR pages and the basis maps of radiosity normal mapping.
#include "q3map2/lightmap/store/page_light.h"

#include "q3map2/lightmap/encode/rnm.h"
#include "q3map2/lightmap/store/stored_light.h"

namespace q3 {

namespace {

/// Writes the layers of all pages.
class PageLightWriter {
  public:
    PageLightWriter(const SurfaceInputs &in, const LightmapLayers &stored, std::vector<LightmapPage> &pages)
        : in_(in), stored_(stored), pages_(pages), tone_(StoredTone(in)) {}

    void Run() {
        for (const LightmapLayer &layer : stored_.layers)
            if (layer.page >= 0 && layer.kinds.basis)
                for (std::vector<Vec3f> &map : pages_[std::size_t(layer.page)].basis)
                    map.resize(pages_[std::size_t(layer.page)].Texels());
        for (LightmapPage &page : pages_)
            page.light.resize(in_.lightmap.hdr ? page.Texels() : 0);
        in_.jobs.For(std::int64_t(stored_.layers.size()), [&](std::int64_t i, int) {
            if (const LightmapLayer &layer = stored_.layers[std::size_t(i)]; layer.twin < 0 && layer.page >= 0)
                Write(layer);
        });
    }

  private:
    void Write(const LightmapLayer &layer) {
        LightmapPage &page = pages_[std::size_t(layer.page)];
        const float scale = ToneMapper::FactorOf(layer.brightness, tone_) / 255;
        const Vec3f least = layer.style == 0 ? in_.world.minLight : Vec3f{};
        if (layer.solid) {
            if (!page.light.empty())
                page.light[page.Index(layer.x, layer.y)] = Max(layer.color, least) * scale;
            return;
        }
        for (int y = 0; y < layer.height; ++y)
            for (int x = 0; x < layer.width; ++x) {
                const std::size_t from = std::size_t(y) * std::size_t(layer.width) + std::size_t(x);
                if (!layer.Used(from))
                    continue;
                const std::size_t to = page.Index(layer.x + x, layer.y + y);
                const Vec3f flat = Max(layer.texels[from], least) * scale;
                if (!page.light.empty())
                    page.light[to] = flat;
                if (layer.kinds.basis)
                    WriteBasis(layer, from, least, scale, flat, page, to);
            }
    }

    void WriteBasis(const LightmapLayer &layer, std::size_t from, const Vec3f &least, float scale, const Vec3f &flat,
                    LightmapPage &page, std::size_t to) {
        RnmLight light;
        for (std::size_t i = 0; i < light.map.size(); ++i)
            light.map[i] = Max(layer.OnBasis(i)[from], least) * scale;
        if (in_.lightmap.rnmRescaled)
            light = RescaleToFlat(light, flat);
        for (std::size_t i = 0; i < light.map.size(); ++i)
            page.basis[i][to] = light.map[i];
    }

    const SurfaceInputs &in_;
    const LightmapLayers &stored_;
    std::vector<LightmapPage> &pages_;
    const ToneOptions tone_;
};

} // namespace

void SetPageLight(const SurfaceInputs &in, const LightmapLayers &stored, std::vector<LightmapPage> &pages) {
    PageLightWriter(in, stored, pages).Run();
}

Vec3f VertexLightOf(const SurfaceInputs &in, const ShaderInfo &shader, const Vec3f &light, const ToneOptions &tone) {
    const float scale = VertexScale(in, shader);
    return Max(light, in.world.minVertex) * ((scale > 0 ? scale : 1) * ToneMapper::FactorOf(1, tone) / 255);
}

} // namespace q3
