// GPL-2.0-or-later. Files of unit results: whole, and checked by hash when they are read.
#include "q3map2/units/unit_file.h"

#include "common/error.h"
#include "common/files/files.h"
#include "q3map2/units/unit_bytes.h"

#include <algorithm>

namespace q3 {

namespace {

constexpr std::array<char, 8> kMagic = {'Q', '3', 'U', 'N', 'I', 'T', 'S', '1'};

/// Appends to a file, and hashes what it appends.
class HashedOutput {
  public:
    explicit HashedOutput(FileReplacement &file) : file_(file) {}
    void Append(std::span<const std::byte> bytes) {
        hash_.Add(bytes);
        file_.Append(bytes);
    }
    Hash128 Hash() const { return hash_.Hash(); }

  private:
    FileReplacement &file_;
    StreamHash hash_;
};

} // namespace

// The magic; the header; for each result its key, size and bytes; the hash of all before.
void WriteUnitFile(const std::filesystem::path &path, const UnitFile &file) {
    FileReplacement replacement(path);
    HashedOutput output(replacement);
    UnitWriter writer;
    const UnitFileHeader &header = file.header;
    writer.Put(kMagic);
    writer.PutText(header.stage);
    writer.PutText(header.text);
    writer.Put(header.inputs);
    writer.Put(header.round);
    writer.Put(header.part.number);
    writer.Put(header.part.count);
    writer.Put(std::uint64_t(file.results.size()));
    output.Append(writer.Take());
    for (const UnitResult &one : file.results) {
        writer.Put(one.key);
        writer.Put(std::uint64_t(one.bytes.size()));
        output.Append(writer.Take());
        output.Append(one.bytes);
    }
    writer.Put(output.Hash());
    replacement.Append(writer.Take());
    replacement.Commit();
}

UnitFile ReadUnitFile(const std::filesystem::path &path) {
    UnitFile file;
    file.storage = MappedFile(path);
    const std::span<const std::byte> bytes = file.storage.Bytes();
    std::array<char, 8> magic{};
    UnitReader head(bytes);
    head.Get(magic);
    if (!head.Fits() || magic != kMagic)
        throw Error("{}: no file of results of this version", path.string());
    Hash128 hash;
    const std::size_t end = bytes.size() - std::min(bytes.size(), sizeof(hash));
    UnitReader(bytes.subspan(end)).Get(hash);
    if (HashOf(bytes.first(end)) != hash)
        throw Error("{}: damaged: its contents do not have the hash that it names", path.string());
    UnitReader reader(bytes.first(end).subspan(std::min(end, sizeof(magic))));
    UnitFileHeader &header = file.header;
    reader.GetText(header.stage);
    reader.GetText(header.text);
    reader.Get(header.inputs);
    reader.Get(header.round);
    reader.Get(header.part.number);
    reader.Get(header.part.count);
    std::uint64_t count = 0;
    reader.Get(count);
    for (std::uint64_t i = 0; i < count && reader.Fits(); ++i) {
        UnitResult &one = file.results.emplace_back();
        reader.Get(one.key);
        reader.GetView(one.bytes);
    }
    if (!reader.IsComplete())
        throw Error("{}: its numbers contradict each other", path.string());
    return file;
}

} // namespace q3
