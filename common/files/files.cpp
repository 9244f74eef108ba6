// GPL-2.0-or-later. Files: reading, and safe replacement.
#include "common/files/files.h"

#include "common/error.h"
#include "common/log.h"
#include "common/platform/posix_names.h"
#include "common/text/text.h"

#include <glib/gstdio.h>

#include <algorithm>
#include <cerrno>
#include <glib.h>
#include <system_error>
#include <utility>

namespace q3 {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t kRandomLetters = 6; ///< in names of unfinished files

std::string Reason(int number) {
    return std::generic_category().message(number);
}

/// The file that a chain of symbolic links ends at, so that the file is replaced and not the link.
fs::path BehindLinks(fs::path path) {
    constexpr int kMaxLinks = 40; // as Linux has it
    for (int i = 0; i < kMaxLinks; i++) {
        std::error_code notALink;
        const fs::path next = fs::read_symlink(path, notALink);
        if (notALink)
            return path;
        path = next.is_absolute() ? next : path.parent_path() / next;
    }
    throw Error("{}: cannot write: more than {} symbolic links", path.string(), kMaxLinks);
}

bool IsWritable(const fs::path &path) {
    return g_access(path.string().c_str(), W_OK) == 0;
}

/// `target`: `path` with its symbolic links resolved. Errors: something other than a regular file is there, or the file
/// is write protected.
void RequireReplaceable(const fs::path &path, const fs::path &target) {
    std::error_code ignored;
    const fs::file_status old = fs::status(target, ignored);
    if (fs::is_directory(old))
        throw Error("{}: cannot write: not a regular file, but a folder", path.string());
    if (fs::exists(old) && !fs::is_regular_file(old))
        throw Error("{}: cannot write: not a regular file", path.string());
    if (fs::exists(old) && !IsWritable(target))
        throw Error("{}: cannot write: the file is write protected", path.string());
}

} // namespace

InputFile::InputFile(fs::path path) : path_(std::move(path)) {
    std::error_code ignored;
    const fs::file_status status = fs::status(path_, ignored);
    if (fs::exists(status) && !fs::is_regular_file(status)) // a pipe would block, a device may have no end
        throw Error("{}: cannot read: not a regular file", path_.string());
    file_.reset(OpenFile(path_, "rbe"));
    struct stat info {};
    if (!file_ || fstat(fileno(file_.get()), &info) != 0)
        throw Error("{}: cannot read: {}", path_.string(), Reason(errno));
    size_ = std::uint64_t(info.st_size);
}

void InputFile::Read(std::uint64_t at, std::span<std::byte> into) {
    if (into.empty())
        return;
    const bool there = fseeko(file_.get(), off_t(at), SEEK_SET) == 0;
    if (there && std::fread(into.data(), 1, into.size(), file_.get()) == into.size())
        return;
    const int number = errno;
    const bool ended = there && std::feof(file_.get()) != 0;
    throw Error("{}: cannot read: {}", path_.string(),
                ended ? fmt::format("it ends before byte {}", at + into.size()) : Reason(number));
}

MappedFile::MappedFile(const fs::path &path) {
    GError *failure = nullptr;
    mapping_.reset(g_mapped_file_new(path.string().c_str(), FALSE, &failure));
    if (mapping_)
        return;
    const std::string reason = failure ? failure->message : "unknown reason";
    g_clear_error(&failure);
    throw Error("{}: cannot be read: {}", path.string(), reason);
}

std::span<const std::byte> MappedFile::Bytes() const {
    auto *const mapping = static_cast<GMappedFile *>(mapping_.get());
    if (!mapping || g_mapped_file_get_length(mapping) == 0)
        return {};
    return std::as_bytes(std::span(g_mapped_file_get_contents(mapping), g_mapped_file_get_length(mapping)));
}

void MappedFile::Unmap::operator()(void *mapping) const {
    g_mapped_file_unref(static_cast<GMappedFile *>(mapping));
}

std::vector<std::byte> ReadFile(const fs::path &path) {
    InputFile file(path);
    std::vector<std::byte> bytes(file.Size());
    file.Read(0, bytes);
    return bytes;
}

