// GPL-2.0-or-later. HDR light of lightmap pages and basis maps: BSPX lumps of the map, and images beside it.
#include "q3map2/lightmap/store/hdr_store.h"

#include "common/error.h"
#include "common/files/files.h"
#include "common/image/float_image.h"
#include "common/image/image.h"
#include "common/text/text.h"
#include "libs/math/packed_color.h"
#include "q3map2/lightmap/encode/directional_encode.h"
#include "q3map2/lightmap/store/lightmap_pages.h"
#include "q3map2/lightmap/store/lightmap_store.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <span>
#include <system_error>
#include <vector>

namespace q3 {

// ---- Light of lightmap pages in full range: HDR pages and the basis maps of radiosity normal mapping ----

namespace {

/// Writes the layers of all pages.
class PageLightWriter {
  public:
    PageLightWriter(const SurfaceInputs &in, const LightmapLayers &layers, std::vector<LightmapPage> &pages)
        : in_(in), layers_(layers), pages_(pages), tone_(StoredTone(in)) {}

    void Run() {
        for (const LightmapLayer &layer : layers_.layers)
            if (layer.page >= 0 && layer.kinds.basis)
                for (std::vector<Vec3f> &map : pages_[std::size_t(layer.page)].basis)
                    map.resize(pages_[std::size_t(layer.page)].Texels());
        for (LightmapPage &page : pages_)
            page.light.resize(in_.lightmap.hdr ? page.Texels() : 0);
        in_.jobs.For(std::int64_t(layers_.layers.size()), [&](std::int64_t i, int) {
            if (const LightmapLayer &layer = layers_.layers[std::size_t(i)]; layer.twin < 0 && layer.page >= 0)
                Write(layer);
        });
    }

