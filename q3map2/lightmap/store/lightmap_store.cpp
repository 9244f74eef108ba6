// GPL-2.0-or-later. Stores the light of surfaces in the Bsp: pages, coordinates, vertex colors, generated shaders.
#include "q3map2/lightmap/store/lightmap_store.h"

#include "common/text/text.h"
#include "q3map2/light/options/light_tone.h"
#include "q3map2/lightmap/store/hdr_store.h"
#include "q3map2/lightmap/store/lightmap_layers.h"
#include "q3map2/lightmap/store/lightmap_pack.h"
#include "q3map2/lightmap/store/lightmap_scripts.h"

#include <algorithm>
#include <cmath>
#include <set>

namespace q3 {

namespace {

using ByteColor = std::array<std::uint8_t, 3>;

/// A direction as bytes: components -1 to 1 become 0 to 255.
ByteColor DirectionBytes(const Vec3f &direction) {
    const Vec3f d = Normalize(direction);
    const auto byte = [](float c) { return std::uint8_t(std::clamp(c * 127.5f + 127.5f, 0.0f, 255.0f)); };
    return {byte(d.x), byte(d.y), byte(d.z)};
}

void Put(std::vector<std::uint8_t> &pixels, std::size_t at, const ByteColor &color) {
    std::copy(color.begin(), color.end(), pixels.begin() + std::ptrdiff_t(3 * at));
}

/// What -fill knows of a texel.
enum class TexelFill : std::uint8_t { Unused, Used, InNextRing };

/// -fill: unused texels take the mean of their 4 neighbors, in rings growing from used ones; pages wrap around.
void FillPage(LightmapPage &page, std::vector<TexelFill> texels) {
    const int w = page.width, h = page.height;
    const auto neighbors = [&](std::size_t at) {
        const int x = int(at) % w, y = int(at) / w;
        const auto index = [&](int column, int row) { return std::size_t(row) * std::size_t(w) + std::size_t(column); };
        return std::array{index((x + 1) % w, y), index((x + w - 1) % w, y), index(x, (y + 1) % h),
                          index(x, (y + h - 1) % h)};
    };
    std::vector<std::size_t> ring, next;
    const auto addNeighbors = [&](std::size_t from) {
        for (const std::size_t at : neighbors(from))
            if (texels[at] == TexelFill::Unused)
                texels[at] = TexelFill::InNextRing, next.push_back(at);
    };
    for (std::size_t at = 0; at < texels.size(); ++at)
        if (texels[at] == TexelFill::Used)
            addNeighbors(at);
    std::vector<ByteColor> means;
    while (!next.empty()) {
        ring.swap(next), next.clear(), means.clear();
        for (const std::size_t at : ring) {
            std::array<int, 3> sum{};
            int count = 0;
            for (const std::size_t other : neighbors(at))
                if (texels[other] == TexelFill::Used) {
                    ++count;
                    for (std::size_t i = 0; i < 3; ++i)
                        sum[i] += page.colors[3 * other + i];
                }
            means.push_back({std::uint8_t(sum[0] / count), std::uint8_t(sum[1] / count), std::uint8_t(sum[2] / count)});
        }
        for (std::size_t i = 0; i < ring.size(); ++i)
            Put(page.colors, ring[i], means[i]), texels[ring[i]] = TexelFill::Used;
        for (const std::size_t at : ring)
            addNeighbors(at);
    }
}

class Storer {
  public:
    Storer(const SurfaceInputs &in, SurfaceLight &surfaces, std::string_view mapName, Bsp &bsp)
        : in_(in), surfaces_(surfaces), mapName_(mapName), bsp_(bsp), tone_(StoredTone(in)) {
        const std::vector<Entity> entities = ParseEntities(bsp.entities, mapName);
        if (!entities.empty())
            world_ = entities.front();
    }

