// GPL-2.0-or-later. The portal file (.prt): reading and checking.
#include "q3map2/bspfile/prtfile.h"

#include "common/error.h"
#include "common/files/files.h"
#include "q3map2/bspfile/bspfile_ibsp.h"

#include <charconv>
#include <cmath>
#include <string>

namespace q3 {

namespace {

// Limits that keep a damaged file from huge allocations; chosen.
constexpr int kMaxPortals = 65536;
constexpr int kMaxFaces = 1 << 22;
constexpr int kMaxPoints = 512;           ///< of a winding
constexpr float kMaxCoordinate = 1 << 20; ///< game units from 0

/// Splits the text into words and single parentheses, and counts lines.
class PrtScanner {
  public:
    PrtScanner(std::string_view text, std::string_view name) : text_(text), name_(name) {}

    std::string_view Next() {
        while (at_ < text_.size() && static_cast<unsigned char>(text_[at_]) <= ' ')
            line_ += text_[at_++] == '\n';
        const std::size_t start = at_;
        if (at_ < text_.size() && IsParenthesis(text_[at_]))
            return text_.substr(at_++, 1);
        while (at_ < text_.size() && static_cast<unsigned char>(text_[at_]) > ' ' && !IsParenthesis(text_[at_]))
            ++at_;
        return text_.substr(start, at_ - start);
    }
    int Line() const { return line_; }

    [[noreturn]] void Fail(std::string_view found, std::string_view expected) const {
        if (found.empty())
            throw Error("{}:{}: the file ends, expected {}", name_, line_, expected);
        throw Error("{}:{}: \"{}\", expected {}", name_, line_, found.substr(0, 40), expected);
    }
    void Expect(std::string_view word, std::string_view what) {
        const std::string_view found = Next();
        if (found != word)
            Fail(found, what);
    }
    int Integer(int least, int most, std::string_view what) {
        const std::string_view word = Next();
        int value = 0;
        const auto result = std::from_chars(word.data(), word.data() + word.size(), value);
        if (word.empty() || result.ec != std::errc() || result.ptr != word.data() + word.size() || value < least ||
            value > most)
            Fail(word, fmt::format("{} of {} to {}", what, least, most));
        return value;
    }
    float Coordinate() {
        const std::string_view word = Next();
        double value = 0;
        const auto result = std::from_chars(word.data(), word.data() + word.size(), value);
        if (word.empty() || result.ec != std::errc() || result.ptr != word.data() + word.size() ||
            !(std::abs(value) <= double(kMaxCoordinate)))
            Fail(word, fmt::format("a coordinate within {} units", kMaxCoordinate));
        return float(value);
    }

  private:
    static bool IsParenthesis(char c) { return c == '(' || c == ')'; }

    std::string_view text_, name_;
    std::size_t at_ = 0;
    int line_ = 1;
};

void ReadPoints(PrtScanner &scanner, int count, PortalFile &file, PrtWinding &winding) {
    winding.firstPoint = file.points.size();
    winding.numPoints = std::size_t(count);
    for (int i = 0; i < count; ++i) {
        scanner.Expect("(", "( before a point");
        const float x = scanner.Coordinate(), y = scanner.Coordinate(), z = scanner.Coordinate();
        file.points.emplace_back(x, y, z);
        scanner.Expect(")", ") after a point");
    }
}

PrtWinding ReadWinding(PrtScanner &scanner, PortalFile &file, bool isPortal) {
    PrtWinding winding;
    const int count = scanner.Integer(3, kMaxPoints, isPortal ? "points of a portal" : "points of a face");
    winding.line = scanner.Line();
    winding.clusters[0] = scanner.Integer(0, file.clusters - 1, "a cluster");
    if (isPortal) {
        winding.clusters[1] = scanner.Integer(0, file.clusters - 1, "a cluster");
        if (winding.clusters[0] == winding.clusters[1])
            scanner.Fail(std::to_string(winding.clusters[1]), "two different clusters");
        const int flags = scanner.Integer(0, kPrtHintFlag | kPrtSkyFlag, "flags");
        winding.isHint = (flags & kPrtHintFlag) != 0;
        winding.isSky = (flags & kPrtSkyFlag) != 0;
    }
    ReadPoints(scanner, count, file, winding);
    return winding;
}

} // namespace

PortalFile ParsePortalFile(std::string_view text, std::string_view name) {
    PrtScanner scanner(text, name);
    PortalFile file;
    scanner.Expect("PRT1", "PRT1, which portal files begin with");
    file.clusters = scanner.Integer(0, kMaxVisClusters, "a number of clusters");
    const int portals = scanner.Integer(0, kMaxPortals, "a number of portals");
    const int faces = scanner.Integer(0, kMaxFaces, "a number of faces");
    for (int i = 0; i < portals; ++i)
        file.portals.push_back(ReadWinding(scanner, file, true));
    for (int i = 0; i < faces; ++i)
        file.faces.push_back(ReadWinding(scanner, file, false));
    if (const std::string_view rest = scanner.Next(); !rest.empty())
        scanner.Fail(rest, fmt::format("the end after {} portals and {} faces", portals, faces));
    return file;
}

PortalFile ReadPortalFile(const std::filesystem::path &path) {
    return ParsePortalFile(ReadTextFile(path), path.string());
}

} // namespace q3
