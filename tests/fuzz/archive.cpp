// GPL-2.0-or-later. Fuzz target archive: pk3 archives, their directory and all entries, alone and as game files. What
// is read is archived again and reads equal.
#include "common/files/archive.h"
#include "common/files/vfs.h"
#include "tests/fuzz/fuzz_target.h"

#include <map>

namespace q3::fuzz {
namespace {

/// Bytes of contents that one input may expand to: a deflate stream of a few KB expands to MB.
constexpr std::size_t kMaxContents = 32 << 20;

using Contents = std::map<std::string, std::vector<std::byte>>;

/// What can be read, by name.
Contents AllContents(const Archive &archive) {
    Contents contents;
    std::size_t total = 0;
    for (const std::string &name : archive.Names()) {
        Require(archive.Contains(name) && !SafeName(name).empty(), "a name that is not in the directory");
        archive.ChecksumOf(name);
        std::vector<std::byte> bytes;
        if (total < kMaxContents && Accepts([&] { bytes = archive.Read(name); })) {
            total += bytes.size();
            contents[name] = std::move(bytes);
        }
    }
    return contents;
}

void ArchiveAgain(const Contents &contents, const ScratchFolder &folder) {
    MustSucceed("a written archive", [&] {
        ArchiveWriter writer(1);
        for (const auto &[name, bytes] : contents)
            writer.Add(name, bytes);
        const std::filesystem::path path = folder.Write("again.pk3", writer.Finish());
        const Archive again(path);
        Require(again.Names().size() == contents.size(), "another number of entries");
        for (const auto &[name, bytes] : contents)
            Require(again.Read(name) == bytes, "an entry changes when it is written and read");
    });
}

void AsGameFiles(const std::filesystem::path &folder, const Contents &contents) {
    SilentLog log;
    VirtualFileSystem files(log);
    Accepts([&] { files.Mount(folder, "pk3"); });
    for (const auto &[name, bytes] : contents)
        files.Exists(name), files.Location(name);
    for (const std::string_view folderName : {"", "scripts", "a"})
        for (const std::string &name : files.List(folderName, ".shader"))
            files.Exists(name);
}

} // namespace
} // namespace q3::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t *data, std::size_t size) {
    using namespace q3::fuzz;
    ScratchFolder folder;
    const std::filesystem::path path = folder.Write("game/x.pk3", Input(data, size).Rest());
    Contents contents;
    // minizip opens no archive without entries.
    if (Accepts([&] { contents = AllContents(q3::Archive(path)); }) && !contents.empty())
        ArchiveAgain(contents, folder);
    AsGameFiles(folder.Path() / "game", contents);
    return 0;
}