    StoredLightmaps Run() {
        layers_ = MakeLayers(in_, surfaces_);
        CountUsedLuxels();
        ApplyStandIns();
        if (in_.lightmap.collapse && !surfaces_.styled && !in_.lightmap.deluxe)
            JoinTwins(layers_.layers);
        MakePages(PackLayers(PackingOrder(in_, surfaces_, layers_), in_.lightmap, layers_));
        FillTexels();
        if (in_.lightmap.lightmass)
            MakeLightmassPages();
        SetPageLight(in_, layers_, result_.pages);
        for (LightmapLayer &layer : layers_.layers)
            layer.channels = {};
        StartVertexLight();
        for (std::size_t i = 0; i < bsp_.drawSurfaces.size(); ++i)
            if (!CopiesParent(i))
                StoreSurface(i);
        for (std::size_t i = 0; i < bsp_.drawSurfaces.size(); ++i)
            if (CopiesParent(i))
                CopyParent(i);
        StoreLump();
        Print();
        return std::move(result_);
    }

  private:
    void CountUsedLuxels() {
        for (const LightmapLayer &layer : layers_.layers)
            usedLuxels_ +=
                std::count_if(layer.texels.begin(), layer.texels.end(), [](const Vec3f &t) { return t.x >= 0; });
    }

    void ApplyStandIns() {
        const std::vector<VertexStandIn> standIns = FindVertexStandIns(in_, surfaces_);
        for (LightmapLayer &layer : layers_.layers) {
            const VertexStandIn kind = standIns[std::size_t(layer.lightmap)];
            const bool tooLarge = layer.width > layer.pageSize[0] || layer.height > layer.pageSize[1];
            layer.byVertex = kind != VertexStandIn::No || tooLarge;
            if (layer.slot == 0) {
                forced_ += kind == VertexStandIn::Forced;
                approximated_ += kind == VertexStandIn::Close;
            }
        }
    }

    void MakePages(const std::vector<std::array<int, 2>> &sizes) {
        int number = 0;
        const int numbersPerPage = in_.lightmap.deluxe ? 2 : 1; // the second is that of the directions
        for (std::size_t i = 0; i < sizes.size(); ++i) {
            LightmapPage page;
            page.width = sizes[i][0], page.height = sizes[i][1];
            page.file = int(i) * numbersPerPage;
            page.needsImage = in_.lightmap.external;
            if (page.needsImage || sizes[i] == in_.lightmap.gamePageSize) {
                page.number = number;
                number += numbersPerPage;
            } else
                page.needsImage = true;
            const std::size_t texels = page.Texels();
            page.colors.resize(in_.lightmap.ldr ? 3 * texels : 0);
            if (in_.lightmap.deluxe)
                page.directions.resize(3 * texels);
            if (in_.lightmap.fillPink && in_.lightmap.ldr)
                for (std::size_t at = 0; at < texels; ++at)
                    Put(page.colors, at, {255, 0, 255});
            result_.pages.push_back(std::move(page));
        }
        if (in_.lightmap.fill && in_.lightmap.ldr)
            for (const LightmapPage &page : result_.pages)
                fills_.emplace_back(page.Texels());
    }

    void MakeLightmassPages() {
        for (const LightmapPage &page : result_.pages) {
            LightmassPage &to = result_.lightmass.pages.emplace_back();
            to.number = page.number, to.file = page.file;
            to.width = page.width, to.height = page.height;
        }
        EncodeLightmass(in_, surfaces_, layers_, result_.lightmass);
        for (LightmapLayer &layer : layers_.layers) // frees memory for HDR pages and basis maps
            for (std::size_t c = 0; c < layer.channels.size(); ++c)
                if (layer.kinds.IsSH(c))
                    layer.channels[c] = {};
    }

