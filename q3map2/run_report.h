// GPL-2.0-or-later. What a run prints about itself: its settings at the start, how it went at the end.
#pragma once

#include "common/arguments.h"
#include "q3map2/bspfile/entities.h"
#include "q3map2/bspfile/entity_key.h"

#include <chrono>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace q3 {

/// Prints the options that changed a setting, with the value that they replace.
void PrintChangedOptions(const Arguments &arguments, Log &log);
/// Prints the keys whose value in `entity` is not their default. `source` is its class name.
void PrintChangedKeys(const Entity &entity, std::span<const EntityKey> keys, std::string_view source, Log &log);

/// Times a run.
class RunReport {
  public:
    /// Keeps a fault that makes the result unfit, such as a leak: the last line says it first.
    void Conclude(std::string fault) { faults_.push_back(std::move(fault)); }
    /// The faults, separated by commas.
    std::string Faults() const;
    /// Repeats warnings of unknown options, then prints how the run ended, warnings by kind, times and memory.
    void PrintEnd(bool failed, Log &log) const;

  private:
    std::vector<std::string> faults_;
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

} // namespace q3
