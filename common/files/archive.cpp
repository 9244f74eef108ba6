// GPL-2.0-or-later. One zip archive (pk3), opened for reading.
#include "common/files/archive.h"

#include "common/error.h"
#include "common/text/text_scan.h"

#include <minizip/unzip.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstring>
#include <memory>
#include <mutex>
#include <system_error>

namespace q3 {

namespace {

constexpr std::uint64_t kMaxEntrySize = 256u << 20;
constexpr std::uint64_t kMaxDeflateRatio = 1032; // no deflate stream can expand further
constexpr std::size_t kMaxName = 255;
constexpr std::size_t kChunk = 1u << 16;
constexpr std::size_t kBlock = 1u << 14;
constexpr std::size_t kHeaderSize = 46; // of an entry in the directory, before its name

/// A file read in blocks: minizip asks for single bytes, and seeks before each few.
class BlockFile {
  public:
    explicit BlockFile(const char *path) : file_(std::fopen(path, "rb")) {
        if (file_)
            std::setvbuf(file_.get(), nullptr, _IONBF, 0);
    }
    bool IsOpen() const { return file_ != nullptr; }
    bool Failed() const { return std::ferror(file_.get()) != 0; }
    std::uint64_t At() const { return at_; }
    /// 0: it went there.
    long Seek(std::uint64_t offset, int origin) {
        if (origin == ZLIB_FILEFUNC_SEEK_CUR) {
            at_ += offset;
        } else if (origin == ZLIB_FILEFUNC_SEEK_END) {
            if (fseeko(file_.get(), 0, SEEK_END) != 0)
                return -1;
            at_ = std::uint64_t(ftello(file_.get())) + offset;
        } else
            at_ = offset;
        return 0;
    }
    /// How many bytes there were.
    std::size_t Read(char *to, std::size_t size) {
        if (size == 1 && at_ >= blockAt_ && at_ < blockAt_ + blockSize_) { // how minizip reads directories
            *to = block_[std::size_t(at_++ - blockAt_)];
            return 1;
        }
        std::size_t done = 0;
        while (done < size) {
            if (at_ < blockAt_ || at_ >= blockAt_ + blockSize_) {
                FillBlock();
                if (at_ >= blockAt_ + blockSize_)
                    break;
            }
            const auto in = std::size_t(at_ - blockAt_);
            const std::size_t count = std::min(size - done, blockSize_ - in);
            std::memcpy(to + done, block_.data() + in, count);
            done += count, at_ += count;
        }
        return done;
    }

  private:
    struct Close {
        void operator()(std::FILE *file) const { std::fclose(file); }
    };
    /// The block that holds at_; blocks are aligned, since minizip also goes backwards.
    void FillBlock() {
        blockAt_ = at_ / kBlock * kBlock, blockSize_ = 0;
        if (blockAt_ <= std::uint64_t(INT64_MAX) && fseeko(file_.get(), off_t(blockAt_), SEEK_SET) == 0)
            blockSize_ = std::fread(block_.data(), 1, block_.size(), file_.get());
    }

    std::unique_ptr<std::FILE, Close> file_;
    std::array<char, kBlock> block_;
    std::size_t blockSize_ = 0;
    std::uint64_t at_ = 0, blockAt_ = 0;
};

BlockFile &Of(void *stream) {
    return *static_cast<BlockFile *>(stream);
}

/// minizip's calls to a BlockFile. Not for writing.
zlib_filefunc64_def BlockFileCalls() {
    zlib_filefunc64_def calls{};
    calls.zopen64_file = [](void *, const void *path, int) -> void * {
        auto file = std::make_unique<BlockFile>(static_cast<const char *>(path));
        return file->IsOpen() ? file.release() : nullptr;
    };
    calls.zread_file = [](void *, void *stream, void *to, uLong size) -> uLong {
        return Of(stream).Read(static_cast<char *>(to), size);
    };
    calls.zwrite_file = [](void *, void *, const void *, uLong) -> uLong { return 0; };
    calls.ztell64_file = [](void *, void *stream) -> ZPOS64_T { return Of(stream).At(); };
    calls.zseek64_file = [](void *, void *stream, ZPOS64_T offset, int origin) -> long {
        return Of(stream).Seek(offset, origin);
    };
    calls.zclose_file = [](void *, void *stream) -> int {
        delete &Of(stream);
        return 0;
    };
    calls.zerror_file = [](void *, void *stream) -> int { return Of(stream).Failed() ? 1 : 0; };
    return calls;
}

struct CloseZip {
    void operator()(void *zip) const { unzClose(zip); }
};
using Zip = std::unique_ptr<void, CloseZip>;

Zip Open(const std::filesystem::path &path) {
    zlib_filefunc64_def calls = BlockFileCalls();
    Zip zip(unzOpen2_64(path.c_str(), &calls));
    if (!zip)
        throw Error("{}: expected a zip archive", path.string());
    return zip;
}

/// The start of an entry in the directory: PKWARE's APPNOTE.TXT, 4.3.12.
struct DirectoryHeader {
    std::uint32_t signature, flags, checksum, packedSize, size, nameSize, extraSize, commentSize, dataAt;

    explicit DirectoryHeader(const std::array<char, kHeaderSize> &bytes)
        : signature(Number<4>(&bytes[0])), flags(Number<2>(&bytes[8])), checksum(Number<4>(&bytes[16])),
          packedSize(Number<4>(&bytes[20])), size(Number<4>(&bytes[24])), nameSize(Number<2>(&bytes[28])),
          extraSize(Number<2>(&bytes[30])), commentSize(Number<2>(&bytes[32])), dataAt(Number<4>(&bytes[42])) {}

