// GPL-2.0-or-later. -cache: the same bytes as without it, less work, and damaged entries that are not used.
#include "tests/program/lit_room.h"

#include "common/files/files.h"

#include <gmock/gmock.h>

#include <chrono>
#include <random>

namespace q3::test {

namespace {

namespace fs = std::filesystem;

/// A lamp or a box that an edit moves.
struct Thing {
    Vec3f at;
    float value = 0; ///< light, or half of the box's edge
};

class CacheTest : public LitRoomTest {
  protected:
    std::string Cached() const { return " -cache " + (folder_.Root() / "cache").string() + " "; }
    std::string MapFile() const { return (maps_ / "room.bsp").string(); }
    std::vector<fs::path> Entries() const {
        std::vector<fs::path> files;
        for (const auto &entry : fs::recursive_directory_iterator(folder_.Root() / "cache"))
            if (entry.is_regular_file())
                files.push_back(entry.path());
        return files;
    }
    std::uint64_t Size() const {
        std::uint64_t size = 0;
        for (const fs::path &file : Entries())
            size += fs::file_size(file);
        return size;
    }
    /// bsp, vis and light; the bytes of the map.
    std::vector<std::byte> Build(const std::string &cache, const std::string &light) {
        for (const std::string &stage : {std::string("-bsp -meta"), std::string("-vis -saveprt"), light}) {
            const Outcome run = RunWords(cache + stage);
            EXPECT_EQ(run.status, 0) << run.text;
            lastText_ = run.text;
        }
        return MapBytes();
    }
    /// A count of the last run's log.
    long CountOf(const std::string &name) const {
        const std::size_t at = lastText_.find(name);
        if (at == std::string::npos)
            return -1;
        const std::size_t line = lastText_.rfind('\n', at) + 1;
        return std::atol(lastText_.c_str() + line);
    }
    void WriteMap(const std::vector<Thing> &lamps, const std::vector<Thing> &boxes) {
        std::string entities, brushes;
        for (const Thing &lamp : lamps)
            entities += Lamp(lamp.at, lamp.value);
        for (const Thing &box : boxes)
            brushes += BoxText(box.at - Vec3f{box.value, box.value, box.value},
                               box.at + Vec3f{box.value, box.value, box.value}, "test/pillar");
        Compile(entities, {}, brushes);
    }

