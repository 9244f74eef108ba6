// GPL-2.0-or-later. The program: reports, from a map to a page.
#include "common/files/archive.h"
#include "common/files/files.h"
#include "common/image/image.h"
#include "tests/support/run_program.h"
#include "tests/support/this_system.h"

#include <glib.h>
#include <nlohmann/json.hpp>

namespace q3::test {

namespace {

class SHReportProgramTest : public ProgramTest {
  protected:
    static constexpr std::string_view kOpening = R"(<script type="application/zip;base64" id="package" data-map=")";

    /// The attribute data-map and the base64 text of a page; what is around it must be tools/viewer/viewer.html.
    static std::pair<std::string, std::string> Taken(const std::string &page) {
        const std::size_t at = page.find(kOpening), quote = page.find('"', at + kOpening.size()),
                          end = page.find("</script>", quote);
        if (at == std::string::npos || end == std::string::npos) {
            ADD_FAILURE() << "no package in the page";
            return {};
        }
        const std::string viewer = ReadTextFile(std::filesystem::path(SOURCE) / "tools/viewer/viewer.html");
        EXPECT_EQ(page.substr(0, at) + "<!-- package -->" + page.substr(end + 9), viewer);
        const std::size_t begin = at + kOpening.size();
        return {page.substr(begin, quote - begin), page.substr(quote + 2, end - quote - 2)};
    }
    /// The archive of a page.
    Archive PackageOf(const std::filesystem::path &page) {
        const std::string base64 = Taken(ReadTextFile(page)).second;
        gsize size = 0;
        guchar *bytes = g_base64_decode(base64.c_str(), &size);
        folder_.Write("out.pk3", std::string_view(reinterpret_cast<const char *>(bytes), size));
        g_free(bytes);
        return Archive(folder_ / "out.pk3");
    }
};

TEST_F(SHReportProgramTest, ThePageHoldsTheMap) {
    const std::vector<std::uint8_t> gray(std::size_t(3 * 256 * 256), 90);
    folder_.Write("base/baseq3/levelshots/demo.tga", EncodeTga(gray, 256, 256, 3, TgaRows::TopFirst));
    folder_.Write("base/baseq3/maps/demo.sherror.json", "{}");
    RunWell("-light -onlygrid -shadaptive -gridsh 128 128 128 MAP");
    const Outcome outcome = RunWell("-shreport -texturesize 64 MAP");
    EXPECT_TRUE(outcome.Printed("Writing " + Map(".html").string()));
    EXPECT_EQ(Taken(ReadTextFile(Map(".html"))).first, "maps/demo.bsp");
    EXPECT_TRUE(outcome.Printed(fmt::format("Wrote {} bytes", std::filesystem::file_size(Map(".html")))));
    const Archive archive = PackageOf(Map(".html"));
    EXPECT_EQ(archive.Read("maps/demo.bsp"), MapBytes());
    EXPECT_TRUE(archive.Contains("maps/demo.sherror.json"));
    EXPECT_TRUE(archive.Contains("scripts/demo.shader"));
    EXPECT_EQ(DecodeJpeg(archive.Read("levelshots/demo.jpg"), "levelshots/demo.jpg").width, 64);
}

TEST_F(SHReportProgramTest, TheSameBytesFromAnyNumberOfThreads) {
    RunWell("-threads 1 -shreport MAP");
    const std::string page = ReadTextFile(Map(".html"));
    const std::string other = (folder_ / "other.html").string();
    RunWell("-threads 3 -shreport -o " + other + " MAP");
    EXPECT_EQ(ReadTextFile(other), page);
}

TEST_F(SHReportProgramTest, ExplainedPlacesAreInThePackage) {
    EXPECT_TRUE(RunWell("-shreport -sh MAP").Printed("Unknown argument \"-sh\"")); // options of -light need -explain
    EXPECT_FALSE(PackageOf(Map(".html")).Contains("maps/demo.explain.json"));
    RunWell("-light -sh MAP");
    const std::vector<std::byte> lit = MapBytes();
    const Outcome outcome = RunWell("-threads 1 -shreport -explain -places 60 -sh MAP");
    const std::vector<std::byte> bytes = PackageOf(Map(".html")).Read("maps/demo.explain.json");
    const auto json = nlohmann::json::parse(reinterpret_cast<const char *>(bytes.data()),
                                            reinterpret_cast<const char *>(bytes.data() + bytes.size()));
    EXPECT_EQ(json["format"], "q3map2-sh explanations");
    EXPECT_EQ(json["map"], "maps/demo.bsp");
    EXPECT_EQ(json["options"], "-sh");
    EXPECT_LE(json["places"].size(), 60u);
    EXPECT_GE(json["places"].size(), 30u);
    EXPECT_TRUE(outcome.Printed(fmt::format("{} places explained", json["places"].size())));
    EXPECT_NE(json["places"][0]["text"].get<std::string>().find("Lights at "), std::string::npos);
    EXPECT_EQ(MapBytes(), lit);
    const std::string page = ReadTextFile(Map(".html"));
    RunWell("-threads 3 -shreport -explain -places 60 -sh MAP");
    EXPECT_EQ(ReadTextFile(Map(".html")), page);
}

TEST_F(SHReportProgramTest, OddNamesOfMaps) {
    // Windows allows no quotes and no angle brackets.
    const std::string name = kIsWindows ? "a&b" : "a&b\"c<d", escaped = kIsWindows ? "a&amp;b" : "a&amp;b&quot;c&lt;d";
    std::filesystem::copy_file(Map(".bsp"), maps_ / (name + ".bsp"));
    RunWell("-shreport " + (maps_ / (name + ".bsp")).string());
    const std::filesystem::path page = maps_ / (name + ".html");
    EXPECT_EQ(Taken(ReadTextFile(page)).first, "maps/" + escaped + ".bsp");
    EXPECT_EQ(PackageOf(page).Read("maps/" + name + ".bsp"), MapBytes());
}

TEST_F(SHReportProgramTest, Failures) {
    ExpectError("-shreport " + (maps_ / "none.bsp").string(), "none.bsp");
    ExpectError("-shreport", "-shreport");
    ExpectError("-shreport -texturesize -1 MAP", "-texturesize -1");
    ExpectError("-shreport -explain -places 0 MAP", "-places 0");
    ExpectError("-shreport -o " + (folder_ / "none/x.html").string() + " MAP", "x.html");
    EXPECT_FALSE(std::filesystem::exists(Map(".html")));
}

} // namespace

} // namespace q3::test
