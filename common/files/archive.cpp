// GPL-2.0-or-later. Zip archives (pk3): reading, and writing entry by entry.
#include "common/files/archive.h"

#include "common/error.h"
#include "common/files/files.h"
#include "common/platform/platform.h"
#include "common/text/text_scan.h"

#include <minizip/unzip.h>
#include <minizip/zip.h>
#include <zlib.h>

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
constexpr std::size_t kLikelyRatio = 8;             ///< most entries of game archives are packed to no less than 1 / 8
constexpr std::size_t kMinEntryBytes = 46;          ///< of a directory entry, without its name
constexpr unsigned long kEncryptedFlag = 1;         ///< of an entry

/// A file for minizip, which reads it in small pieces: the system is asked for kChunk bytes at a time.
struct BufferedFile {
    zlib_filefunc64_def system; ///< functions for `stream`
    voidpf stream;
    std::uint64_t size = 0, at = 0;
    std::uint64_t bufferedFrom = 0;
    std::vector<std::byte> buffer{};

    uLong ReadFrom(std::uint64_t from, void *into, std::size_t bytes) const {
        if (system.zseek64_file(system.opaque, stream, from, ZLIB_FILEFUNC_SEEK_SET) != 0)
            return 0;
        return system.zread_file(system.opaque, stream, into, uLong(bytes));
    }
    bool IsBuffered(std::uint64_t from, std::size_t bytes) const {
        return from >= bufferedFrom && from + bytes <= bufferedFrom + buffer.size();
    }
};

BufferedFile &BufferedOf(voidpf file) {
    return *static_cast<BufferedFile *>(file);
}

/// `name`: a path.
voidpf OpenBuffered(voidpf, const void *name, int) {
    auto file = std::make_unique<BufferedFile>();
    fill_fopen64_filefunc(&file->system);
    file->stream = OpenFile(*static_cast<const std::filesystem::path *>(name), "rb");
    if (file->stream == nullptr)
        return nullptr;
    file->system.zseek64_file(file->system.opaque, file->stream, 0, ZLIB_FILEFUNC_SEEK_END);
    file->size = file->system.ztell64_file(file->system.opaque, file->stream);
    return file.release();
}

uLong ReadBuffered(voidpf, voidpf stream, void *into, uLong bytes) {
    BufferedFile &file = BufferedOf(stream);
    const std::size_t wanted = std::min<std::uint64_t>(bytes, file.size - std::min(file.size, file.at));
    std::size_t got = wanted;
    if (wanted >= kChunk) {
        got = file.ReadFrom(file.at, into, wanted);
    } else if (wanted > 0) {
        if (!file.IsBuffered(file.at, wanted)) {
            // Whole chunks, since minizip looks for the directory backwards.
            file.bufferedFrom = file.at / kChunk * kChunk;
            const std::uint64_t end = (file.at + wanted + kChunk - 1) / kChunk * kChunk;
            file.buffer.resize(std::size_t(std::min(end, file.size) - file.bufferedFrom));
            file.buffer.resize(file.ReadFrom(file.bufferedFrom, file.buffer.data(), file.buffer.size()));
            got = file.IsBuffered(file.at, wanted) ? wanted : 0;
        }
        if (got > 0)
            std::memcpy(into, file.buffer.data() + (file.at - file.bufferedFrom), got);
    }
    file.at += got;
    return uLong(got);
}

ZPOS64_T TellBuffered(voidpf, voidpf stream) {
    return BufferedOf(stream).at;
}

long SeekBuffered(voidpf, voidpf stream, ZPOS64_T offset, int origin) {
    BufferedFile &file = BufferedOf(stream);
    file.at = offset + (origin == ZLIB_FILEFUNC_SEEK_CUR ? file.at : origin == ZLIB_FILEFUNC_SEEK_END ? file.size : 0);
    return 0;
}

