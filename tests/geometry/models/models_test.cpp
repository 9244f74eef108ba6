// GPL-2.0-or-later. Models in maps: axes, placement, shaders, clip brushes.
#include "common/error.h"
#include "common/platform/process_copy.h"
#include "common/text/text.h"
#include "q3map2/geometry/effects/surface_effects.h"
#include "q3map2/geometry/faces/face_surfaces.h"
#include "q3map2/geometry/models/models.h"
#include "q3map2/model/model_apart.h"
#include "q3map2/model/model_load.h"
#include "tests/geometry/extra_scene.h"

#include <cmath>
#include <csignal>
#include <functional>

#include <gmock/gmock.h>

namespace q3::test {
namespace {

using testing::HasSubstr;
using testing::SizeIs;

/// A triangle with the y axis up, seen from above; material `foo`. In map axes: (0 0 8) (64 0 8) (0 64 8), facing up.
constexpr std::string_view kTriangle = "usemtl foo\n"
                                       "v 0 8 0\nv 64 8 0\nv 0 8 -64\n"
                                       "vt 0 0\nvt 1 0\nvt 0 1\n"
                                       "vn 0 1 0\n"
                                       "f 1/1/1 2/2/1 3/3/1\n";
/// A square of 64 at z = 64 that faces down in map axes, of two triangles.
constexpr std::string_view kCeiling = "usemtl textures/test/wall\n"
                                      "v 0 64 0\nv 64 64 0\nv 64 64 -64\nv 0 64 -64\n"
                                      "vn 0 -1 0\n"
                                      "f 1//1 4//1 3//1\nf 1//1 3//1 2//1\n";

class ModelTest : public ExtraTest {
  protected:
    /// Surfaces of a misc_model of the triangle with these keys.
    std::vector<DrawSurface> Place(std::initializer_list<std::pair<std::string, std::string>> keys,
                                   std::string_view model = kTriangle) {
        folder.Write("models/t/m.obj", model);
        map.entities.resize(1);
        MapEntity &entity = AddEntity(keys);
        entity.pairs.Set("classname", "misc_model");
        if (!entity.pairs.Has("model"))
            entity.pairs.Set("model", "models/t/m.obj");
        geometry = {};
        AddEntityModels(map, map.World(), geometry, Context());
        return geometry.surfaces;
    }
    const std::deque<Brush> &Clip(std::string_view flags, std::string_view model = kCeiling) {
        map.World().brushes.clear();
        Place({{"spawnflags", std::string(flags)}}, model);
        return map.World().brushes;
    }
};

void ExpectPoint(const Vec3f &got, const Vec3f &want) {
    for (std::size_t i = 0; i < 3; ++i)
        EXPECT_NEAR(got[i], want[i], 1e-3) << "component " << i;
}

const DrawVert *VertAt(const DrawSurface &surface, const Vec3f &p) {
    for (const DrawVert &vert : surface.verts)
        if (Length(vert.xyz - p) < 1e-3f)
            return &vert;
    return nullptr;
}

TEST_F(ModelTest, AxesOfObjFilesTurnFromYUpToZUp) {
    const auto surfaces = Place({});
    ASSERT_THAT(surfaces, SizeIs(1));
    EXPECT_EQ(surfaces[0].kind, SurfaceKind::Triangles);
    EXPECT_EQ(surfaces[0].shader->name, "models/t/foo");
    ASSERT_THAT(surfaces[0].verts, SizeIs(3));
    ASSERT_THAT(surfaces[0].indexes, SizeIs(3));
    const DrawVert *corner = VertAt(surfaces[0], {0, 64, 8});
    ASSERT_NE(corner, nullptr);
    ExpectPoint(corner->normal, {0, 0, 1});
    EXPECT_NEAR(corner->st[0], 0, 1e-6);
    EXPECT_NEAR(corner->st[1], 0, 1e-6); // 1 - 1
    ExpectPoint(Vec3f(TriangleNormal(surfaces[0], 0)), {0, 0, 1});
}

TEST_F(ModelTest, ArchivesHoldModelsToo) {
    folder.WriteArchive("pak0.pk3", {{"models/a/b.obj", std::string(kTriangle)}});
    EXPECT_EQ(Place({{"model", "models\\a\\B.obj"}}).at(0).shader->name, "models/a/foo");
}

TEST_F(ModelTest, ScaleThenAnglesThenOrigin) {
    const auto surfaces = Place({{"modelscale_vec", "2 1 1"}, {"angle", "90"}, {"origin", "100 0 0"}});
    ASSERT_THAT(surfaces, SizeIs(1));
    // (64 0 8) -> (128 0 8) -> (0 128 8) -> (100 128 8); (0 64 8) -> (-64 0 8) -> (36 0 8)
    EXPECT_NE(VertAt(surfaces[0], {100, 128, 8}), nullptr);
    EXPECT_NE(VertAt(surfaces[0], {36, 0, 8}), nullptr);
    ExpectPoint(surfaces[0].verts[0].normal, {0, 0, 1});
}

TEST_F(ModelTest, PitchTurnsTheNoseDown) {
    const auto surfaces = Place({{"angles", "90 0 0"}});
    ASSERT_THAT(surfaces, SizeIs(1));
    EXPECT_NE(VertAt(surfaces[0], {8, 0, -64}), nullptr);
    ExpectPoint(surfaces[0].verts[0].normal, {1, 0, 0});
}

TEST_F(ModelTest, MirroredModelsStillFaceAlongTheirNormals) {
    const auto surfaces = Place({{"modelscale_vec", "-1 1 1"}});
    ASSERT_THAT(surfaces, SizeIs(1));
    EXPECT_NE(VertAt(surfaces[0], {-64, 0, 8}), nullptr);
    ExpectPoint(surfaces[0].verts[0].normal, {0, 0, 1});
    ExpectPoint(Vec3f(TriangleNormal(surfaces[0], 0)), {0, 0, 1});
}

TEST_F(ModelTest, NormalsOfUnevenScalesStayPerpendicular) {
    constexpr std::string_view slope = "usemtl foo\nv 0 0 0\nv 64 64 0\nv 0 0 -64\nvn -0.70710678 0.70710678 0\n"
                                       "f 1//1 2//1 3//1\n";
    const auto surfaces = Place({{"modelscale_vec", "1 1 4"}}, slope);
    ASSERT_THAT(surfaces, SizeIs(1));
    const Vec3d flat = TriangleNormal(surfaces[0], 0);
    EXPECT_NEAR(std::abs(Dot(flat, Vec3d(surfaces[0].verts[0].normal))), 1, 1e-5);
}

TEST_F(ModelTest, TheLongestSuffixRemaps) {
    EXPECT_EQ(Place({{"_remap", "*;textures/a"}})[0].shader->name, "textures/a");
    EXPECT_EQ(Place({{"_remap", "*;textures/a"}, {"_remap2", "oo;textures/b"}, {"_remap3", "t/FOO;textures/c"}})[0]
                  .shader->name,
              "textures/c");
    EXPECT_EQ(Place({{"_remap", "bar;textures/a"}})[0].shader->name, "models/t/foo");
}

TEST_F(ModelTest, BadRemapsWarn) {
    Place({{"_remap", "bar;textures/a"}});
    EXPECT_THAT(out.text, HasSubstr("_remap \"bar;textures/a\" has no effect: no shader of the model ends with bar; it "
                                    "has models/t/foo"));
    EXPECT_EQ(Place({{"_remap", "foo"}})[0].shader->name, "models/t/foo");
    EXPECT_THAT(out.text, HasSubstr("Entity 1: \"_remap\" \"foo\" is ignored"));
}

TEST_F(ModelTest, SkinsReplaceShadersAndLeaveOutTheOthers) {
    folder.Write("models/t/m_red.skin", "replace models/t/foo.tga textures/red.tga\n");
    folder.Write("models/t/m.obj_2.skin", "models/t/foo,textures/two\n");
    folder.Write("models/t/m_none.skin", "replace models/t/other textures/red\n");
    EXPECT_EQ(Place({{"skin", "red"}})[0].shader->name, "textures/red");
    EXPECT_EQ(Place({{"_skin", "2"}})[0].shader->name, "textures/two");
    EXPECT_THAT(Place({{"skin", "none"}}), SizeIs(0));
}

TEST_F(ModelTest, AMissingSkinIsAWarningAndTheModelKeepsItsShaders) {
    EXPECT_EQ(Place({{"skin", "blue"}})[0].shader->name, "models/t/foo");
    EXPECT_THAT(out.text, HasSubstr("Entity 1: the skin file models/t/m_blue.skin cannot be read"));
}

TEST_F(ModelTest, ARemapWithoutMatchNamesTheShadersOfTheSkin) {
    folder.Write("models/t/m_red.skin", "replace models/t/foo.tga textures/red.tga\n");
    Place({{"skin", "red"}, {"_remap", "foo;textures/a"}});
    EXPECT_THAT(out.text, HasSubstr("no shader of the model ends with foo; it has textures/red"));
}

TEST_F(ModelTest, MissingAndBrokenModelsWarnWithFileAndEntity) {
    EXPECT_THAT(Place({{"model", "models/gone.md3"}}), SizeIs(0));
    EXPECT_THAT(out.text, HasSubstr("Entity 1: the model models/gone.md3 cannot be read"));
    folder.Write("models/broken.md3", "IDP3 and then nothing of it");
    Place({{"model", "models/broken.md3"}});
    out.log.FlushWarnings();
    EXPECT_THAT(Place({{"model", "models/broken.md3"}}), SizeIs(0));
    EXPECT_THAT(out.text, HasSubstr("Entity 1: the model models/broken.md3 cannot be read"));
}

TEST_F(ModelTest, AnEntityWithoutModelKeyWarns) {
    AddEntity({{"classname", "misc_model"}});
    AddEntityModels(map, map.World(), geometry, Context());
    EXPECT_THAT(out.text, HasSubstr("Entity 1: misc_model without a \"model\" key"));
}

TEST_F(ModelTest, SpawnflagsForceMetaAndMakeGreyAlpha) {
    const auto surfaces = Place({{"spawnflags", "36"}});
    ASSERT_THAT(surfaces, SizeIs(1));
    EXPECT_EQ(surfaces[0].kind, SurfaceKind::ForcedMeta);
    EXPECT_EQ(surfaces[0].verts[0].color, (std::array<std::uint8_t, 4>{255, 255, 255, 255}));
}

TEST_F(ModelTest, ModelsJoinTheBrushEntityTheyTarget) {
    folder.Write("models/t/m.obj", kTriangle);
    AddBox({0, 0, 0}, {8, 8, 8}, "textures/test/wall");
    AddEntity({{"classname", "misc_model"}, {"model", "models/t/m.obj"}, {"target", "door"}, {"origin", "10 0 0"}});
    MapEntity &door = AddEntity({{"classname", "func_door"}, {"targetname", "door"}, {"origin", "4 0 0"}});
    door.brushes.push_back(map.World().brushes[0]);
    AddEntityModels(map, map.World(), geometry, Context());
    EXPECT_THAT(geometry.surfaces, SizeIs(0));
    AddEntityModels(map, map.entities[2], geometry, Context());
    ASSERT_THAT(geometry.surfaces, SizeIs(1));
    EXPECT_NE(VertAt(geometry.surfaces[0], {6, 0, 8}), nullptr);
    EXPECT_EQ(geometry.surfaces[0].settings.entity, 2);
    EXPECT_EQ(geometry.surfaces[0].settings.castShadows, 0);
}

TEST_F(ModelTest, MaterialNamesBecomeShaderNames) {
    const auto name = [](std::string_view material) { return ShaderOfMaterial(material, "models/t/cube.obj"); };
    EXPECT_EQ(name("foo"), "models/t/foo");
    EXPECT_EQ(name("textures\\base\\wall.tga"), "textures/base/wall");
    EXPECT_EQ(name("C:\\quake\\baseq3\\models\\a\\b.jpg"), "models/a/b");
    EXPECT_EQ(name("../../textures/x/y.tga"), "textures/x/y");
    EXPECT_EQ(name("/home/me/skin.png"), "models/t/skin");
}

TEST_F(ModelTest, ACeilingClipsToASlabAboveIt) {
    const auto &brushes = Clip("2");
    ASSERT_THAT(brushes, SizeIs(1)); // the two triangles are one polygon
    const Brush &slab = brushes[0];
    ExpectPoint(slab.bounds.mins, {0, 0, 64});
    ExpectPoint(slab.bounds.maxs, {64, 64, 66});
    EXPECT_TRUE(slab.detail);
    int withShader = 0;
    for (const BrushSide &side : slab.sides)
        if (side.shader != nullptr) {
            ++withShader;
            EXPECT_EQ(map.planes[side.planeNum].normal, (Vec3d{0, 0, -1}));
        }
    EXPECT_EQ(withShader, 1);
    for (std::size_t i = 0; i < 6; ++i)
        EXPECT_EQ(map.planes[slab.sides[i].planeNum].normal[i / 2], i % 2 == 0 ? -1 : 1);
}

double Volume(const Brush &brush, const PlaneTable &planes) {
    double volume = 0;
    const Vec3d center(brush.bounds.Center());
    for (const BrushSide &side : brush.sides)
        if (side.winding.size() >= 3)
            volume -= planes[side.planeNum].Distance(center) * WindingArea(side.winding) / 3;
    return volume;
}

TEST_F(ModelTest, ClipBrushesCanBeShown) {
    EXPECT_THAT(Place({{"spawnflags", "2"}}, kCeiling), SizeIs(1)) << "the model alone";
    options.debugClip = true;
    const auto surfaces = Place({{"spawnflags", "2"}}, kCeiling);
    ASSERT_THAT(surfaces, SizeIs(7)) << "and the six sides of its brush";
    int onModel = 0;
    for (auto surface = surfaces.begin() + 1; surface != surfaces.end(); ++surface) {
        const bool front = surface->shader->name == "debugclip";
        onModel += front;
        EXPECT_TRUE(front || surface->shader->name == "debugclip2") << surface->shader->name;
        EXPECT_THAT(surface->verts, SizeIs(4));
        EXPECT_THAT(surface->indexes, SizeIs(6));
        const Vec3f normal = surface->verts[0].normal;
        EXPECT_GT(Dot(TriangleNormal(*surface, 0), Vec3d(normal)), 0.99) << "drawn from outside";
        if (front)
            ExpectPoint(normal, {0, 0, -1});
    }
    EXPECT_EQ(onModel, 1);
}

TEST_F(ModelTest, ClipShapesHaveTheirVolumes) {
    const double quad = 64 * 64;
    EXPECT_NEAR(Volume(Clip("8")[0], map.planes), quad * 2, 1);                              // along the normals
    EXPECT_NEAR(Volume(Clip("256")[0], map.planes), quad * 2 / 3, 1);                        // pyramid
    EXPECT_NEAR(Volume(Clip("1024")[0], map.planes), quad * 2, 1);                           // upwards
    EXPECT_NEAR(Volume(Clip("264")[0], map.planes), (64. * 64 * 64 - 60. * 60 * 60) / 6, 1); // sides of 45 degrees
    ExpectPoint(Clip("512")[0].bounds.mins, {0, 0, 62}); // downwards: in front of it
    ASSERT_THAT(Clip("128"), SizeIs(2));                 // triangle by triangle
    EXPECT_NEAR(Volume(map.World().brushes[0], map.planes), quad, 1);
}

TEST_F(ModelTest, AxialBacksAreFlat) {
    // A ramp that rises from z = 0 to 64 and faces up.
    constexpr std::string_view ramp = "usemtl textures/test/wall\nv 0 0 0\nv 128 64 0\nv 128 64 -64\nv 0 0 -64\n"
                                      "vn -0.447 0.894 0\nf 1//1 2//1 3//1\nf 1//1 3//1 4//1\n";
    const auto &brushes = Clip("4096", ramp);
    ASSERT_THAT(brushes, SizeIs(1));
    ExpectPoint(brushes[0].bounds.mins, {0, 0, -2});
    EXPECT_NEAR(Volume(brushes[0], map.planes), 128 * 64 * (32 + 2), 1);
}

TEST_F(ModelTest, OddCombinationsOfClipFlagsWarn) {
    EXPECT_THAT(Clip("2056"), SizeIs(0)); // face normals and full depth
    EXPECT_THAT(out.text, HasSubstr("Entity 1: the spawnflags 2056"));
}

TEST_F(ModelTest, ModelsThatAreNotSolidGetNoClipUnlessTheShaderAsks) {
    Script("textures/test/ghost\n{\nsurfaceparm nonsolid\n}\n"
           "textures/test/asks\n{\nsurfaceparm nonsolid\nq3map_clipModel\n}\n");
    std::string text(kCeiling);
    const auto with = [&](std::string_view shader) {
        std::string model = text;
        return model.replace(model.find("textures/test/wall"), 18, shader);
    };
    EXPECT_THAT(Clip("2", with("textures/test/ghost")), SizeIs(0));
    folder.Write("models/t/n.obj", with("textures/test/asks"));
    Place({{"model", "models/t/n.obj"}});
    EXPECT_THAT(map.World().brushes, SizeIs(1));
}

TEST_F(ModelTest, ScatteredModelsLieOnTheSurfaceAndRepeat) {
    Script("textures/test/grass\n{\nq3map_surfaceModel models/t/m.obj 64 0.5 1 1 0 360 0\n}\n");
    folder.Write("models/t/m.obj", kTriangle);
    const auto scatter = [&] {
        geometry = {};
        map.World().patches = {FlatPatch(0, 0, 512, 512, 32, Shader("textures/test/grass"))};
        MakePatchSurfaces(map.World(), geometry, map.planes, Context());
        AddShaderModels(map.World(), geometry, 0, map.planes, Context());
        return geometry.surfaces;
    };
    const auto once = scatter(), again = scatter();
    ASSERT_EQ(once.size(), again.size());
    // 512 * 512 over right triangles of at most 32 * 64 / 2: at least 256, half of them taken
    EXPECT_GT(once.size(), 80u);
    for (std::size_t i = 1; i < once.size(); ++i) {
        EXPECT_NEAR(once[i].verts[0].xyz.z, 40, 1e-3);
        EXPECT_EQ(once[i].verts[0].xyz, again[i].verts[0].xyz);
    }
}

TEST_F(ModelTest, FoliageIsOneSurfaceWithAPointForEachPlant) {
    Script("textures/test/meadow\n{\nq3map_foliage models/t/m.obj 2 64 1 0\n}\n");
    folder.Write("models/t/m.obj", kTriangle);
    map.World().patches = {FlatPatch(0, 0, 256, 256, 32, Shader("textures/test/meadow"))};
    MakePatchSurfaces(map.World(), geometry, map.planes, Context());
    MakeFoliage(0, geometry, Context());
    ASSERT_THAT(geometry.surfaces, SizeIs(2));
    const DrawSurface &foliage = geometry.surfaces[1];
    EXPECT_EQ(foliage.kind, SurfaceKind::Foliage);
    EXPECT_EQ(foliage.height, 3);
    EXPECT_GE(foliage.width, 32);
    ASSERT_EQ(int(foliage.verts.size()), foliage.width + foliage.height);
    EXPECT_NE(VertAt(foliage, {128, 0, 16}), nullptr); // the model, twice its size
    for (std::size_t i = 3; i < foliage.verts.size(); ++i)
        EXPECT_FLOAT_EQ(foliage.verts[i].xyz.z, 32);
}

/// The ceiling as glTF, whose material and embedded image have these names.
std::string GltfCeiling(std::string_view material, std::string_view image) {
    const auto named = [](std::string_view name) {
        return name.empty() ? "" : fmt::format("\"name\": \"{}\", ", name);
    };
    return fmt::format(
        R"({{"asset": {{"version": "2.0"}}, "scene": 0, "scenes": [{{"nodes": [0]}}], "nodes": [{{"mesh": 0}}],
"meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0}}, "material": 0}}]}}],
"accessors": [{{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 0, 1]}}],
"bufferViews": [{{"buffer": 0, "byteLength": 36}}],
"buffers": [{{"byteLength": 36, "uri": "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAAAAAAAAAAAAAIA/AACAPwAAAAAAAAAA"}}],
"materials": [{{{}"pbrMetallicRoughness": {{"baseColorTexture": {{"index": 0}}}}}}], "textures": [{{"source": 0}}],
"images": [{{{}"uri": "data:image/png;base64,iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mP8z8BQDwAEhQGAhKmMIQAAAABJRU5ErkJggg=="}}]}})",
        named(material), named(image));
}

