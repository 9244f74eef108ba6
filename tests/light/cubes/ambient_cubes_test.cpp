// GPL-2.0-or-later. Ambient cubes: their light against closed forms and slow sums, their places, what is kept.
#include "common/error.h"
#include "libs/ambientcubes/ambient_cubes.h"
#include "q3map2/bspfile/bsp.h"
#include "q3map2/light/cubes/ambient_cubes.h"
#include "q3map2/light/cubes/leaf_positions.h"
#include "tests/support/compiled_map.h"
#include "tests/support/light_fixture.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace q3::test {

namespace {

using testing::HasSubstr;

constexpr double kCode = 1.0 / 256; ///< relative error of a stored color

/// A sample as engines see it.
struct SeenCube {
    std::uint32_t leaf = 0;
    Vec3d position;
    std::array<Vec3d, 6> sides;
    double Largest() const {
        double largest = 0;
        for (const Vec3d &side : sides)
            largest = std::max(largest, MaxComponent(side));
        return largest;
    }
};

/// The cubes of a lit map by the reader for engines.
class CubesView {
  public:
    explicit CubesView(const Bsp &bsp) : bsp_(bsp) {
        bsp_.gridSH.reset();
        file_ = WriteBsp(bsp_, {});
        EXPECT_EQ(ambient_cubes_load(file_.data(), file_.size(), &cubes_), AMBIENT_CUBES_OK);
    }
    CubesView(const CubesView &) = delete;

    std::vector<SeenCube> All() const {
        std::vector<SeenCube> all;
        for (std::uint32_t leaf = 0; leaf < cubes_.leafCount; ++leaf) {
            std::uint32_t first = 0, owner = 0;
            const std::uint32_t count = ambient_cubes_of_leaf(&cubes_, leaf, &first, &owner);
            for (std::uint32_t i = 0; owner == leaf && i < count; ++i)
                all.push_back(Sample(first + i, leaf));
        }
        return all;
    }
    Vec3d Light(const Vec3d &position, const Vec3d &normal) const {
        const Vec3f p(position), n(normal);
        const float at[3] = {p.x, p.y, p.z}, facing[3] = {n.x, n.y, n.z};
        float rgb[3];
        ambient_cubes_light(&cubes_, std::uint32_t(LeafAt(bsp_, p)), at, facing, rgb);
        return {double(rgb[0]), double(rgb[1]), double(rgb[2])};
    }

  private:
    SeenCube Sample(std::uint32_t sample, std::uint32_t leaf) const {
        float position[3];
        ambient_cube cube;
        ambient_cubes_sample(&cubes_, sample, leaf, position, &cube);
        SeenCube seen{leaf, {double(position[0]), double(position[1]), double(position[2])}, {}};
        for (std::size_t side = 0; side < 6; ++side)
            seen.sides[side] = {double(cube.side[side][0]), double(cube.side[side][1]), double(cube.side[side][2])};
        return seen;
    }

    Bsp bsp_;
    std::vector<std::byte> file_;
    ambient_cubes cubes_{};
};

Vec3d FacingAxis(std::size_t side) {
    Vec3d normal;
    normal[side / 2] = side % 2 == 0 ? 1 : -1;
    return normal;
}

class CubesTest : public LightTest {
  protected:
    static constexpr std::string_view kAll = "-ambientcubes -cubetolerance 0";

