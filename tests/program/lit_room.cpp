// GPL-2.0-or-later. A small room that the program compiles and lights.
#include "tests/program/lit_room.h"

#include "common/files/files.h"
#include "common/image/image.h"

#include <cmath>
#include <optional>
#include <sstream>

namespace q3::test {

namespace {

constexpr std::string_view kShaders = R"(
textures/test/floor
{
	{
		map $lightmap
	}
}
textures/test/wall
{
	{
		map $whiteimage
	}
	{
		stage normalMap
		map textures/test/bumps.tga
	}
	{
		map $lightmap
	}
}
textures/test/ceiling
{
	q3map_rnm
	{
		map $lightmap
	}
}
textures/test/pillar
{
	q3map_noRnm
	{
		stage normalMap
		map textures/test/bumps.tga
	}
	{
		map $lightmap
	}
}
textures/test/sky
{
	surfaceparm sky
	surfaceparm noimpact
	surfaceparm nolightmap
}
)";

std::string SideText(const Vec3f &a, const Vec3f &b, const Vec3f &c, std::string_view texture) {
    std::string text;
    for (const Vec3f &p : {a, b, c})
        text += fmt::format("( {} {} {} ) ", p.x, p.y, p.z);
    return text + fmt::format("{} 0 0 0 0.5 0.5 0 0 0\n", texture);
}

/// The value of a vector key.
std::string Words(const Vec3f &v) {
    return fmt::format("{} {} {}", v.x, v.y, v.z);
}

std::string KeyText(const Keys &keys) {
    std::string text;
    for (const auto &[key, value] : keys)
        text += fmt::format("\"{}\" \"{}\"\n", key, value);
    return text;
}

/// The gradient along a plane of a value that is `values` at three points.
Vec3f GradientOf(const std::array<Vec3f, 3> &points, const std::array<float, 3> &values) {
    const Vec3f e1 = points[1] - points[0], e2 = points[2] - points[0], n = Cross(e1, e2);
    return (Cross(e2, n) * (values[1] - values[0]) + Cross(n, e1) * (values[2] - values[0])) / Dot(n, n);
}

} // namespace

std::string EntityText(const Keys &keys) {
    return "{\n" + KeyText(keys) + "}\n";
}

std::string BoxText(const Vec3f &a, const Vec3f &b, std::string_view texture) {
    std::string text = "{\n";
    text += SideText({b.x, a.y, a.z}, {b.x, a.y, b.z}, {b.x, b.y, a.z}, texture);
    text += SideText({a.x, a.y, a.z}, {a.x, b.y, a.z}, {a.x, a.y, b.z}, texture);
    text += SideText({a.x, b.y, a.z}, {b.x, b.y, a.z}, {a.x, b.y, b.z}, texture);
    text += SideText({a.x, a.y, a.z}, {a.x, a.y, b.z}, {b.x, a.y, a.z}, texture);
    text += SideText({a.x, a.y, b.z}, {a.x, b.y, b.z}, {b.x, a.y, b.z}, texture);
    text += SideText({a.x, a.y, a.z}, {b.x, a.y, a.z}, {a.x, b.y, a.z}, texture);
    return text + "}\n";
}

std::string DiamondText(const Vec3f &base, float radius, float height, std::string_view texture) {
    const std::array<Vec3f, 4> corners{base + Vec3f{radius, 0, 0}, base + Vec3f{0, radius, 0},
                                       base + Vec3f{-radius, 0, 0}, base + Vec3f{0, -radius, 0}};
    const Vec3f up{0, 0, height};
    std::string text = "{\n";
    for (std::size_t i = 0; i < 4; ++i)
        text += SideText(corners[i], corners[i] + up, corners[(i + 1) % 4], texture);
    text += SideText(base + up, base + up + Vec3f{0, 1, 0}, base + up + Vec3f{1, 0, 0}, texture);
    text += SideText(base, base + Vec3f{1, 0, 0}, base + Vec3f{0, 1, 0}, texture);
    return text + "}\n";
}

std::string Lamp(const Vec3f &at, float light, const Vec3f &color, const Keys &more) {
    return fmt::format("{{\n\"classname\" \"light\"\n\"origin\" \"{}\"\n\"light\" \"{}\"\n\"_color\" \"{}\"\n{}}}\n",
                       Words(at), light, Words(color), KeyText(more));
}

int LitFace::TexelAt(const Vec3f &p, int side) const {
    const auto at = At(p);
    const int x = int(std::floor(at[0])), y = int(std::floor(at[1]));
    const bool center = std::abs(at[0] - float(x) - 0.5f) < 0.01f && std::abs(at[1] - float(y) - 0.5f) < 0.01f;
    return center && x >= 0 && y >= 0 && x < side && y < side ? y * side + x : -1;
}

LitRoomTest::LitRoomTest() : maps_(folder_ / "base/baseq3/maps") {
    folder_.Write("base/baseq3/scripts/shaderlist.txt", "test\n");
    folder_.Write("base/baseq3/scripts/test.shader", kShaders);
    std::filesystem::create_directories(maps_);
}

