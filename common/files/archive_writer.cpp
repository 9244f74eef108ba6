// GPL-2.0-or-later. A zip archive (pk3), made entry by entry.
#include "common/files/archive_writer.h"

#include "common/error.h"
#include "common/files/files.h"

#include <minizip/zip.h>

#include <algorithm>
#include <cstring>
#include <new>
#include <string>
#include <utility>
#include <vector>

namespace q3 {

namespace {

/// 1980-01-01, 00:00: year - 1980, month and day in 7, 4 and 5 bits, then the time in 16.
constexpr unsigned long kFirstDate = (0UL << 9 | 1UL << 5 | 1UL) << 16;
constexpr std::size_t kMostAtOnce = std::size_t(1) << 30;
constexpr std::size_t kZip64From = 0xffffffffu;

/// What minizip takes for a file.
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
