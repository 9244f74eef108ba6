// GPL-2.0-or-later. Large pages for the heap.
#include "common/heap.h"

#if defined(__GLIBC__) && defined(__linux__)
#include <cstdint>
#include <cstdlib>
#include <malloc.h>
#include <sys/mman.h>
#include <unistd.h>
#endif

namespace q3 {

#if defined(__GLIBC__) && defined(__linux__)

namespace {

constexpr int kMiB = 1 << 20;
/// Address space of the heap that gets large pages; memory is assigned only to pages that are touched.
constexpr int kLargePart = 256 * kMiB;
/// Larger blocks are mapped separately. The highest threshold that glibc would choose by itself.
constexpr int kOwnMemory = 32 * kMiB;
constexpr std::uintptr_t kLargePage = 2 * kMiB;

} // namespace

void UseLargePages() {
    if (mallopt(M_MMAP_THRESHOLD, kOwnMemory) == 0 || mallopt(M_TRIM_THRESHOLD, 2 * kLargePart) == 0 ||
        mallopt(M_TOP_PAD, kLargePart) == 0)
        return;
    const auto end = [] { return reinterpret_cast<std::uintptr_t>(sbrk(0)); };
    const std::uintptr_t before = end();
    // An allocation beyond the end of the heap makes it grow by M_TOP_PAD, and it keeps that size when freed. Volatile,
    // since compilers remove unused allocations.
    void *volatile grown = std::malloc(kMiB);
    std::free(grown);
    mallopt(M_TOP_PAD, kMiB);
    const std::uintptr_t first = (before + kLargePage - 1) / kLargePage * kLargePage, after = end();
    if (after > first)
        madvise(reinterpret_cast<void *>(first), after - first, MADV_HUGEPAGE);
}

#else

void UseLargePages() {}

#endif

} // namespace q3
