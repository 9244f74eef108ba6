// GPL-2.0-or-later. From script text to shaders, before any image is read.
#pragma once

#include "common/text/text_scan.h"
#include "q3map2/shader/shader_table.h"

namespace q3 {

/// Reads all shaders of one script into the table. Mistakes in the script are warnings with their line. Errors:
/// those of the scanner; the shaders before them are in the table.
void ParseShaderScript(TextScanner &scanner, ShaderTable &table, Log &log);

} // namespace q3