    /// Checks that no side of any cube is farther from `expected` than `tolerance` of the largest side there.
    void ExpectSides(const Bsp &bsp, double tolerance, std::size_t atLeast,
                     const std::function<Vec3d(const Vec3d &position, const Vec3d &normal)> &expected) {
        const std::vector<SeenCube> cubes = CubesView(bsp).All();
        EXPECT_GE(cubes.size(), atLeast);
        for (const SeenCube &cube : cubes)
            for (std::size_t side = 0; side < 6; ++side) {
                const Vec3d off = cube.sides[side] - expected(cube.position, FacingAxis(side));
                EXPECT_LE(MaxComponent(Max(off, -off)), tolerance * std::max(cube.Largest(), 4 * kCode))
                    << "side " << side << " is " << cube.sides[side].x << " at " << cube.position.x << ' '
                    << cube.position.y << ' ' << cube.position.z;
            }
    }
    /// A room whose six walls are a sky with one sun of that light from azimuth and elevation, in degrees.
    SceneBuilder SunRoom(double light, double azimuth, double elevation) {
        Script(fmt::format("textures/test/sunsky\n{{\nsurfaceparm sky\nq3map_sun 1 1 1 {} {} {}\n}}\n", light, azimuth,
                           elevation));
        SceneBuilder scene = Room();
        for (const BoxFace face :
             {BoxFace::MinusX, BoxFace::PlusX, BoxFace::MinusY, BoxFace::PlusY, BoxFace::MinusZ, BoxFace::PlusZ})
            scene.SetWallShader(face, TestShader("textures/test/sunsky"));
        return scene;
    }
};

/// Light on a surface from a rectangle: the sum over 400 x 256 pieces. `block`: what hides them.
Vec3d SlowRectangle(const Vec3d &p, const Vec3d &normal, const Vec3d &corner, const Vec3d &u, const Vec3d &v,
                    const Vec3d &facing, double add, const Boundsf *block) {
    constexpr int kAcross = 400, kUp = 256;
    const double area = Length(Cross(u, v)) / (kAcross * kUp);
    double sum = 0;
    for (int i = 0; i < kAcross; ++i)
        for (int k = 0; k < kUp; ++k) {
            const Vec3d at = corner + u * ((i + 0.5) / kAcross) + v * ((k + 0.5) / kUp), way = at - p;
            const double d2 = Dot(way, way), d = std::sqrt(d2);
            const double here = Dot(way, normal) / d, there = -Dot(way, facing) / d;
            if (here > 0 && there > 0 && !(block && SegmentMeets(p, at - way * (1 / d), *block, 0)))
                sum += here * there / d2;
        }
    const double light = sum * area * add / std::numbers::pi / 255;
    return {light, light, light};
}

TEST_F(CubesTest, UniformLightGivesSixEqualSides) {
    SceneBuilder scene = Room();
    scene.SetWorldKey("_ambient", "100");
    const Bsp bsp = Lit(scene, "-ambientcubes");
    ExpectSides(bsp, kCode, 1, [](const Vec3d &, const Vec3d &) { return Vec3d{1, 1, 1} * (100 / 255.0); });
    for (const bspCubeLeaf_t &leaf : bsp.ambientCubes->leafs)
        EXPECT_LE(leaf.count, 1) << "one reproduces all others of a leaf";
}

TEST_F(CubesTest, MinimumLiftsTheMean) {
    SceneBuilder scene = Room();
    scene.SetWorldKey("_mingridlight", "51");
    ExpectSides(Lit(scene, "-ambientcubes -gridscale 2"), kCode, 1, [](const Vec3d &, const Vec3d &) {
        return Vec3d{0.4, 0.4, 0.4};
    });
}

TEST_F(CubesTest, SunFromAboveLightsOneSide) {
    const SceneBuilder scene = SunRoom(120, 0, 90);
    ExpectSides(Lit(scene, kAll), kCode, 1, [](const Vec3d &, const Vec3d &normal) {
        return Vec3d{1, 1, 1} * (std::max(0.0, normal.z) * 120 / 255);
    });
}

TEST_F(CubesTest, DiagonalSunIsWhatThreeSidesCanTell) {
    const double third = 1 / std::sqrt(3.0);
    const SceneBuilder scene = SunRoom(255, 45, std::asin(third) * 180 / std::numbers::pi);
    const Bsp bsp = Lit(scene, kAll);
    ExpectSides(bsp, kCode, 1, [&](const Vec3d &, const Vec3d &normal) {
        return Vec3d{1, 1, 1} * std::max(0.0, Dot(normal, Vec3d{third, third, third}));
    });
    const CubesView cubes(bsp);
    const Vec3d at{32, 0, 64}, sun{third, third, third};
    EXPECT_NEAR(cubes.Light(at, sun).x, 0.577, 0.003) << "the true light is 1";
    EXPECT_NEAR(Evaluate(GridView(bsp).Sample(at), sun).x, 1.0625, 0.001);
    EXPECT_NEAR(cubes.Light(at, -sun).x, 0, 1e-6);
}

TEST_F(CubesTest, PointLightsAreExact) {
    SceneBuilder scene = Room();
    scene.AddEntity(MakeEntity("light", {{"origin", "40 -24 150"}, {"light", "300"}}));
    scene.AddEntity(MakeEntity("light", {{"origin", "-200 100 30"}, {"light", "100"}}));
    ExpectSides(Lit(scene, kAll), 2 * kCode, 10, [](const Vec3d &p, const Vec3d &normal) {
        double light = 0;
        for (const auto &[from, intensity] : {std::pair{Vec3d{40, -24, 150}, 300.0}, {Vec3d{-200, 100, 30}, 100.0}}) {
            const Vec3d way = from - p;
            const double d2 = std::max(Dot(way, way), 256.0);
            light += intensity * 7500 / d2 * std::max(0.0, Dot(Normalize(way), normal)) / 255;
        }
        return Vec3d{light, light, light};
    });
}

TEST_F(CubesTest, LampThatStandsOnBothSidesOfASurfaceIsCut) {
    Script("textures/test/lamp\n{\nq3map_surfacelight 600\nq3map_lightRGB 1 1 1\nq3map_backsplash 0 0\n"
           "{\nmap $whiteimage\n}\n}\n");
    SceneBuilder scene = Room();
    scene.SetWallShader(BoxFace::MinusX, TestShader("textures/test/lamp"));
    ExpectSides(Lit(scene, kAll), 0.01, 16, [](const Vec3d &p, const Vec3d &normal) {
        return SlowRectangle(p, normal, {-250, -186, 4}, {0, 372, 0}, {0, 0, 248}, {1, 0, 0}, 450, nullptr);
    });
}

TEST_F(CubesTest, LampPartlyHiddenIsWithinThreePercent) {
    Script("textures/test/lamp\n{\nq3map_surfacelight 600\nq3map_lightRGB 1 1 1\nq3map_backsplash 0 0\n"
           "{\nmap $whiteimage\n}\n}\n");
    SceneBuilder scene = Room();
    scene.SetWallShader(BoxFace::MinusX, TestShader("textures/test/lamp"));
    const Boundsf block{{-180, -186, 4}, {-160, 186, 100}};
    scene.AddBox(block.mins, block.maxs, TestShader("textures/test/wall"), BoxKind::Detail);
    ExpectSides(Lit(scene, "-ambientcubes -cubetolerance 0 -shsamples 4"), 0.03, 10,
                [&](const Vec3d &p, const Vec3d &normal) {
                    return SlowRectangle(p, normal, {-250, -186, 4}, {0, 372, 0}, {0, 0, 248}, {1, 0, 0}, 450, &block);
                });
}

TEST_F(CubesTest, BrightLightKeepsItsStrength) {
    SceneBuilder scene = Room();
    scene.AddEntity(MakeEntity("light", {{"origin", "0 0 128"}, {"light", "90000"}}));
    const Bsp bsp = Lit(scene, kAll);
    double largest = 0;
    for (const SeenCube &cube : CubesView(bsp).All())
        largest = std::max(largest, cube.Largest());
    EXPECT_GT(largest, 100) << "byte 255 is 1";
    EXPECT_TRUE(std::any_of(bsp.ambientCubes->samples.begin(), bsp.ambientCubes->samples.end(),
                            [](const bspCubeSample_t &sample) { return sample.sides[0].exponent > 0; }));
}

TEST_F(CubesTest, BouncedLightIsThatOfTheGrid) {
    surfaces = true;
    SceneBuilder scene = Room({-32, -32, 0}, {32, 32, 128}); // so small that all samples are kept
    scene.AddEntity(MakeEntity("light", {{"origin", "3 5 64"}, {"light", "30"}}));
    const std::string options = std::string(kAll) + " -gridsh 16 16 16";
    const Bsp direct = Lit(scene, options), bounced = Lit(scene, options + " -bounce 2 -bouncegrid");
    const GridView grid(bounced), directGrid(direct);
    const std::vector<SeenCube> cubes = CubesView(bounced).All(), directCubes = CubesView(direct).All();
    ASSERT_EQ(cubes.size(), directCubes.size());
    double more = 0, gridMore = 0;
    for (std::size_t i = 0; i < cubes.size(); ++i)
        for (std::size_t side = 0; side < 6; ++side) {
            const Vec3d p = cubes[i].position, n = FacingAxis(side);
            more += (cubes[i].sides[side] - directCubes[i].sides[side]).x;
            gridMore += (Evaluate(grid.Sample(p), n) - Evaluate(directGrid.Sample(p), n)).x;
        }
    EXPECT_GT(gridMore, 0.05 * double(cubes.size()));
    EXPECT_NEAR(more / gridMore, 1, 0.1) << "two patterns of rays";
}

TEST_F(CubesTest, SidesOfTheGrid) {
    SceneBuilder scene = Room();
    scene.AddEntity(MakeEntity("light", {{"origin", "40 -24 150"}, {"light", "300"}}));
    for (const std::string_view form : {"", " -shradiance"}) {
        const Bsp bsp = Lit(scene, "-ambientcubesfrom sh -cubetolerance 0" + std::string(form));
        const GridView grid(bsp);
        ExpectSides(bsp, 2 * kCode, 10, [&](const Vec3d &p, const Vec3d &normal) {
            Coefficients c = grid.Sample(p);
            for (std::size_t k = 0; k < 9 && !form.empty(); ++k)
                c[k] = c[k] * Lobe(k);
            return Max(Evaluate(c, normal), Vec3d{});
        });
    }
    KeptLog quiet;
    Arguments arguments({"-ambientcubesfrom", "sh"});
    EXPECT_THROW(ParseLightOptions(arguments, *FindGame("quake3"), quiet.log), Error);
}

TEST_F(CubesTest, ThreadsDoNotMatter) {
    SceneBuilder scene = Room();
    scene.AddBox({-60, -50, 60}, {70, 80, 76}, TestShader("textures/test/wall"));
    scene.SetWallShader(BoxFace::PlusZ, TestShader("textures/vec/sky_light"));
    scene.AddEntity(MakeEntity("light", {{"origin", "5 -7 170"}, {"light", "200"}}));
    EXPECT_EQ(WriteBsp(Lit(scene, "-ambientcubes", 1), {}), WriteBsp(Lit(scene, "-ambientcubes", 3), {}));
}

TEST_F(CubesTest, LeafsHoldAsManyAsAsked) {
    SceneBuilder scene = Room();
    scene.AddEntity(MakeEntity("light", {{"origin", "40 -24 150"}, {"light", "300"}}));
    const auto most = [&](std::string_view options) {
        const Bsp bsp = Lit(scene, std::string(kAll) + std::string(options));
        int count = 0;
        for (const bspCubeLeaf_t &leaf : bsp.ambientCubes->leafs)
            count = std::max(count, int(leaf.count));
        return count;
    };
    EXPECT_EQ(most(""), 16);
    EXPECT_EQ(most(" -cubesperleaf 5"), 5);
    EXPECT_GT(most(" -cubesperleaf 32"), 16);
}

TEST_F(CubesTest, RelightWithoutTheOptionDropsThem) {
    const Bsp bsp = Lit(Room(), "-ambientcubes");
    ASSERT_TRUE(bsp.ambientCubes);
    EXPECT_FALSE(Lit(bsp).ambientCubes);
}

/// Checks that a position is in the leaf that the tree leads to, at least `margin` from every plane on the way.
void ExpectWellInside(const Bsp &bsp, std::uint32_t leaf, const Vec3d &p, double margin) {
    int child = RootOf(bsp);
    while (child >= 0) {
        const bspNode_t &node = bsp.nodes[std::size_t(child)];
        const bspPlane_t &plane = bsp.planes[std::size_t(node.planeNum)];
        const double d = Dot(Vec3d(plane.normal), p) - double(plane.dist);
        EXPECT_GE(std::abs(d), margin);
        child = node.children[d > 0 ? 0 : 1];
    }
    EXPECT_EQ(LeafOf(child), int(leaf));
}

TEST_F(CubesTest, PlacesAreInTheirLeafs) {
    for (const std::string_view name : {"pillar", "room", "white_lamp"}) {
        const Bsp bsp = Lit(CompiledMapOf(name), kAll);
        const std::vector<SeenCube> cubes = CubesView(bsp).All();
        EXPECT_FALSE(cubes.empty());
        for (const SeenCube &cube : cubes)
            ExpectWellInside(bsp, cube.leaf, cube.position, 1.0 / 32 - 1e-4);
    }
}

/// Number of places of each open leaf that has any.
std::vector<std::size_t> PlacesOf(const Bsp &bsp) {
    const BspSpace space(bsp, std::vector<bool>(bsp.brushes.size(), true));
    const LeafPolytopes polytopes(bsp);
    std::vector<std::size_t> counts;
    for (std::size_t leaf = 0; leaf < bsp.leafs.size(); ++leaf)
        if (bsp.leafs[leaf].cluster >= 0)
            if (const std::size_t count = FindCubePlaces(space, polytopes, leaf).size(); count > 0)
                counts.push_back(count);
    return counts;
}

TEST(CubePlaces, FollowTheSizeOfTheLeafOnAllAxes) {
    const auto counts = [](const Vec3f &size) {
        SceneBuilder scene;
        scene.SetInterior({0, 0, 0}, size, TestShader("textures/test/wall"));
        return PlacesOf(scene.Build());
    };
    using Counts = std::vector<std::size_t>;
    EXPECT_EQ(counts({32, 32, 64}), Counts{1});
    EXPECT_EQ(counts({8, 8, 8}), Counts{1});
    EXPECT_EQ(counts({32, 32, 1024}), Counts{16}) << "tall";
    EXPECT_EQ(counts({32, 1024, 64}), Counts{32}) << "long";
    EXPECT_EQ(counts({512, 32, 64}), Counts{16}) << "wide";
    EXPECT_EQ(counts({1024, 1024, 64}), Counts{128});
}

TEST(CubePlaces, KeepOutOfOpaqueBrushes) {
    SceneBuilder scene;
    scene.SetInterior({0, 0, 0}, {256, 256, 128}, TestShader("textures/test/wall"));
    scene.AddBox({16, 16, 0}, {256, 256, 128}, TestShader("textures/test/wall"), BoxKind::Detail);
    KeptLog quiet;
    VirtualFileSystem vfs(quiet.log);
    vfs.Mount(TEST_DATA "/vectors/baseq3", "pk3");
    const Bsp bsp = CompiledScene(scene, vfs);
    const BspSpace space(bsp, std::vector<bool>(bsp.brushes.size(), true));
    const LeafPolytopes polytopes(bsp);
    std::size_t found = 0;
    for (std::size_t leaf = 0; leaf < bsp.leafs.size(); ++leaf)
        for (const CubePlace &place :
             bsp.leafs[leaf].cluster >= 0 ? FindCubePlaces(space, polytopes, leaf) : std::vector<CubePlace>{}) {
            EXPECT_TRUE(place.position.x < 16 || place.position.y < 16);
            ++found;
        }
    EXPECT_GT(found, 8u);
}

CubeSample SampleAt(const Vec3f &position, const Vec3f &light) {
    bspLeaf_t leaf{};
    leaf.maxs = {255, 255, 255};
    CubeSides sides;
    sides.fill(light);
    return MakeCubeSample(leaf, {std::uint8_t(position.x), std::uint8_t(position.y), std::uint8_t(position.z)}, sides);
}

TEST(CubeThinning, RemovedSamplesStayWithinTheTolerance) {
    std::mt19937 random(7);
    std::size_t removed = 0, kept = 0;
    for (const float tolerance : {0.5f, 3.0f, 10.0f, 40.0f})
        for (int run = 0; run < 20; ++run) {
            std::vector<CubeSample> all;
            for (int i = 0; i < 16; ++i) {
                const Vec3f at{float(random() % 256), float(random() % 256), float(random() % 256)};
                all.push_back(SampleAt(at, Vec3f{0.2f, 0.4f, 0.1f} * (1 + 0.0004f * float(run) * at.x) +
                                               Vec3f{0, 0, 0.0001f * at.y}));
            }
            std::vector<CubeSample> thin = all;
            ThinOutCubes(tolerance, thin);
            ASSERT_GE(thin.size(), 1u);
            removed += all.size() - thin.size(), kept += thin.size();
            for (const CubeSample &sample : all) {
                const bool stays = std::any_of(thin.begin(), thin.end(), [&](const CubeSample &other) {
                    return other.position == sample.position;
                });
                if (stays)
                    continue;
                // The blend by its formula.
                double sum = 0, weights = 0;
                for (const CubeSample &other : thin) {
                    const Vec3d way = Vec3d(other.position) - Vec3d(sample.position);
                    const double weight = 1 / (Dot(way, way) + 1);
                    sum += weight * double(other.sides[0].x), weights += weight;
                }
                const auto shown = [](double light) { return 255 * std::pow(light, 1 / 2.2); };
                EXPECT_LE(std::abs(shown(sum / weights) - shown(double(sample.sides[0].x))), double(tolerance) * 1.001);
            }
        }
    EXPECT_GT(removed, 100u);
    EXPECT_GT(kept, 100u);
}

TEST(CubeThinning, KeepsWhatShowsAllSamplesBest) {
    // Light of a step and, at one place, of a lamp that is white beyond measure.
    std::vector<CubeSample> samples;
    for (int i = 0; i < 40; ++i)
        samples.push_back(SampleAt({float(6 * i), 0, 0}, Vec3f{1, 1, 1} * (i == 10 ? 500 : i < 25 ? 0.1f : 0.4f)));
    const std::vector<CubeSample> all = samples;
    KeepBestCubes(16, samples);
    EXPECT_LE(samples.size(), 16u);
    double squares = 0;
    for (const CubeSample &sample : all) {
        const float shown = std::min(BlendCubes(samples, sample.position)[0].x, 1.0f);
        squares += std::pow(double(shown - std::min(sample.sides[0].x, 1.0f)), 2);
    }
    EXPECT_LT(std::sqrt(squares / double(all.size())), 0.16) << "the lamp is missing, the rest is right";
}

/// A compiled room of several leafs, two samples of different light in each open one.
struct CubeCase {
    CubeCase() : bsp(Compiled()), space(bsp, std::vector<bool>(bsp.brushes.size(), true)), cubes(bsp.leafs.size()) {
        for (std::size_t leaf = 0; leaf < cubes.size(); ++leaf)
            if (bsp.leafs[leaf].cluster >= 0) {
                cubes[leaf] = {SampleAt({0, 0, 0}, {0.1f, 0.1f, 0.1f}), SampleAt({255, 0, 0}, {0.5f, 0.5f, 0.5f})};
                open.push_back(leaf);
            }
    }
    static Bsp Compiled() {
        SceneBuilder scene = Room();
        scene.AddBox({-60, -50, 60}, {70, 80, 76}, TestShader("textures/test/wall"));
        // What is above the box is hidden from what is below.
        scene.SetVisibility({.writeLump = true, .sees = [](const Boundsf &a, const Boundsf &b) {
                                 return (a.Center().z > 68) == (b.Center().z > 68);
                             }});
        return scene.Build();
    }
    std::optional<AmbientCubes> Store(std::size_t most = kMostCubes) {
        return StoreCubes(space, cubes, 3, JobPool(2), log.log, most);
    }

