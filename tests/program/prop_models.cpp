// GPL-2.0-or-later. MD3 models for tests of static props.
#include "tests/program/prop_models.h"

#include <cmath>
#include <cstdint>
#include <cstring>

namespace q3::test {

namespace {

class Bytes {
  public:
    template <typename Value> void Put(Value value) {
        const auto *from = reinterpret_cast<const std::byte *>(&value);
        bytes_.insert(bytes_.end(), from, from + sizeof value);
    }
    void PutName(const std::string &name) {
        std::array<char, 64> field{};
        std::memcpy(field.data(), name.data(), std::min(name.size(), field.size() - 1));
        for (const char c : field)
            Put(c);
    }
    void Append(const Bytes &other) { bytes_.insert(bytes_.end(), other.bytes_.begin(), other.bytes_.end()); }
    std::int32_t Size() const { return std::int32_t(bytes_.size()); }
    std::vector<std::byte> Take() { return std::move(bytes_); }

  private:
    std::vector<std::byte> bytes_;
};

void PutVert(const TestVert &vert, Bytes &to) {
    for (const float c : {vert.xyz.x, vert.xyz.y, vert.xyz.z})
        to.Put(std::int16_t(std::lround(c * 64)));
    const double step = std::acos(-1.0) / 128;
    to.Put(std::uint8_t(std::lround(std::acos(double(vert.normal.z)) / step)));
    to.Put(std::uint8_t(std::lround(std::atan2(double(vert.normal.y), double(vert.normal.x)) / step) & 255));
}

Bytes SurfaceBytes(const TestMesh &mesh) {
    Bytes body;
    const std::int32_t head = 108;
    const auto at = [&] { return head + body.Size(); };
    const std::int32_t triangles = at();
    for (const auto &triangle : mesh.triangles)
        for (const int corner : triangle)
            body.Put(std::int32_t(corner));
    const std::int32_t shaders = at();
    body.PutName(mesh.shader);
    body.Put(std::int32_t(0));
    const std::int32_t st = at();
    for (const TestVert &vert : mesh.verts)
        body.Put(vert.st);
    const std::int32_t verts = at();
    for (const TestVert &vert : mesh.verts)
        PutVert(vert, body);
    Bytes surface;
    surface.Put(std::array<char, 4>{'I', 'D', 'P', '3'});
    surface.PutName("mesh");
    for (const std::int32_t value : {0, 1, 1, std::int32_t(mesh.verts.size()), std::int32_t(mesh.triangles.size()),
                                     triangles, shaders, st, verts, at()})
        surface.Put(value);
    surface.Append(body);
    return surface;
}

} // namespace

void TestMesh::AddSheet(float low, float high, int side, float z) {
    const int first = int(verts.size()), row = side + 1;
    for (int y = 0; y <= side; ++y)
        for (int x = 0; x <= side; ++x) {
            const float s = float(x) / float(side), t = float(y) / float(side);
            verts.push_back({{low + (high - low) * s, low + (high - low) * t, z}, {0, 0, 1}, {s, t}});
        }
    for (int y = 0; y < side; ++y)
        for (int x = 0; x < side; ++x) {
            const int a = first + y * row + x, b = a + 1, c = a + row, d = c + 1;
            triangles.push_back({a, c, d});
            triangles.push_back({a, d, b});
        }
}

void TestMesh::AddPlate(const Vec3f &low, const Vec3f &high) {
    const int first = int(verts.size());
    verts.push_back({{low.x, low.y, low.z}, {0, 0, 1}, {0, 0}});
    verts.push_back({{high.x, low.y, low.z}, {0, 0, 1}, {1, 0}});
    verts.push_back({{low.x, high.y, high.z}, {0, 0, 1}, {0, 1}});
    verts.push_back({{high.x, high.y, high.z}, {0, 0, 1}, {1, 1}});
    triangles.push_back({first, first + 2, first + 3});
    triangles.push_back({first, first + 3, first + 1});
}

void TestMesh::AddWalls(float radius, const std::vector<float> &heights) {
    for (const Vec3f &normal : {Vec3f{1, 0, 0}, Vec3f{0, 1, 0}, Vec3f{-1, 0, 0}, Vec3f{0, -1, 0}}) {
        const Vec3f along{-normal.y, normal.x, 0};
        const int first = int(verts.size());
        for (const float z : heights)
            for (const float side : {-radius, radius})
                verts.push_back({normal * radius + along * side + Vec3f{0, 0, z}, normal, {}});
        for (int i = 0; i + 1 < int(heights.size()); ++i) {
            const int a = first + 2 * i; // from the front: a left, a + 1 right
            triangles.push_back({a, a + 2, a + 3});
            triangles.push_back({a, a + 3, a + 1});
        }
    }
}

std::vector<std::byte> Md3Of(const std::vector<TestMesh> &meshes) {
    Bytes surfaces;
    for (const TestMesh &mesh : meshes)
        surfaces.Append(SurfaceBytes(mesh));
    Bytes file, frame;
    for (int i = 0; i < 10; ++i)
        frame.Put(0.0f);
    for (int i = 0; i < 4; ++i)
        frame.Put(std::int32_t(0));
    const std::int32_t head = 108, surfacesAt = head + frame.Size();
    file.Put(std::array<char, 4>{'I', 'D', 'P', '3'});
    file.Put(std::int32_t(15));
    file.PutName("test");
    for (const std::int32_t value :
         {0, 1, 0, std::int32_t(meshes.size()), 0, head, surfacesAt, surfacesAt, surfacesAt + surfaces.Size()})
        file.Put(value);
    file.Append(frame);
    file.Append(surfaces);
    return file.Take();
}

} // namespace q3::test