    bool IsPlain() const {
        constexpr std::uint32_t kSignature = 0x02014b50, kIsInExtra = 0xFFFFFFFF; // the latter: zip64
        return signature == kSignature && packedSize != kIsInExtra && size != kIsInExtra && dataAt != kIsInExtra;
    }
    std::uint64_t WholeSize() const { return kHeaderSize + nameSize + extraSize + commentSize; }

  private:
    /// Little-endian.
    template <int count> static std::uint32_t Number(const char *at) {
        std::uint32_t number = 0;
        for (int i = 0; i < count; ++i)
            number |= std::uint32_t(static_cast<unsigned char>(at[i])) << (8 * i);
        return number;
    }
};

} // namespace

std::string SafeName(std::string_view name) {
    std::string safe(name);
    for (char &c : safe) {
        if (c == '\\')
            c = '/';
        if (static_cast<unsigned char>(c) < 32 || c == 127 || c == ':')
            return {};
    }
    if (safe.empty() || safe.front() == '/')
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
    entries_.reserve(std::size_t(std::min<std::uint64_t>(global.number_entry, fileSize_ / kHeaderSize)));

    if (!ReadPlainDirectory(global.number_entry)) {
        entries_.clear();
        ReadAnyDirectory();
    }
}

/// minizip needs thousands of instructions a header, but knows all variants and what to say of damage. So this gives up
/// where anything is unusual, also when bytes before the archive move it: then its first header is not in its place.
bool Archive::ReadPlainDirectory(std::uint64_t count) {
    constexpr std::uint64_t kMoreThanPlain = 0xFFFF;
    unz64_file_pos first{};
    unz_file_info64 info{};
    BlockFile file(path_.c_str());
    if (count >= kMoreThanPlain || !file.IsOpen() || unzGetFilePos64(reader_->zip.get(), &first) != UNZ_OK ||
        unzGetCurrentFileInfo64(reader_->zip.get(), &info, nullptr, 0, nullptr, 0, nullptr, 0) != UNZ_OK)
        return false;
    std::uint64_t at = first.pos_in_zip_directory;
    for (std::uint64_t number = 0; number < count; ++number) {
        std::array<char, kHeaderSize> bytes;
        file.Seek(at, ZLIB_FILEFUNC_SEEK_SET);
        if (file.Read(bytes.data(), bytes.size()) != bytes.size())
            return false;
        const DirectoryHeader header(bytes);
        // minizip looks at up to 4 bytes behind a damaged extra field.
        if (!header.IsPlain() || at + header.WholeSize() + 4 > fileSize_ ||
            (number == 0 && (header.checksum != info.crc || header.packedSize != info.compressed_size ||
                             header.size != info.uncompressed_size || header.nameSize != info.size_filename)))
            return false;
        std::array<char, kMaxName> name;
        if (header.nameSize <= kMaxName) {
            if (file.Read(name.data(), header.nameSize) != header.nameSize)
                return false;
            Add(std::string_view(name.data(), header.nameSize),
                {{}, at, number, header.packedSize, header.size, (header.flags & 1) != 0});
        }
        at += header.WholeSize();
    }
    return true;
}

void Archive::ReadAnyDirectory() {
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
    entry.name = SafeName(name);
    if (entry.name.empty() || entry.name.back() == '/')
        return;
    std::string key = LowerCase(entry.name);
    entries_.insert_or_assign(std::move(key), std::move(entry));
}

const Archive::Entry *Archive::Find(std::string_view name) const {
    const auto found = entries_.find(LowerCase(SafeName(name)));
    return found == entries_.end() ? nullptr : &found->second;
}

std::string Archive::Place(const Entry &entry) const {
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
        throw Error("{}: the entry is encrypted, expected plain data", Place(*entry));
    if (entry->size > kMaxEntrySize)
        throw Error("{}: {} bytes, expected at most {}", Place(*entry), entry->size, kMaxEntrySize);
    if (entry->packedSize > fileSize_ || entry->size > (entry->packedSize + 1) * kMaxDeflateRatio)
        throw Error("{}: {} packed bytes cannot hold {} bytes", Place(*entry), entry->packedSize, entry->size);

    const std::lock_guard lock(reader_->mutex);
    const Zip &zip = reader_->zip;
    const unz64_file_pos at{entry->directoryAt, entry->number};
    if (unzGoToFilePos64(zip.get(), &at) != UNZ_OK || unzOpenCurrentFile(zip.get()) != UNZ_OK)
        throw Error("{}: the entry is damaged", Place(*entry));
    std::vector<std::byte> data;
    for (;;) {
        // Grows with what is really there, never by the size that the header claims.
        const std::size_t have = data.size();
        const std::size_t want = std::min<std::size_t>(entry->size - have + 1, std::max(kChunk, have));
        data.resize(have + want);
        const int got = unzReadCurrentFile(zip.get(), data.data() + have, unsigned(want));
        data.resize(have + std::size_t(std::max(got, 0)));
        if (got < 0 || data.size() > entry->size)
            throw Error("{}: the entry is damaged", Place(*entry));
        if (got == 0)
            break;
    }
    if (data.size() != entry->size)
        throw Error("{}: the entry ends after {} of {} bytes", Place(*entry), data.size(), entry->size);
    if (unzCloseCurrentFile(zip.get()) != UNZ_OK)
        throw Error("{}: the checksum of the entry is wrong", Place(*entry));
    return data;
}

} // namespace q3
