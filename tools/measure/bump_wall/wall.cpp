// GPL-2.0-or-later. A brick wall with bumps and two lamps.
#include "tools/measure/bump_wall/wall.h"

#include <algorithm>
#include <cmath>

namespace q3::bump_wall {

namespace {

struct Lamp {
    Vec3f at, strength; ///< world units; light at normal incidence times squared distance
};
constexpr std::array<Lamp, 2> kLamps = {Lamp{{24, 22, 26}, {640, 400, 155}}, Lamp{{100, 68, 34}, {190, 380, 1080}}};

constexpr float kBrickWidth = 32, kBrickHeight = 16, kMortar = 1.5f, kBevel = 2; // world units
constexpr float kBrickDepth = 1.4f, kStudRadius = 4, kStudHeight = kTallest - kBrickDepth;
constexpr float kStep = 0.25f; // of rays through the bumps, world units
constexpr float kLift = 0.02f; // of the starts of these rays off the bumps, world units

float SmoothStep(float x) {
    x = std::clamp(x, 0.0f, 1.0f);
    return x * x * (3 - 2 * x);
}

} // namespace

LocalLight LampsAt(float x, float y) {
    LocalLight light;
    for (const Lamp &lamp : kLamps) {
        const Vec3f to = lamp.at - Vec3f{x, y, 0};
        light.rays.push_back({lamp.strength * (1 / Dot(to, to)), Normalize(to)});
    }
    return light;
}

float BumpHeight(float x, float y) {
    const float course = std::floor(y / kBrickHeight);
    const bool odd = std::fmod(course, 2.0f) != 0;
    const float along = x / kBrickWidth + (odd ? 0.5f : 0), brick = std::floor(along);
    const float bx = (along - brick) * kBrickWidth, by = y - course * kBrickHeight;
    const float toEdge = std::min({bx, kBrickWidth - bx, by, kBrickHeight - by});
    const float body = kBrickDepth * SmoothStep((toEdge - kMortar / 2) / kBevel);
    const float dx = bx - kBrickWidth / 2, dy = by - kBrickHeight / 2;
    const bool stud = std::fmod(brick + course + 64, 2.0f) == 0; // 64: no sum is negative
    const float dome = 1 - (dx * dx + dy * dy) / (kStudRadius * kStudRadius);
    return body + (stud && dome > 0 ? kStudHeight * SmoothStep(dome * 1.5f) : 0);
}

Vec3f BumpNormal(float x, float y) {
    constexpr float kDelta = 0.05f; // world units
    return Normalize(Vec3f{(BumpHeight(x - kDelta, y) - BumpHeight(x + kDelta, y)) / (2 * kDelta),
                           (BumpHeight(x, y - kDelta) - BumpHeight(x, y + kDelta)) / (2 * kDelta), 1});
}

bool BumpsBlock(float x, float y, const Vec3f &direction) {
    if (direction.z <= 0)
        return true;
    const float start = BumpHeight(x, y) + kLift;
    for (float t = kStep; start + t * direction.z < kTallest; t += kStep)
        if (BumpHeight(x + t * direction.x, y + t * direction.y) > start + t * direction.z)
            return true;
    return false;
}

LocalLight VisibleLamps(float x, float y) {
    LocalLight light = LampsAt(x, y);
    std::erase_if(light.rays, [&](const Ray &ray) { return BumpsBlock(x, y, ray.direction); });
    return light;
}

} // namespace q3::bump_wall
