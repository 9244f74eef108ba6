// GPL-2.0-or-later. Measures CPU time.
#pragma once

#include "common/platform/platform.h"

namespace q3 {

/// Measures CPU seconds of the process from its construction.
class CpuTimer {
  public:
    CpuTimer() : start_(CpuSeconds()) {}
    double Seconds() const { return CpuSeconds() - start_; }

  private:
    double start_;
};

} // namespace q3
