// GPL-2.0-or-later. The shaders of libs/shgrid as C++: their files are written in the part of GLSL and HLSL that C++
// can read, given vectors, samplers and a few functions.
#pragma once

#include "libs/shgrid/shgrid_atlas.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace q3::test {

namespace shaders {

struct vec3 {
    float x = 0, y = 0, z = 0;
    vec3() = default;
    explicit vec3(double v) : x(float(v)), y(float(v)), z(float(v)) {}
    vec3(double x_, double y_, double z_) : x(float(x_)), y(float(y_)), z(float(z_)) {}
};
struct vec4 {
    float x = 0, y = 0, z = 0, w = 0;
    vec4() = default;
    vec4(double x_, double y_, double z_, double w_) : x(float(x_)), y(float(y_)), z(float(z_)), w(float(w_)) {}
    float operator[](int i) const { return i == 0 ? x : i == 1 ? y : i == 2 ? z : w; }
};
struct ivec2 {
    int x, y;
    ivec2(int x_, int y_) : x(x_), y(y_) {}
};
struct ivec3 {
    int x, y, z;
    ivec3(int x_, int y_, int z_) : x(x_), y(y_), z(z_) {}
    explicit ivec3(vec3 v) : x(int(v.x)), y(int(v.y)), z(int(v.z)) {}
};
struct int4 {
    int x, y, z, w;
    int4(ivec3 v, int w_) : x(v.x), y(v.y), z(v.z), w(w_) {}
};
struct uvec4 {
    unsigned x, y, z, w;
    unsigned operator[](int i) const { return i == 0 ? x : i == 1 ? y : i == 2 ? z : w; }
};
using float3 = vec3;
using float4 = vec4;
using int3 = ivec3;
using uint4 = uvec4;

inline vec3 operator+(vec3 a, vec3 b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
}
inline vec3 operator-(vec3 a, vec3 b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
inline vec3 operator*(vec3 a, vec3 b) {
    return {a.x * b.x, a.y * b.y, a.z * b.z};
}
inline vec3 operator/(vec3 a, vec3 b) {
    return {a.x / b.x, a.y / b.y, a.z / b.z};
}
inline vec3 operator*(vec3 a, double s) {
    return a * vec3(s);
}
inline vec3 &operator*=(vec3 &a, double s) {
    return a = a * s;
}
inline vec3 operator/(vec3 a, double s) {
    return a / vec3(s);
}
inline vec3 &operator+=(vec3 &a, vec3 b) {
    return a = a + b;
}
inline vec3 min(vec3 a, vec3 b) {
    return {std::min(a.x, b.x), std::min(a.y, b.y), std::min(a.z, b.z)};
}
inline vec3 max(vec3 a, vec3 b) {
    return {std::max(a.x, b.x), std::max(a.y, b.y), std::max(a.z, b.z)};
}
inline double min(double a, double b) {
    return std::min(a, b);
}
inline double max(double a, double b) {
    return std::max(a, b);
}
inline double clamp(double a, double low, double high) {
    return std::clamp(a, low, high);
}
inline double abs(double a) {
    return std::abs(a);
}
inline double sqrt(double a) {
    return std::sqrt(a);
}
inline double atan(double y, double x) {
    return std::atan2(y, x);
}
inline double atan2(double y, double x) {
    return std::atan2(y, x);
}
inline float dot(vec3 a, vec3 b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
inline float length(vec3 a) {
    return std::sqrt(dot(a, a));
}
inline vec3 cross(vec3 a, vec3 b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline double pow(double a, double b) {
    return std::pow(a, b);
}
inline vec3 pow(vec3 a, vec3 b) {
    return {std::pow(a.x, b.x), std::pow(a.y, b.y), std::pow(a.z, b.z)};
}
inline double exp(double a) {
    return std::exp(a);
}
inline vec3 mix(vec3 a, vec3 b, double share) {
    return a + (b - a) * share;
}
inline vec3 lerp(vec3 a, vec3 b, double share) {
    return mix(a, b, share);
}
inline vec3 fract(vec3 a) {
    return {a.x - std::floor(a.x), a.y - std::floor(a.y), a.z - std::floor(a.z)};
}
inline vec3 frac(vec3 a) {
    return fract(a);
}
inline float exp2(float a) {
    return std::exp2(a);
}

/// Texels of a 3D texture, filtered linearly. Weights have all bits of float; those of hardware have 8.
struct sampler3D {
    std::array<int, 3> size{};
    std::vector<vec4> texels;
    const vec4 &Texel(int x, int y, int z) const {
        return texels[std::size_t(x) + std::size_t(size[0]) * (std::size_t(y) + std::size_t(size[1]) * std::size_t(z))];
    }
};
/// Four whole numbers a texel.
struct usampler3D {
    std::array<int, 3> size{};
    std::vector<unsigned> entries;
};
struct sampler2D {
    std::array<int, 2> size{};
    std::vector<vec4> texels;
};

inline uvec4 texelFetch(const usampler3D &from, ivec3 at, int) {
    const bool inside =
        at.x >= 0 && at.y >= 0 && at.z >= 0 && at.x < from.size[0] && at.y < from.size[1] && at.z < from.size[2];
    EXPECT_TRUE(inside);
    const unsigned *e = &from.entries[4 * std::size_t(at.x + from.size[0] * (at.y + from.size[1] * at.z))];
    return {e[0], e[1], e[2], e[3]};
}
inline vec4 texelFetch(const sampler2D &from, ivec2 at, int) {
    EXPECT_TRUE(at.x >= 0 && at.y >= 0 && at.x < from.size[0] && at.y < from.size[1]);
    return from.texels[std::size_t(at.x + from.size[0] * at.y)];
}
inline vec4 textureLod(const sampler3D &from, vec3 p, double) {
    const std::array<float, 3> at = {p.x * float(from.size[0]) - 0.5f, p.y * float(from.size[1]) - 0.5f,
                                     p.z * float(from.size[2]) - 0.5f};
    vec4 sum;
    for (int corner = 0; corner < 8; ++corner) {
        std::array<int, 3> texel{};
        float weight = 1;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const float low = std::floor(at[axis]), fraction = at[axis] - low;
            const int upper = corner >> axis & 1;
            weight *= upper != 0 ? fraction : 1 - fraction;
            texel[axis] = std::clamp(int(low) + upper, 0, from.size[axis] - 1);
        }
        const vec4 &t = from.Texel(texel[0], texel[1], texel[2]);
        sum = {sum.x + weight * t.x, sum.y + weight * t.y, sum.z + weight * t.z, sum.w + weight * t.w};
    }
    return sum;
}

struct SamplerState {};
template <typename Texel> struct Texture3D;
template <> struct Texture3D<float4> {
    const sampler3D &from;
    Texture3D(const sampler3D &texture) : from(texture) {}
    vec4 SampleLevel(SamplerState, vec3 p, double) const { return textureLod(from, p, 0); }
};
template <> struct Texture3D<uint4> {
    const usampler3D &from;
    Texture3D(const usampler3D &texture) : from(texture) {}
    uvec4 Load(int4 at) const { return texelFetch(from, ivec3(at.x, at.y, at.z), at.w); }
};
template <typename Texel> struct Texture2D {
    const sampler2D &from;
    Texture2D(const sampler2D &texture) : from(texture) {}
    vec4 Load(int3 at) const { return texelFetch(from, ivec2(at.x, at.y), at.z); }
};

// Literals are of type double in C++, and functions of the files are not inline, so each source has its own.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wfloat-conversion"
namespace glsl {
namespace {
#define sampler2D const sampler2D &
#define sampler3D const sampler3D &
#define usampler3D const usampler3D &
#include "libs/shgrid/shgrid.glsl"
#include "libs/shgrid/shgrid_atlas.glsl"
#undef sampler2D
#undef sampler3D
#undef usampler3D
} // namespace
} // namespace glsl
namespace hlsl {
namespace {
#include "libs/shgrid/shgrid.hlsl"
#include "libs/shgrid/shgrid_atlas.hlsl"
} // namespace
} // namespace hlsl
#pragma GCC diagnostic pop

} // namespace shaders

/// The value of an IEEE half.
inline float FromHalf(std::uint16_t half) {
    const int exponent = half >> 10 & 31, mantissa = half & 1023;
    const float size =
        exponent == 0 ? std::ldexp(float(mantissa), -24) : std::ldexp(float(mantissa + 1024), exponent - 25);
    return (half & 0x8000) != 0 ? -size : size;
}

} // namespace q3::test