TEST_F(ModelTest, AnImageWithinTheModelGivesNoName) {
    const auto shader = [this](std::string_view material, std::string_view image) {
        const std::string file = fmt::format("models/t/g{}{}.gltf", material.size(), image.size());
        folder.Write(file, GltfCeiling(material, image));
        const auto surfaces = Place({{"model", "/" + file}});
        return surfaces.empty() ? "" : surfaces[0].shader->name;
    };
    EXPECT_EQ(shader("stone", "pebbles"), "models/t/stone");
    EXPECT_EQ(shader("textures/base/wall", "stone"), "textures/base/wall");
    EXPECT_EQ(shader("", "pebble"), "models/t/pebble");
    EXPECT_EQ(shader("", ""), "models/t/g00");
}

/// A triangle whose third corner is far outside the list of vertices: assimp 5.2.5 reads there.
constexpr std::string_view kAseOutside = R"(*3DSMAX_ASCIIEXPORT 200
*GEOMOBJECT {
 *MESH {
  *MESH_NUMVERTEX 3
  *MESH_NUMFACES 1
  *MESH_VERTEX_LIST {
   *MESH_VERTEX 0 0 0 0
   *MESH_VERTEX 1 1 0 0
   *MESH_VERTEX 2 1 1 0
  }
  *MESH_FACE_LIST {
   *MESH_FACE 0: A: 0 B: 1 C: 99999999 AB: 0 BC: 0 CA: 0 *MESH_SMOOTHING 1 *MESH_MTLID 0
  }
 }
}
)";