  private:
    void Write(const LightmapLayer &layer) {
        LightmapPage &page = pages_[std::size_t(layer.page)];
        const float scale = ToneMapper::FactorOf(layer.brightness, tone_) / 255;
        const Vec3f least = layer.slot == 0 ? in_.world.minLight : Vec3f{};
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
    const LightmapLayers &layers_;
    std::vector<LightmapPage> &pages_;
    const ToneOptions tone_;
};

} // namespace

void SetPageLight(const SurfaceInputs &in, const LightmapLayers &layers, std::vector<LightmapPage> &pages) {
    PageLightWriter(in, layers, pages).Run();
}

Vec3f VertexLightOf(const SurfaceInputs &in, const ShaderInfo &shader, const Vec3f &light, const ToneOptions &tone) {
    const float scale = VertexScale(in, shader); // 0 or less counts as 1, as in ToneMapper
    return Max(light, in.world.minVertex) * ((scale > 0 ? scale : 1) * ToneMapper::FactorOf(1, tone) / 255);
}

// ---- HDR images of -export and -import ----

namespace {

using FileBytes = std::vector<std::byte>;

/// A format of -hdrformat. Images in exr, pfm and hdr have the last row of the page on top, as in ExportLightmaps.
struct HdrFormat {
    std::string_view name, prefix, extension;
    FileBytes (*encode)(const FloatImage &page);
    FloatImage (*decode)(std::span<const std::byte> file, std::string_view name);
    float fullVertexLight = 0; ///< full light in vertlight.raw; 0: the format has no such file
};

constexpr HdrFormat kHdrFormats[] = {
    {"exr", "lightmap", "exr", [](const FloatImage &page) { return EncodeExr(FlippedRows(page)); },
     [](std::span<const std::byte> file, std::string_view name) { return FlippedRows(DecodeExr(file, name)); }},
    {"pfm", "lightmap", "pfm", [](const FloatImage &page) { return EncodePfm(FlippedRows(page)); },
     [](std::span<const std::byte> file, std::string_view name) { return FlippedRows(DecodePfm(file, name)); }},
    {"hdr", "lightmap", "hdr", [](const FloatImage &page) { return EncodeHdr(FlippedRows(page)); },
     [](std::span<const std::byte> file, std::string_view name) { return FlippedRows(DecodeHdr(file, name)); }},
    {"exp32", "lightmap", "exp32.json", EncodeExp32Json, DecodeExp32Json},
    {"rend2", "lm", "hdr", EncodeRend2Hdr, DecodeRend2Hdr, kRend2VertexScale},
    {"ioquake3", "lm", "hdr", EncodeIoquake3Hdr, DecodeIoquake3Hdr, kIoquake3VertexScale}};
/// Formats that -import looks for without -hdrformat. Their file names differ; rend2 and ioquake3 share theirs.
constexpr std::span<const HdrFormat> kFormatsByFileName(kHdrFormats, 4);

const HdrFormat &FormatOf(std::string_view name) {
    return *std::ranges::find(kHdrFormats, name, &HdrFormat::name);
}

/// The E5BGR9 codes of one image: a page, or the map of one basis normal.
struct HdrPart {
    std::span<std::uint32_t> codes;
    int side = 0;
    std::string name; ///< NNNN or NNNN_b1
};

std::vector<HdrPart> HdrParts(Bsp &bsp, int side) {
    std::vector<HdrPart> parts;
    const std::size_t texels = std::size_t(side) * std::size_t(side);
    if (bsp.lightmapsE5bgr9.size() % texels != 0)
        throw Error("the HDR lightmaps have {} texels, not a whole number of {} x {} pages", bsp.lightmapsE5bgr9.size(),
                    side, side);
    for (std::size_t i = 0; i * texels < bsp.lightmapsE5bgr9.size(); ++i)
        parts.push_back({std::span(bsp.lightmapsE5bgr9).subspan(i * texels, texels), side, fmt::format("{:04}", i)});
    if (bsp.rnm)
        for (RnmPage &page : bsp.rnm->pages)
            for (std::size_t i = 0; i < page.maps.size(); ++i)
                parts.push_back(
                    {page.maps[i], int(bsp.rnm->header.side), fmt::format("{:04}_b{}", page.lightmapNum, i + 1)});
    return parts;
}

std::filesystem::path FileOfPart(const std::filesystem::path &folder, const HdrPart &part, const HdrFormat &format) {
    return folder / fmt::format("{}_{}.{}", format.prefix, part.name, format.extension);
}

FloatImage ImageOf(const HdrPart &part) {
    return {part.side, part.side, DecodeE5bgr9(part.codes)};
}

/// The first format whose file exists; null: none.
const HdrFormat *FirstExistingFormat(const std::filesystem::path &folder, const HdrPart &part,
                                     const std::string &wanted, Log &log) {
    const HdrFormat *found = nullptr;
    int count = 0;
    std::error_code ignored;
    for (const HdrFormat &format :
         wanted.empty() ? kFormatsByFileName : std::span<const HdrFormat>(&FormatOf(wanted), 1))
        // A build without OpenEXR passes .exr files over, unless they are asked for: then reading one is an error.
        if ((HasOpenExr() || format.extension != "exr" || !wanted.empty()) &&
            std::filesystem::exists(FileOfPart(folder, part, format), ignored)) {
            ++count;
            found = found ? found : &format;
        }
    if (count > 1)
        log.Warn("HDR lightmap images", "{} has images in {} formats: {} is taken; -hdrformat chooses", part.name,
                 count, found->name);
    return found;
}

void ImportVertexLight(const std::filesystem::path &path, float fullLight, Bsp &bsp, Log &log) {
    std::error_code ignored;
    if (bsp.vertexE5bgr9.empty() || !std::filesystem::exists(path, ignored))
        return;
    const std::vector<Vec3f> light = DecodeVertexLight(ReadFile(path), bsp.drawVerts.size(), fullLight, path.string());
    bsp.vertexE5bgr9 = EncodeE5bgr9(light);
    log.Print("Read the HDR light of {} from {}\n", Counted(light.size(), "vertices"), path.string());
}

} // namespace

void AddHdrExport(const Bsp &bsp, int side, const std::filesystem::path &folder, const std::string &formatName,
                  FileSet &written, Log &log) {
    Bsp light; // a copy: HdrParts returns mutable spans
    light.lightmapsE5bgr9 = bsp.lightmapsE5bgr9;
    light.rnm = bsp.rnm;
    const std::vector<HdrPart> parts = HdrParts(light, side);
    const HdrFormat &format = FormatOf(!formatName.empty() ? std::string_view(formatName)
                                       : HasOpenExr()      ? "exr"
                                                           : "pfm");
    for (const HdrPart &part : parts)
        written.AddFile(FileOfPart(folder, part, format), format.encode(ImageOf(part)));
    if (format.fullVertexLight > 0 && !bsp.vertexE5bgr9.empty()) {
        const std::vector<Vec3f> vertices = DecodeE5bgr9(bsp.vertexE5bgr9);
        written.AddFile(folder / kVertexLightFile, EncodeVertexLight(vertices, format.fullVertexLight));
    }
    if (!parts.empty())
        written.AddLine(log, fmt::format("Wrote {} to {}\n", Counted(parts.size(), "HDR lightmaps"), folder.string()));
}

void ImportHdrLight(Bsp &bsp, int side, const std::filesystem::path &folder, const std::string &formatName, Log &log) {
    const std::vector<HdrPart> parts = HdrParts(bsp, side);
    std::size_t replaced = 0;
    for (const HdrPart &part : parts) {
        const HdrFormat *format = FirstExistingFormat(folder, part, formatName, log);
        if (!format)
            continue;
        const auto path = FileOfPart(folder, part, *format);
        const FloatImage image = format->decode(ReadFile(path), path.string());
        if (image.width != part.side || image.height != part.side) {
            log.Warn("lightmap image size", "{}: {} x {}, expected {} x {}; this lightmap stays", path.string(),
                     image.width, image.height, part.side, part.side);
            continue;
        }
        std::ranges::copy(EncodeE5bgr9(image.texels), part.codes.begin());
        ++replaced;
    }
    if (!parts.empty())
        log.Print("Read {} of {} from {}\n", replaced, Counted(parts.size(), "HDR lightmaps"), folder.string());
    if (const float full = formatName.empty() ? 0 : FormatOf(formatName).fullVertexLight; full > 0)
        ImportVertexLight(folder / kVertexLightFile, full, bsp, log);
}

// ---- BSPX lumps, and the files of -hdrfiles ----

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

/// How -hdrfiles writes a page, row 0 on top.
struct PageFormat {
    std::string_view extension;
    FileBytes (*encode)(const FloatImage &page);
    float fullVertexLight = 0; ///< as in HdrFormat
};

/// Pages outside the .bsp are written without -hdrfiles too, as for rend2.
PageFormat PageFormatOf(HdrFiles files) {
    if (files == HdrFiles::OpenExr)
        return {"exr", EncodeExr};
    if (files == HdrFiles::Pfm)
        return {"pfm", EncodePfm};
    const HdrFormat &ofEngine = FormatOf(files == HdrFiles::Ioquake3 ? "ioquake3" : "rend2");
    return {ofEngine.extension, ofEngine.encode, ofEngine.fullVertexLight};
}

/// Writes HDR pages and basis maps as files beside the map.
class HdrFileWriter {
  public:
    HdrFileWriter(const std::filesystem::path &folder, const LightmapOptions &options, FileSet &files, Log &log)
        : folder_(folder), options_(options), format_(PageFormatOf(options.hdrFiles)), files_(files), log_(log) {}

