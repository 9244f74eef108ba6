// GPL-2.0-or-later. Results of units of work, such as a raw lightmap or a brick of grid points, that need not be
// computed again: those of an earlier run (-cache), or of other machines (-part, -join).
#pragma once

#include "common/files/files.h"
#include "common/hash.h"
#include "libs/math/vec.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <optional>
#include <span>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

namespace q3 {

/// Part `number` of `count`, from 1.
struct PartNumber {
    int number = 1, count = 1;
    bool operator==(const PartNumber &) const = default;
};

/// A unit and its result, which somebody else holds.
struct UnitResult {
    Hash128 key;
    std::span<const std::byte> bytes;
};

/// Results by key. Safe from several threads after the last Load.
class UnitStore {
  public:
    enum class Purpose {
        Cache, ///< a key holds all that a result depends on, lights included
        Parts  ///< all results are of the same inputs, so a key only names the unit
    };
    /// part: the units that this process computes; nothing: all that are asked for.
    explicit UnitStore(Purpose purpose, std::optional<PartNumber> part = {}) : purpose_(purpose), part_(part) {}

    bool IsCache() const { return purpose_ == Purpose::Cache; }
    bool IsPart() const { return part_.has_value(); }

    /// Adds known results of units with these inputs. A cache may hold results of other inputs: then Begin drops them.
    /// storage: what the results view.
    void Load(std::span<const UnitResult> results, MappedFile storage, const Hash128 &inputs);
    /// To be called before the first Find. inputs: what all units depend on. Errors: results that were loaded for a
    /// part or a join are of other inputs.
    void Begin(const Hash128 &inputs);
    const Hash128 &Inputs() const { return inputs_; }
    /// A loaded result that no run finds again, for what the run before says of itself. Valid as long as the store.
    std::optional<std::span<const std::byte>> TakeLoaded(const Hash128 &key);
    /// Boxes in which what blocks light has changed since the run whose results a cache holds.
    std::vector<Boundsf> changedBoxes;
    /// Hash of the geometry of the map, for keys of units that depend on more of it than receivers and blockers.
    Hash128 geometry;
    /// Hash of the settings of the run, for Begin's caller to add.
    Hash128 settings;
    /// The number of rounds whose results were loaded.
    int roundsBefore = 0;
    /// Whether this process ends with the file of joined results, and another round follows.
    bool endsWithFile = false;
    /// Forgets all results.
    void Clear();
    /// Whether this process computes a part of direct light on surfaces, the first round.
    bool IsPartOfFirstRound() const { return IsPart() && roundsBefore == 0; }

    /// The result of a unit, or nothing. Valid as long as the store.
    std::optional<std::span<const std::byte>> Find(const Hash128 &key) const;
    /// Keeps a new result.
    void Keep(const Hash128 &key, std::vector<std::byte> bytes);
    /// Results that Keep got, by key. Valid until Keep or Clear.
    std::vector<UnitResult> Kept() const;
    /// Of a cache, results that Find returned or Keep got; else all that Load or Keep got. By key, valid likewise.
    std::vector<UnitResult> Used() const;
    /// Whether Keep got any, or Find did not return all loaded ones.
    bool HasChanged() const;
    /// Number of results that Find returned, and that Keep got.
    std::size_t FoundCount() const, KeptCount() const;

    /// By unit of a pass: whether this process computes it. `costs` in any unit. In ranges: those of a part follow each
    /// other; else a part has units of all sizes.
    enum class Division { Ranges, BySize };
    std::vector<std::uint8_t> Own(std::span<const double> costs, Division division) const;

  private:
    struct HashKey {
        std::size_t operator()(const Hash128 &key) const { return std::size_t(key.low); }
    };
    struct Loaded {
        std::span<const std::byte> bytes;
        mutable std::uint8_t isUsed = 0; ///< set by any thread, always to 1
    };
    struct Shard {
        std::mutex mutex;
        std::vector<std::pair<Hash128, std::vector<std::byte>>> kept;
    };
    static constexpr std::size_t kShards = 64;

    const Purpose purpose_;
    const std::optional<PartNumber> part_;
    Hash128 inputs_, loadedInputs_;
    std::vector<MappedFile> storage_; ///< of loaded_
    std::unordered_map<Hash128, Loaded, HashKey> loaded_;
    mutable std::array<Shard, kShards> shards_; ///< by key
};

/// The units that each of `count` parts gets, by unit from 0. See UnitStore::Own.
std::vector<int> DivideUnits(std::span<const double> costs, int count, UnitStore::Division division);

} // namespace q3