int CloseBuffered(voidpf, voidpf stream) {
    const std::unique_ptr<BufferedFile> file(&BufferedOf(stream));
    return file->system.zclose_file(file->system.opaque, file->stream);
}

int ErrorOfBuffered(voidpf, voidpf stream) {
    const BufferedFile &file = BufferedOf(stream);
    return file.system.zerror_file(file.system.opaque, file.stream);
}

struct CloseZip {
    void operator()(void *zip) const { unzClose(zip); }
};
using Zip = std::unique_ptr<void, CloseZip>;

Zip Open(const std::filesystem::path &path) {
    zlib_filefunc64_def functions{};
    functions.zopen64_file = OpenBuffered;
    functions.zread_file = ReadBuffered;
    functions.ztell64_file = TellBuffered;
    functions.zseek64_file = SeekBuffered;
    functions.zclose_file = CloseBuffered;
    functions.zerror_file = ErrorOfBuffered;
    Zip zip(unzOpen2_64(&path, &functions));
    if (!zip)
        throw Error("{}: expected a zip archive", path.string());
    return zip;
}

/// Replaces the deflated bytes by their contents, or by the first `size` bytes of them. False: damaged.
bool Inflate(std::vector<std::byte> &bytes, std::size_t size) {
    constexpr int kNoHeader = -MAX_WBITS;
    z_stream stream{};
    stream.next_in = reinterpret_cast<Bytef *>(bytes.data());
    stream.avail_in = uInt(bytes.size());
    if (inflateInit2(&stream, kNoHeader) != Z_OK)
        throw std::bad_alloc();
    const std::unique_ptr<z_stream, int (*)(z_stream *)> end(&stream, inflateEnd);
    // Grows with the contents, as the size in the header may be false.
    std::vector<std::byte> contents;
    int result = Z_OK;
    while (result == Z_OK && contents.size() < size) {
        const std::size_t have = contents.size(), likely = kLikelyRatio * bytes.size();
        contents.resize(std::min(size, std::max({kChunk, likely, 2 * have})));
        stream.next_out = reinterpret_cast<Bytef *>(contents.data() + have);
        stream.avail_out = uInt(contents.size() - have);
        result = inflate(&stream, Z_NO_FLUSH);
        contents.resize(contents.size() - stream.avail_out);
    }
    bytes = std::move(contents);
    return result == Z_OK || result == Z_STREAM_END;
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

/// Only this part of reading an entry needs the file.
Archive::PackedEntry Archive::ReadPacked(const Entry &entry) const {
    constexpr int kRaw = 1; // as stored, without inflating
    const std::lock_guard lock(reader_->mutex);
    const Zip &zip = reader_->zip;
    const unz64_file_pos at{entry.directoryAt, entry.number};
    PackedEntry packed;
    int level = 0;
    if (unzGoToFilePos64(zip.get(), &at) != UNZ_OK ||
        unzOpenCurrentFile2(zip.get(), &packed.method, &level, kRaw) != UNZ_OK ||
        (packed.method != 0 && packed.method != Z_DEFLATED))
        throw Error("{}: the entry is damaged", Location(entry));
    packed.bytes.resize(std::size_t(entry.packedSize));
    const int got = unzReadCurrentFile(zip.get(), packed.bytes.data(), unsigned(packed.bytes.size()));
    if (got < 0 || std::size_t(got) != packed.bytes.size())
        throw Error("{}: the entry is damaged", Location(entry));
    return packed;
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

    PackedEntry packed = ReadPacked(*entry);
    std::vector<std::byte> data = std::move(packed.bytes);
    if (packed.method == Z_DEFLATED && !Inflate(data, std::size_t(entry->size)))
        throw Error("{}: the entry is damaged", Location(*entry));
    if (data.size() != entry->size)
        throw Error("{}: the entry ends after {} of {} bytes", Location(*entry), data.size(), entry->size);
    if (crc32_z(0, reinterpret_cast<const Bytef *>(data.data()), data.size()) != entry->checksum)
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

} // namespace q3