    std::string lastText_;
};

TEST_F(CacheTest, AStageWithoutChangesGivesTheEarlierFilesAndWarnings) {
    Compile("");
    const std::string light = "-light -sh -gridsh 64 64 64 -nonsense";
    const std::vector<std::byte> plain = Build("", light);
    EXPECT_TRUE(Build(Cached(), light) == plain);
    EXPECT_EQ(lastText_.find("Nothing has changed"), std::string::npos);
    EXPECT_TRUE(Build(Cached(), light) == plain);
    EXPECT_NE(lastText_.find("Nothing has changed"), std::string::npos);
    EXPECT_NE(lastText_.find("no light entities"), std::string::npos) << "the warning of the first run";
    EXPECT_TRUE(Build(Cached(), light + " -samples 2") != plain) << "other options";
}

TEST_F(CacheTest, AMovedLampComputesOnlyWhatItReaches) {
    // Two rooms without a view of each other.
    const std::string wall = BoxText({-256, -8, 0}, {256, 8, 256}, "test/pillar");
    const auto write = [&](float x) {
        Compile(Lamp({x, -128, 200}, 100) + Lamp({100, 128, 200}, 100) +
                    EntityText({{"classname", "info_player_start"}, {"origin", "0 128 64"}}),
                {}, wall);
    };
    const std::string light = "-light -sh -gridsh 32 32 32";
    write(0);
    Build(Cached(), light);
    const long all = CountOf("units computed");
    EXPECT_GT(all, 10);
    write(16);
    const std::vector<std::byte> warm = Build(Cached(), light);
    EXPECT_LT(CountOf("units computed"), all);
    EXPECT_GT(CountOf("units taken from the cache"), 0);
    EXPECT_TRUE(warm == Build("", light));
}

TEST_F(CacheTest, EntriesThatKilledProgramsLeftUnfinishedAreRemovedAfterADay) {
    Compile("");
    const fs::path old = folder_ / "cache/ab/abcd.q3c.aB3dE6.tmp", recent = folder_ / "cache/ab/abcd.q3c.zB3dE6.tmp",
                   other = folder_ / "cache/notes.backup.tmp";
    for (const fs::path &file : {old, recent, other})
        folder_.Write(fs::relative(file, folder_.Root()).generic_string(), "x");
    for (const fs::path &file : {old, other})
        fs::last_write_time(file, fs::file_time_type::clock::now() - std::chrono::hours(48));
    RunWords(Cached() + "-bsp -meta");
    EXPECT_FALSE(fs::exists(old));
    EXPECT_TRUE(fs::exists(recent)) << "a program may be writing it";
    EXPECT_TRUE(fs::exists(other));
}

TEST_F(CacheTest, GeometryIsTakenOnlyWhileTheSameRoomsAreFlooded) {
    // A closet in a corner, in which no entity stands, so it is filled.
    std::string walls;
    for (const auto &[mins, maxs] : {std::pair(Vec3f{96, 96, 128}, Vec3f{256, 256, 144}),
                                     {Vec3f{96, 96, 0}, Vec3f{112, 256, 128}},
                                     {Vec3f{112, 96, 0}, Vec3f{256, 112, 128}}})
        walls += BoxText(mins, maxs, "test/pillar");
    const auto build = [&](const Vec3f &lamp) {
        Compile(Lamp(lamp, 100), {}, walls);
        const Outcome plain = RunWords("-bsp -meta");
        const std::vector<std::byte> bytes = MapBytes();
        const Outcome cached = RunWords(Cached() + "-bsp -meta");
        EXPECT_TRUE(MapBytes() == bytes);
        for (const std::string kind : {"stands in solid", "WARNING"})
            EXPECT_EQ(plain.text.find(kind) == std::string::npos, cached.text.find(kind) == std::string::npos) << kind;
        return cached.text.find("geometry is taken from the cache") != std::string::npos;
    };
    EXPECT_FALSE(build({0, 100, 64})) << "the first run";
    EXPECT_TRUE(build({0, 16, 64}));
    EXPECT_TRUE(build({0, 16, -4})) << "in the floor, with a warning";
    EXPECT_TRUE(build({0, 20, 64})) << "in the open again, without";
    EXPECT_FALSE(build({180, 180, 64})) << "the closet is open now";
    walls += BoxText({-64, 0, 0}, {-48, 16, 16}, "test/pillar");
    EXPECT_FALSE(build({0, 16, 64})) << "another brush";
}

TEST_F(CacheTest, GeometryThatWasTakenStillDependsOnItsModels) {
    const auto writeModel = [&](int height) {
        folder_.Write("base/baseq3/models/tent.obj",
                      fmt::format("v 0 0 0\nv 64 0 0\nv 0 64 0\nv 0 0 {}\nf 1 2 4\nf 2 3 4\nf 3 1 4\n", height));
    };
    const std::string tent =
        EntityText({{"classname", "misc_model"}, {"model", "models/tent.obj"}, {"origin", "0 0 64"}});
    const auto build = [&](const std::string &cache) {
        fs::remove(MapFile());
        const Outcome run = RunWords(cache + "-bsp -meta");
        EXPECT_EQ(run.status, 0) << run.text;
        lastText_ = run.text;
        return MapBytes();
    };
    writeModel(32);
    Compile(tent + Lamp({100, 100, 64}, 100));
    build(Cached());
    Compile(tent + Lamp({100, 120, 64}, 100));
    const std::vector<std::byte> low = build(Cached());
    EXPECT_NE(lastText_.find("geometry is taken from the cache"), std::string::npos);
    EXPECT_TRUE(build("") == low);
    writeModel(48);
    const std::vector<std::byte> high = build(Cached());
    EXPECT_TRUE(high != low);
    EXPECT_TRUE(build("") == high);
}

TEST_F(CacheTest, RandomEditsHaveTheSameBytes) {
    std::mt19937 random(46);
    const auto number = [&](float low, float high) {
        return std::round(std::uniform_real_distribution<float>(low, high)(random));
    };
    const auto place = [&] { return Vec3f{number(-200, 200), number(-200, 200), number(40, 216)}; };
    std::vector<Thing> lamps, boxes;
    for (int i = 0; i < 5; ++i)
        lamps.push_back({place(), number(50, 300)});
    for (int i = 0; i < 3; ++i)
        boxes.push_back({place(), number(4, 24)});
    const std::string lights[] = {"-light -sh -gridsh 64 64 64", "-light -fast -samples 2 -deluxe",
                                  "-light -bounce 2 -sh -gridsh 64 64 64 -bouncegrid",
                                  "-light -shadaptive -shbspx -gridsh 64 64 64 -filter"};
    const char *edits = std::getenv("CACHE_EDITS");
    const int count = edits ? std::atoi(edits) : 24;
    for (int edit = 0; edit < count; ++edit) {
        const int kind = int(random() % 5);
        if (kind < 3)
            lamps[random() % lamps.size()] = {place(), number(50, 300)};
        else if (kind == 3)
            boxes[random() % boxes.size()] = {place(), number(4, 24)};
        WriteMap(lamps, boxes); // kind 4: nothing changes
        const std::string &light = lights[random() % std::size(lights)];
        const std::vector<std::byte> warm = Build(Cached(), light);
        ASSERT_TRUE(Build("", light) == warm) << "edit " << edit << " of kind " << kind << ": " << light;
    }
}

/// A picture of one color, 4 x 4 texels.
std::vector<std::byte> Tga(std::uint8_t red, std::uint8_t green, std::uint8_t blue) {
    std::vector<std::byte> bytes(18 + 4 * 4 * 3);
    bytes[2] = std::byte(2), bytes[12] = std::byte(4), bytes[14] = std::byte(4), bytes[16] = std::byte(24);
    for (std::size_t at = 18; at < bytes.size(); at += 3)
        bytes[at] = std::byte(blue), bytes[at + 1] = std::byte(green), bytes[at + 2] = std::byte(red);
    return bytes;
}

TEST_F(CacheTest, AChangedImageCounts) {
    const fs::path image = folder_ / "base/baseq3/textures/test/lamp.tga";
    fs::create_directories(image.parent_path());
    folder_.Write("base/baseq3/scripts/lamps.shader",
                  "textures/test/lamp\n{\n\tqer_editorimage textures/test/lamp.tga\n"
                  "\tq3map_surfacelight 3000\n}\n");
    folder_.Write("base/baseq3/scripts/shaderlist.txt", "lamps\n");
    Compile(Lamp({0, 0, 200}, 20), {}, BoxText({-32, -32, 240}, {32, 32, 256}, "test/lamp"));
    const std::string light = "-light -sh -gridsh 64 64 64";
    ReplaceFile(image, Tga(255, 0, 0));
    const std::vector<std::byte> red = Build(Cached(), light);
    ReplaceFile(image, Tga(0, 255, 0));
    const std::vector<std::byte> green = Build(Cached(), light);
    EXPECT_TRUE(green == Build("", light));
    EXPECT_TRUE(green != red);
}

TEST_F(CacheTest, LightOfOtherStylesComesBack) {
    const Keys style = {{"style", "32"}, {"targetname", "switch"}};
    const auto write = [&](float x) {
        Compile(Lamp({-100, 0, 100}, 200) + Lamp({100, 0, 100}, 200, {1, 1, 1}, style) + Lamp({x, 200, 200}, 30));
    };
    const std::string light = "-light -sh -gridsh 64 64 64 -bounce 2";
    write(0);
    Build(Cached(), light);
    write(0.5f);
    EXPECT_TRUE(Build(Cached(), light) == Build("", light));
}

TEST_F(CacheTest, DamagedEntriesAreRemovedAndNotUsed) {
    Compile(Lamp({0, 0, 128}, 200));
    const std::string light = "-light -sh -gridsh 64 64 64";
    const std::vector<std::byte> plain = Build("", light);
    Build(Cached(), light);
    for (const fs::path &file : Entries()) {
        std::vector<std::byte> bytes = ReadFile(file);
        bytes[bytes.size() - 9] ^= std::byte(4);
        ReplaceFile(file, bytes);
    }
    EXPECT_TRUE(Build(Cached(), light) == plain);
    EXPECT_THAT(lastText_, testing::HasSubstr("an entry is not used, and removed"));
    for (const fs::path &file : Entries())
        ReplaceFile(file, std::vector<std::byte>(7));
    EXPECT_TRUE(Build(Cached(), light) == plain);
}

TEST_F(CacheTest, TheFolderStaysBelowItsLimit) {
    const std::string cache = Cached() + "-cachesize 16 ";
    for (int i = 0; i < 6; ++i) {
        Compile(Lamp({float(10 * i), 0, 128}, 200));
        Build(cache, "-light -sh -gridsh 16 16 16");
    }
    EXPECT_LE(Size(), 16u << 20);
    EXPECT_GT(Size(), 4u << 20);
}

TEST_F(CacheTest, NotTogetherWithParts) {
    Compile("");
    const Outcome run = RunWords("-light" + Cached() + "-part 1/2 -partfile x.q3p");
    EXPECT_EQ(run.status, 1);
    EXPECT_THAT(run.text, testing::HasSubstr("-cache: not together with -part"));
}

} // namespace

} // namespace q3::test
