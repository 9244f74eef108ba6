// GPL-2.0-or-later. Fuzz target units: binary files of results (-part, -join, -cache), events of a run, and bot files.
#include "common/files/files.h"
#include "q3map2/edit/bot_files.h"
#include "q3map2/stages/run_events.h"
#include "q3map2/units/unit_bytes.h"
#include "q3map2/units/unit_file.h"
#include "tests/fuzz/fuzz_target.h"

namespace q3::fuzz {
namespace {

using Bytes = std::span<const std::byte>;

// ---- Files of results ----

/// The bytes with the magic of the file in front and their hash behind them, without which nothing is read.
std::vector<std::byte> Sealed(Bytes bytes) {
    const Bytes magic = std::as_bytes(std::span("Q3UNITS1", 8));
    std::vector<std::byte> file(magic.begin(), magic.end());
    file.insert(file.end(), bytes.begin(), bytes.end());
    const Hash128 hash = HashOf(Bytes(file));
    const Bytes end = std::as_bytes(std::span(&hash, 1));
    file.insert(file.end(), end.begin(), end.end());
    return file;
}

void ReadResults(Bytes bytes) {
    const ScratchFolder folder;
    Accepts([&] { ReadUnitFile(folder.Write("plain", bytes)); });
    const std::vector<std::byte> sealed = Sealed(bytes);
    UnitFile file;
    if (!Accepts([&] { file = ReadUnitFile(folder.Write("sealed", sealed)); }))
        return;
    MustSucceed("a written file of results", [&] {
        WriteUnitFile(folder.Path() / "again", file);
        Require(ReadFile(folder.Path() / "again") == sealed, "a file of results changes when it is written");
    });
    UnitStore store(UnitStore::Purpose::Cache);
    store.Load(file.results, {}, file.header.inputs);
    Accepts([&] {
        store.Begin(file.header.inputs);
        for (const UnitResult &one : file.results)
            store.Find(one.key);
        Require(store.Used().size() <= file.results.size(), "more results than were loaded");
    });
}

/// Values of all kinds, as the readers of kept results take them.
void ReadValues(Bytes bytes) {
    UnitReader reader(bytes);
    std::vector<std::string> texts;
    std::vector<std::array<float, 3>> points;
    Bytes view;
    reader.GetTexts(texts);
    reader.GetAll(points);
    reader.GetView(view);
    if (!reader.IsComplete())
        return;
    UnitWriter writer;
    writer.PutTexts(texts);
    writer.PutAll(points);
    writer.PutAll(view);
    Require(std::ranges::equal(writer.Take(), bytes), "values change when they are written");
}

void ReplayEvents(Bytes bytes) {
    SilentLog log;
    Accepts([&] { RunEvents::Replay(bytes, log); });
}

// ---- Bot files ----

void ReadBotFile(Bytes bytes) {
    const ScratchFolder folder;
    const std::filesystem::path path = folder.Write("x.aas", bytes);
    std::vector<BotFile> found;
    if (!Accepts([&] { found = FindBotFiles(folder.Path() / "x.bsp"); }))
        return;
    MustSucceed("a new checksum", [&] {
        Require(found.size() == 1 && found[0].checksum == ChecksumIn(bytes, path), "another checksum");
        SetChecksum(found[0], 0x12345678);
        Require(ChecksumIn(ReadFile(path), path) == 0x12345678, "the new checksum is not there");
        SetChecksum(found[0], found[0].checksum);
        Require(std::ranges::equal(ReadFile(path), bytes), "a bot file changes");
    });
}

} // namespace
} // namespace q3::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t *data, std::size_t size) {
    using namespace q3::fuzz;
    constexpr void (*kReaders[])(Bytes) = {ReadResults, ReadValues, ReplayEvents, ReadBotFile};
    Input input(data, size);
    kReaders[input.Choose(std::size(kReaders))](input.Rest());
    return 0;
}
