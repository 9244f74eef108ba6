// GPL-2.0-or-later. collision_compare: do players meet the same solids in two files of one map?
#include "common/arguments.h"
#include "common/tool_main.h"
#include "libs/math/sampling.h"
#include "q3map2/bspfile/bsp.h"
#include "tools/measure/collision_compare/collision.h"

#include <algorithm>
#include <cmath>

namespace q3 {

namespace {

constexpr std::string_view kUsage = R"(usage: collision_compare [--moves N] [--worst N] A.bsp B.bsp
Moves a box of a player's size N (100000) times along random lines through the brushes of both files, from places in the
open that are free in both, and says how often it gets equally far, and whether it ever leaves the map.
)";
/// Bounds of a standing player in Quake III.
const Boundsd kPlayer{{-15, -15, -24}, {15, 15, 32}};
/// Largest offset of a move on each axis; largest difference of two lengths that count as equal. Game units.
constexpr double kMaxOffset = 1024, kEqualDistance = 0.25;

/// A move that ends in different places.
struct Move {
    Vec3d start, end;
    double difference; ///< how much farther the box gets in B than in A; game units
};

/// Random places and directions; the same for every pair of files.
class RandomPlaces {
  public:
    double Next() { return UnitFromHash(HashIndex(++count_)); }
    Vec3d InBox(const Boundsd &box) {
        const double x = Next(), y = Next(), z = Next();
        return box.mins + (box.maxs - box.mins) * Vec3d{x, y, z};
    }

  private:
    std::uint64_t count_ = 0;
};

struct Result {
    long long tried = 0, moved = 0;             ///< places; those where the box is free in both files, and is moved
    long long insideOnlyA = 0, insideOnlyB = 0; ///< places where it is in a brush of one file
    long long outOfA = 0, outOfB = 0;           ///< moves that end outside of open leafs
    long long equal = 0;                        ///< moves that end at most kEqualDistance apart
    std::vector<Move> different;                ///< the others
};

/// Whether the point, the origin of a player's box, is in an open leaf.
bool InOpen(const Bsp &bsp, const Vec3d &p) {
    return bsp.leafs[std::size_t(LeafAt(bsp, Vec3f(p)))].cluster != kSolidCluster;
}

Result Compare(const Bsp &a, const Bsp &b, long long moves) {
    const CollisionMap inA(a), inB(b);
    Boundsd world;
    for (const Bsp *bsp : {&a, &b})
        for (const bspDrawVert_t &v : bsp->drawVerts)
            world.Add(Vec3d(v.xyz));
    RandomPlaces random;
    Result result;
    constexpr long long kTriesPerMove = 1000; // at most
    while (result.moved < moves && ++result.tried < kTriesPerMove * moves) {
        const Vec3d start = random.InBox(world);
        const Vec3d way = random.InBox({{-1, -1, -1}, {1, 1, 1}}) * kMaxOffset;
        if (!InOpen(b, start))
            continue;
        const auto hitA = inA.Move(kPlayer, start, start + way), hitB = inB.Move(kPlayer, start, start + way);
        result.insideOnlyA += hitA.startsInside && !hitB.startsInside;
        result.insideOnlyB += hitB.startsInside && !hitA.startsInside;
        if (hitA.startsInside || hitB.startsInside)
            continue;
        ++result.moved;
        result.outOfA += !InOpen(a, start + way * hitA.fraction);
        result.outOfB += !InOpen(b, start + way * hitB.fraction);
        const double difference = (hitB.fraction - hitA.fraction) * Length(way);
        if (std::abs(difference) <= kEqualDistance)
            ++result.equal;
        else
            result.different.push_back({start, start + way, difference});
    }
    return result;
}

void Print(const Result &r, std::size_t worst) {
    fmt::print("{} places tried, {} free in both; solid in A alone {}, in B alone {}\n", r.tried, r.moved,
               r.insideOnlyA, r.insideOnlyB);
    fmt::print("{} of {} moves end within {} units of each other ({:.4f} %)\n", r.equal, r.moved, kEqualDistance,
               r.moved > 0 ? 100.0 * double(r.equal) / double(r.moved) : 0.0);
    fmt::print("{} moves leave A, {} leave B\n", r.outOfA, r.outOfB);
    std::vector<Move> sorted = r.different;
    std::stable_sort(sorted.begin(), sorted.end(),
                     [](const Move &x, const Move &y) { return std::abs(x.difference) > std::abs(y.difference); });
    for (std::size_t i = 0; i < std::min(worst, sorted.size()); ++i)
        fmt::print("in B {:+9.2f} units farther, from {:.1f} {:.1f} {:.1f} towards {:.1f} {:.1f} {:.1f}\n",
                   sorted[i].difference, sorted[i].start.x, sorted[i].start.y, sorted[i].start.z, sorted[i].end.x,
                   sorted[i].end.y, sorted[i].end.z);
}

int Run(const std::vector<std::string> &words) {
    Arguments arguments(words);
    const int moves = arguments.TakeInteger("--moves", 100000, 1), worst = arguments.TakeInteger("--worst", 10, 1);
    if (arguments.Rest().size() != 2) {
        fmt::print("{}", kUsage);
        return 1;
    }
    Log log(Log::Nowhere());
    const Bsp a = ReadBspFile(arguments.Rest()[0], {}, log), b = ReadBspFile(arguments.Rest()[1], {}, log);
    const Result result = Compare(a, b, moves);
    Print(result, std::size_t(worst));
    return result.moved > 0 ? 0 : 1;
}

} // namespace

} // namespace q3

int main(int count, char **words) {
    return q3::RunTool("collision_compare", count, words, q3::Run);
}