TEST_F(ModelTest, AFileThatCrashesItsReaderIsNoModel) {
    if (!ProcessCopy::IsAvailable())
        GTEST_SKIP() << "models are read in this process";
    folder.Write("models/t/outside.ase", kAseOutside);
    EXPECT_THAT(Place({{"model", "models/t/outside.ase"}}), testing::IsEmpty());
    const auto error = [this](const std::function<Model(const ModelFiles &)> &read) -> std::string {
        try {
            ReadModelApart(*vfs, read);
        } catch (const Error &e) {
            return e.what();
        }
        return "no error";
    };
    EXPECT_THAT(error([](const ModelFiles &) -> Model {
                    std::raise(SIGSEGV);
                    return {};
                }),
                HasSubstr("the model reader (assimp) fails with this file: "));
    EXPECT_EQ(error([](const ModelFiles &) -> Model { throw Error("no triangles"); }), "no triangles");
    EXPECT_EQ(error([](const ModelFiles &) {
                  return Model{{{"x", std::vector<DrawVert>(3), {{0, 1, 3}}}}};
              }),
              "a triangle names vertex 3 of 3");
}

TEST_F(ModelTest, ReadersAskTheProcessForFiles) {
    folder.Write("models/t/a.txt", "text");
    Context();
    vfs->RecordRequests();
    const Model model = ReadModelApart(*vfs, [](const ModelFiles &files) {
        const auto file = files.Read("models/t/a.txt");
        const bool isRight = files.Exists("models/t/a.txt") && !files.Exists("models/t/b.txt") && file &&
                             AsText(*file) == "text" && !files.Read("models/t/b.txt");
        return Model{{{isRight ? "right" : "wrong", std::vector<DrawVert>(3), {{0, 1, 2}}}}};
    });
    ASSERT_THAT(model.meshes, SizeIs(1));
    EXPECT_EQ(model.meshes[0].shader, "right");
    EXPECT_THAT(model.meshes[0].verts, SizeIs(3));
    EXPECT_THAT(vfs->Requests(), testing::Contains(HasSubstr("models/t/b.txt")));
}

} // namespace
} // namespace q3::test
