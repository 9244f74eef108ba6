// GPL-2.0-or-later. A map in the format of another game: IBSP with one light style, RBSP and FBSP with four.
#include "q3map2/convert/game/format_change.h"

#include "q3map2/bspfile/bspfile_rbsp.h"
#include "q3map2/bspfile/bspx_lumps.h"
#include "q3map2/bspfile/entities.h"

#include <algorithm>
#include <utility>

namespace q3 {

namespace {

constexpr std::array<std::uint8_t, 3> kBlack{};

/// Whether a point is in a wall: without ambient light in IBSP files, without a style in others.
bool IsInWall(const bspGridPoint_t &point, std::string_view ident) {
    return ident == kIbspIdent ? point.ambient[0] == kBlack : point.styles == kNoStyles;
}

/// The slot of style 0; slot 0 if no slot has it.
std::size_t SteadySlot(const Styles &styles) {
    const auto slot = std::size_t(std::ranges::find(styles, 0) - styles.begin());
    return slot < kStyles ? slot : 0;
}

/// Whether a record has light of other styles than 0.
bool HasOtherStyles(const Styles &styles) {
    return std::ranges::any_of(styles, [](int style) { return style != 0 && style != kNoStyle; });
}

/// Drops the light of other styles than 0. A surface that has no other keeps that of its first slot.
void DropStyles(Bsp &bsp, Log &log) {
    std::size_t surfaces = 0;
    for (bspDrawSurface_t &surface : bsp.drawSurfaces) {
        surfaces += HasOtherStyles(surface.lightmapStyles) || HasOtherStyles(surface.vertexStyles);
        const std::size_t page = SteadySlot(surface.lightmapStyles), color = SteadySlot(surface.vertexStyles);
        std::swap(surface.lightmapNum[0], surface.lightmapNum[page]);
        for (int v = surface.firstVert; v < surface.firstVert + surface.numVerts; ++v) {
            bspDrawVert_t &vert = bsp.drawVerts[std::size_t(v)];
            std::swap(vert.lightmap[0], vert.lightmap[page]);
            std::swap(vert.color[0], vert.color[color]);
        }
        surface.lightmapStyles = surface.vertexStyles = kOnlyStyle0;
        std::fill(surface.lightmapNum.begin() + 1, surface.lightmapNum.end(), kLightmapByVertex);
        std::fill(surface.lightmapX.begin() + 1, surface.lightmapX.end(), 0);
        std::fill(surface.lightmapY.begin() + 1, surface.lightmapY.end(), 0);
    }
    for (bspDrawVert_t &vert : bsp.drawVerts) {
        std::fill(vert.lightmap.begin() + 1, vert.lightmap.end(), std::array<float, 2>{});
        std::fill(vert.color.begin() + 1, vert.color.end(), std::array<std::uint8_t, 4>{});
    }
    if (surfaces > 0)
        log.Warn("light styles dropped",
                 "surfaces with light of other styles than 0: {}; one style is kept, 0 if they have it", surfaces);
}

/// RBSP: engines look up the color of a style in a table that ends at kLastStyle.
void DropHighStyles(Bsp &bsp, Log &log) {
    std::size_t surfaces = 0;
    for (bspDrawSurface_t &surface : bsp.drawSurfaces) {
        const auto isHigh = [](int style) { return style > kLastStyle && style != kNoStyle; };
        for (std::size_t slot = 0; slot < kStyles; ++slot)
            if (isHigh(surface.lightmapStyles[slot]) || isHigh(surface.vertexStyles[slot])) {
                std::fill(surface.lightmapStyles.begin() + std::ptrdiff_t(slot), surface.lightmapStyles.end(),
                          kNoStyle);
                std::fill(surface.vertexStyles.begin() + std::ptrdiff_t(slot), surface.vertexStyles.end(), kNoStyle);
                ++surfaces;
            }
    }
    if (surfaces > 0)
        log.Warn("light styles dropped",
                 "surfaces with light styles above {}, which RBSP engines do not have: {}; they "
                 "lose that light and that of the slots behind it",
                 kLastStyle, surfaces);
}

void ConvertGrid(Bsp &bsp, std::string_view ident) {
    for (bspGridPoint_t &point : bsp.gridPoints) {
        const bool inWall = IsInWall(point, bsp.ident);
        if (ident != kIbspIdent) {
            if (bsp.ident == kIbspIdent)
                point.styles = inWall ? kNoStyles : kOnlyStyle0;
            continue;
        }
        const std::size_t slot = SteadySlot(point.styles);
        const bool isSteady = point.styles[slot] == 0;
        point = {{point.ambient[slot]}, {point.directed[slot]}, kOnlyStyle0, point.latLong};
        if (inWall || !isSteady)
            point.ambient[0] = point.directed[0] = kBlack;
        if (!inWall && point.ambient[0] == kBlack)
            point.ambient[0] = {1, 1, 1}; // black ambient light would mean a wall
    }
}

/// Lightmap pages for the format, and the key that says their size.
void FitPages(Bsp &bsp, std::string_view ident, Log &log) {
    if (ident == kFbspIdent) {
        std::vector<Entity> entities = StoredEntities(bsp.entities, "entities");
        entities.front().Set(kLightmapImageSizeKey, fmt::format("{}", bsp.lightmapSide));
        bsp.entities = FormatEntities(entities);
        return;
    }
    if (bsp.lightmapSide == kLightmapSide)
        return;
    if (!bsp.lightmaps.empty() || !bsp.lightmapsE5bgr9.empty() || bsp.rnm) {
        log.Warn("lightmaps dropped",
                 "lightmap pages of {} texels are dropped, {} has pages of {}: surfaces show the light of their "
                 "vertices until the map is lit again",
                 bsp.lightmapSide, ident, kLightmapSide);
        for (bspDrawSurface_t &surface : bsp.drawSurfaces)
            surface.lightmapNum.fill(kLightmapByVertex);
        bsp.lightmaps.clear();
        for (const BspxId id : {BspxId::LightmapsE5bgr9, BspxId::Rnm})
            RowOf(id).clear(bsp);
    }
    bsp.lightmapSide = kLightmapSide;
}

} // namespace

void ChangeFormat(Bsp &bsp, std::string_view ident, Log &log) {
    if (bsp.ident == ident)
        return;
    ConvertGrid(bsp, ident);
    FitPages(bsp, ident, log);
    if (ident == kIbspIdent)
        DropStyles(bsp, log);
    if (ident == kRbspIdent)
        DropHighStyles(bsp, log);
    if (ident != kIbspIdent && !bsp.advertisements.empty()) {
        log.Warn("advertisements dropped", "{} advertisements are dropped: {} has no place for them",
                 bsp.advertisements.size(), ident);
        bsp.advertisements.clear();
    }
    if (bsp.gridSH && ident != kIbspIdent)
        bsp.gridSHContainer = GridSHContainer::Bspx;
    bsp.ident = ident;
}

} // namespace q3