    struct Kept {
        std::string text;
        Log log{[this](LogLevel, std::string_view line) { text += line; }};
    } log;
    Bsp bsp;
    BspSpace space;
    LeafCubes cubes;
    std::vector<std::size_t> open;
};

TEST(CubeStoring, LeafsWithoutSamplesReferToOnesThatTheySee) {
    CubeCase c;
    ASSERT_GE(c.open.size(), 4u);
    const std::size_t empty = c.open[1];
    c.cubes[empty].clear();
    c.bsp.ambientCubes = c.Store();
    ASSERT_TRUE(c.bsp.ambientCubes);
    CheckAmbientCubes(c.bsp, "test");
    EXPECT_EQ(c.bsp.ambientCubes->leafs[empty].count, 0);
    const auto used = c.bsp.ambientCubes->leafs[empty].first;
    EXPECT_GT(c.bsp.ambientCubes->leafs[used].count, 0);
    EXPECT_TRUE(c.space.Visible(c.bsp.leafs[empty].cluster, c.bsp.leafs[used].cluster));
    EXPECT_EQ(c.bsp.ambientCubes->samples.size(), 2 * (c.open.size() - 1));
    for (auto &leaf : c.cubes)
        leaf.clear();
    EXPECT_FALSE(c.Store());
}

TEST(CubeStoring, TooManySamplesAreThinnedOutUntilTheyFit) {
    CubeCase c;
    const auto cubes = c.Store(c.open.size() + 1);
    ASSERT_TRUE(cubes);
    EXPECT_LE(cubes->samples.size(), c.open.size() + 1);
    EXPECT_GE(cubes->samples.size(), c.open.size());
    EXPECT_THAT(c.log.text, HasSubstr(fmt::format("{} ambient cubes within a tolerance of 3", 2 * c.open.size())));
    EXPECT_THAT(c.log.text, HasSubstr(fmt::format("holds {}", c.open.size() + 1)));
}

TEST(CubeStoring, TooManyLeafsAreAnErrorThatNamesTheFirst) {
    CubeCase c;
    try {
        c.Store(c.open.size() - 1);
        FAIL() << "fits";
    } catch (const Error &error) {
        EXPECT_THAT(error.what(), HasSubstr(fmt::format("leaf {} ", c.open.back())));
    }
}

TEST(LeafPolytope, PyramidOfSlantedPlanes) {
    // A leaf of 100 x 100 x 100 cut by the plane x + y + z = 100: a tetrahedron.
    Bsp bsp;
    const float third = 1 / std::sqrt(3.0f);
    bsp.planes = {{{third, third, third}, 100 * third}};
    bsp.nodes = {{0, {-1, -2}, {}, {}}};
    bspLeaf_t leaf{};
    leaf.maxs = {100, 100, 100};
    bsp.leafs = {leaf, leaf};
    const LeafPolytopes polytopes(bsp);
    const LeafPolytope corner = polytopes.Of(1), rest = polytopes.Of(0);
    EXPECT_NEAR(corner.volume, 1e6 / 6, 1);
    EXPECT_NEAR(rest.volume, 1e6 * 5 / 6, 1);
    EXPECT_NEAR(corner.center.x, 25, 1e-3);
    EXPECT_NEAR(corner.center.z, 25, 1e-3);
    EXPECT_TRUE(corner.Contains({20, 20, 20}, 1));
    EXPECT_FALSE(corner.Contains({40, 40, 40}, 0));
    EXPECT_TRUE(rest.Contains({40, 40, 40}, 1));
}

} // namespace

} // namespace q3::test
