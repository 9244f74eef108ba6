// GPL-2.0-or-later. Hash of what reference light depends on.
#pragma once

#include "q3map2/bspfile/bsp.h"
#include "q3map2/light/scene/surface_table.h"
#include "q3map2/light/sources/light_sources.h"

#include <glib.h>

#include <memory>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace q3::bench {

/// SHA-256 of values.
class Hash {
  public:
    Hash() : sum_(g_checksum_new(G_CHECKSUM_SHA256), g_checksum_free) {}

    template <typename T> void Value(const T &value) {
        static_assert(std::is_arithmetic_v<T> || std::is_enum_v<T>);
        Bytes(&value, sizeof value);
    }
    void Value(const Vec3f &v) { Value(v.x), Value(v.y), Value(v.z); }
    void Value(std::string_view text) {
        Value(text.size());
        Bytes(text.data(), text.size());
    }
    template <typename T> void Records(const std::vector<T> &records) {
        static_assert(std::is_trivially_copyable_v<T> && !std::is_pointer_v<T>);
        Value(records.size());
        Bytes(records.data(), records.size() * sizeof(T));
    }
    std::string Hex() const { return g_checksum_get_string(sum_.get()); }

  private:
    void Bytes(const void *data, std::size_t size) {
        if (size > 0)
            g_checksum_update(sum_.get(), static_cast<const guchar *>(data), gssize(size));
    }
    std::unique_ptr<GChecksum, void (*)(GChecksum *)> sum_;
};

/// Everything of the map but its light.
void AddGeometry(Hash &hash, const Bsp &bsp);
/// What shadow rays need of the surfaces.
void AddSurfaces(Hash &hash, const SurfaceTable &table);
void AddLight(Hash &hash, const Light &light);

} // namespace q3::bench