    void FillTexels() {
        in_.jobs.For(std::int64_t(layers_.layers.size()), [&](std::int64_t i, int) {
            const LightmapLayer &layer = layers_.layers[std::size_t(i)];
            if (layer.twin >= 0 || layer.page < 0)
                return;
            const ToneMapper mapper(1, layer.brightness, tone_);
            if (layer.solid)
                return PutTexel(layer, 0, 0, layer.color, layer.direction, mapper);
            for (int y = 0; y < layer.height; ++y)
                for (int x = 0; x < layer.width; ++x)
                    if (const std::size_t at = std::size_t(y) * std::size_t(layer.width) + std::size_t(x);
                        layer.Used(at))
                        PutTexel(layer, x, y, layer.texels[at],
                                 layer.directions.empty() ? Vec3f{} : layer.directions[at], mapper);
        });
        in_.jobs.For(std::int64_t(fills_.size()),
                     [&](std::int64_t i, int) { FillPage(result_.pages[std::size_t(i)], fills_[std::size_t(i)]); });
    }

    void PutTexel(const LightmapLayer &layer, int x, int y, const Vec3f &color, const Vec3f &direction,
                  const ToneMapper &mapper) {
        LightmapPage &page = result_.pages[std::size_t(layer.page)];
        const std::size_t at = page.Index(layer.x + x, layer.y + y);
        const Vec3f least = layer.slot == 0 ? in_.world.minLight : Vec3f{};
        if (!page.colors.empty())
            Put(page.colors, at, mapper.Bytes(Max(color, least)));
        if (!page.directions.empty())
            Put(page.directions, at, DirectionBytes(direction));
        if (!fills_.empty())
            fills_[std::size_t(layer.page)][at] = TexelFill::Used;
    }

    /// The packed layer of a surface; null: none, or it is lit at its vertices.
    const LightmapLayer *LayerOf(std::size_t surface, std::size_t slot) const {
        const int lightmap = surfaces_.lightmapOf[surface];
        const int layer = lightmap < 0 ? -1 : layers_.layerOf[std::size_t(lightmap)][slot];
        return layer < 0 || layers_.layers[std::size_t(layer)].page < 0 ? nullptr : &layers_.layers[std::size_t(layer)];
    }

    std::array<float, 2> Coordinates(const LightmapLayer &layer, std::size_t vertex) const {
        const LightmapPage &page = result_.pages[std::size_t(layer.page)];
        const float super = float(surfaces_.lightmaps[std::size_t(layer.lightmap)].super);
        const std::array<float, 2> &luxel = surfaces_.verts[vertex].luxel;
        const float x = layer.solid ? 0.5f : luxel[0] / super, y = layer.solid ? 0.5f : luxel[1] / super;
        return {(float(layer.x) + x) / float(page.width), (float(layer.y) + y) / float(page.height)};
    }

    void StoreSurface(std::size_t i) {
        bspDrawSurface_t &surface = bsp_.drawSurfaces[i];
        surface.lightmapX.fill(0), surface.lightmapY.fill(0);
        surface.lightmapWidth = surface.lightmapHeight = 0;
        surface.lightmapNum.fill(kLightmapByVertex);
        if (surface.surfaceType != MST_FLARE) // the bsp stage knows the style of a flare
            surface.lightmapStyles = surface.vertexStyles = kOnlyStyle0;
        // The surface may name a shader generated by an earlier run, whose script is gone.
        const bspShader_t old = bsp_.shaders[std::size_t(surface.shaderNum)];
        const ShaderInfo &shader = *in_.table[i].shader;
        if (IsGeneratedName(FieldName(old.shader), mapName_) && !IsGeneratedName(shader.name, mapName_))
            surface.shaderNum = ShaderNumber(bsp_, shader.name, old.surfaceFlags, old.contentFlags);
        const LightmapLayer *layer = LayerOf(i, 0);
        if (in_.options.styleSlots)
            StoreOtherStyles(i);
        StoreVertexColors(i);
        if (!layer)
            return;
        const RawLightmap &lightmap = surfaces_.lightmaps[std::size_t(layer->lightmap)];
        surface.lightmapOrigin = {lightmap.storedOrigin.x, lightmap.storedOrigin.y, lightmap.storedOrigin.z};
        StorePage(i, 0, *layer);
        combinations_.insert({layer->page, surface.shaderNum});
        MakeShader(i, *layer);
    }

