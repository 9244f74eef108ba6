// GPL-2.0-or-later. Zip archives (pk3): reading, and writing entry by entry.
#include "common/files/archive.h"

#include "common/error.h"
#include "common/files/files.h"
#include "common/platform/platform.h"
#include "common/text/text_scan.h"

#include <minizip/unzip.h>
#include <minizip/zip.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <memory>
#include <mutex>
#include <new>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

namespace q3 {

// ---- One zip archive (pk3), opened for reading ----

namespace {

constexpr std::uint64_t kMaxEntrySize = 256u << 20; ///< bytes; chosen
constexpr std::size_t kMaxName = 255;               ///< bytes of a name with its folders; chosen
constexpr std::size_t kChunk = 1u << 16;            ///< bytes that are unpacked at once, at least
constexpr std::size_t kMinEntryBytes = 46;          ///< of a directory entry, without its name
constexpr unsigned long kEncryptedFlag = 1;         ///< of an entry

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
                                                                      std::uint32_t(info.crc),
                                                                      (info.flag & kEncryptedFlag) != 0});
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
    return fmt::format("{}{}{}", path_.string(), kInArchive, entry.name);
}

std::uint64_t Archive::ChecksumOf(std::string_view name) const {
    const Entry *entry = Find(name);
    return entry ? std::uint64_t(entry->checksum) << 32 ^ entry->size : 0;
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
    if (entry->isEncrypted)
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

// ---- A zip archive (pk3), made entry by entry ----

namespace {

/// 1980-01-01, 00:00: year - 1980, month and day in 7, 4 and 5 bits, then the time in 16.
constexpr unsigned long kFirstDate = (0UL << 9 | 1UL << 5 | 1UL) << 16;
constexpr std::size_t kMostAtOnce = std::size_t(1) << 30; ///< bytes given to minizip, which counts in unsigned
constexpr std::size_t kZip64From = 0xffffffffu;           ///< bytes of an entry whose sizes need 64 bits

/// What minizip takes for a file. The functions that follow are its zlib_filefunc64_def.
struct MemoryFile {
    std::vector<std::byte> bytes;
    std::size_t at = 0;
};

MemoryFile &FileOf(voidpf file) {
    return *static_cast<MemoryFile *>(file);
}

voidpf OpenMemory(voidpf file, const void *, int) {
    return file;
}

uLong ReadMemory(voidpf, voidpf stream, void *into, uLong size) {
    MemoryFile &file = FileOf(stream);
    const std::size_t got = std::min<std::size_t>(size, file.bytes.size() - file.at);
    std::memcpy(into, file.bytes.data() + file.at, got);
    file.at += got;
    return uLong(got);
}

uLong WriteMemory(voidpf, voidpf stream, const void *from, uLong size) {
    MemoryFile &file = FileOf(stream);
    try { // no exception may pass through minizip, which is C
        if (file.bytes.size() < file.at + size)
            file.bytes.resize(file.at + size);
    } catch (const std::bad_alloc &) {
        return 0;
    }
    std::memcpy(file.bytes.data() + file.at, from, size);
    file.at += size;
    return size;
}

ZPOS64_T TellMemory(voidpf, voidpf stream) {
    return FileOf(stream).at;
}

long SeekMemory(voidpf, voidpf stream, ZPOS64_T offset, int origin) {
    MemoryFile &file = FileOf(stream);
    const std::size_t base = origin == ZLIB_FILEFUNC_SEEK_CUR   ? file.at
                             : origin == ZLIB_FILEFUNC_SEEK_END ? file.bytes.size()
                                                                : 0;
    if (base + offset > file.bytes.size())
        return -1;
    file.at = base + std::size_t(offset);
    return 0;
}

int CloseMemory(voidpf, voidpf) {
    return 0;
}

int NoError(voidpf, voidpf) {
    return 0;
}

} // namespace

struct ArchiveWriter::State {
    int level = 0;
    MemoryFile file{};
    zipFile zip = nullptr;

    static void Check(bool good, std::string_view entry) {
        if (!good)
            throw Error("cannot add {} to an archive", entry);
    }
};

ArchiveWriter::ArchiveWriter(int level) : state_(new State{.level = level}) {
    zlib_filefunc64_def functions{};
    functions.zopen64_file = OpenMemory;
    functions.zread_file = ReadMemory;
    functions.zwrite_file = WriteMemory;
    functions.ztell64_file = TellMemory;
    functions.zseek64_file = SeekMemory;
    functions.zclose_file = CloseMemory;
    functions.zerror_file = NoError;
    functions.opaque = &state_->file;
    state_->zip = zipOpen2_64(&state_->file, APPEND_STATUS_CREATE, nullptr, &functions);
    if (state_->zip == nullptr)
        throw Error("cannot begin an archive");
}

ArchiveWriter::~ArchiveWriter() {
    if (state_->zip != nullptr)
        zipClose(state_->zip, nullptr);
}

void ArchiveWriter::Add(std::string_view name, std::span<const std::byte> data) {
    zip_fileinfo info{};
    info.dosDate = kFirstDate;
    const int method = state_->level == 0 ? 0 : Z_DEFLATED;
    const int zip64 = data.size() >= kZip64From ? 1 : 0;
    State::Check(zipOpenNewFileInZip64(state_->zip, std::string(name).c_str(), &info, nullptr, 0, nullptr, 0, nullptr,
                                       method, state_->level, zip64) == ZIP_OK,
                 name);
    for (std::size_t at = 0; at < data.size(); at += kMostAtOnce) {
        const std::size_t size = std::min(kMostAtOnce, data.size() - at);
        State::Check(zipWriteInFileInZip(state_->zip, data.data() + at, unsigned(size)) == ZIP_OK, name);
    }
    State::Check(zipCloseFileInZip(state_->zip) == ZIP_OK, name);
}

std::vector<std::byte> ArchiveWriter::Finish() {
    const int result = zipClose(std::exchange(state_->zip, nullptr), nullptr);
    State::Check(result == ZIP_OK, "the directory");
    return std::move(state_->file.bytes);
}

std::uint64_t ArchiveWriter::Commit(const std::filesystem::path &path) {
    const std::vector<std::byte> bytes = Finish();
    ReplaceFile(path, bytes);
    return bytes.size();
}

} // namespace q3
