// GPL-2.0-or-later. Where things of a map source are: primitives that messages name, and lights.
#pragma once

#include "libs/math/vec.h"
#include "q3map2/bspfile/entities.h"
#include "q3map2/shader/games.h"

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace q3 {

/// The light entities of a map source. Empty if the text cannot be read.
std::vector<Entity> LightsOfSource(const std::string &text);

/// Positions of the primitives of a map source.
class SourcePlaces {
  public:
    SourcePlaces() = default;
    /// Of what can be read: none after an error in the text.
    SourcePlaces(const std::string &text, const Game &game);
    /// The center of the primitive (brush or patch), or the origin of its entity; numbers as in LogMark.
    std::optional<Vec3f> Of(int entity, int primitive) const;

  private:
    std::map<std::pair<int, int>, Vec3f> primitives_;
    std::map<int, Vec3f> entities_;
};

} // namespace q3
