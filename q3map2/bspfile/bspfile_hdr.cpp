// GPL-2.0-or-later. BSPX lumps of HDR light.
#include "q3map2/bspfile/bspfile_hdr.h"

#include <fmt/format.h>

#include <set>

namespace q3 {

namespace {

constexpr std::size_t kTexelBytes = 3; ///< of lightmaps in lump 14: RGB
constexpr std::size_t kCodeBytes = 4;  ///< of an E5BGR9 code
/// Texels of the smallest pages; larger ones have a multiple of them.
constexpr std::size_t kLeastPageTexels = kLightmapPageBytes / kTexelBytes;

std::uint64_t MapTexels(const bspRnmHeader_t &head) {
    return std::uint64_t(head.side) * head.side;
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

} // namespace

std::vector<std::uint32_t> ReadCodes(const BspxSource &from) {
    const auto codeBytes = std::int64_t(kCodeBytes);
    if (from.part.length % codeBytes != 0)
        from.Fail(fmt::format("length {} is not a multiple of {}", from.part.length, codeBytes));
    std::vector<std::uint32_t> codes(std::size_t(from.part.length / codeBytes));
    from.file.Fill(std::uint64_t(from.part.offset), std::span(codes));
    return codes;
}

RnmLightmaps ReadRnm(const BspxSource &from) {
    RnmLightmaps rnm;
    const std::int64_t length = from.part.length;
    if (length < std::int64_t(sizeof rnm.header))
        from.Fail(fmt::format("length {} is under the {} of its head", length, sizeof rnm.header));
    std::uint64_t at = std::uint64_t(from.part.offset);
    from.file.Fill(at, std::span(&rnm.header, 1));
    at += sizeof rnm.header;
    if (const std::string fault = RnmHeadFault(rnm.header); !fault.empty())
        from.Fail(fault);
    const std::uint64_t texels = MapTexels(rnm.header);
    const std::uint64_t page = sizeof(RnmPage::lightmapNum) + 3 * kCodeBytes * texels; // three maps
    const std::uint64_t room = std::uint64_t(length) - sizeof rnm.header;
    if (room % page != 0 || room / page != rnm.header.pageCount)
        from.Fail(
            fmt::format("length {} is not {} + {} pages x {}", length, sizeof rnm.header, rnm.header.pageCount, page));
    rnm.pages.resize(rnm.header.pageCount);
    for (RnmPage &read : rnm.pages) {
        from.file.Fill(at, std::span(&read.lightmapNum, 1));
        at += sizeof read.lightmapNum;
        for (std::vector<std::uint32_t> &map : read.maps) {
            map.resize(std::size_t(texels));
            from.file.Fill(at, std::span(map));
            at += kCodeBytes * texels;
        }
    }
    return rnm;
}

ByteRanges RnmRanges(const RnmLightmaps &rnm) {
    ByteRanges bytes;
    bytes.Add(std::span(&rnm.header, 1));
    for (const RnmPage &page : rnm.pages) {
        bytes.Add(std::span(&page.lightmapNum, 1));
        for (const std::vector<std::uint32_t> &map : page.maps)
            bytes.Add(map);
    }
    return bytes;
}

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

} // namespace q3