    void AddPage(const LightmapPage &page) {
        const bool wanted = page.needsImage || options_.hdrFiles != HdrFiles::None;
        if (wanted && !page.light.empty())
            AddHdr(page, PageImageName(page.file), page.light);
        if (!wanted || !page.HasBasis())
            return;
        for (std::size_t i = 0; i < page.basis.size(); ++i)
            if (!page.light.empty())
                AddHdr(page, BasisImageName(page.file, i), page.basis[i]);
        if (!options_.ldr || !page.needsImage)
            return;
        const auto bytes = BasisBytes(page, options_.rnmRescaled);
        for (std::size_t i = 0; i < bytes.size(); ++i)
            Add(BasisImageName(page.file, i) + ".tga",
                EncodeTga(bytes[i], page.width, page.height, 3, TgaRows::TopFirst));
    }

    void AddVertices(const std::vector<Vec3f> &light) {
        if (options_.hdrFiles != HdrFiles::None && format_.fullVertexLight > 0)
            Add(std::string(kVertexLightFile), EncodeVertexLight(light, format_.fullVertexLight));
    }

    void Report() const {
        if (!names_.empty())
            files_.AddLine(log_, fmt::format("Wrote {} of HDR light and basis maps to {}\n",
                                             Counted(names_.size(), "files"), folder_.string()));
    }

    /// Warns of files of an earlier run that engines would load with the new map.
    void WarnOfOldFiles() const {
        for (const std::string_view name : {std::string_view("lm_0000.hdr"), kVertexLightFile}) {
            std::error_code ignored;
            if (!names_.contains(std::string(name)) && std::filesystem::exists(folder_ / name, ignored))
                log_.Warn("old HDR light", "{}: left by an earlier run; engines may load it with this map",
                          (folder_ / name).string());
        }
    }

  private:
    void AddHdr(const LightmapPage &page, const std::string &name, const std::vector<Vec3f> &light) {
        if (options_.hdrFiles == HdrFiles::Ioquake3 &&
            (page.width != kIoquake3PageSide || page.height != kIoquake3PageSide))
            return log_.Warn("HDR page size", "{}: ioquake3 loads HDR pages of {} x {} only, not of {} x {}", name,
                             kIoquake3PageSide, kIoquake3PageSide, page.width, page.height);
        Add(fmt::format("{}.{}", name, format_.extension), format_.encode({page.width, page.height, light}));
    }

    void Add(const std::string &name, const std::vector<std::byte> &bytes) {
        if (names_.empty())
            files_.AddFolder(folder_);
        names_.insert(name);
        files_.AddFile(folder_ / name, bytes);
    }

    const std::filesystem::path &folder_;
    const LightmapOptions &options_;
    const PageFormat format_;
    FileSet &files_;
    Log &log_;
    std::set<std::string> names_; ///< of the files that were added
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
            // Zeros in the place of the page of directions, so that page numbers are those of the 8-bit lump.
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

void AddHdrFiles(const std::filesystem::path &folder, const LightmapOptions &options, const StoredLightmaps &stored,
                 FileSet &written, Log &log) {
    HdrFileWriter writer(folder, options, written, log);
    for (const LightmapPage &page : stored.pages)
        writer.AddPage(page);
    writer.AddVertices(stored.vertexLight);
    writer.Report();
    writer.WarnOfOldFiles();
}

} // namespace q3
