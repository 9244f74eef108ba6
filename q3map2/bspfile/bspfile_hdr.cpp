// GPL-2.0-or-later. BSPX lumps of HDR light.
#include "q3map2/bspfile/bspfile_hdr.h"

#include "common/error.h"
#include "q3map2/bspfile/bspx.h"
#include "q3map2/bspfile/prop_light.h"

#include <algorithm>
#include <set>
#include <string>

namespace q3 {

namespace {

constexpr std::uint32_t kMaxRnmSide = 16384;
constexpr std::size_t kTexelBytes = 3; ///< of lightmaps in lump 14
constexpr std::size_t kLeastPageTexels = kLightmapPageBytes / kTexelBytes;

std::uint64_t MapTexels(const bspRnmHeader_t &head) {
    return std::uint64_t(head.side) * head.side;
}

std::vector<std::uint32_t> ReadCodes(const ByteSource &file, const BspxPart &lump, std::string_view name) {
    if (lump.part.length % 4 != 0)
        throw Error("{}: BSPX lump {}: length {} is not a multiple of 4", name, lump.name, lump.part.length);
    std::vector<std::uint32_t> codes(std::size_t(lump.part.length / 4));
    file.Fill(std::uint64_t(lump.part.offset), std::span(codes));
    return codes;
}

/// What is wrong with the head; empty: nothing.
std::string RnmHeadFault(const bspRnmHeader_t &head) {
    if (head.magic != bspRnmHeader_t{}.magic)
        return "does not start with RNM1";
    if (head.version != 1)
        return fmt::format("version {}, expected 1", head.version);
    if (head.storage != RnmStorage::Raw && head.storage != RnmStorage::Rescaled)
        return fmt::format("storage {}, expected 0 or 1", std::uint32_t(head.storage));
    if (head.side < 1 || head.side > kMaxRnmSide)
        return fmt::format("side {}, expected 1 to {}", head.side, kMaxRnmSide);
    if (head.pageCount < 1)
        return "no pages, expected at least 1";
    return {};
}

RnmLightmaps ReadRnm(const ByteSource &file, const FilePart &part, std::string_view name) {
    const auto fail = [&](const std::string &text) { throw Error("{}: BSPX lump {}: {}", name, kBspxRnm, text); };
    RnmLightmaps rnm;
    if (part.length < std::int64_t(sizeof rnm.header))
        fail(fmt::format("length {} is under the {} of its head", part.length, sizeof rnm.header));
    std::uint64_t at = std::uint64_t(part.offset);
    file.Fill(at, std::span(&rnm.header, 1));
    at += sizeof rnm.header;
    if (const std::string fault = RnmHeadFault(rnm.header); !fault.empty())
        fail(fault);
    const std::uint64_t texels = MapTexels(rnm.header), page = 4 + 12 * texels;
    const std::uint64_t room = std::uint64_t(part.length) - sizeof rnm.header;
    if (room % page != 0 || room / page != rnm.header.pageCount)
        fail(fmt::format("length {} is not {} + {} pages x {}", part.length, sizeof rnm.header, rnm.header.pageCount,
                         page));
    rnm.pages.resize(rnm.header.pageCount);
    for (RnmPage &one : rnm.pages) {
        file.Fill(at, std::span(&one.lightmapNum, 1));
        at += 4;
        for (std::vector<std::uint32_t> &map : one.maps) {
            map.resize(std::size_t(texels));
            file.Fill(at, std::span(map));
            at += 4 * texels;
        }
    }
    return rnm;
}

// Each returns what does not fit the map; empty: nothing.

std::string LightmapsFault(const Bsp &bsp) {
    const std::size_t texels = bsp.lightmaps.size() / kTexelBytes, codes = bsp.lightmapsE5bgr9.size();
    if (codes == 0)
        return {};
    if (texels > 0 && codes != texels)
        return fmt::format("{} texels, but the lightmaps have {}", codes, texels);
    if (codes % kLeastPageTexels != 0) // lump 14 is empty: nothing to compare with
        return fmt::format("{} texels are not a multiple of {}", codes, kLeastPageTexels);
    return {};
}

std::string VertexFault(const Bsp &bsp) {
    if (!bsp.vertexE5bgr9.empty() && bsp.vertexE5bgr9.size() != bsp.drawVerts.size())
        return fmt::format("{} colors, but the map has {} draw verts", bsp.vertexE5bgr9.size(), bsp.drawVerts.size());
    return {};
}

std::string RnmFault(const Bsp &bsp) {
    if (!bsp.rnm)
        return {};
    const bspRnmHeader_t &head = bsp.rnm->header;
    if (std::string fault = RnmHeadFault(head); !fault.empty())
        return fault;
    if (head.pageCount != bsp.rnm->pages.size())
        return fmt::format("pageCount is {}, but there are {} pages", head.pageCount, bsp.rnm->pages.size());
    const std::uint64_t texels = MapTexels(head), bytes = kTexelBytes * texels, all = bsp.lightmaps.size();
    if (all % bytes != 0)
        return fmt::format("side {}, but the lightmaps are not whole pages of that side", head.side);
    std::set<std::int32_t> seen;
    for (const RnmPage &page : bsp.rnm->pages) {
        if (page.lightmapNum < 0 || (all > 0 && std::uint64_t(page.lightmapNum) >= all / bytes))
            return fmt::format("lightmapNum {} is not one of {} lightmaps", page.lightmapNum, all / bytes);
        if (!seen.insert(page.lightmapNum).second)
            return fmt::format("two pages have lightmapNum {}", page.lightmapNum);
        for (const std::vector<std::uint32_t> &map : page.maps)
            if (map.size() != texels)
                return fmt::format("a map of {} texels, expected {}", map.size(), texels);
    }
    return {};
}

/// Calls visit(name of the lump, fault) for each of the lumps that does not fit.
template <typename Visit> void ForEachFault(const Bsp &bsp, const Visit &visit) {
    const std::pair<std::string_view, std::string> faults[] = {{kBspxLightmapsE5bgr9, LightmapsFault(bsp)},
                                                               {kBspxVertexE5bgr9, VertexFault(bsp)},
                                                               {kBspxRnm, RnmFault(bsp)},
                                                               {kBspxPropLight, PropLightFault(bsp)}};
    for (const auto &[lump, fault] : faults)
        if (!fault.empty())
            visit(lump, fault);
}

} // namespace

bool IsHdrLump(std::string_view name) {
    return name == kBspxLightmapsE5bgr9 || name == kBspxVertexE5bgr9 || name == kBspxRnm;
}

bool ReadHdrLump(const ByteSource &file, const BspxPart &lump, std::string_view name, Bsp &bsp) {
    if (lump.name == kBspxLightmapsE5bgr9)
        bsp.lightmapsE5bgr9 = ReadCodes(file, lump, name);
    else if (lump.name == kBspxVertexE5bgr9)
        bsp.vertexE5bgr9 = ReadCodes(file, lump, name);
    else if (lump.name == kBspxRnm)
        bsp.rnm = ReadRnm(file, lump.part, name);
    else
        return false;
    return true;
}

void CheckHdrLight(const Bsp &bsp, std::string_view name) {
    ForEachFault(bsp, [&](std::string_view lump, const std::string &fault) {
        throw Error("{}: BSPX lump {}: {}", name, lump, fault);
    });
}

void DropUnfitHdrLight(Bsp &bsp, std::string_view name, Log &log) {
    ForEachFault(bsp, [&](std::string_view lump, const std::string &fault) {
        log.Warn(lump, "{}: BSPX lump {} is dropped: {}", name, lump, fault);
        if (lump == kBspxLightmapsE5bgr9)
            bsp.lightmapsE5bgr9.clear();
        else if (lump == kBspxVertexE5bgr9)
            bsp.vertexE5bgr9.clear();
        else if (lump == kBspxRnm)
            bsp.rnm.reset();
        else
            SetPropLight(bsp, {});
    });
}

void ClearHdrLight(Bsp &bsp) {
    bsp.lightmapsE5bgr9.clear();
    bsp.vertexE5bgr9.clear();
    bsp.rnm.reset();
}

} // namespace q3
