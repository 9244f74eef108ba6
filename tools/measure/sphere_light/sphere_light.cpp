// GPL-2.0-or-later. sphere_light: compares pictures of a white sphere in an engine with the light grids of the map.
#include "common/arguments.h"
#include "common/error.h"
#include "common/files/files.h"
#include "common/text/text.h"
#include "common/tool_main.h"
#include "q3map2/bspfile/bspfile.h"
#include "tools/measure/sphere_light/engine_light.h"
#include "tools/measure/sphere_light/sphere_places.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <sstream>

namespace q3 {

namespace {

constexpr std::string_view kUsage = R"(usage: sphere_light places MAP.bsp COUNT
       sphere_light compare MAP.bsp PLACES FOLDER [options]
       sphere_light wall IMAGE.tga [--limit N]
places   prints x y z yaw of COUNT spheres with a free view, a line each
compare  pictures FOLDER/0.tga, 1.tga, ... of the places with the light that the grid gives there
  --grid sh|legacy       (sh)
  --renderer 1|2         whose formula of the legacy grid (1)
  --at-pixels            with the light where each pixel is, not at the center of the sphere
  --dark N               light style of the SH grid that is switched off
  --shift N              r_mapOverBrightBits less the engine's overbright bits (0)
  --limit N              exit status 1 unless the mean difference of all pixels is below N bytes
wall     the middle of the sphere with the wall behind it, left and right of the sphere
  --limit N              exit status 1 if a channel differs by more than N bytes
)";

constexpr float kLeastLight = 4; ///< mean light at a place, bytes

/// Differences of shown pixels from expected ones.
struct Differences {
    double sum = 0, signedSum = 0, largest = 0; ///< of differences of channels, bytes; sum: absolute
    std::size_t count = 0;                      ///< of channels

