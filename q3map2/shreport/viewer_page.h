// GPL-2.0-or-later. The page that shows a map, and the map in it.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

namespace q3 {

/// The text of tools/viewer/viewer.html, embedded when the program was built.
std::string ViewerPage();

/// The page with `<!-- package -->` replaced by a script element that holds the archive in base64: its id is `package`,
/// its type `application/zip;base64`, and its attribute `data-map` is `map`, the name of the .bsp in the archive.
/// Errors: the comment is not in the page, or more than once.
std::string PageWithPackage(std::string_view page, std::string_view map, std::span<const std::byte> archive);

} // namespace q3