std::string ReadTextFile(const std::filesystem::path &path) {
    return std::string(AsText(ReadFile(path)));
}

std::string TargetOfUnfinished(std::string_view name) {
    if (!name.ends_with(kUnfinished))
        return {};
    name.remove_suffix(kUnfinished.size());
    const std::size_t dot = name.rfind('.');
    const bool isUnfinished =
        dot != name.npos && name.size() == dot + 1 + kRandomLetters &&
        std::all_of(name.end() - kRandomLetters, name.end(), [](char c) { return g_ascii_isalnum(c); });
    return std::string(isUnfinished ? name.substr(0, dot) : std::string_view());
}

FileReplacement::FileReplacement(fs::path path) : path_(std::move(path)), target_(BehindLinks(path_)) {
    std::error_code ignored;
    RequireReplaceable(path_, target_);
    const fs::file_status old = fs::status(target_, ignored);
    constexpr int kNewFileMode = 0666; // readable and writable for all, less the umask
    isNew_ = !fs::exists(old);
    const int mode = isNew_ ? kNewFileMode : int(old.permissions());

    std::string name = target_.string() + ".XXXXXX" + std::string(kUnfinished);
    file_.reset(CreateTemporary(name, mode));
    if (!file_)
        Fail(errno);
    temporary_ = std::move(name);
    if (!isNew_)
        SetPermissions(file_.get(), mode);
}

FileReplacement::~FileReplacement() {
    file_.reset(); // Windows removes no open file
    if (!temporary_.empty())
        g_unlink(temporary_.c_str());
    std::error_code ignored;
    if (!old_.empty() && !keepsOld_)
        fs::remove(old_, ignored);
}

void FileReplacement::Append(std::span<const std::byte> data) {
    if (!data.empty() && std::fwrite(data.data(), 1, data.size(), file_.get()) != data.size())
        Fail(errno);
}

void FileReplacement::Finish() {
    if (!SyncFile(file_.get()))
        Fail(errno);
    file_.reset();
}

void FileReplacement::Commit() {
    if (file_)
        Finish();
    if (!RenameOver(temporary_, target_))
        Fail(errno);
    temporary_.clear();
}

void FileReplacement::KeepOld() {
    if (isNew_)
        return;
    std::string name = temporary_;
    const auto letters = name.end() - std::ptrdiff_t(kUnfinished.size() + kRandomLetters);
    std::reverse(letters, letters + kRandomLetters);
    if (name == temporary_)
        *letters = *letters == 'a' ? 'b' : 'a';
    fs::path old = std::move(name);
    std::error_code failed;
    fs::create_hard_link(target_, old, failed);
    if (!failed)
        old_ = std::move(old); // needs no memory
}

void FileReplacement::Revert() noexcept {
    if (!temporary_.empty())
        return;
    std::error_code ignored;
    if (isNew_)
        fs::remove(target_, ignored);
    else if (!old_.empty() && RenameOver(old_, target_))
        old_.clear();
    else
        keepsOld_ = !old_.empty();
}

void FileReplacement::Fail(int reason) const {
    throw Error("{}: cannot write: {}", path_.string(), Reason(reason));
}

void ReplaceFile(const fs::path &path, std::span<const std::byte> data) {
    FileReplacement file(path);
    file.Append(data);
    file.Commit();
}

void MakeFolder(const std::filesystem::path &folder) {
    std::error_code failed;
    std::filesystem::create_directories(folder, failed);
    if (failed)
        throw Error("{}: cannot make this folder: {}", folder.string(), failed.message());
}

void ReplaceTextFile(const fs::path &path, std::string_view text) {
    ReplaceFile(path, std::as_bytes(std::span(text)));
}

void FileSet::AddFile(const fs::path &path, std::span<const std::byte> data) {
    FileReplacement &file = Add(path);
    file.Append(data);
    file.Finish();
}

void FileSet::AddText(const fs::path &path, std::string_view text) {
    AddFile(path, std::as_bytes(std::span(text)));
}

