// GPL-2.0-or-later. Errors of the encodings on random lights.
#pragma once

namespace q3::bump_wall {

/// Prints a table in Markdown: for each encoding the error over 20000 luxels, each with a random bump normal within
/// 45 degrees of the flat one: root mean square error over root mean square light. Columns are kinds of light. SSBump
/// is left out: without shadows it equals RNM with linear weights.
void PrintErrors();

} // namespace q3::bump_wall