    void Add(const Vec3f &shown, const Vec3f &expected) {
        for (std::size_t i = 0; i < 3; ++i) {
            const double difference = double(shown[i] - expected[i]);
            sum += std::abs(difference);
            signedSum += difference;
            largest = std::max(largest, std::abs(difference));
        }
        count += 3;
    }
    void Add(const Differences &other) {
        sum += other.sum;
        signedSum += other.signedSum;
        largest = std::max(largest, other.largest);
        count += other.count;
    }
    void Print(std::string_view name, double light) const {
        fmt::print("{:<32} {:>8} {:>8.1f} {:>8.3f} {:>8.3f} {:>8.1f}\n", name, count / 3, light, sum / double(count),
                   signedSum / double(count), largest);
    }
};

/// The words that are left after the options. Error: not `count` of them.
const std::vector<std::string> &Words(const Arguments &arguments, std::size_t count, std::string_view meaning) {
    if (arguments.Rest().size() != count)
        throw Error("expected {}, got {} words", meaning, arguments.Rest().size());
    return arguments.Rest();
}

/// Reads a map; warnings go to stderr, other lines of the log are dropped.
Bsp ReadMap(const std::string &path) {
    Log log(PrintWarnings);
    return ReadBspFile(path, {}, log);
}

EngineLight GridOf(const std::string &name, const std::vector<std::byte> &file, const Bsp &bsp, Renderer renderer,
                   int shift, std::optional<int> darkStyle) {
    if (name == "sh")
        return SHGridLight(file, bsp, shift, darkStyle);
    if (name == "legacy")
        return LegacyGridLight(bsp, renderer, shift);
    throw Error("--grid {}: expected sh or legacy", name);
}

/// Mean over the six directions of the axes and the channels.
float MeanLight(const NormalColor &light) {
    float sum = 0;
    for (const Vec3f &normal : {Vec3f{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {-1, 0, 0}, {0, -1, 0}, {0, 0, -1}}) {
        const Vec3f color = light(normal);
        sum += (color.x + color.y + color.z) / (6 * 3);
    }
    return sum;
}

int PrintPlaces(const Arguments &arguments) {
    const auto &words = Words(arguments, 2, "a map and a number of places");
    const int count = int(NumberFromText(words[1]));
    if (count < 1)
        throw Error("expected 1 place or more, got {}", words[1]);
    const Bsp bsp = ReadMap(words[0]);
    const std::vector<std::byte> file = ReadFile(words[0]);
    const EngineLight light =
        bsp.gridSH || bsp.sparseGridSH ? SHGridLight(file, bsp, 0) : LegacyGridLight(bsp, Renderer::OpenGL1, 0);
    const auto isLit = [&](const Vec3f &position) { return MeanLight(light(position)) >= kLeastLight; };
    for (const SpherePlace &place : FindSpherePlaces(bsp, count, isLit))
        fmt::print("{} {} {} {}\n", place.center.x, place.center.y, place.center.z, place.yaw);
    return 0;
}

std::vector<SpherePlace> ReadPlaces(const std::string &path) {
    const std::vector<std::byte> bytes = ReadFile(path);
    std::istringstream text(std::string(reinterpret_cast<const char *>(bytes.data()), bytes.size()));
    std::vector<SpherePlace> places;
    for (SpherePlace place; text >> place.center.x >> place.center.y >> place.center.z >> place.yaw;)
        places.push_back(place);
    if (places.empty())
        throw Error("{}: expected lines of x y z yaw", path);
    return places;
}

Image ReadScreenshot(const std::string &path) {
    return DecodeTga(ReadFile(path), path);
}

/// isAtPixels: the light where each pixel is; else that at the center of the sphere.
Differences ComparePlace(const SpherePlace &place, const Image &image, const EngineLight &light, bool isAtPixels) {
    const NormalColor atCenter = light(place.center);
    Differences differences;
    for (int row = 0; row < image.height; ++row)
        for (int column = 0; column < image.width; ++column)
            if (const auto normal = SphereNormal(place, image, column, row))
                differences.Add(PixelColor(image, column, row),
                                isAtPixels ? light(place.center + *normal * kSphereRadius)(*normal)
                                           : atCenter(*normal));
    if (differences.count == 0)
        throw Error("a picture is too small to show the sphere");
    return differences;
}

int CompareImages(Arguments &arguments) {
    const int renderer = arguments.TakeInteger("--renderer", 1, 1), shift = arguments.TakeInteger("--shift", 0, 0);
    const std::string grid = arguments.TakeValue("--grid").value_or("sh");
    const bool isAtPixels = arguments.TakeFlag("--at-pixels");
    const auto limit = arguments.TakeValue("--limit"), dark = arguments.TakeValue("--dark");
    const std::optional<int> darkStyle = dark ? std::optional<int>(int(NumberFromText(*dark))) : std::nullopt;
    if (darkStyle && (*darkStyle < 0 || *darkStyle > 63))
        throw Error("--dark {}: expected 0 to 63", *darkStyle);
    if (renderer > 2)
        throw Error("--renderer {}: expected 1 or 2", renderer);
    const auto &words = Words(arguments, 3, "a map, a file of places and a folder");
    const std::string &path = words[0], &placesPath = words[1], &folder = words[2];
    const std::vector<std::byte> file = ReadFile(path);
    const Bsp bsp = ReadMap(path);
    const EngineLight light =
        GridOf(grid, file, bsp, renderer == 1 ? Renderer::OpenGL1 : Renderer::OpenGL2, shift, darkStyle);
    const std::vector<SpherePlace> places = ReadPlaces(placesPath);
    fmt::print("{:<32} {:>8} {:>8} {:>8} {:>8} {:>8}\n", "of 255", "pixels", "light", "mean", "bias", "largest");
    Differences all;
    double allLight = 0;
    for (std::size_t i = 0; i < places.size(); ++i) {
        const SpherePlace &place = places[i];
        const NormalColor expected = light(place.center);
        const Image image = ReadScreenshot(fmt::format("{}/{}.tga", folder, i));
        const Differences one = ComparePlace(place, image, light, isAtPixels);
        one.Print(fmt::format("{}: {} {} {} {}", i, place.center.x, place.center.y, place.center.z, place.yaw),
                  double(MeanLight(expected)));
        all.Add(one);
        allLight += double(MeanLight(expected));
    }
    all.Print("all", allLight / double(places.size()));
    return limit && all.sum / double(all.count) >= NumberFromText(*limit) ? 1 : 0;
}

/// Mean color of the pixels of some columns in the four middle rows.
Vec3f MeanColor(const Image &image, int firstColumn, int endColumn) {
    constexpr int kHalfRows = 2;
    Vec3f sum;
    for (int row = image.height / 2 - kHalfRows; row < image.height / 2 + kHalfRows; ++row)
        for (int column = firstColumn; column < endColumn; ++column)
            sum += PixelColor(image, column, row);
    return sum / float(2 * kHalfRows * (endColumn - firstColumn));
}

int CompareWall(Arguments &arguments) {
    const auto limit = arguments.TakeValue("--limit");
    const std::string &path = Words(arguments, 1, "one image").front();
    const Image image = ReadScreenshot(path);
    const int middle = image.width / 2;
    // Radius of the outline in pixels; r / d is 1.3 % below the exact r / sqrt(d^2 - r^2).
    const float radius = float(middle) * kSphereRadius / kSphereDistance;
    // Of the columns beside the sphere where the wall is looked at: from its middle, pixels.
    const int inner = int(1.1f * radius), outer = int(1.3f * radius);
    constexpr float kLeastRadius = 8; // pixels
    if (radius < kLeastRadius || outer > middle)
        throw Error("{}: too small a picture", path);
    const Vec3f left = MeanColor(image, middle - outer, middle - inner),
                right = MeanColor(image, middle + inner, middle + outer), wall = (left + right) * 0.5f;
    constexpr int kHalfColumns = 2;
    const Vec3f sphere = MeanColor(image, middle - kHalfColumns, middle + kHalfColumns), step = sphere - wall;
    const float most = std::max({std::abs(step.x), std::abs(step.y), std::abs(step.z)});
    fmt::print(
        "sphere {:.1f} {:.1f} {:.1f}, wall {:.1f} {:.1f} {:.1f} (left {:.1f}, right {:.1f} in green), step {:.1f}\n",
        sphere.x, sphere.y, sphere.z, wall.x, wall.y, wall.z, left.y, right.y, most);
    return limit && double(most) > NumberFromText(*limit) ? 1 : 0;
}

int Run(const std::vector<std::string> &words) {
    Arguments arguments(words);
    const std::string task = arguments.Empty() ? std::string() : arguments.TakeFirst();
    if (task == "places")
        return PrintPlaces(arguments);
    if (task == "compare")
        return CompareImages(arguments);
    if (task == "wall")
        return CompareWall(arguments);
    fmt::print("{}", kUsage);
    return 2;
}

} // namespace

} // namespace q3

int main(int count, char **words) {
    return q3::RunTool("sphere_light", count, words, q3::Run);
}
