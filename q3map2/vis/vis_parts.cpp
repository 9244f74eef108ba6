// GPL-2.0-or-later. Portal visibility in parts on several machines.
#include "q3map2/vis/vis_parts.h"

#include "q3map2/units/unit_bytes.h"

#include <algorithm>

namespace q3 {

namespace {

/// Most words of rows are zero: the others are stored with their place.
class WordList {
  public:
    explicit WordList(std::span<const BitWord> dense) {
        for (std::size_t i = 0; i < dense.size(); ++i)
            Add(i, dense[i]);
    }
    explicit WordList(const SparseBits &row) {
        row.ForEachWord([&](std::size_t i, BitWord word) { Add(i, word); });
    }
    void Put(UnitWriter &writer) const {
        writer.PutAll(places_);
        writer.PutAll(words_);
    }
    /// `row` must be zero. False: damaged, or a bit is set where no portal has its column.
    static bool Get(UnitReader &reader, const VisMap &map, std::span<BitWord> row) {
        std::vector<std::uint32_t> places;
        std::vector<BitWord> words;
        reader.GetAll(places);
        reader.GetAll(words);
        if (!reader.Fits() || places.size() != words.size())
            return false;
        for (std::size_t i = 0; i < places.size(); ++i) {
            if (places[i] >= row.size())
                return false;
            row[places[i]] = words[i];
        }
        bool hasPortals = true;
        ForEachBit(row, [&](std::size_t column) { hasPortals &= map.HasPortal(column); });
        return hasPortals;
    }
    static bool GetRows(UnitReader &reader, const VisMap &map, SparseBitTable &rows) {
        std::vector<BitWord> dense(map.Words());
        for (std::size_t row = 0; row < rows.NumRows(); ++row) {
            std::ranges::fill(dense, BitWord(0));
            if (!Get(reader, map, dense))
                return false;
            rows.Set(row, dense);
        }
        return true;
    }

  private:
    void Add(std::size_t place, BitWord word) {
        if (word != 0)
            places_.push_back(std::uint32_t(place)), words_.push_back(word);
    }

    std::vector<std::uint32_t> places_;
    std::vector<BitWord> words_;
};

Hash128 KeyOfRow(VisUnits::Row kind, std::size_t portal) {
    KeyBuilder key("vis row");
    key.Add(kind, std::uint64_t(portal));
    return key.Key();
}

Hash128 KeyOfPassages(std::size_t portal) {
    KeyBuilder key("vis passages");
    key.Add(std::uint64_t(portal));
    return key.Key();
}

Hash128 KeyOfState(std::string_view part) {
    KeyBuilder key("vis state");
    key.AddText(part);
    return key.Key();
}

} // namespace

void VisUnits::Keep(Row kind, std::size_t portal, std::span<const BitWord> words) const {
    UnitWriter writer;
    WordList(words).Put(writer);
    units_->Keep(KeyOfRow(kind, portal), writer.Take());
}

bool VisUnits::Find(Row kind, std::size_t portal, std::span<BitWord> words) const {
    const auto bytes = units_ ? units_->Find(KeyOfRow(kind, portal)) : std::nullopt;
    if (!bytes)
        return false;
    std::ranges::fill(words, BitWord(0));
    UnitReader reader(*bytes);
    return WordList::Get(reader, *map_, words);
}

void VisUnits::KeepPassages(std::size_t portal, std::span<const BitWord> rows) const {
    UnitWriter writer;
    for (std::size_t first = 0; first < rows.size(); first += map_->Words())
        WordList(rows.subspan(first, map_->Words())).Put(writer);
    units_->Keep(KeyOfPassages(portal), writer.Take());
}

bool VisUnits::FindPassages(std::size_t portal, std::span<BitWord> rows) const {
    const auto bytes = units_ ? units_->Find(KeyOfPassages(portal)) : std::nullopt;
    if (!bytes)
        return false;
    std::ranges::fill(rows, BitWord(0));
    UnitReader reader(*bytes);
    for (std::size_t first = 0; first < rows.size(); first += map_->Words())
        if (!WordList::Get(reader, *map_, rows.subspan(first, map_->Words())))
            return false;
    return true;
}

void VisUnits::KeepState(const MightSeeTable &mightSee, const Passages *passages) const {
    UnitWriter seen, through;
    for (std::size_t p = 0; p < mightSee.NumRows(); ++p)
        WordList(mightSee[p]).Put(seen);
    through.Put(std::uint8_t(passages != nullptr));
    through.Put(std::uint64_t(passages ? passages->NumMade() : 0));
    for (std::size_t row = 0; passages && row < passages->Rows().NumRows(); ++row)
        WordList(passages->Rows()[row]).Put(through);
    units_->Clear();
    units_->Keep(KeyOfState("might see"), seen.Take());
    units_->Keep(KeyOfState("passages"), through.Take());
}

bool VisUnits::FindState(MightSeeTable &mightSee, std::optional<Passages> &passages) const {
    const auto seen = units_ ? units_->Find(KeyOfState("might see")) : std::nullopt,
               through = units_ ? units_->Find(KeyOfState("passages")) : std::nullopt;
    if (!seen || !through)
        return false;
    UnitReader seenReader(*seen), throughReader(*through);
    if (!WordList::GetRows(seenReader, *map_, mightSee))
        return false;
    std::uint8_t hasPassages = 0;
    std::uint64_t made = 0;
    throughReader.Get(hasPassages);
    throughReader.Get(made);
    SparseBitTable rows(made != 0 ? Passages::NumRows(*map_) : 0);
    if (!throughReader.Fits() || made > map_->NumPortals() || !WordList::GetRows(throughReader, *map_, rows))
        return false;
    if (hasPassages != 0)
        passages.emplace(*map_, std::move(rows), std::size_t(made));
    return true;
}

} // namespace q3
