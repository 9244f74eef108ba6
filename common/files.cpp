// GPL-2.0-or-later. Whole files, and their safe replacement.
#include "common/files.h"

#include "common/error.h"

#include <glib.h>
#include <glib/gstdio.h>

#include <memory>
#include <system_error>

#include <unistd.h>

namespace q3 {

namespace {

struct FreeError {
    void operator()(GError *error) const { g_error_free(error); }
};

[[noreturn]] void Fail(const std::filesystem::path &path, const char *action, GError *error) {
    const std::unique_ptr<GError, FreeError> owner(error);
    throw Error("{}: cannot {}: {}", path.string(), action, error ? error->message : "unknown reason");
}

/// The file that a chain of symbolic links ends at, so that the file is replaced and not the link.
std::filesystem::path BehindLinks(std::filesystem::path path) {
    constexpr int kMaxLinks = 40;
    for (int i = 0; i < kMaxLinks; i++) {
        std::error_code notALink;
        const std::filesystem::path next = std::filesystem::read_symlink(path, notALink);
        if (notALink)
            return path;
        path = next.is_absolute() ? next : path.parent_path() / next;
    }
    throw Error("{}: cannot write: more than {} symbolic links", path.string(), kMaxLinks);
}

} // namespace

std::vector<std::byte> ReadFile(const std::filesystem::path &path) {
    GError *error = nullptr;
    char *contents = nullptr;
    gsize length = 0;
    if (!g_file_get_contents(path.c_str(), &contents, &length, &error))
        Fail(path, "read", error);
    const std::unique_ptr<char, decltype(&g_free)> owner(contents, g_free);
    const auto *bytes = reinterpret_cast<const std::byte *>(contents);
    return {bytes, bytes + length};
}

void ReplaceFile(const std::filesystem::path &path, std::span<const std::byte> data) {
    namespace fs = std::filesystem;
    const fs::path target = BehindLinks(path);
    std::error_code ignored;
    const fs::file_status old = fs::status(target, ignored);
    if (fs::exists(old) && !fs::is_regular_file(old))
        throw Error("{}: cannot write: not a regular file", path.string());
    if (fs::exists(old) && g_access(target.c_str(), W_OK) != 0)
        throw Error("{}: cannot write: the file is write protected", path.string());
    const fs::perms mode = fs::exists(old) ? old.permissions() : fs::perms(0666);

    GError *error = nullptr;
    const auto flags = GFileSetContentsFlags(G_FILE_SET_CONTENTS_CONSISTENT | G_FILE_SET_CONTENTS_DURABLE);
    if (!g_file_set_contents_full(target.c_str(), reinterpret_cast<const char *>(data.data()), gssize(data.size()),
                                  flags, int(mode), &error))
        Fail(path, "write", error);
    // GLib masks the mode with the umask, as is right for a new file only.
    if (fs::exists(old))
        fs::permissions(target, mode, ignored);
}

} // namespace q3
