// GPL-2.0-or-later. The page that shows a map, the map in it, and the options of -shreport.
#include "q3map2/shreport/viewer_page.h"

#include "common/error.h"

#include <glib.h>

#include <memory>

namespace q3 {

// ---- Options of the stage -shreport ----

std::vector<SettingGroup<SHReportOptions>> SHReportSettings() {
    constexpr SettingRange sizes{0, 16384};
    return {{"Page",
             "",
             {{{.name = "-texturesize",
                .values = "N",
                .unit = "texels",
                .range = sizes,
                .help = "Longer side of a texture at most; 0: no textures"},
               &SHReportOptions::textureSize},
              {{.name = "-o", .values = "FILE", .initial = "x.html beside x.bsp", .help = "The page"},
               &SHReportOptions::output}}}};
}

SHReportOptions ParseSHReportOptions(Arguments &arguments, Log &log) {
    SHReportOptions options;
    TakeSettings(SHReportSettings(), options, arguments, log);
    return options;
}

// ---- The page that shows a map, and the map in it ----

namespace {

constexpr std::string_view kMarker = "<!-- package -->";

struct FreeText {
    void operator()(gchar *text) const { g_free(text); }
};

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

} // namespace

std::string PageWithPackage(std::string_view page, std::string_view map, std::span<const std::byte> archive) {
    const std::size_t at = page.find(kMarker);
    if (at == std::string_view::npos)
        throw Error("the viewer page has no comment {}", kMarker);
    const std::string_view rest = page.substr(at + kMarker.size());
    if (rest.find(kMarker) != std::string_view::npos)
        throw Error("the viewer page has more than one comment {}", kMarker);
    const std::unique_ptr<gchar, FreeText> base64(
        g_base64_encode(reinterpret_cast<const guchar *>(archive.data()), archive.size()));
    std::string result(page.substr(0, at));
    result +=
        fmt::format(R"(<script type="application/zip;base64" id="package" data-map="{}">)", EscapedAttribute(map));
    result += base64.get();
    result += "</script>";
    result += rest;
    return result;
}

} // namespace q3
