// GPL-2.0-or-later. Whole files, and their safe replacement.
#include "common/files.h"

#include "common/error.h"

#include <glib.h>

#include <memory>

namespace q3 {

namespace {

struct FreeError {
    void operator()(GError *error) const { g_error_free(error); }
};

[[noreturn]] void Fail(const std::filesystem::path &path, const char *action, GError *error) {
    const std::unique_ptr<GError, FreeError> owner(error);
    throw Error("{}: cannot {}: {}", path.string(), action, error ? error->message : "unknown reason");
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
    GError *error = nullptr;
    const auto flags = GFileSetContentsFlags(G_FILE_SET_CONTENTS_CONSISTENT | G_FILE_SET_CONTENTS_DURABLE);
    if (!g_file_set_contents_full(path.c_str(), reinterpret_cast<const char *>(data.data()), gssize(data.size()), flags,
                                  0666, &error))
        Fail(path, "write", error);
}

} // namespace q3
