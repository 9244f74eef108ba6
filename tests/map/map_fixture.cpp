// GPL-2.0-or-later. Map text of brushes and patches, and a reader of it.
#include "tests/map/map_fixture.h"
#include "common/error.h"

namespace q3::test {

namespace {

std::string PointText(const Vec3d &p) {
    return fmt::format("( {} {} {} )", p.x, p.y, p.z);
}

} // namespace

std::string PointsText(const Plane &plane) {
    const Vec3d &n = plane.normal;
    const Vec3d other = std::abs(n.z) > 0.7 ? Vec3d{1, 0, 0} : Vec3d{0, 0, 1};
    const Vec3d u = Normalize(Cross(other, n)), v = Cross(n, u), p = n * plane.dist;
    return PointText(p) + " " + PointText(p + v * 64) + " " + PointText(p + u * 64);
}

std::string SideText(const Plane &plane, std::string_view shader, std::string_view flags) {
    return fmt::format("{} {} 0 0 0 1 1 {}\n", PointsText(plane), shader, flags);
}

std::string BrushText(const std::vector<Plane> &planes, std::string_view shader, std::string_view flags) {
    std::string text = "{\n";
    for (const Plane &plane : planes)
        text += SideText(plane, shader, flags);
    return text + "}\n";
}

std::vector<Plane> BoxPlanes(const Vec3d &mins, const Vec3d &maxs) {
    return {{{1, 0, 0}, maxs.x},   {{-1, 0, 0}, -mins.x}, {{0, 1, 0}, maxs.y},
            {{0, -1, 0}, -mins.y}, {{0, 0, 1}, maxs.z},   {{0, 0, -1}, -mins.z}};
}

std::string BoxText(const Vec3d &mins, const Vec3d &maxs, std::string_view shader, std::string_view flags) {
    return BrushText(BoxPlanes(mins, maxs), shader, flags);
}

std::string FlatPatchText(int width, int height, const Vec3d &corner, double spacing) {
    std::string text = fmt::format("{{\npatchDef2\n{{\nwall\n( {} {} 0 0 0 )\n(\n", width, height);
    for (int column = 0; column < width; ++column) {
        text += "(";
        for (int row = 0; row < height; ++row)
            text += fmt::format(" ( {} {} {} {} {} )", corner.x + column * spacing, corner.y + row * spacing, corner.z,
                                column, row);
        text += " )\n";
    }
    return text + ")\n}\n}\n";
}

std::string EntityText(std::string_view className, std::string_view body) {
    return fmt::format("{{\n\"classname\" \"{}\"\n{}}}\n", className, body);
}

std::string WorldText(std::string_view body) {
    return EntityText("worldspawn", body);
}

MapTest::MapTest() {
    options.imageSizes = true;
    folder.Write("scripts/test.shader", R"(
textures/water
{
    surfaceparm water
    surfaceparm trans
}
textures/fogged
{
    surfaceparm fog
    surfaceparm nonsolid
    surfaceparm trans
    fogparms ( 1 1 1 ) 512
}
textures/clip
{
    surfaceparm playerclip
    surfaceparm nodraw
}
textures/origin
{
    surfaceparm origin
    surfaceparm nodraw
    surfaceparm nonsolid
}
textures/portal
{
    surfaceparm areaportal
    surfaceparm structural
    surfaceparm trans
    surfaceparm nodraw
}
textures/structure
{
    surfaceparm structural
}
textures/see
{
    surfaceparm trans
}
textures/hint
{
    surfaceparm hint
    surfaceparm structural
    surfaceparm trans
    surfaceparm nodraw
    surfaceparm nonsolid
}
textures/slick
{
    surfaceparm slick
}
textures/global
{
    q3map_globaltexture
}
textures/vectors
{
    q3map_tcGen ivector ( 128 0 0 ) ( 0 0 256 )
}
textures/volume
{
    q3map_rgbMod volume
    q3map_rgbMod set ( 1 0 0 )
    surfaceparm trans
    surfaceparm nonsolid
}
)");
    WriteTga("textures/small.tga", std::vector<std::array<int, 4>>(16, {255, 255, 255, 255}));
    Load();
}

std::string MapTest::ErrorOf(std::string_view text) {
    try {
        Read(text);
    } catch (const Error &error) {
        return error.what();
    }
    return "no error";
}

} // namespace q3::test
