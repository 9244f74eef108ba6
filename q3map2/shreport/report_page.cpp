// GPL-2.0-or-later. A map as a page: its package for the viewer, the page, and the options of -shreport.
#include "q3map2/shreport/report_page.h"

#include "common/error.h"
#include "common/files/archive.h"
#include "common/files/files.h"
#include "common/image/image.h"
#include "common/text/text.h"
#include "q3map2/pk3/map_needs.h"
#include "q3map2/pk3/package_plan.h"
#include "q3map2/shader/image_formats.h"

#include <glib.h>

#include <algorithm>
#include <array>

namespace q3 {

// ---- The archive in a report: a map, and the files that the viewer needs to draw it ----

namespace fs = std::filesystem;

namespace {

constexpr int kZlibsChoice = -1; ///< level of compression
constexpr int kJpegQuality = 85; ///< 0 to 100

bool IsImage(std::string_view name) {
    return FindImageFormat(name) != nullptr;
}

/// A file of the archive, or why there is none.
struct EncodedTexture {
    std::string name, fault;
    std::vector<std::byte> bytes;
};

bool IsOpaque(const Image &image) {
    for (std::size_t i = 3; i < image.rgba.size(); i += 4)
        if (image.rgba[i] != 255)
            return false;
    return true;
}

/// The image as PNG if a texel is not opaque, else as JPEG.
EncodedTexture EncodeTexture(const std::string &name, const PackageSource &source, int textureSize) {
    EncodedTexture texture;
    try {
        const auto file = source.Read(name);
        if (!file)
            throw Error("{}: it is damaged", name);
        const Image whole = EndsWithNoCase(name, ".crn") ? DecodeCrn(*file, name) : DecodeImage(*file, name);
        const Image image = Reduced(whole, textureSize);
        const bool isOpaque = IsOpaque(image);
        texture.bytes = isOpaque ? EncodeJpeg(image, kJpegQuality, name)
                                 : EncodePng(image.rgba, image.width, image.height, 4, name);
        constexpr std::string_view kDdsFolder = "dds/"; // of compressed textures, with the folders of the others in it
        const std::size_t begin = name.starts_with(kDdsFolder) ? kDdsFolder.size() : 0;
        texture.name = name.substr(begin, name.rfind('.') - begin) + (isOpaque ? ".jpg" : ".png");
    } catch (const Error &error) {
        texture.fault = error.what();
    }
    return texture;
}

class ReportPackage {
  public:
    ReportPackage(const ReportedMap &map, Log &log) : map_(map), name_(map.path.stem().string()), log_(log) {
        AddNeeds(map.bsp, name_, map.game, needs_);
        MapNeeds drawn;
        drawn.shaders = needs_.shaders;
        plan_ =
            MakePlan(drawn, map.source, map.scripts,
                     {.exclusions = {}, .imageFiles = map.game.imageFiles, .png = true, .wholeScripts = false}, log);
    }

    void AddMap() {
        AddFile(fmt::format("maps/{}.bsp", name_), map_.path);
        for (const std::string_view end : {".lin", ".prt", ".sherror.json", ".unexplained.json"}) {
            const fs::path beside = map_.path.parent_path() / (name_ + std::string(end));
            if (fs::is_regular_file(beside))
                AddFile(fmt::format("maps/{}{}", name_, end), beside);
        }
        if (!map_.explanations.empty())
            Add(fmt::format("maps/{}.explain.json", name_), std::as_bytes(std::span(map_.explanations)));
    }

    void AddLightmaps() {
        PackagePlan lights;
        AddLightFiles(map_.path, needs_.externalPages, map_.source, lights);
        for (const PackageEntry &entry : lights.Files()) {
            if (!StartsWithNoCase(fs::path(entry.name).filename().string(), "lm_"))
                continue;
            lightmaps_.Add(entry.name, name_);
            if (!entry.disk.empty())
                AddFile(entry.name, entry.disk);
            else if (const auto bytes = map_.source.Read(entry.name))
                Add(entry.name, *bytes);
        }
        for (const std::string &page : lights.missing)
            log_.Warn("missing lightmap", "missing: {}", page);
    }

    void AddShaders() {
        std::string text;
        for (const EngineShader *shader : plan_.strippedShaders)
            text += '\n' + StrippedText(*shader);
        if (!text.empty())
            Add(fmt::format("scripts/{}.shader", name_), std::as_bytes(std::span(text)));
        log_.Count(plan_.strippedShaders.size(), "shaders");
    }

    void AddTextures(int textureSize, const JobPool &jobs) {
        std::vector<std::string> images;
        for (const PackageEntry &entry : plan_.Files())
            if (IsImage(entry.name) && !lightmaps_.Has(entry.name))
                images.push_back(entry.name);
        std::vector<EncodedTexture> textures(images.size());
        jobs.For(std::int64_t(images.size()), [&](std::int64_t i, int) {
            textures[std::size_t(i)] = EncodeTexture(images[std::size_t(i)], map_.source, textureSize);
        });
        int count = 0;
        for (const EncodedTexture &texture : textures) {
            if (!texture.fault.empty()) {
                log_.Warn("damaged texture", "{}", texture.fault);
                continue;
            }
            Add(texture.name, texture.bytes);
            ++count;
        }
        for (const std::string &texture : plan_.missing)
            log_.Warn("missing texture", "missing: {}", texture);
        log_.Count(count, "textures");
    }

