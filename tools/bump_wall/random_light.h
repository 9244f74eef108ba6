// GPL-2.0-or-later. Errors of the encodings on random lights.
#pragma once

namespace q3::bump_wall {

/// Prints a table in Markdown: for each encoding the error over 20000 luxels, each with a bump of another normal within
/// 45 degrees of the flat one, as root mean square over that of the light; columns are kinds of light. Self-shadowed
/// bump maps without anything that shadows are RNM with linear weights, and left out.
void PrintErrors();

} // namespace q3::bump_wall
