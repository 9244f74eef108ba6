// GPL-2.0-or-later. Zip archives (pk3): reading, and writing entry by entry.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

namespace q3 {

/// Stands between the path of an archive and the name of an entry where a location is printed.
inline constexpr std::string_view kInArchive = " :: ";

/// One open archive: its directory in memory, contents read on demand. Safe for concurrent reads, which take turns only
/// at the file.
class Archive {
  public:
    /// Reads the directory. Error: missing, not an archive, or damaged.
    explicit Archive(std::filesystem::path path);
    ~Archive();
    Archive(Archive &&) noexcept;

    /// Names are case-insensitive, with '/'. Entries with unsafe names (absolute, "..", control bytes, over 255
    /// bytes) are not in the directory; of two equal names the last counts.
    bool Contains(std::string_view name) const { return Find(name) != nullptr; }
    /// Contents of an entry. Error: absent, damaged, encrypted, or over 256 MiB.
    std::vector<std::byte> Read(std::string_view name) const;
    /// Checksum and size of an entry's contents as the directory states them; 0: there is no such entry.
    std::uint64_t ChecksumOf(std::string_view name) const;
    /// All names as stored, in unspecified order.
    std::vector<std::string> Names() const;
    const std::filesystem::path &Path() const { return path_; }

  private:
    struct Entry {
        std::string name;
        std::uint64_t directoryAt, number; ///< position of the entry, for unzGoToFilePos64
        std::uint64_t packedSize, size;
        std::uint32_t checksum; ///< CRC-32 of the contents
        bool isEncrypted;
    };

    struct Reader;

    struct PackedEntry {
        int method = 0; ///< as the zip format numbers them
        std::vector<std::byte> bytes;
    };

    void ReadDirectory();
    PackedEntry ReadPacked(const Entry &entry) const;
    void Add(std::string_view name, Entry entry);
    const Entry *Find(std::string_view name) const;
    /// "archive.pk3 :: inner name", for messages.
    std::string Location(const Entry &entry) const;

    std::filesystem::path path_;
    std::uint64_t fileSize_ = 0;
    std::unique_ptr<Reader> reader_;
    std::unordered_map<std::string, Entry> entries_; ///< by lower-case name
};

/// The name as engines look it up: backslashes become slashes; leading, trailing and repeated slashes and folders "."
/// are removed.
std::string PlainName(std::string_view name);

/// PlainName; a name that could lead out of the game folders, or that holds control bytes, becomes empty.
std::string SafeName(std::string_view name);

/// An archive in memory. The same entries in the same order give the same bytes: every entry has the date 1980-01-01,
/// the first that zip knows.
class ArchiveWriter {
  public:
    /// zlib's levels: -1 its own choice, 0 stored as it is, 1 fast to 9 small.
    explicit ArchiveWriter(int level);
    ~ArchiveWriter();
    ArchiveWriter(const ArchiveWriter &) = delete;
    ArchiveWriter &operator=(const ArchiveWriter &) = delete;

    void Add(std::string_view name, std::span<const std::byte> data);
    /// The finished archive. To be called once, as the last call.
    std::vector<std::byte> Finish();

  private:
    struct State;
    std::unique_ptr<State> state_;
};

} // namespace q3
