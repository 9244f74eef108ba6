// GPL-2.0-or-later. Command line arguments.
#include "common/arguments.h"

#include "common/error.h"
#include "common/text.h"

#include <algorithm>

#include <fmt/ranges.h>

namespace q3 {

std::optional<std::size_t> Arguments::Find(std::initializer_list<std::string_view> names) const {
    for (std::size_t i = 0; i < words_.size(); ++i)
        for (const std::string_view name : names)
            if (EqualNoCase(words_[i], name))
                return i;
    return std::nullopt;
}

bool Arguments::TakeFlag(std::initializer_list<std::string_view> names) {
    bool found = false;
    while (const auto at = Find(names)) {
        words_.erase(words_.begin() + std::ptrdiff_t(*at));
        found = true;
    }
    return found;
}

bool Arguments::TakeFirstFlag(std::string_view name) {
    const auto at = Find({name});
    if (at)
        words_.erase(words_.begin() + std::ptrdiff_t(*at));
    return at.has_value();
}

std::optional<std::vector<std::string>> Arguments::TakeValues(std::initializer_list<std::string_view> names,
                                                              std::size_t count) {
    const auto at = Find(names);
    if (!at)
        return std::nullopt;
    if (words_.size() - *at - 1 < count)
        throw Error("{} needs {} value{} and has {}", words_[*at], count, count == 1 ? "" : "s",
                    words_.size() - *at - 1);
    const auto first = words_.begin() + std::ptrdiff_t(*at);
    std::vector<std::string> values(first + 1, first + 1 + std::ptrdiff_t(count));
    words_.erase(first, first + 1 + std::ptrdiff_t(count));
    return values;
}

std::optional<std::string> Arguments::TakeValue(std::initializer_list<std::string_view> names) {
    auto values = TakeValues(names, 1);
    if (!values)
        return std::nullopt;
    return std::move(values->front());
}

std::optional<int> Arguments::TakeCount(std::string_view name) {
    const auto at = Find({name});
    if (!at)
        return std::nullopt;
    const auto first = words_.begin() + std::ptrdiff_t(*at);
    const std::optional<int> count = first + 1 == words_.end() ? std::nullopt : WholeInteger(*(first + 1));
    const bool follows = count && *count >= 1;
    words_.erase(first, first + (follows ? 2 : 1));
    return follows ? *count : 0;
}

std::string Arguments::TakeLast() {
    if (words_.empty())
        return {};
    std::string last = std::move(words_.back());
    words_.pop_back();
    return last;
}

std::string Arguments::TakeAt(std::size_t at) {
    std::string word = std::move(words_[at]);
    words_.erase(words_.begin() + std::ptrdiff_t(at));
    return word;
}

void Arguments::NoteChange(std::string_view name, const std::vector<std::string> &values, std::string before) {
    changes_.push_back({std::string(name), fmt::format("{}", fmt::join(values, " ")), std::move(before)});
}

std::string Arguments::TakeFirst() {
    if (words_.empty())
        return {};
    std::string first = std::move(words_.front());
    words_.erase(words_.begin());
    return first;
}

} // namespace q3
