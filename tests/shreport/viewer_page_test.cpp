// GPL-2.0-or-later. The page of a report: where the archive goes, and under which name.
#include "common/error.h"
#include "q3map2/shreport/report_page.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace q3::test {

namespace {

using testing::HasSubstr;

std::string Page(std::string_view page, std::string_view map, std::string_view archive) {
    return PageWithPackage(page, map, std::as_bytes(std::span(archive)));
}

TEST(ViewerPage, TheArchiveReplacesTheComment) {
    // The vector of RFC 4648, section 10.
    EXPECT_EQ(Page("a<!-- package -->b", "maps/x.bsp", "foobar"),
              R"(a<script type="application/zip;base64" id="package" data-map="maps/x.bsp">Zm9vYmFy</script>b)");
    EXPECT_THAT(Page("<!-- package -->", "maps/x.bsp", "foob"), HasSubstr(">Zm9vYg==<"));
}

TEST(ViewerPage, NamesAreEscaped) {
    EXPECT_THAT(Page("<!-- package -->", R"(maps/a"b&c<d>.bsp)", ""),
                HasSubstr(R"( data-map="maps/a&quot;b&amp;c&lt;d&gt;.bsp">)"));
}

TEST(ViewerPage, TheCommentStandsThereOnce) {
    EXPECT_THROW(Page("<!-- packages -->", "maps/x.bsp", ""), Error);
    EXPECT_THROW(Page("<!-- package --> <!-- package -->", "maps/x.bsp", ""), Error);
    EXPECT_NO_THROW(Page(ViewerPage(), "maps/x.bsp", "")) << "the page in the program";
}

} // namespace

} // namespace q3::test
