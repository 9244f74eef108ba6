// GPL-2.0-or-later. CPU time of this process.
#include "common/cpu_time.h"

#include <sys/resource.h>
#include <time.h>

namespace q3 {

double CpuSeconds() {
    timespec now{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return double(now.tv_sec) + double(now.tv_nsec) * 1e-9;
}

double PeakMemory() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
#ifdef __APPLE__
    return double(usage.ru_maxrss); // bytes on macOS, kilobytes elsewhere
#else
    return 1024.0 * double(usage.ru_maxrss);
#endif
}

} // namespace q3
