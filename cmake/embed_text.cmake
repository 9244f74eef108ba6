# Writes OUTPUT, a source that includes HEADER and defines std::string q3::FUNCTION(), which returns the bytes of INPUT.
# The text is split into string literals of 8192 bytes, since compilers limit their length (MSVC: 16,380 bytes).
cmake_minimum_required(VERSION 3.25)
set(piece_bytes 8192)
file(SIZE ${INPUT} bytes)
set(source "#include \"${HEADER}\"

namespace q3 {

std::string ${FUNCTION}() {
    std::string text;
    text.reserve(${bytes});
")
set(at 0)
while(at LESS bytes)
  file(READ ${INPUT} piece OFFSET ${at} LIMIT ${piece_bytes} HEX)
  string(LENGTH "${piece}" length)
  math(EXPR length "${length} / 2")
  string(REGEX REPLACE "(..)" "\\\\x\\1" piece "${piece}")
  string(APPEND source "    text.append(\"${piece}\", ${length});\n")
  math(EXPR at "${at} + ${piece_bytes}")
endwhile()
string(APPEND source "    return text;
}

} // namespace q3
")
file(WRITE ${OUTPUT} "${source}")
