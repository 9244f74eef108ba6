// GPL-2.0-or-later. The SH light grid that names lights as JSON.
#include "q3map2/convert/json/convert_json_bspx.h"
namespace q3 {
void WriteJsonNamedGrid(const std::filesystem::path &, const Bsp &, const Game &) {}
void ReadJsonNamedGrid(const std::filesystem::path &, const JsonReadRules &, Bsp &) {}
}