    std::vector<std::byte> Finish() {
        log_.Count(files_, "files");
        return archive_.Finish();
    }

  private:
    void Add(std::string_view name, std::span<const std::byte> bytes) {
        archive_.Add(name, bytes);
        ++files_;
    }
    void AddFile(std::string_view name, const fs::path &path) { Add(name, ReadFile(path)); }

    const ReportedMap &map_;
    std::string name_; ///< without folder and extension
    Log &log_;
    MapNeeds needs_;
    PackagePlan plan_;
    WantedList lightmaps_; ///< external ones: shaders may name them as images
    ArchiveWriter archive_{kZlibsChoice};
    int files_ = 0;
};

} // namespace

namespace {

void AddResources(ReportPackage &package, int textureSize, const JobPool &jobs) {
    package.AddLightmaps();
    package.AddShaders();
    if (textureSize > 0)
        package.AddTextures(textureSize, jobs);
}

} // namespace

std::vector<std::byte> MakeReportPackage(const ReportedMap &map, int textureSize, const JobPool &jobs, Log &log) {
    ReportPackage package(map, log);
    package.AddMap();
    AddResources(package, textureSize, jobs);
    return package.Finish();
}

std::vector<std::byte> MakeResourcePackage(const ReportedMap &map, int textureSize, const JobPool &jobs, Log &log) {
    ReportPackage package(map, log);
    AddResources(package, textureSize, jobs);
    return package.Finish();
}

// ---- Options of the stage -shreport ----

std::vector<SettingGroup<SHReportOptions>> SHReportSettings() {
    constexpr SettingRange sizes{0, 16384}, places{1, 100000};
    return {{"Page",
             "",
             {{{.name = "-texturesize",
                .values = "N",
                .unit = "texels",
                .range = sizes,
                .help = "Limits the longer side of textures to N, where 0 leaves all textures out",
                .details = "Larger textures make the page a larger file.",
                .since = "0.2.0",
                .example = "256"},
               &SHReportOptions::textureSize},
              {{.name = "-o",
                .values = "FILE",
                .initial = "x.html next to x.bsp",
                .help = "Names the page to write",
                .since = "0.2.0",
                .example = "mymap.html"},
               &SHReportOptions::output}}},
            {"Explanations",
             "With `-explain`, a click on a surface of the page shows why it is lit as it is. The page [Why a place is "
             "lit as it is](../guide/explain.md) describes it. All options of `-light` may be given too, and should be "
             "those with which the map was lit.",
             {{{.name = "-explain",
                .help = "Explains places all over the map, for clicks on their surfaces",
                .since = "0.2.0"},
               &SHReportOptions::explain},
              {{.name = "-places",
                .values = "N",
                .range = places,
                .help = "Sets how many places -explain explains at most",
                .details = "The places are spread evenly over the surfaces.",
                .since = "0.2.0",
                .example = "5000"},
               &SHReportOptions::places}}}};
}

SHReportOptions ParseSHReportOptions(Arguments &arguments, Log &log) {
    SHReportOptions options;
    TakeSettings(SHReportSettings(), options, arguments, log);
    return options;
}

// ---- The page that shows a map, and the map in it ----

namespace {

constexpr std::string_view kMarker = "<!-- package -->";

/// The text as the value of an attribute in double quotes.
std::string EscapedAttribute(std::string_view text) {
    std::string escaped;
    for (const char c : text)
        switch (c) {
        case '&':
            escaped += "&amp;";
            break;
        case '"':
            escaped += "&quot;";
            break;
        case '<':
            escaped += "&lt;";
            break;
        case '>':
            escaped += "&gt;";
            break;
        default:
            escaped += c;
        }
    return escaped;
}

/// The page with `what`, which must be there once, replaced by `by`.
std::string WithReplaced(std::string_view page, std::string_view what, std::string_view by) {
    const std::size_t at = page.find(what);
    if (at == std::string_view::npos)
        throw Error("the viewer page has no {}", what);
    const std::string_view rest = page.substr(at + what.size());
    if (rest.find(what) != std::string_view::npos)
        throw Error("the viewer page has more than one {}", what);
    std::string result(page.substr(0, at));
    result += by;
    result += rest;
    return result;
}

/// Into memory of our own: g_base64_encode ends the process if it gets none.
std::string Base64(std::span<const std::byte> bytes) {
    std::string text((bytes.size() / 3 + 1) * 4, '\0');
    int state = 0, save = 0;
    std::size_t size = g_base64_encode_step(reinterpret_cast<const guchar *>(bytes.data()), bytes.size(), FALSE,
                                            text.data(), &state, &save);
    size += g_base64_encode_close(FALSE, text.data() + size, &state, &save);
    text.resize(size);
    return text;
}

} // namespace

std::string PageWithPackage(std::string_view page, std::string_view map, std::span<const std::byte> archive) {
    return WithReplaced(page, kMarker,
                        fmt::format(R"(<script type="application/zip;base64" id="package" data-map="{}">{}</script>)",
                                    EscapedAttribute(map), Base64(archive)));
}

std::string PageForWatch(std::string_view page, std::string_view map, std::string_view origins) {
    constexpr std::string_view kPolicy = "; img-src blob: data:\">";
    return WithReplaced(
        WithReplaced(page, kMarker,
                     fmt::format(R"(<div id="watch" data-map="{}" hidden></div>)", EscapedAttribute(map))),
        kPolicy, fmt::format("; img-src blob: data:; connect-src {}\">", origins));
}

} // namespace q3
