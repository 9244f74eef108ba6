// GPL-2.0-or-later. CPU time and memory of this process.
#pragma once

namespace q3 {

/// CPU seconds of all threads of the process so far.
double CpuSeconds();
/// Peak resident memory so far, in bytes.
double PeakMemory();

/// Measures CPU seconds from its construction.
class CpuTimer {
  public:
    CpuTimer() : start_(CpuSeconds()) {}
    double Seconds() const { return CpuSeconds() - start_; }

  private:
    double start_;
};

} // namespace q3
