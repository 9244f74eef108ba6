// GPL-2.0-or-later. Map text of brushes and patches, and a reader of it.
#pragma once

#include "q3map2/map/map.h"
#include "q3map2/map/map_parse.h"
#include "tests/support/library_fixture.h"

#include <string>
#include <string_view>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace q3::test {

/// Three points of the plane, as map text has them.
std::string PointsText(const Plane &plane);
/// A classic side with plain texture axes.
std::string SideText(const Plane &plane, std::string_view shader = "wall", std::string_view flags = "0 0 0");
std::string BrushText(const std::vector<Plane> &planes, std::string_view shader = "wall",
                      std::string_view flags = "0 0 0");
std::vector<Plane> BoxPlanes(const Vec3d &mins, const Vec3d &maxs);
std::string BoxText(const Vec3d &mins, const Vec3d &maxs, std::string_view shader = "wall",
                    std::string_view flags = "0 0 0");
/// patchDef2 over a square of the ground: columns along x, rows along y, `spacing` apart from `corner`.
std::string FlatPatchText(int width, int height, const Vec3d &corner, double spacing = 64);
std::string EntityText(std::string_view className, std::string_view body);
/// The world with this in it.
std::string WorldText(std::string_view body);

/// Reads maps with the shaders of map_test.cpp; `wall` and others have no script.
class MapTest : public LibraryTest {
  protected:
    MapTest();
    BspContext Context() { return {bspOptions, *FindGame(gameName), *library, out.log, vfs.get()}; }
    Map Read(std::string_view text) { return ReadMap(text, "maps/test.map", Context()); }
    /// The error that this text gives.
    std::string ErrorOf(std::string_view text);

    BspOptions bspOptions;
    std::string_view gameName = "quake3";
};

} // namespace q3::test
