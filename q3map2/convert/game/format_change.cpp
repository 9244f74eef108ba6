// GPL-2.0-or-later. A map in the format of another game: IBSP with one light style, RBSP and FBSP with four.
#include "q3map2/convert/game/format_change.h"

#include "q3map2/bspfile/bspfile_rbsp.h"
#include "q3map2/bspfile/bspx_lumps.h"
#include "q3map2/bspfile/entities.h"

#include <algorithm>

namespace q3 {

namespace {

constexpr std::array<std::uint8_t, 3> kBlack{};

/// Whether a point is in a wall: without ambient light in IBSP files, without a style in others.
bool IsInWall(const bspGridPoint_t &point, std::string_view ident) {
    return ident == kIbspIdent ? point.ambient[0] == kBlack : point.styles == kNoStyles;
}

/// Keeps style 0 of a record; returns whether it had others.
bool KeepFirst(Styles &styles) {
    const bool hadOthers = std::ranges::any_of(styles.begin() + 1, styles.end(), [](int s) { return s != kNoStyle; });
    styles = kOnlyStyle0;
    return hadOthers;
}

/// Drops the light of other styles than that of slot 0.
void DropStyles(Bsp &bsp, Log &log) {
    std::size_t surfaces = 0;
    for (bspDrawSurface_t &surface : bsp.drawSurfaces) {
        const bool ofLightmap = KeepFirst(surface.lightmapStyles), ofVertices = KeepFirst(surface.vertexStyles);
        surfaces += ofLightmap || ofVertices;
        std::fill(surface.lightmapNum.begin() + 1, surface.lightmapNum.end(), kLightmapByVertex);
        std::fill(surface.lightmapX.begin() + 1, surface.lightmapX.end(), 0);
        std::fill(surface.lightmapY.begin() + 1, surface.lightmapY.end(), 0);
    }
    for (bspDrawVert_t &vert : bsp.drawVerts) {
        std::fill(vert.lightmap.begin() + 1, vert.lightmap.end(), std::array<float, 2>{});
        std::fill(vert.color.begin() + 1, vert.color.end(), std::array<std::uint8_t, 4>{});
    }
    if (surfaces > 0)
        log.Warn("light styles dropped", "{} surfaces have light of several styles: only style 0 is kept", surfaces);
}

void ConvertGrid(Bsp &bsp, std::string_view ident) {
    for (bspGridPoint_t &point : bsp.gridPoints) {
        const bool inWall = IsInWall(point, bsp.ident);
        if (ident != kIbspIdent) {
            if (bsp.ident == kIbspIdent)
                point.styles = inWall ? kNoStyles : kOnlyStyle0;
            continue;
        }
        const bool isSteady = point.styles[0] == 0;
        point = {{point.ambient[0]}, {point.directed[0]}, kOnlyStyle0, point.latLong};
        if (inWall || !isSteady)
            point.ambient[0] = point.directed[0] = kBlack;
        else if (point.ambient[0] == kBlack && point.directed[0] != kBlack)
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
    if (!bsp.lightmaps.empty()) {
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
    else if (!bsp.advertisements.empty()) {
        log.Warn("advertisements dropped", "{} advertisements are dropped: {} has no place for them",
                 bsp.advertisements.size(), ident);
        bsp.advertisements.clear();
    }
    if (bsp.gridSH && ident != kIbspIdent)
        bsp.gridSHContainer = GridSHContainer::Bspx;
    bsp.ident = ident;
}

} // namespace q3
