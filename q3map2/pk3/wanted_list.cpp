// GPL-2.0-or-later. Names of files or shaders that a package wants, and who wants them.
#include "q3map2/pk3/wanted_list.h"

#include "common/files/archive.h"

#include <algorithm>

namespace q3 {

std::string PackageName(std::string_view name) {
    return PlainName(name);
}

bool WantedList::Add(std::string_view name, std::string_view why, bool required) {
    std::string clean = PackageName(name);
    if (clean.empty())
        return false;
    if (known_.insert(LowerCase(clean)).second) {
        all_.push_back({std::move(clean), std::string(why), required});
        return true;
    }
    if (required)
        std::ranges::find_if(all_, [&](const Wanted &w) { return EqualNoCase(w.name, clean); })->required = true;
    return false;
}

} // namespace q3