    /// Stores which page has the light of a slot, and where.
    void StorePage(std::size_t i, std::size_t slot, const LightmapLayer &layer) {
        bspDrawSurface_t &surface = bsp_.drawSurfaces[i];
        const LightmapPage &page = result_.pages[std::size_t(layer.page)];
        surface.lightmapNum[slot] = page.number < 0 ? kLightmapByVertex : page.number;
        if (in_.lightmap.debugDeluxe && in_.lightmap.deluxe && page.number >= 0)
            ++surface.lightmapNum[slot];
        for (int v = surface.firstVert; v < surface.firstVert + surface.numVerts; ++v)
            bsp_.drawVerts[std::size_t(v)].lightmap[slot] = Coordinates(layer, std::size_t(v));
    }

    /// Fills the slots after the first, without a gap: with the styles of the lightmap, or else with those of the
    /// vertices.
    void StoreOtherStyles(std::size_t i) {
        bspDrawSurface_t &surface = bsp_.drawSurfaces[i];
        const bool hasLightmap = LayerOf(i, 0) != nullptr;
        std::size_t next = 1;
        for (std::size_t slot = 1; slot < kStyles; ++slot) {
            const LightmapLayer *layer = hasLightmap ? LayerOf(i, slot) : nullptr;
            if (layer) {
                surface.lightmapStyles[next] = surfaces_.lightmaps[std::size_t(layer->lightmap)].styles[slot];
                StorePage(i, next++, *layer);
            } else if (!hasLightmap && HasVertexLight(i, slot))
                surface.lightmapStyles[next++] = surfaces_.vertex.styles[i][slot];
        }
        surface.vertexStyles = surface.lightmapStyles;
    }

    /// Whether a style slot of the vertices shows at any of them.
    bool HasVertexLight(std::size_t i, std::size_t slot) const {
        const bspDrawSurface_t &surface = bsp_.drawSurfaces[i];
        const std::vector<Vec3f> &sum = surfaces_.vertex.sum[slot];
        if (sum.empty() || surfaces_.vertex.styles[i][slot] == kNoStyle)
            return false;
        const auto light = std::span(sum).subspan(std::size_t(surface.firstVert), std::size_t(surface.numVerts));
        return std::ranges::any_of(light, [&](const Vec3f &l) {
            return StyledVertexBytes(in_, *in_.table[i].shader, l, tone_) != ByteColor{};
        });
    }

    /// Generates a shader if the surface has several styles that its record does not hold, or a page that the file
    /// cannot hold.
    void MakeShader(std::size_t i, const LightmapLayer &layer) {
        bspDrawSurface_t &surface = bsp_.drawSurfaces[i];
        const ShaderInfo &shader = *in_.table[i].shader;
        LightmapPage &page = result_.pages[std::size_t(layer.page)];
        std::string text;
        if (const std::vector<StyleStage> stages = StagesOf(i, layer); !stages.empty()) {
            text = StyledText(shader, stages, world_, mapName_);
            if (text.empty() && unmarked_.insert(shader.name).second)
                in_.log.Warn("light style without a stage",
                             "{}: no q3map_styleMarker in its script, engines show no light of other styles than 0; it "
                             "belongs after the stage of $lightmap",
                             shader.name);
            for (std::size_t slot = 1; slot < kStyles && !text.empty(); ++slot)
                if (const LightmapLayer *other = LayerOf(i, slot); other && other->page != layer.page)
                    result_.pages[std::size_t(other->page)].needsImage = true;
        }
        if (page.number < 0)
            text = ImageText(shader, text, page.file, mapName_);
        if (text.empty())
            return;
        if (page.HasBasis() && (page.number < 0 || in_.lightmap.external))
            text = WithBasisMaps(std::move(text), mapName_, page.file, in_.lightmap.rnmRescaled);
        const std::string name = ShaderNameFor(text, mapName_);
        if (madeShaders_.insert(name).second)
            result_.scripts.push_back({name, text});
        const bspShader_t old = bsp_.shaders[std::size_t(surface.shaderNum)];
        surface.shaderNum = ShaderNumber(bsp_, name, old.surfaceFlags, old.contentFlags);
    }

