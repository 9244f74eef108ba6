// GPL-2.0-or-later. A small original arena that shows what the light grids do.
#include "tests/support/scene/demo_scene.h"

#include "tests/support/scene/scene_builder.h"

namespace q3 {

namespace {

// Surface flags of the parms sky, noimpact and nolightmap.
constexpr std::uint32_t kSkyFlags = 0x4 | 0x10 | 0xC00;

const char *const kShaderText = R"(// Demo arena: walls without textures, a lamp that shines, a sky with a sun.
textures/demo/wall
{
	q3map_lightRGB 0.6 0.6 0.6
	{
		map $whiteimage
		rgbGen exactVertex
	}
}
textures/demo/floor
{
	q3map_lightRGB 0.5 0.45 0.4
	{
		map $whiteimage
		rgbGen exactVertex
	}
}
textures/demo/trim
{
	q3map_lightRGB 0.4 0.4 0.45
	{
		map $whiteimage
		rgbGen exactVertex
	}
}
textures/demo/redlamp
{
	surfaceparm nomarks
	{
		map $whiteimage
		rgbGen const ( 1 0.2 0.1 )
	}
}
textures/demo/bluelamp
{
	surfaceparm nomarks
	{
		map $whiteimage
		rgbGen const ( 0.1 0.3 1 )
	}
}
textures/demo/warmlamp
{
	surfaceparm nomarks
	q3map_lightRGB 1 0.75 0.45
	q3map_surfacelight 2500
	{
		map $whiteimage
		rgbGen const ( 1 0.75 0.45 )
	}
}
textures/demo/sky
{
	surfaceparm sky
	surfaceparm noimpact
	surfaceparm nolightmap
	q3map_lightRGB 0.55 0.75 1
	q3map_sunExt 1 0.95 0.85 180 20 60 1 8
	q3map_skyLight 60 3
	{
		map $whiteimage
		rgbGen const ( 0.55 0.75 1 )
	}
}
)";

SceneShader Wall() {
    return {"textures/demo/wall"};
}

SceneShader Trim() {
    return {"textures/demo/trim"};
}

void AddRooms(SceneBuilder &scene) {
    scene.SetInterior({-512, -384, 0}, {512, 384, 320}, Wall());
    scene.SetWallShader(BoxFace::MinusZ, {"textures/demo/floor"});
    scene.SetWallShader(BoxFace::PlusZ, {"textures/demo/sky", kSkyFlags});
    // The ceiling, except for an opening over the east room.
    scene.AddBox({-512, -384, 288}, {128, 384, 320}, Wall());
    scene.AddBox({384, -384, 288}, {512, 384, 320}, Wall());
    scene.AddBox({128, -384, 288}, {384, -256, 320}, Wall());
    scene.AddBox({128, 0, 288}, {384, 384, 320}, Wall());
    // The dividing wall with its doorway, and the thin wall.
    scene.AddBox({-8, -384, 0}, {8, -64, 288}, Wall());
    scene.AddBox({-8, 64, 0}, {8, 384, 288}, Wall());
    scene.AddBox({-8, -64, 160}, {8, 64, 288}, Wall());
    scene.AddBox({64, 126, 0}, {448, 130, 288}, Wall());
}

void AddFurniture(SceneBuilder &scene) {
    for (const float x : {-384.0f, -160.0f})
        for (const float y : {-200.0f, 152.0f})
            scene.AddBox({x, y, 0}, {x + 48, y + 48, 288}, Trim());
    scene.AddBox({-296, -384, 128}, {-232, -368, 192}, {"textures/demo/redlamp"}, BoxKind::Detail);
    scene.AddBox({-296, 368, 128}, {-232, 384, 192}, {"textures/demo/bluelamp"}, BoxKind::Detail);
    const int lamp = scene.AddBox({192, 224, 272}, {320, 288, 288}, Trim(), BoxKind::Detail);
    scene.SetFaceShader(lamp, BoxFace::MinusZ, {"textures/demo/warmlamp"});
    scene.AddBox({400, -384, 0}, {512, -256, 48}, Trim());
    scene.AddBox({368, -384, 0}, {400, -256, 24}, Trim(), BoxKind::Detail);
    scene.AddBox({200, -200, 0}, {264, -136, 64}, Trim(), BoxKind::Detail);

    // A round bay before the west wall, and a pyramid on the platform.
    std::vector<Vec3f> bay;
    for (const float z : {0.0f, 144.0f, 288.0f})
        for (const auto &[x, y] :
             {std::pair{-512.0f, -64.0f}, {-448.0f, -64.0f}, {-448.0f, 0.0f}, {-448.0f, 64.0f}, {-512.0f, 64.0f}})
            bay.push_back({x, y, z});
    scene.AddPatch(5, 3, bay, Trim());
    const std::array<Vec3f, 5> pyramid = {
        Vec3f{432, -344, 48}, {480, -344, 48}, {480, -296, 48}, {432, -296, 48}, {456, -320, 96}};
    const std::array<std::int32_t, 12> faces = {0, 4, 1, 1, 4, 2, 2, 4, 3, 3, 4, 0};
    scene.AddTriangles(pyramid, faces, Trim());
    scene.AddInlineModel({-16, -64, 144}, {16, 64, 160}, Trim(), {{{"classname", "func_static"}}});
}

// Kept by the bsp stage; info_null is what the spotlight aims at.
std::vector<Entity> Places() {
    return {{{{"classname", "info_null"}, {"origin", "-64 -240 8"}, {"targetname", "spot1"}}},
            {{{"classname", "info_player_deathmatch"}, {"origin", "-264 0 32"}, {"angle", "0"}}},
            {{{"classname", "info_player_deathmatch"}, {"origin", "320 -64 32"}, {"angle", "180"}}},
            {{{"classname", "info_player_deathmatch"}, {"origin", "256 320 32"}, {"angle", "270"}}}};
}

std::vector<Entity> Lights() {
    return {{{{"classname", "light"}, {"origin", "-264 -336 160"}, {"light", "700"}, {"_color", "1 0.15 0.05"}}},
            {{{"classname", "light"}, {"origin", "-264 336 160"}, {"light", "700"}, {"_color", "0.05 0.2 1"}}},
            {{{"classname", "light"},
              {"origin", "-64 -320 264"},
              {"light", "200"},
              {"_color", "0.3 1 0.4"},
              {"target", "spot1"},
              {"radius", "80"}}}};
}

} // namespace

DemoMap DemoScene() {
    SceneBuilder scene;
    AddRooms(scene);
    AddFurniture(scene);
    scene.SetWorldKey("message", "Demo arena");
    scene.SetVisibility({.writeLump = true});
    for (const Entity &place : Places())
        scene.AddEntity(place);
    DemoMap map{scene.Build(), "", kShaderText};
    std::vector<Entity> all = ParseEntities(map.bsp.entities, "demo");
    for (const Entity &light : Lights())
        all.push_back(light);
    map.mapText = FormatEntities(all);
    return map;
}

} // namespace q3
