// GPL-2.0-or-later. Names of files or shaders that a package wants, and who wants them.
#pragma once

#include "common/text/text.h"

#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace q3 {

/// PlainName: how files of packages are named.
std::string PackageName(std::string_view name);

struct Wanted {
    std::string name, why;
    bool required = true;
};

/// Names in the order in which they were added, each once; case does not matter.
class WantedList {
  public:
    /// False: it is there already (and is required if either is), or empty.
    bool Add(std::string_view name, std::string_view why, bool required = true);
    bool Has(std::string_view name) const { return known_.contains(LowerCase(name)); }
    const std::vector<Wanted> &All() const { return all_; }

  private:
    std::vector<Wanted> all_;
    std::set<std::string> known_; ///< lower case
};

} // namespace q3
