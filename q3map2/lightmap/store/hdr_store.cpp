// GPL-2.0-or-later. HDR lightmaps and basis maps: BSPX lumps of the map and images beside it.
#include "q3map2/lightmap/store/hdr_store.h"

#include "common/files/files.h"
#include "common/image/engine_hdr.h"
#include "common/image/image.h"
#include "common/text/counted.h"
#include "libs/math/packed_color.h"
#include "q3map2/lightmap/encode/rnm.h"

#include <cmath>
#include <set>

namespace q3 {

namespace {

/// Whether the .bsp holds the page; else it is only an image beside the map. Pages that a generated shader names are
/// both.
bool IsInBsp(const LightmapPage &page, const LightmapOptions &options) {
    return page.number >= 0 && !options.external;
}

std::uint8_t UnitByte(float value) {
    return std::uint8_t(std::lround(std::clamp(value, 0.0f, 1.0f) * 255));
}

/// 8-bit basis maps. Rescaled maps pass what exceeds 1 to the other two; raw maps are cut at 1.
std::array<std::vector<std::uint8_t>, 3> BasisBytes(const LightmapPage &page, bool rescaled) {
    std::array<std::vector<std::uint8_t>, 3> bytes;
    for (std::size_t at = 0; at < page.Texels(); ++at) {
        RnmLight light{{page.basis[0][at], page.basis[1][at], page.basis[2][at]}};
        if (rescaled)
            light = OverflowToOthers(light);
        for (std::size_t i = 0; i < bytes.size(); ++i)
            for (const float channel : {light.map[i].x, light.map[i].y, light.map[i].z})
                bytes[i].push_back(UnitByte(channel));
    }
    return bytes;
}

/// Writes HDR pages and basis maps as files beside the map.
class HdrFileWriter {
  public:
    HdrFileWriter(const std::filesystem::path &folder, const LightmapOptions &options, Log &log)
        : folder_(folder), options_(options),
          form_(options.hdrFiles == HdrFiles::None ? HdrFiles::Rend2 : options.hdrFiles), log_(log) {}

    void WritePage(const LightmapPage &page) {
        const bool wanted = page.needsImage || options_.hdrFiles != HdrFiles::None;
        if (wanted && !page.light.empty())
            WriteHdr(page, fmt::format("lm_{:04}", page.file), page.light);
        if (!wanted || !page.HasBasis())
            return;
        for (std::size_t i = 0; i < page.basis.size(); ++i)
            if (!page.light.empty())
                WriteHdr(page, BasisName(page, i), page.basis[i]);
        if (!options_.ldr || !page.needsImage)
            return;
        const auto bytes = BasisBytes(page, options_.rnmRescaled);
        for (std::size_t i = 0; i < bytes.size(); ++i)
            Write(BasisName(page, i) + ".tga", EncodeTga(bytes[i], page.width, page.height, 3, TgaRows::TopFirst));
    }

    void WriteVertices(const std::vector<Vec3f> &light) {
        if (options_.hdrFiles == HdrFiles::Rend2)
            Write(std::string(kVertexLightFile), EncodeVertexLight(light, kRend2VertexScale));
        if (options_.hdrFiles == HdrFiles::Ioquake3)
            Write(std::string(kVertexLightFile), EncodeVertexLight(light, kIoquake3VertexScale));
    }

    void Report() const {
        if (!written_.empty())
            log_.Print("Wrote {} of HDR light and basis maps to {}\n", Counted((long long)(written_.size()), "files"),
                       folder_.string());
    }

    /// Warns of files of an earlier run that engines would load with the new map.
    void WarnOfOldFiles() const {
        for (const std::string_view name : {std::string_view("lm_0000.hdr"), kVertexLightFile}) {
            std::error_code ignored;
            if (!written_.contains(std::string(name)) && std::filesystem::exists(folder_ / name, ignored))
                log_.Warn("old HDR light", "{}: left by an earlier run; engines may load it with this map",
                          (folder_ / name).string());
        }
    }

  private:
    static std::string BasisName(const LightmapPage &page, std::size_t i) {
        return fmt::format("lm_{:04}_b{}", page.file, i + 1);
    }

    void WriteHdr(const LightmapPage &page, const std::string &name, const std::vector<Vec3f> &light) {
        const FloatImage image{page.width, page.height, light};
        switch (form_) {
        case HdrFiles::OpenExr:
            return Write(name + ".exr", EncodeExr(image));
        case HdrFiles::Pfm:
            return Write(name + ".pfm", EncodePfm(image));
        case HdrFiles::Ioquake3:
            if (page.width == kIoquake3PageSide && page.height == kIoquake3PageSide)
                return Write(name + ".hdr", EncodeIoquake3Hdr(image));
            log_.Warn("HDR page size", "{}: ioquake3 loads HDR pages of {} x {} only, not of {} x {}", name,
                      kIoquake3PageSide, kIoquake3PageSide, page.width, page.height);
            return;
        case HdrFiles::None:
        case HdrFiles::Rend2:
            return Write(name + ".hdr", EncodeRend2Hdr(image));
        }
    }

    void Write(const std::string &name, const std::vector<std::byte> &bytes) {
        if (written_.empty())
            MakeFolder(folder_);
        written_.insert(name);
        ReplaceFile(folder_ / name, bytes);
    }

    const std::filesystem::path &folder_;
    const LightmapOptions &options_;
    const HdrFiles form_;
    Log &log_;
    std::set<std::string> written_; ///< names
};

} // namespace

void StoreHdrLight(const LightmapOptions &options, const StoredLightmaps &stored, Bsp &bsp) {
    bsp.vertexE5bgr9 = EncodeE5bgr9(stored.vertexLight);
    RnmLightmaps rnm;
    rnm.header.storage = options.rnmRescaled ? RnmStorage::Rescaled : RnmStorage::Raw;
    rnm.header.side = std::uint32_t(options.gamePageSize[0]);
    for (const LightmapPage &page : stored.pages) {
        if (!IsInBsp(page, options))
            continue;
        if (options.hdr) {
            const std::vector<std::uint32_t> codes = EncodeE5bgr9(page.light);
            bsp.lightmapsE5bgr9.insert(bsp.lightmapsE5bgr9.end(), codes.begin(), codes.end());
            bsp.lightmapsE5bgr9.resize(bsp.lightmapsE5bgr9.size() + (page.directions.empty() ? 0 : page.Texels()));
        }
        if (page.HasBasis())
            rnm.pages.push_back(
                {page.number, {EncodeE5bgr9(page.basis[0]), EncodeE5bgr9(page.basis[1]), EncodeE5bgr9(page.basis[2])}});
    }
    if (rnm.pages.empty())
        return;
    rnm.header.pageCount = std::uint32_t(rnm.pages.size());
    bsp.rnm = std::move(rnm);
}

void WriteHdrFiles(const std::filesystem::path &folder, const LightmapOptions &options, const StoredLightmaps &stored,
                   Log &log) {
    HdrFileWriter writer(folder, options, log);
    for (const LightmapPage &page : stored.pages)
        writer.WritePage(page);
    writer.WriteVertices(stored.vertexLight);
    writer.Report();
    writer.WarnOfOldFiles();
}

} // namespace q3