    std::vector<StyleStage> StagesOf(std::size_t i, const LightmapLayer &first) const {
        std::vector<StyleStage> stages;
        if (in_.options.styleSlots)
            return stages;
        const auto vertex = std::size_t(bsp_.drawSurfaces[i].firstVert);
        for (std::size_t slot = 1; slot < kStyles; ++slot) {
            const LightmapLayer *layer = LayerOf(i, slot);
            if (!layer)
                continue;
            const LightmapPage &page = result_.pages[std::size_t(layer->page)];
            const auto from = Coordinates(first, vertex), to = Coordinates(*layer, vertex);
            const bool samePage = layer->page == first.page && page.number >= 0;
            stages.push_back({surfaces_.lightmaps[std::size_t(first.lightmap)].styles[slot],
                              samePage ? -1 : page.file,
                              {to[0] - from[0], to[1] - from[1]}});
        }
        return stages;
    }

    /// Starts with the vertex colors, which stay where no surface stores light.
    void StartVertexLight() {
        for (const bspDrawVert_t &vertex : bsp_.drawVerts)
            if (in_.lightmap.hdr)
                result_.vertexLight.push_back(
                    Vec3f{float(vertex.color[0][0]), float(vertex.color[0][1]), float(vertex.color[0][2])} / 255);
    }

    void StoreVertexColors(std::size_t i) {
        const bspDrawSurface_t &surface = bsp_.drawSurfaces[i];
        const ShaderInfo &shader = *in_.table[i].shader;
        const std::vector<Vec3f> &sum = surfaces_.vertex.sum[0];
        if (sum.empty())
            return;
        const auto put = [this](const ByteColor &color, std::size_t vertex, std::size_t slot) {
            std::ranges::copy(color, bsp_.drawVerts[vertex].color[slot].begin()); // alpha stays
        };
        const auto first = std::size_t(surface.firstVert), end = first + std::size_t(surface.numVerts);
        for (std::size_t v = first; v < end && !shader.lightmap.noVertexLight; ++v) {
            put(VertexBytes(in_, shader, sum[v], tone_), v, 0);
            if (!result_.vertexLight.empty())
                result_.vertexLight[v] = VertexLightOf(in_, shader, sum[v], tone_);
        }
        for (std::size_t slot = 1; slot < kStyles; ++slot) {
            const std::uint8_t style = surface.vertexStyles[slot];
            const std::size_t from = style == kNoStyle ? kStyles : FindStyleSlot(surfaces_.vertex.styles[i], style);
            const bool known = from < kStyles && !surfaces_.vertex.sum[from].empty() && !shader.lightmap.noVertexLight;
            for (std::size_t v = first; v < end; ++v)
                put(known ? StyledVertexBytes(in_, shader, surfaces_.vertex.sum[from][v], tone_) : ByteColor{}, v,
                    slot);
        }
    }

    bool CopiesParent(std::size_t i) const {
        const int parent = in_.table[i].parent;
        return parent >= 0 && std::size_t(parent) < bsp_.drawSurfaces.size() && std::size_t(parent) != i &&
               in_.table[std::size_t(parent)].parent < 0 &&
               bsp_.drawSurfaces[std::size_t(parent)].numVerts == bsp_.drawSurfaces[i].numVerts &&
               bsp_.drawSurfaces[std::size_t(parent)].numIndexes == bsp_.drawSurfaces[i].numIndexes;
    }

