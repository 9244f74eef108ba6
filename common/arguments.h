// GPL-2.0-or-later. Command line arguments, taken out one option at a time.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace q3 {

/// The word after the last occurrence of an option, for options that must act before the line is parsed. Empty: none.
std::string LastValueOf(std::string_view option, const std::vector<std::string> &words);

/// The rest of the command line. An option is found by its whole name, case-insensitive, wherever it stands, and is
/// removed together with the values after it; so the order of different options never matters, and repetitions of one
/// option are taken in their order.
class Arguments {
  public:
    explicit Arguments(std::vector<std::string> words) : words_(std::move(words)) {}

    /// Removes every occurrence of any of these names; true if there was one.
    bool TakeFlag(std::initializer_list<std::string_view> names);
    bool TakeFlag(std::string_view name) { return TakeFlag({name}); }
    /// Removes the first occurrence of any of these names with `count` values and returns them. Error: too few values.
    std::optional<std::vector<std::string>> TakeValues(std::initializer_list<std::string_view> names,
                                                       std::size_t count);
    /// Removes the first occurrence with its one value.
    std::optional<std::string> TakeValue(std::initializer_list<std::string_view> names);
    std::optional<std::string> TakeValue(std::string_view name) { return TakeValue({name}); }
    /// Removes every occurrence with its value. The last value, or `fallback`. Error: a value below `least`;
    /// words that are no numbers count as 0.
    int TakeInteger(std::string_view name, int fallback, int least);

    /// Removes and returns the last word, the input file of every stage; empty if no word is left.
    std::string TakeLast();
    /// The same for the first word.
    std::string TakeFirst();
    /// Removes and returns Rest()[at].
    std::string TakeAt(std::size_t at);
    const std::vector<std::string> &Rest() const { return words_; }
    bool Empty() const { return words_.empty(); }

    /// Puts words in front of the others. They count as standing after the stage word.
    void Prepend(const std::vector<std::string> &words);

    /// Marks the words of Rest() before index `end` as standing before the stage word.
    void SetBeforeStage(std::size_t end) { beforeStageEnd_ = end; }
    /// Whether Rest()[at] stood before the stage word on the command line.
    bool IsBeforeStage(std::size_t at) const { return at >= prependedCount_ && at < beforeStageEnd_; }

    /// An option that changed a setting; `before`: the value that it replaced.
    struct Change {
        std::string name, values, before;
    };
    /// Keeps the change for Changes().
    void NoteChange(std::string_view name, const std::vector<std::string> &values, std::string before);
    /// Forgets the change of an option that turned out to have no effect.
    void DropChange(std::string_view name);
    const std::vector<Change> &Changes() const { return changes_; }

  private:
    std::optional<std::size_t> Find(std::initializer_list<std::string_view> names) const;

    void Erase(std::size_t at, std::size_t count);

    std::vector<std::string> words_;
    std::size_t prependedCount_ = 0; ///< of words_, at the front: those of Prepend
    std::size_t beforeStageEnd_ = 0; ///< words between those of Prepend and this index stood before the stage word
    std::vector<Change> changes_;
};

} // namespace q3