void FileSet::AddFolder(const fs::path &folder) {
    std::error_code ignored;
    const std::size_t before = newFolders_.size();
    for (fs::path missing = fs::absolute(folder); !fs::exists(missing, ignored) && missing.has_relative_path();
         missing = missing.parent_path())
        newFolders_.insert(newFolders_.begin() + std::ptrdiff_t(before), missing);
    MakeFolder(folder);
}

void FileSet::Commit() {
    for (FileReplacement &file : files_)
        if (file.file_)
            file.Finish();
    try {
        for (FileReplacement &file : files_) {
            if (&file != &files_.back()) // nothing can fail after the last one
                file.KeepOld();
            file.Commit();
        }
    } catch (const Error &error) {
        RevertAll();
        std::string text = error.what();
        for (const FileReplacement &file : files_)
            if (file.keepsOld_)
                text += fmt::format("; {} cannot be put back: its old contents are in {}", file.path_.string(),
                                    file.old_.string());
        throw Error("{}", text);
    } catch (...) {
        RevertAll();
        throw;
    }
    files_.clear();
    newFolders_.clear();
    std::error_code ignored;
    for (const fs::path &path : removed_)
        fs::remove(path, ignored);
    for (const auto &[log, line] : lines_)
        log->Print("{}", line);
}

void FileSet::RevertAll() noexcept {
    for (FileReplacement &file : files_)
        file.Revert();
}

FileSet::~FileSet() {
    files_.clear();
    std::error_code ignored;
    for (auto folder = newFolders_.rbegin(); folder != newFolders_.rend(); ++folder)
        fs::remove(*folder, ignored); // only if it is empty
}

void RequireWritable(const fs::path &file) {
    const fs::path target = BehindLinks(fs::absolute(file));
    RequireReplaceable(file, target);
    const fs::path folder = target.parent_path();
    std::error_code ignored;
    if (!fs::exists(folder, ignored))
        throw Error("{}: cannot write: the folder {} does not exist", file.string(), folder.string());
    if (!fs::is_directory(folder, ignored))
        throw Error("{}: cannot write: {} is not a folder", file.string(), folder.string());
    if (!IsWritable(folder))
        throw Error("{}: cannot write: the folder {} is write protected", file.string(), folder.string());
}

void RequireFolder(const fs::path &folder) {
    std::error_code ignored;
    fs::path there = fs::absolute(folder);
    while (!fs::exists(there, ignored) && there.has_relative_path())
        there = there.parent_path();
    if (!fs::is_directory(there, ignored))
        throw Error("{}: cannot write to this folder: {} is a file", folder.string(), there.string());
    if (!IsWritable(there))
        throw Error("{}: cannot write to this folder: {} is write protected", folder.string(), there.string());
}

bool IsFile(const fs::path &path) {
    std::error_code failed;
    const fs::file_status status = fs::status(path, failed);
    if (status.type() == fs::file_type::none && failed != std::errc::permission_denied &&
        failed != std::errc::filename_too_long)
        throw Error("{}: cannot read: {}", path.string(), failed.message());
    return fs::is_regular_file(status);
}

std::vector<fs::path> EntriesOf(const fs::path &folder) {
    std::vector<fs::path> entries;
    const std::error_code failed = ListFolder(folder, entries);
    for (const std::errc harmless :
         {std::errc{}, std::errc::no_such_file_or_directory, std::errc::not_a_directory, std::errc::permission_denied})
        if (failed == std::make_error_condition(harmless))
            return entries;
    throw Error("{}: cannot read this folder: {}", folder.string(), failed.message());
}

std::uint64_t DiskOf(const fs::path &path) {
    GStatBuf info{}; // stat of Windows reads names in its code page
    return g_stat(path.string().c_str(), &info) == 0 ? std::uint64_t(info.st_dev) : 0;
}

FileState FileState::Of(const fs::path &path) {
    FileState state;
    GStatBuf info{};
    if (g_stat(path.string().c_str(), &info) != 0)
        return state;
    state.exists = true;
    state.size = std::uint64_t(info.st_size);
    state.stamp = StampOf(path);
    return state;
}

} // namespace q3
