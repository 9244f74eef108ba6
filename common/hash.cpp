// GPL-2.0-or-later. Hashes of 128 bits, to name contents and to find damage.
#include "common/hash.h"

#include <fmt/format.h>

#define XXH_INLINE_ALL // the header alone, without its library
#include <xxhash.h>

namespace q3 {

std::string Hash128::Text() const {
    return fmt::format("{:016x}{:016x}", high, low);
}

Hash128 HashOf(std::span<const std::byte> bytes) {
    const XXH128_hash_t hash = XXH3_128bits(bytes.data(), bytes.size());
    return {hash.low64, hash.high64};
}

Hash128 HashOf(std::string_view text) {
    return HashOf(std::as_bytes(std::span(text)));
}

struct StreamHash::State {
    XXH3_state_t state;
};

StreamHash::StreamHash() : state_(std::make_unique<State>()) {
    XXH3_128bits_reset(&state_->state);
}

StreamHash::~StreamHash() = default;

void StreamHash::Add(std::span<const std::byte> bytes) {
    XXH3_128bits_update(&state_->state, bytes.data(), bytes.size());
}

Hash128 StreamHash::Hash() const {
    const XXH128_hash_t hash = XXH3_128bits_digest(&state_->state);
    return {hash.low64, hash.high64};
}

} // namespace q3
