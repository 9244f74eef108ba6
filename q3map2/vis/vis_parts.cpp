// GPL-2.0-or-later. Portal visibility in parts on several machines.
#include "q3map2/vis/vis_parts.h"

#include "q3map2/units/unit_bytes.h"

#include <algorithm>

namespace q3 {

namespace {

/// Most words of rows are zero: the others are stored with their index.
std::vector<std::byte> BytesOfWords(std::span<const BitWord> words) {
    std::vector<std::uint32_t> indices;
    std::vector<BitWord> values;
    for (std::size_t i = 0; i < words.size(); ++i)
        if (words[i] != 0)
            indices.push_back(std::uint32_t(i)), values.push_back(words[i]);
    UnitWriter writer;
    writer.PutAll(indices);
    writer.PutAll(values);
    return writer.Take();
}

/// words: zero. They are rows of that many portals; bits beyond the last one do not fit.
bool ReadWords(UnitReader &reader, std::size_t portals, std::span<BitWord> words) {
    const std::size_t perRow = WordsOf(portals);
    const BitWord last = portals % kBitsPerWord == 0 ? ~BitWord(0) : (BitWord(1) << portals % kBitsPerWord) - 1;
    std::vector<std::uint32_t> indices;
    std::vector<BitWord> values;
    reader.GetAll(indices);
    reader.GetAll(values);
    if (!reader.Fits() || indices.size() != values.size())
        return false;
    for (std::size_t i = 0; i < indices.size(); ++i) {
        if (indices[i] >= words.size() || (indices[i] % perRow == perRow - 1 && (values[i] & ~last) != 0))
            return false;
        words[indices[i]] = values[i];
    }
    return true;
}

Hash128 KeyOfRow(VisUnits::Row kind, std::size_t portal) {
    KeyBuilder key("vis row");
    key.Add(kind, std::uint64_t(portal));
    return key.Key();
}

Hash128 KeyOfState(std::string_view part) {
    KeyBuilder key("vis state");
    key.AddText(part);
    return key.Key();
}

} // namespace

void VisUnits::Keep(Row kind, std::size_t portal, std::span<const BitWord> words) const {
    units_->Keep(KeyOfRow(kind, portal), BytesOfWords(words));
}

bool VisUnits::Find(Row kind, std::size_t portal, std::span<BitWord> words) const {
    const auto bytes = units_ ? units_->Find(KeyOfRow(kind, portal)) : std::nullopt;
    if (!bytes)
        return false;
    std::ranges::fill(words, BitWord(0));
    UnitReader reader(*bytes);
    return ReadWords(reader, portals_, words);
}

void VisUnits::KeepState(std::span<const BitWord> mightSee, std::span<const BitWord> passages) const {
    units_->Clear();
    units_->Keep(KeyOfState("might see"), BytesOfWords(mightSee));
    units_->Keep(KeyOfState("passages"), BytesOfWords(passages));
}

bool VisUnits::FindState(std::span<BitWord> mightSee, std::span<BitWord> passages) const {
    const auto seen = units_ ? units_->Find(KeyOfState("might see")) : std::nullopt,
               through = units_ ? units_->Find(KeyOfState("passages")) : std::nullopt;
    if (!seen || !through)
        return false;
    std::ranges::fill(mightSee, BitWord(0));
    std::ranges::fill(passages, BitWord(0));
    UnitReader seenReader(*seen), throughReader(*through);
    return ReadWords(seenReader, portals_, mightSee) && ReadWords(throughReader, portals_, passages);
}

} // namespace q3
