// GPL-2.0-or-later. One lit room in all encodings of light, decoded as by engines, against a reference.
#include "common/files/files.h"
#include "common/image/image.h"
#include "libs/ambientcubes/ambient_cubes.h"
#include "libs/directional/directional.h"
#include "libs/shgrid/shgrid.h"
#include "libs/staticprops/staticprops.h"
#include "tests/program/lit_room.h"
#include "tests/program/prop_models.h"
#include "tests/program/room_reference.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>

namespace q3::test {

namespace {

constexpr double kReflectanceOfWhite = 187.5 * 3 / 255 * 0.25;
constexpr double kAmbient = 3;

using Gray = std::array<std::uint8_t, 3>;
constexpr Gray kFloorColor{220, 180, 140}, kWallColor{160, 170, 200}, kCeilingColor{200, 200, 200},
    kPanelColor{200, 90, 70}, kPillarColor{120, 200, 120};
const Boundsd kPillar{{-48, -144, 0}, {16, -96, 112}};
const std::vector<ReferenceLamp> kLamps{{{-104, 72, 168}, 130, {1, 0.8, 0.6}}, {{120, -40, 128}, 90, {0.5, 0.8, 1}}};

Vec3d ReflectanceOf(const Gray &color) {
    return Vec3d{double(color[0]), double(color[1]), double(color[2])} * (kReflectanceOfWhite / 255);
}

Vec3d FromFloats(const float v[3]) {
    return {double(v[0]), double(v[1]), double(v[2])};
}

/// Normals evenly distributed over the sphere: a Fibonacci spiral.
std::vector<Vec3d> SphereNormals(int count = 32) {
    std::vector<Vec3d> all;
    for (int i = 0; i < count; ++i) {
        const double z = 1 - (2 * i + 1.0) / count, around = i * std::numbers::pi * (3 - std::sqrt(5.0));
        all.push_back({std::sqrt(1 - z * z) * std::cos(around), std::sqrt(1 - z * z) * std::sin(around), z});
    }
    return all;
}

Vec3d AxisOf(std::size_t side) {
    Vec3d axis;
    axis[side / 2] = side % 2 == 0 ? 1 : -1;
    return axis;
}

double LargestOf(const Vec3d &v) {
    return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

/// The most light that the field gives to any of SphereNormals.
double PeakOf(const LightField &field) {
    double peak = 0;
    for (const Vec3d &normal : SphereNormals())
        peak = std::max(peak, LargestOf(field.On(normal)));
    return peak;
}

/// The light on a surface if all of it came from one direction. An encoding's error as a share of this is largest for a
/// single light.
double StrengthOf(const LightField &field) {
    Vec3d sum = field.ambient;
    for (const ArrivingLight &one : field.lights)
        sum += one.light;
    return LargestOf(sum);
}

/// Statistics of differences from expected light, relative to a scale.
struct Differences {
    double largest = 0, squares = 0;
    int count = 0;
    void Add(const Vec3d &got, const Vec3d &expected, double scale) {
        const double off = LargestOf(got - expected) / scale;
        largest = std::max(largest, off), squares += off * off, ++count;
    }
    double Rms() const { return std::sqrt(squares / std::max(count, 1)); }
};

/// Normals at 20 and 40 degrees to the z axis.
std::vector<Vec3d> TiltedNormals() {
    std::vector<Vec3d> all;
    for (const double tilt : {20.0, 40.0})
        for (int i = 0; i < 6; ++i) {
            const double down = tilt * std::numbers::pi / 180, around = (i + 0.25) * std::numbers::pi / 3;
            all.push_back({std::sin(down) * std::cos(around), std::sin(down) * std::sin(around), std::cos(down)});
        }
    return all;
}

/// World space direction of basis normal i on the floor, whose texture coordinates grow along +x (s) and -y (t).
Vec3d FloorBasis(std::size_t i) {
    float basis[3][3];
    directional_rnm_basis(basis);
    return {double(basis[i][0]), -double(basis[i][1]), double(basis[i][2])};
}

/// A point of the SH grid, or an ambient cube.
struct SeenPlace {
    Vec3d position;
    std::function<Vec3d(const Vec3d &)> on; ///< its light on a normal, byte scale
};

/// Light that one encoding gives at a place on one normal.
struct Reading {
    Vec3d position, normal, light;
};
/// Readings by name of the encoding, in the same order in each bake.
using Readings = std::map<std::string, std::vector<Reading>>;

class EncodingsTest : public LitRoomTest {
  protected:
    class MassImages;
    EncodingsTest();
    /// panel: the shader of the box in front of the wall at x = 256.
    void CompileRoom(std::string_view panel);
    void Bake(const std::string &options);
    RoomReference Reference(int bounces) const;

    /// Points of the floor away from shadow edges, at centers of luxels.
    std::vector<Vec3d> SmoothFloor(const RoomReference &reference) const;
    std::vector<SeenPlace> GridPlaces() const;
    std::vector<SeenPlace> CubePlaces() const;
    /// Position and light of the panel's vertices, in a bake where it has no lightmap.
    std::vector<std::pair<Vec3d, Vec3d>> PanelVertices(const RoomReference &reference) const;
    /// Colors of the n-th prop.
    std::vector<Vec3d> PropColors(std::uint32_t prop) const;
    /// Writes the models of the props: a sheet on the floor, and probes at these places.
    void WriteProps(const std::vector<Vec3d> &gridPlaces, const std::vector<Vec3d> &cubePlaces);
    /// Writes a model with six vertices at each place, whose normals are along the axes.
    void WriteProbes(std::string_view model, const std::vector<Vec3d> &places);
    Readings Read(const RoomReference &reference) const;
    void ReadFloor(const RoomReference &reference, Readings &all) const;
    /// Bakes with these options and reads all encodings. Bakes twice: the second time with props at the places of the
    /// ambient cubes and grid points found in the first.
    Readings BakeAndRead(const RoomReference &reference, const std::string &options);

    std::vector<std::byte> file_;
};

/// The images of -lightmass for one face.
class EncodingsTest::MassImages {
  public:
    MassImages(const EncodingsTest &test, const LitFace &face)
        : color_(test.MassImage(face.page, "hq_color", 4)), direction_(test.MassImage(face.page, "hq_direction", 4)) {
        const auto json = test.Lightmass();
        for (const auto &from : json.at("lightmaps"))
            if (from["surfaces"].at(0) == face.surface)
                for (std::size_t image = 0; image < 2; ++image)
                    for (std::size_t c = 0; c < 4; ++c) {
                        range_.multiply[image][c] = from["multiply"][image][c];
                        range_.add[image][c] = from["add"][image][c];
                    }
    }
    Vec3d Light(std::size_t texel, const Vec3d &normal) const {
        float color[4], direction[4], rgb[3];
        directional_texel(color_.data() + 4 * texel, color);
        directional_texel(direction_.data() + 4 * texel, direction);
        const float n[3] = {float(normal.x), float(normal.y), float(normal.z)};
        directional_lightmass_high(color, direction, &range_, n, rgb);
        return FromFloats(rgb) * 255;
    }

  private:
    std::vector<std::uint8_t> color_, direction_;
    directional_range range_{};
};

EncodingsTest::EncodingsTest() {
    std::string script;
    const auto add = [&](std::string_view name, const Gray &color, std::string_view more, std::string_view stage) {
        std::vector<std::uint8_t> texels;
        for (int i = 0; i < 64; ++i)
            texels.insert(texels.end(), {color[0], color[1], color[2]});
        folder_.Write(fmt::format("base/baseq3/textures/test/{}.tga", name),
                      EncodeTga(texels, 8, 8, 3, TgaRows::TopFirst));
        script +=
            fmt::format("textures/test/{0}\n{{\n{1}{{\nmap textures/test/{0}.tga\n{2}}}\n}}\n", name, more, stage);
    };
    const std::string_view lightmapped = "}\n{\nmap $lightmap\n";
    add("floor", kFloorColor, "", lightmapped);
    add("wall", kWallColor, "", lightmapped);
    add("ceiling", kCeilingColor, "", lightmapped);
    add("pillar", kPillarColor, "", lightmapped);
    add("panel", kPanelColor, "", lightmapped);
    add("vertexpanel", kPanelColor, "surfaceparm pointlight\nq3map_tessSize 32\n", "rgbGen vertex\n");
    folder_.Write("base/baseq3/scripts/test.shader", script);
}

void EncodingsTest::CompileRoom(std::string_view panel) {
    const auto prop = [](std::string_view model) {
        return EntityText({{"classname", "misc_model_static"},
                           {"model", fmt::format("models/{}.md3", model)},
                           {"origin", "0 0 0"},
                           {"disableshadows", "1"}});
    };
    std::string entities = prop("sheet") + prop("gridprobes") + prop("cubeprobes");
    for (const ReferenceLamp &lamp : kLamps)
        entities += Lamp(Vec3f(lamp.origin), float(lamp.light), Vec3f(lamp.color));
    Compile(entities, {{"_ambient", fmt::format("{}", kAmbient)}},
            BoxText({240, -256, 0}, {256, 256, 256}, panel) +
                BoxText(Vec3f(kPillar.mins), Vec3f(kPillar.maxs), "test/pillar"));
}

void EncodingsTest::Bake(const std::string &options) {
    Light(fmt::format("-hdr -hdrfiles pfm -rnmall -lightmass -sh -gridsh 32 32 32 -ambientcubes "
                      "-cubetolerance 0 -staticproplighting -nofastpoint {}",
                      options));
    file_ = MapBytes();
}

RoomReference EncodingsTest::Reference(int bounces) const {
    RoomReference room;
    const Vec3d x{496, 0, 0}, y{0, 512, 0}, z{0, 0, 256}, low{-256, -256, 0};
    room.AddRectangle(low, x, y, ReflectanceOf(kFloorColor));
    room.AddRectangle(low + z, y, x, ReflectanceOf(kCeilingColor));
    room.AddRectangle(low, y, z, ReflectanceOf(kWallColor));
    room.AddRectangle(low + x, z, y, ReflectanceOf(kPanelColor));
    room.AddRectangle(low, z, x, ReflectanceOf(kWallColor));
    room.AddRectangle(low + y, x, z, ReflectanceOf(kWallColor));
    room.AddPillar(kPillar, ReflectanceOf(kPillarColor));
    for (const ReferenceLamp &lamp : kLamps)
        room.AddLamp(lamp);
    room.SetAmbient({kAmbient, kAmbient, kAmbient});
    room.Solve(bounces);
    return room;
}

std::vector<Vec3d> EncodingsTest::SmoothFloor(const RoomReference &reference) const {
    std::vector<Vec3d> points;
    for (int y = -208; y <= 208; y += 32)
        for (int x = -208; x <= 208; x += 32) {
            const Vec3d p{double(x), double(y), 0};
            Boundsd around = kPillar;
            around.mins -= Vec3d{32, 32, 32}, around.maxs += Vec3d{32, 32, 32};
            if ((x + y) % 64 == 0 && !around.Contains(p) && reference.IsSmoothAt(p, {0, 0, 1}, 24))
                points.push_back(p);
        }
    return points;
}

std::vector<SeenPlace> EncodingsTest::GridPlaces() const {
    shgrid_grid grid;
    EXPECT_EQ(shgrid_load(file_.data(), file_.size(), &grid), SHGRID_OK);
    std::vector<SeenPlace> places;
    for (std::int32_t z = 0; z < grid.bounds[2]; ++z)
        for (std::int32_t y = 0; y < grid.bounds[1]; ++y)
            for (std::int32_t x = 0; x < grid.bounds[0]; ++x) {
                SeenPlace place;
                for (std::size_t axis = 0; axis < 3; ++axis)
                    place.position[axis] =
                        double(grid.mins[axis]) + double(std::array{x, y, z}[axis]) * double(grid.cell[axis]);
                shgrid_coeffs coeffs;
                shgrid_point(&grid, x, y, z, &coeffs);
                place.on = [coeffs](const Vec3d &normal) {
                    const Vec3f n(normal);
                    const float facing[3] = {n.x, n.y, n.z};
                    float rgb[3];
                    shgrid_evaluate(&coeffs, facing, rgb);
                    return FromFloats(rgb) * 255;
                };
                const Vec3d &p = place.position;
                const bool lit = std::none_of(kLamps.begin(), kLamps.end(),
                                              [&](const ReferenceLamp &lamp) { return Length(lamp.origin - p) < 64; });
                const Boundsd inside{{-200, -200, 40}, {200, 200, 216}};
                if (lit && inside.Contains(p) && kPillar.Distance(p) > 24 && (x + y + z) % 9 == 0)
                    places.push_back(std::move(place));
            }
    return places;
}

std::vector<SeenPlace> EncodingsTest::CubePlaces() const {
    ambient_cubes cubes;
    EXPECT_EQ(ambient_cubes_load(file_.data(), file_.size(), &cubes), AMBIENT_CUBES_OK);
    std::vector<SeenPlace> places;
    for (std::uint32_t leaf = 0; leaf < cubes.leafCount; ++leaf) {
        std::uint32_t first = 0, owner = 0;
        const std::uint32_t count = ambient_cubes_of_leaf(&cubes, leaf, &first, &owner);
        for (std::uint32_t i = 0; owner == leaf && i < count; ++i) {
            float position[3];
            ambient_cube cube;
            ambient_cubes_sample(&cubes, first + i, leaf, position, &cube);
            const Boundsd inside{{-244, -244, 12}, {228, 244, 244}};
            if (!inside.Contains(FromFloats(position)) || kPillar.Distance(FromFloats(position)) < 12)
                continue;
            places.push_back({FromFloats(position), [cube](const Vec3d &normal) {
                                  const Vec3f n(normal);
                                  const float facing[3] = {n.x, n.y, n.z};
                                  float rgb[3];
                                  ambient_cube_evaluate(&cube, facing, rgb);
                                  return FromFloats(rgb) * 255;
                              }});
        }
    }
    return places;
}

std::vector<std::pair<Vec3d, Vec3d>> EncodingsTest::PanelVertices(const RoomReference &reference) const {
    const Bsp bsp = Load();
    std::vector<std::pair<Vec3d, Vec3d>> vertices;
    for (const bspDrawSurface_t &surface : bsp.drawSurfaces)
        for (int i = surface.firstVert; i < surface.firstVert + surface.numVerts; ++i) {
            if (FieldName(bsp.shaders[std::size_t(surface.shaderNum)].shader) != "textures/test/vertexpanel")
                continue;
            float rgb[3];
            directional_e5bgr9(bsp.vertexE5bgr9.at(std::size_t(i)), rgb);
            const Vec3d p(Vec3f(bsp.drawVerts[std::size_t(i)].xyz));
            if (p.x == 240 && std::abs(p.y) < 232 && p.z > 24 && p.z < 232 && reference.IsSmoothAt(p, {-1, 0, 0}, 24))
                vertices.emplace_back(p, FromFloats(rgb) * 255);
        }
    return vertices;
}

std::vector<Vec3d> EncodingsTest::PropColors(std::uint32_t prop) const {
    staticprops_light light;
    EXPECT_EQ(staticprops_load(file_.data(), file_.size(), &light), STATICPROPS_OK);
    const staticprops_mesh mesh = staticprops_get_mesh(&light, staticprops_get(&light, prop).firstMesh);
    std::vector<Vec3d> colors;
    for (std::uint32_t i = 0; i < mesh.colorCount; ++i) {
        float rgb[3];
        staticprops_color(&light, mesh.firstColor + i, rgb);
        colors.push_back(FromFloats(rgb) * 255);
    }
    return colors;
}

void EncodingsTest::WriteProps(const std::vector<Vec3d> &gridPlaces, const std::vector<Vec3d> &cubePlaces) {
    TestMesh sheet;
    sheet.AddSheet(-240, 240, 15, 1.0f / 64);
    folder_.Write("base/baseq3/models/sheet.md3", Md3Of({sheet}));
    WriteProbes("gridprobes", gridPlaces);
    WriteProbes("cubeprobes", cubePlaces);
}

void EncodingsTest::WriteProbes(std::string_view model, const std::vector<Vec3d> &places) {
    TestMesh mesh;
    for (const Vec3d &place : places)
        for (std::size_t side = 0; side < 6; ++side) {
            const Vec3f normal(AxisOf(side)), u = Vec3f(AxisOf((side + 2) % 6)) / 16, v = Cross(normal, u);
            const int first = int(mesh.verts.size());
            for (const Vec3f &at : {Vec3f{}, u, v})
                mesh.verts.push_back({Vec3f(place) + at, normal, {}});
            mesh.triangles.push_back({first, first + 2, first + 1});
        }
    folder_.Write(fmt::format("base/baseq3/models/{}.md3", model), Md3Of({mesh}));
}

void EncodingsTest::ReadFloor(const RoomReference &reference, Readings &all) const {
    const LitFace floor = FaceOf(Load(), "textures/test/floor", kUpward);
    const FloatImage page = Pfm(floor.page);
    const std::array<FloatImage, 3> basis{Pfm(floor.page, "_b1"), Pfm(floor.page, "_b2"), Pfm(floor.page, "_b3")};
    const auto sheet = PropColors(0);
    const MassImages mass(*this, floor);
    for (const Vec3d &p : SmoothFloor(reference)) {
        const auto texel = std::size_t(std::max(floor.TexelAt(Vec3f(p)), 0));
        EXPECT_GT(texel, 0u);
        const Vec3d above = p + Vec3d{0, 0, 1}, up{0, 0, 1};
        all["luxel"].push_back({above, up, Vec3d(page.texels.at(texel)) * 255});
        const std::size_t at = std::size_t((p.y + 240) / 32) * 16 + std::size_t((p.x + 240) / 32);
        all["prop on the floor"].push_back({p, up, sheet.at(at)});
        float maps[3][3];
        for (std::size_t i = 0; i < 3; ++i) {
            const Vec3f light = basis[i].texels.at(texel);
            std::copy_n(&light.x, 3, maps[i]);
            all["basis map"].push_back({above, FloorBasis(i), Vec3d(light) * 255});
        }
        const auto rnm = [&](const Vec3d &normal) {
            const float n[3] = {float(normal.x), -float(normal.y), float(normal.z)};
            float rgb[3];
            directional_rnm_rescaled(&maps[0][0], n, rgb);
            return FromFloats(rgb) * 255;
        };
        all["flat rnm"].push_back({above, up, rnm(up)});
        all["flat lightmass"].push_back({above, up, mass.Light(texel, up)});
        for (const Vec3d &normal : TiltedNormals()) {
            all["tilted rnm"].push_back({above, normal, rnm(normal)});
            all["tilted lightmass"].push_back({above, normal, mass.Light(texel, normal)});
        }
    }
}

Readings EncodingsTest::Read(const RoomReference &reference) const {
    Readings all;
    ReadFloor(reference, all);
    for (const auto &[p, light] : PanelVertices(reference))
        all["vertex"].push_back({p, {-1, 0, 0}, light});
    for (const bool cube : {false, true}) {
        const auto colors = PropColors(cube ? 2 : 1);
        const auto places = cube ? CubePlaces() : GridPlaces();
        for (std::size_t i = 0; i < places.size(); ++i)
            for (std::size_t side = 0; side < 6; ++side) {
                const Vec3d axis = AxisOf(side), p = places[i].position;
                all[cube ? "cube" : "grid"].push_back({p, axis, places[i].on(axis)});
                all[cube ? "prop at a cube" : "prop in the grid"].push_back({p, axis, colors.at(18 * i + 3 * side)});
            }
    }
    return all;
}

Readings EncodingsTest::BakeAndRead(const RoomReference &reference, const std::string &options) {
    WriteProps({}, {});
    Bake(options);
    std::vector<Vec3d> gridPlaces, cubePlaces;
    for (const SeenPlace &place : GridPlaces())
        gridPlaces.push_back(place.position);
    for (const SeenPlace &place : CubePlaces())
        cubePlaces.push_back(place.position);
    WriteProps(gridPlaces, cubePlaces);
    Bake(options);
    return Read(reference);
}

double GrayOf(const Vec3d &c) {
    return 0.3 * c.x + 0.59 * c.y + 0.11 * c.z;
}

/// The light on a normal that an encoding gives if its stored values are exact.
Vec3d Encoded(const std::string &name, const LightField &field, const Vec3d &normal) {
    const Vec3d up{0, 0, 1}, flat = field.On(up);
    if (name == "grid")
        return Max(field.InBands(2, normal), Vec3d{});
    if (name == "basis map") {
        const Vec3d sum = field.On(FloorBasis(0)) + field.On(FloorBasis(1)) + field.On(FloorBasis(2)),
                    own = field.On(normal);
        return Vec3d{own.x / sum.x, own.y / sum.y, own.z / sum.z} * flat * 3;
    }
    if (name == "tilted rnm") {
        Vec3d sum;
        for (std::size_t i = 0; i < 3; ++i)
            sum += Encoded("basis map", field, FloorBasis(i)) * std::max(0.0, Dot(FloorBasis(i), normal));
        return sum / std::sqrt(3.0);
    }
    if (name == "tilted lightmass")
        return flat * std::max(0.0, GrayOf(field.InBands(1, normal)) / GrayOf(field.InBands(1, up)));
    return field.On(normal);
}

/// Whether an encoding belongs to luxels of the floor, which get no light from below the horizon.
bool OnFloor(const std::string &name) {
    return name == "basis map" || name.starts_with("tilted");
}

void CutBelow(LightField &field) {
    std::erase_if(field.lights, [](const ArrivingLight &one) { return one.direction.z <= 0; });
}

/// Differences between readings and the reference.
struct Comparison {
    Differences own;    ///< from Encoded, as a share of PeakOf
    double worst = 0;   ///< largest over places: RMS over normals of the difference from all light / StrengthOf
    double bounced = 0; ///< sum of bounced light / its expected sum
};

Comparison Compare(const std::string &name, const std::vector<Reading> &readings, const RoomReference &reference) {
    Comparison result;
    LightField all, only;
    Differences here;
    double peak = 0, strength = 0, bounced = 0, expected = 0;
    for (std::size_t i = 0; i < readings.size(); ++i) {
        const auto &[position, normal, light] = readings[i];
        if (i == 0 || !(position == readings[i - 1].position)) {
            all = only = reference.Bounced(position);
            reference.AddDirect(position, all);
            if (OnFloor(name))
                CutBelow(all), CutBelow(only);
            peak = PeakOf(all), strength = StrengthOf(all);
            result.worst = std::max(result.worst, here.Rms());
            here = {};
        }
        const Vec3d own = Encoded(name, all, normal);
        result.own.Add(light, own, peak);
        here.Add(light, all.On(normal), strength);
        const Vec3d indirect = name == "grid" ? only.InBands(2, normal) : only.On(normal);
        bounced += GrayOf(light - (own - indirect)), expected += GrayOf(indirect);
    }
    result.worst = std::max(result.worst, here.Rms());
    result.bounced = expected > 0 ? bounced / expected : 1;
    return result;
}

/// Readings of places on 128 normals all around.
std::vector<Reading> AllAround(const std::vector<SeenPlace> &places) {
    std::vector<Reading> readings;
    for (const SeenPlace &place : places)
        for (const Vec3d &normal : SphereNormals(128))
            readings.push_back({place.position, normal, place.on(normal)});
    return readings;
}

/// Bounds of Comparison::worst that are inherent in encodings: SH up to band 2, up to band 1, cubes of six sides.
constexpr double kTwoBands = 0.04, kOneBand = 0.15, kSixSides = 0.2;

/// Expects each encoding to agree with the reference, and thereby with all other encodings.
void ExpectLight(const Readings &all, const RoomReference &reference, double largest, double rms) {
    EXPECT_EQ(all.size(), 12u);
    for (const auto &[name, readings] : all) {
        const Comparison compared = Compare(name, readings, reference);
        EXPECT_GT(compared.own.count, 50) << name;
        EXPECT_LT(compared.own.largest, largest) << name;
        EXPECT_LT(compared.own.Rms(), rms) << name;
        EXPECT_NEAR(compared.bounced, 1, 0.015) << name;
        if (name == "tilted lightmass") {
            EXPECT_LT(compared.worst, kOneBand);
        }
    }
}

TEST_F(EncodingsTest, HoldDirectLightAsTheyCan) {
    CompileRoom("test/vertexpanel");
    const RoomReference reference = Reference(0);
    ExpectLight(BakeAndRead(reference, ""), reference, 0.007, 0.003); // codes of colors have steps of up to 1/128
    EXPECT_LT(Compare("grid", AllAround(GridPlaces()), reference).worst, kTwoBands);
    EXPECT_LT(Compare("cube", AllAround(CubePlaces()), reference).worst, kSixSides);
}

TEST_F(EncodingsTest, AgreeOnBouncedLight) {
    CompileRoom("test/vertexpanel");
    const RoomReference reference = Reference(4);
    for (const int rays : {64, 256}) {
        SCOPED_TRACE(rays);
        const Readings all = BakeAndRead(reference, fmt::format("-bounce 4 -bouncegrid -bouncerays {}", rays));
        ExpectLight(all, reference, rays < 256 ? 0.1 : 0.06, rays < 256 ? 0.03 : 0.02);
        EXPECT_LT(Compare("grid", AllAround(GridPlaces()), reference).worst, kTwoBands);
        EXPECT_LT(Compare("cube", AllAround(CubePlaces()), reference).worst, kSixSides);
    }
}

/// Weak light is interpolated within a tolerance of 1.5 bytes: three times that anywhere, less than that by RMS.
TEST_F(EncodingsTest, InterpolatedLightIsThatOfTracedPoints) {
    WriteProps({}, {});
    CompileRoom("test/vertexpanel");
    const RoomReference reference = Reference(4);
    const auto bake = [&](std::string_view smooth) {
        Bake(fmt::format("-bounce 4 -bouncegrid -bouncerays 512 {}", smooth));
        return AllAround(GridPlaces());
    };
    const std::vector<Reading> traced = bake("-noskipsmooth"), interpolated = bake("");
    ASSERT_EQ(traced.size(), interpolated.size());
    Differences differences;
    for (std::size_t i = 0; i < traced.size(); ++i)
        differences.Add(interpolated[i].light, traced[i].light, 1);
    EXPECT_LT(differences.largest, 3 * 1.5) << "bytes";
    EXPECT_LT(differences.Rms(), 1) << "bytes";
    EXPECT_GT(differences.largest, 0) << "some are interpolated";
    EXPECT_NEAR(Compare("grid", interpolated, reference).bounced, 1, 0.015);
}

TEST_F(EncodingsTest, FlatNormalsHaveTheLightmapExactly) {
    CompileRoom("test/vertexpanel");
    const RoomReference reference = Reference(0);
    const Readings all = BakeAndRead(reference, "-bounce 4");
    const auto &luxels = all.at("luxel"), &rnm = all.at("flat rnm"), &mass = all.at("flat lightmass");
    ASSERT_GT(luxels.size(), 50u);
    for (std::size_t i = 0; i < luxels.size(); ++i) {
        const double light = LargestOf(luxels[i].light);
        EXPECT_LT(LargestOf(rnm[i].light - luxels[i].light), 1e-5 * light);
        EXPECT_LT(LargestOf(mass[i].light - luxels[i].light), 0.01 * light);
    }
}

/// The panel without and with a lightmap. Luxels are lit 1 unit in front of it.
TEST_F(EncodingsTest, VerticesHaveTheLightOfLuxels) {
    const RoomReference reference = Reference(0);
    WriteProps({}, {});
    CompileRoom("test/vertexpanel");
    Bake("");
    const auto vertices = PanelVertices(reference);
    CompileRoom("test/panel");
    Bake("");
    const LitFace panel = FaceOf(Load(), "textures/test/panel", {-1, 0, 0});
    const FloatImage page = Pfm(panel.page);
    EXPECT_GT(vertices.size(), 90u);
    for (const auto &[p, light] : vertices) {
        const int texel = panel.TexelAt(Vec3f(p));
        ASSERT_GE(texel, 0);
        const Vec3d luxel = Vec3d(page.texels.at(std::size_t(texel))) * 255;
        EXPECT_LT(LargestOf(light - luxel), 0.015 * LargestOf(luxel)) << p.y << ' ' << p.z;
    }
}

} // namespace

} // namespace q3::test
