// GPL-2.0-or-later. One zip archive (pk3), opened for reading.
#include "common/files/archive.h"

#include "common/error.h"
#include "common/files/files.h"
#include "common/platform/platform.h"
#include "common/text/text_scan.h"

#include <minizip/unzip.h>

#include <algorithm>
#include <array>
#include <memory>
#include <mutex>
#include <system_error>

namespace q3 {

namespace {

constexpr std::uint64_t kMaxEntrySize = 256u << 20;
constexpr std::size_t kMaxName = 255;
constexpr std::size_t kChunk = 1u << 16;
constexpr std::size_t kMinEntryBytes = 46; // size of a directory entry without its name

struct CloseZip {
    void operator()(void *zip) const { unzClose(zip); }
};
using Zip = std::unique_ptr<void, CloseZip>;

Zip Open(const std::filesystem::path &path) {
    zlib_filefunc64_def functions{};
    fill_fopen64_filefunc(&functions);
    functions.zopen64_file = [](voidpf, const void *name, int) -> voidpf {
        return OpenFile(*static_cast<const std::filesystem::path *>(name), "rb");
    };
    Zip zip(unzOpen2_64(&path, &functions));
    if (!zip)
        throw Error("{}: expected a zip archive", path.string());
    return zip;
}

} // namespace

std::string PlainName(std::string_view name) {
    std::string plain;
    for (std::size_t begin = 0; begin <= name.size();) {
        const std::size_t end = std::min(name.find_first_of("/\\", begin), name.size());
        const std::string_view part = name.substr(begin, end - begin);
        if (!part.empty() && part != ".") {
            plain += plain.empty() ? "" : "/";
            plain += part;
        }
        begin = end + 1;
    }
    return plain;
}

std::string SafeName(std::string_view name) {
    std::string safe = PlainName(name);
    for (const char c : safe)
        if (static_cast<unsigned char>(c) < 32 || c == 127 || c == ':')
            return {};
    for (std::size_t up = safe.find(".."); up != std::string::npos; up = safe.find("..", up + 1))
        if ((up == 0 || safe[up - 1] == '/') && (up + 2 == safe.size() || safe[up + 2] == '/'))
            return {};
    return safe;
}

struct Archive::Reader {
    std::mutex mutex;
    Zip zip;
};

Archive::~Archive() = default;
Archive::Archive(Archive &&) noexcept = default;

Archive::Archive(std::filesystem::path path) : path_(std::move(path)), reader_(std::make_unique<Reader>()) {
    // A pipe or a device of that name would block.
    if (!std::filesystem::is_regular_file(path_))
        throw Error("{}: expected a zip archive, found no regular file", path_.string());
    fileSize_ = std::filesystem::file_size(path_);
    reader_->zip = Open(path_);
    const Zip &zip = reader_->zip;
    unz_global_info64 global{};
    if (unzGetGlobalInfo64(zip.get(), &global) != UNZ_OK)
        throw Error("{}: the directory of the archive is damaged", path_.string());
    if (global.number_entry == 0)
        return;
    entries_.reserve(std::size_t(std::min<std::uint64_t>(global.number_entry, fileSize_ / kMinEntryBytes)));
    ReadDirectory();
}

void Archive::ReadDirectory() {
    const Zip &zip = reader_->zip;
    int result = unzGoToFirstFile(zip.get());
    for (; result == UNZ_OK; result = unzGoToNextFile(zip.get())) {
        unz_file_info64 info{};
        std::array<char, kMaxName + 1> buffer{};
        unz64_file_pos at{};
        if (unzGetCurrentFileInfo64(zip.get(), &info, buffer.data(), kMaxName, nullptr, 0, nullptr, 0) != UNZ_OK ||
            unzGetFilePos64(zip.get(), &at) != UNZ_OK)
            break;
        if (info.size_filename <= kMaxName)
            Add(std::string_view(buffer.data(), info.size_filename), {{},
                                                                      at.pos_in_zip_directory,
                                                                      at.num_of_file,
                                                                      info.compressed_size,
                                                                      info.uncompressed_size,
                                                                      (info.flag & 1) != 0});
    }
    if (result != UNZ_END_OF_LIST_OF_FILE)
        throw Error("{}: the directory of the archive is damaged after {} entries", path_.string(), entries_.size());
}

void Archive::Add(std::string_view name, Entry entry) {
    const auto isSlash = [](char c) { return c == '/' || c == '\\'; };
    if (name.empty() || isSlash(name.front()) || isSlash(name.back())) // absolute, or a folder
        return;
    entry.name = SafeName(name);
    if (entry.name.empty())
        return;
    std::string key = LowerCase(entry.name);
    entries_.insert_or_assign(std::move(key), std::move(entry));
}

const Archive::Entry *Archive::Find(std::string_view name) const {
    const auto found = entries_.find(LowerCase(SafeName(name)));
    return found == entries_.end() ? nullptr : &found->second;
}

std::string Archive::Location(const Entry &entry) const {
    return fmt::format("{} :: {}", path_.string(), entry.name);
}

std::vector<std::string> Archive::Names() const {
    std::vector<std::string> names;
    names.reserve(entries_.size());
    for (const auto &[key, entry] : entries_)
        names.push_back(entry.name);
    return names;
}

std::vector<std::byte> Archive::Read(std::string_view name) const {
    const Entry *entry = Find(name);
    if (!entry)
        throw Error("{}: expected an entry {}", path_.string(), name);
    if (entry->encrypted)
        throw Error("{}: the entry is encrypted, expected plain data", Location(*entry));
    if (entry->size > kMaxEntrySize)
        throw Error("{}: {} bytes, expected at most {}", Location(*entry), entry->size, kMaxEntrySize);
    if (entry->packedSize > fileSize_ || entry->size > (entry->packedSize + 1) * kMaxDeflateRatio)
        throw Error("{}: {} packed bytes cannot hold {} bytes", Location(*entry), entry->packedSize, entry->size);

    const std::lock_guard lock(reader_->mutex);
    const Zip &zip = reader_->zip;
    const unz64_file_pos at{entry->directoryAt, entry->number};
    if (unzGoToFilePos64(zip.get(), &at) != UNZ_OK || unzOpenCurrentFile(zip.get()) != UNZ_OK)
        throw Error("{}: the entry is damaged", Location(*entry));
    std::vector<std::byte> data;
    for (;;) {
        // Grows with the bytes read, as the size in the header may be false.
        const std::size_t have = data.size();
        const std::size_t want = std::min<std::size_t>(entry->size - have + 1, std::max(kChunk, have));
        data.resize(have + want);
        const int got = unzReadCurrentFile(zip.get(), data.data() + have, unsigned(want));
        data.resize(have + std::size_t(std::max(got, 0)));
        if (got < 0 || data.size() > entry->size)
            throw Error("{}: the entry is damaged", Location(*entry));
        if (got == 0)
            break;
    }
    if (data.size() != entry->size)
        throw Error("{}: the entry ends after {} of {} bytes", Location(*entry), data.size(), entry->size);
    if (unzCloseCurrentFile(zip.get()) != UNZ_OK)
        throw Error("{}: the checksum of the entry is wrong", Location(*entry));
    return data;
}

} // namespace q3
