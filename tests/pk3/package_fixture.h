// GPL-2.0-or-later. A game folder, a map in it, and the package that is planned for it.
#pragma once

#include "q3map2/pk3/package_plan.h"
#include "tests/support/game_folder.h"
#include "tests/support/small_bsp.h"

#include <algorithm>

namespace q3::test {

class PackageTest : public testing::Test {
  protected:
    /// SmallBsp with that text behind its worldspawn; its face has the shader textures/base/wall.
    static Bsp MapWith(std::string_view entities) {
        Bsp bsp = SmallBsp();
        bsp.entities = fmt::format("{{\n\"classname\" \"worldspawn\"\n}}\n{}", entities);
        bsp.fogs.clear();
        return bsp;
    }

    /// The plan for the map, which is maps/x.bsp of the folder `base`.
    PackagePlan Plan(const Bsp &bsp, const Exclusions &exclusions = {}, bool png = false, bool wholeScripts = true,
                     const std::vector<std::string> &basePaks = {}) {
        vfs_ = std::make_unique<VirtualFileSystem>(log_.log);
        vfs_->Mount(folder_ / "base", "pk3");
        source_ = std::make_unique<PackageSource>(*vfs_, std::vector{folder_ / "base"}, basePaks);
        scripts_ = EngineScripts();
        for (const std::string &name : source_->List("scripts", ".shader"))
            scripts_.Read("scripts/" + name, *source_->ReadText("scripts/" + name), log_.log);
        MapNeeds needs;
        AddNeeds(bsp, "x", Quake3(), needs);
        PackagePlan plan = MakePlan(
            needs, *source_, scripts_,
            {.exclusions = exclusions, .imageFiles = Quake3().imageFiles, .png = png, .wholeScripts = wholeScripts},
            log_.log);
        folder_.Write("base/maps/x.bsp", Bytes(bsp));
        AddMapFiles(folder_ / "base/maps/x.bsp", needs.externalPages, *source_, plan);
        return plan;
    }

    void Put(std::string_view name, std::string_view text = "data") {
        folder_.Write("base/" + std::string(name), text);
    }

    static std::vector<std::string> Names(const PackagePlan &plan) {
        std::vector<std::string> names;
        for (const PackageEntry &entry : plan.Files())
            names.push_back(entry.name);
        return names;
    }

    GameFolder folder_;
    KeptLog log_;
    std::unique_ptr<VirtualFileSystem> vfs_;
    std::unique_ptr<PackageSource> source_;
    EngineScripts scripts_;
};

} // namespace q3::test