    void CopyParent(std::size_t i) {
        const bspDrawSurface_t &parent = bsp_.drawSurfaces[std::size_t(in_.table[i].parent)];
        bspDrawSurface_t &surface = bsp_.drawSurfaces[i];
        const bspDrawSurface_t old = surface;
        surface = parent;
        surface.fogNum = old.fogNum;
        surface.firstVert = old.firstVert, surface.firstIndex = old.firstIndex;
        surface.lightmapVecs = old.lightmapVecs;
        for (int v = 0; v < surface.numVerts; ++v) {
            bspDrawVert_t &to = bsp_.drawVerts[std::size_t(surface.firstVert + v)];
            const bspDrawVert_t &from = bsp_.drawVerts[std::size_t(parent.firstVert + v)];
            to.lightmap = from.lightmap, to.color = from.color;
            if (!result_.vertexLight.empty())
                result_.vertexLight[std::size_t(surface.firstVert + v)] =
                    result_.vertexLight[std::size_t(parent.firstVert + v)];
        }
    }

    void StoreLump() {
        bsp_.lightmaps.clear();
        bsp_.lightmapSide = in_.lightmap.gamePageSize[0];
        for (const LightmapPage &page : result_.pages) {
            if (in_.lightmap.external || page.number < 0 || !in_.lightmap.ldr)
                continue;
            bsp_.lightmaps.insert(bsp_.lightmaps.end(), page.colors.begin(), page.colors.end());
            bsp_.lightmaps.insert(bsp_.lightmaps.end(), page.directions.begin(), page.directions.end());
        }
    }

    void Print() const {
        long long stored = (long long)(bsp_.lightmaps.size() / 3), solid = 0, twins = 0, twinLuxels = 0, numbered = 0;
        for (const LightmapLayer &layer : layers_.layers) {
            solid += layer.solid;
            twins += layer.twin >= 0;
            twinLuxels += layer.twin >= 0 ? (long long)(layer.texels.size()) : 0;
        }
        for (const LightmapPage &page : result_.pages)
            numbered += page.number < 0 ? 0 : page.directions.empty() ? 1 : 2;
        Log &log = in_.log;
        log.Count(usedLuxels_, "luxels used");
        log.Print("{:9} {} stored ({:.2f} percent efficiency)\n", stored, stored == 1 ? "luxel" : "luxels",
                  stored > 0 ? 100 * double(usedLuxels_) / double(stored) : 0);
        log.Count(solid, "solid surface lightmaps");
        log.Print("{:9} identical surface {}, using {}\n", twins, twins == 1 ? "lightmap" : "lightmaps",
                  Counted(twinLuxels, "luxels"));
        log.Count(forced_, "vertex forced surfaces");
        log.Count(approximated_, "vertex approximated surfaces");
        log.Count(in_.lightmap.external ? 0 : numbered, "BSP lightmaps");
        log.Count(result_.pages.size(), "total lightmaps");
        log.Count(combinations_.size(), "unique lightmap/shader combinations");
    }

    const SurfaceInputs &in_;
    SurfaceLight &surfaces_;
    const std::string mapName_;
    Bsp &bsp_;
    ToneOptions tone_;
    Entity world_;
    LightmapLayers layers_;
    StoredLightmaps result_;
    std::vector<std::vector<TexelFill>> fills_;   ///< by page, texel; only with -fill
    std::set<std::pair<int, int>> combinations_;  ///< of page and shader
    std::set<std::string, std::less<>> unmarked_; ///< shaders that styles do not show on
    std::set<std::string> madeShaders_;           ///< names of generated shaders
    long long usedLuxels_ = 0;
    long long forced_ = 0, approximated_ = 0; ///< lightmaps by VertexStandIn
};

} // namespace

StoredLightmaps StoreLightmaps(const SurfaceInputs &in, SurfaceLight &surfaces, std::string_view mapName, Bsp &bsp) {
    return Storer(in, surfaces, mapName, bsp).Run();
}

} // namespace q3
