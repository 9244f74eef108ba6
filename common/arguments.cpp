// GPL-2.0-or-later. Command line arguments.
#include "common/arguments.h"

#include "common/error.h"
#include "common/text/text.h"

#include <algorithm>

#include <fmt/ranges.h>

namespace q3 {

std::string LastValueOf(std::string_view option, const std::vector<std::string> &words) {
    for (std::size_t i = words.size(); i-- > 1;)
        if (EqualNoCase(words[i - 1], option))
            return words[i];
    return {};
}

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
        Erase(*at, 1);
        found = true;
    }
    return found;
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
    Erase(*at, count + 1);
    return values;
}

std::optional<std::string> Arguments::TakeValue(std::initializer_list<std::string_view> names) {
    auto values = TakeValues(names, 1);
    if (!values)
        return std::nullopt;
    return std::move(values->front());
}

int Arguments::TakeInteger(std::string_view name, int fallback, int least) {
    int value = fallback;
    while (const auto text = TakeValue(name)) {
        value = IntegerFromText(*text);
        if (value < least)
            throw Error("{} {}: expected a whole number of at least {}", name, *text, least);
    }
    return value;
}

void Arguments::Erase(std::size_t at, std::size_t count) {
    words_.erase(words_.begin() + std::ptrdiff_t(at), words_.begin() + std::ptrdiff_t(at + count));
    for (std::size_t *end : {&prependedCount_, &beforeStageEnd_})
        *end -= std::min(*end, at + count) - std::min(*end, at);
}

void Arguments::Prepend(const std::vector<std::string> &words) {
    words_.insert(words_.begin(), words.begin(), words.end());
    prependedCount_ += words.size();
    beforeStageEnd_ += words.size();
}

std::string Arguments::TakeLast() {
    return words_.empty() ? std::string() : TakeAt(words_.size() - 1);
}

std::string Arguments::TakeAt(std::size_t at) {
    std::string word = std::move(words_[at]);
    Erase(at, 1);
    return word;
}

void Arguments::NoteChange(std::string_view name, const std::vector<std::string> &values, std::string before) {
    changes_.push_back({std::string(name), fmt::format("{}", fmt::join(values, " ")), std::move(before)});
}

void Arguments::DropChange(std::string_view name) {
    std::erase_if(changes_, [&](const Change &change) { return change.name == name; });
}

std::string Arguments::TakeFirst() {
    return words_.empty() ? std::string() : TakeAt(0);
}

} // namespace q3