void LitRoomTest::Compile(const std::string &entities, const Keys &worldKeys, const std::string &brushes,
                          std::string_view ceiling) {
    std::string text = "{\n\"classname\" \"worldspawn\"\n" + KeyText(worldKeys);
    text += BoxText({-256, -256, -16}, {256, 256, 0}, "test/floor");
    text += BoxText({-256, -256, 256}, {256, 256, 272}, ceiling);
    const std::string_view wall = ceiling == "test/sky" ? "test/sky" : "test/wall";
    text += BoxText({-272, -256, 0}, {-256, 256, 256}, wall);
    text += BoxText({256, -256, 0}, {272, 256, 256}, wall);
    text += BoxText({-256, -272, 0}, {256, -256, 256}, wall);
    text += BoxText({-256, 256, 0}, {256, 272, 256}, wall);
    text += brushes + "}\n";
    text += EntityText({{"classname", "info_player_deathmatch"}, {"origin", "-200 -200 32"}});
    folder_.Write("base/baseq3/maps/room.map", text + entities);
    const Outcome outcome = RunProgramFile(
        {"-fs_basepath", (folder_ / "base").string(), "-meta", (maps_ / "room.map").string()}, folder_.Root());
    ASSERT_EQ(outcome.status, 0) << outcome.text;
    ASSERT_FALSE(std::filesystem::exists(maps_ / "room.lin")) << "the room leaks";
}

Outcome LitRoomTest::Run(std::string_view options) {
    return RunWords("-light -nogrid " + std::string(options));
}

Outcome LitRoomTest::RunWords(std::string_view words) {
    std::vector<std::string> arguments{"-fs_basepath", (folder_ / "base").string()};
    std::istringstream text{std::string(words)};
    for (std::string word; text >> word;)
        arguments.push_back(word);
    arguments.push_back((maps_ / "room.bsp").string());
    return RunProgramFile(arguments, folder_.Root());
}

Outcome LitRoomTest::Light(std::string_view options) {
    Outcome outcome = Run(options);
    EXPECT_EQ(outcome.status, 0) << options << '\n' << outcome.text;
    return outcome;
}

Bsp LitRoomTest::Load() const {
    KeptLog quiet;
    return ReadBspFile(maps_ / "room.bsp", {}, quiet.log);
}

std::vector<std::byte> LitRoomTest::MapBytes() const {
    return ReadFile(maps_ / "room.bsp");
}

std::map<std::string, std::size_t> LitRoomTest::Files() const {
    std::map<std::string, std::size_t> files;
    if (std::filesystem::exists(maps_ / "room"))
        for (const auto &entry : std::filesystem::directory_iterator(maps_ / "room"))
            files[entry.path().filename().string()] = std::size_t(entry.file_size());
    return files;
}

FloatImage LitRoomTest::Pfm(int page, std::string_view suffix) const {
    const auto path = Beside(fmt::format("lm_{:04}{}.pfm", page, suffix));
    return DecodePfm(ReadFile(path), path.string());
}

nlohmann::json LitRoomTest::Lightmass() const {
    return nlohmann::json::parse(ReadTextFile(Beside("lightmass.json")));
}

std::vector<std::uint8_t> LitRoomTest::MassImage(int page, std::string_view what, int channels) const {
    const std::string name = Lightmass().at("pages").at(std::size_t(page)).at("images").at(std::string(what));
    const auto path = folder_ / ("base/baseq3/" + name);
    const Image image = DecodeTga(ReadFile(path), path.string());
    std::vector<std::uint8_t> texels;
    for (std::size_t at = 0; at < image.rgba.size(); at += 4)
        for (int c = 0; c < channels; ++c)
            texels.push_back(image.rgba[at + std::size_t(c)]);
    return texels;
}

LitFace LitRoomTest::FaceOf(const Bsp &bsp, std::string_view shader, const Vec3f &normal) const {
    std::optional<LitFace> found;
    for (std::size_t i = 0; i < bsp.drawSurfaces.size(); ++i) {
        const bspDrawSurface_t &surface = bsp.drawSurfaces[i];
        const auto *verts = bsp.drawVerts.data() + surface.firstVert;
        const auto at = [&](int v) { return Vec3f{verts[v].xyz[0], verts[v].xyz[1], verts[v].xyz[2]}; };
        const Vec3f n{verts[0].normal[0], verts[0].normal[1], verts[0].normal[2]};
        if (FieldName(bsp.shaders[std::size_t(surface.shaderNum)].shader) != shader || Dot(n, normal) < 0.99f)
            continue;
        EXPECT_FALSE(found) << "several surfaces of " << shader;
        int c = 2;
        while (c + 1 < surface.numVerts && Length(Cross(at(1) - at(0), at(c) - at(0))) < 1)
            ++c;
        LitFace &face = found.emplace();
        face.surface = int(i), face.page = surface.lightmapNum[0];
        face.normal = n, face.corner = at(0);
        const auto texels = [&](int v, std::size_t k) { return verts[v].lightmap[0][k] * 128; };
        face.s = GradientOf({at(0), at(1), at(c)}, {texels(0, 0), texels(1, 0), texels(c, 0)});
        face.t = GradientOf({at(0), at(1), at(c)}, {texels(0, 1), texels(1, 1), texels(c, 1)});
        face.origin = {texels(0, 0), texels(0, 1)};
    }
    EXPECT_TRUE(found) << "no surface of " << shader;
    return found.value_or(LitFace{});
}

std::vector<Vec3f> LitRoomTest::FloorPoints() {
    std::vector<Vec3f> points;
    for (int y = -240; y <= 240; y += 16)
        for (int x = -240; x <= 240; x += 16)
            points.push_back({float(x), float(y), 0});
    return points;
}

} // namespace q3::test
