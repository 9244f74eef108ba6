// GPL-2.0-or-later. Vectors, boxes and colors.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

namespace q3 {

/// Three numbers: a position or displacement in game units, a direction, or an RGB color.
template <typename T> struct Vec3 {
    T x{}, y{}, z{};

    constexpr Vec3() = default;
    constexpr Vec3(T x_, T y_, T z_) : x(x_), y(y_), z(z_) {}
    template <typename U> constexpr explicit Vec3(const Vec3<U> &v) : x(T(v.x)), y(T(v.y)), z(T(v.z)) {}
    constexpr explicit Vec3(const std::array<float, 3> &v) : x(T(v[0])), y(T(v[1])), z(T(v[2])) {}

    constexpr std::array<T, 3> Array() const { return {x, y, z}; }
    constexpr T &operator[](std::size_t i) { return i == 0 ? x : i == 1 ? y : z; }
    constexpr T operator[](std::size_t i) const { return i == 0 ? x : i == 1 ? y : z; }

    constexpr Vec3 operator+(const Vec3 &b) const { return {x + b.x, y + b.y, z + b.z}; }
    constexpr Vec3 operator-(const Vec3 &b) const { return {x - b.x, y - b.y, z - b.z}; }
    constexpr Vec3 operator*(const Vec3 &b) const { return {x * b.x, y * b.y, z * b.z}; }
    constexpr Vec3 operator*(T s) const { return {x * s, y * s, z * s}; }
    constexpr Vec3 operator/(T s) const { return {x / s, y / s, z / s}; }
    constexpr Vec3 operator-() const { return {-x, -y, -z}; }
    constexpr Vec3 &operator+=(const Vec3 &b) { return *this = *this + b; }
    constexpr Vec3 &operator-=(const Vec3 &b) { return *this = *this - b; }
    constexpr Vec3 &operator*=(T s) { return *this = *this * s; }
    constexpr bool operator==(const Vec3 &) const = default;
};

using Vec3f = Vec3<float>;
using Vec3d = Vec3<double>;

template <typename T> constexpr T Dot(const Vec3<T> &a, const Vec3<T> &b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <typename T> constexpr Vec3<T> Cross(const Vec3<T> &a, const Vec3<T> &b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <typename T> T Length(const Vec3<T> &v) {
    return std::sqrt(Dot(v, v));
}
/// Unit vector along v; the zero vector stays zero.
template <typename T> Vec3<T> Normalize(const Vec3<T> &v) {
    const T length = Length(v);
    return length > T(0) ? v / length : Vec3<T>{};
}
template <typename T> constexpr Vec3<T> Min(const Vec3<T> &a, const Vec3<T> &b) {
    return {a.x < b.x ? a.x : b.x, a.y < b.y ? a.y : b.y, a.z < b.z ? a.z : b.z};
}
template <typename T> constexpr Vec3<T> Max(const Vec3<T> &a, const Vec3<T> &b) {
    return {a.x > b.x ? a.x : b.x, a.y > b.y ? a.y : b.y, a.z > b.z ? a.z : b.z};
}
template <typename T> constexpr T MaxComponent(const Vec3<T> &v) {
    return v.x > v.y ? (v.x > v.z ? v.x : v.z) : (v.y > v.z ? v.y : v.z);
}
/// The largest absolute value of a component.
template <typename T> constexpr T MaxAbsComponent(const Vec3<T> &v) {
    return MaxComponent(Max(v, -v));
}
template <typename T> bool IsFinite(const Vec3<T> &v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

/// Axis-aligned box; empty (mins > maxs) until a point is added.
template <typename T> struct Bounds {
    Vec3<T> mins{std::numeric_limits<T>::max(), std::numeric_limits<T>::max(), std::numeric_limits<T>::max()};
    Vec3<T> maxs{std::numeric_limits<T>::lowest(), std::numeric_limits<T>::lowest(), std::numeric_limits<T>::lowest()};

    void Add(const Vec3<T> &p) { mins = Min(mins, p), maxs = Max(maxs, p); }
    void Add(const Bounds &b) { mins = Min(mins, b.mins), maxs = Max(maxs, b.maxs); }
    bool Empty() const { return mins.x > maxs.x || mins.y > maxs.y || mins.z > maxs.z; }
    bool Contains(const Vec3<T> &p) const {
        return p.x >= mins.x && p.y >= mins.y && p.z >= mins.z && p.x <= maxs.x && p.y <= maxs.y && p.z <= maxs.z;
    }
    /// Whether the boxes come within `slack` of each other on every axis.
    bool Touches(const Bounds &b, T slack = 0) const {
        for (std::size_t axis = 0; axis < 3; ++axis)
            if (mins[axis] > b.maxs[axis] + slack || maxs[axis] < b.mins[axis] - slack)
                return false;
        return true;
    }
    Vec3<T> Center() const { return (mins + maxs) * T(0.5); }
    /// Distance from p to the nearest point of the box; 0 inside.
    T Distance(const Vec3<T> &p) const { return Length(Max(Max(mins - p, p - maxs), Vec3<T>{})); }
};

using Boundsf = Bounds<float>;
using Boundsd = Bounds<double>;

/// Luma of an RGB color by the weights of Rec. 601, as map compilers use them on linear light too.
inline float Luminance(const Vec3f &color) {
    return 0.2989f * color.x + 0.587f * color.y + 0.114f * color.z;
}

} // namespace q3
