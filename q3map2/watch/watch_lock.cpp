// GPL-2.0-or-later. One -watch for each map.
#include "q3map2/watch/watch_lock.h"

#include "common/error.h"
#include "common/files/files.h"
#include "q3map2/cli/stage_files.h"

#include <cerrno>
#include <cstring>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

namespace q3 {

namespace {

/// Whether the open file is still the one that has that name: its owner may have removed it meanwhile.
bool IsFileOf(int descriptor, const std::filesystem::path &file) {
    struct stat open {
    }, named{};
    return fstat(descriptor, &open) == 0 && stat(file.c_str(), &named) == 0 && open.st_ino == named.st_ino &&
           open.st_dev == named.st_dev;
}

} // namespace

WatchLock::WatchLock(const std::filesystem::path &map)
    : file_(WithExtension(std::filesystem::weakly_canonical(map), ".watch")) {
    while (true) {
        constexpr int kOwnerOnly = 0600; // it holds the secret part of the address
        descriptor_ = open(file_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, kOwnerOnly);
        if (descriptor_ < 0)
            throw Error("{}: cannot write: {}", file_.string(), std::strerror(errno));
        struct stat opened {};
        if (fstat(descriptor_, &opened) != 0 || !S_ISREG(opened.st_mode) || opened.st_uid != geteuid() ||
            opened.st_nlink > 1 || fchmod(descriptor_, kOwnerOnly) != 0) {
            close(descriptor_);
            throw Error("{}: expected a file of this user, or none: delete it", file_.string());
        }
        if (flock(descriptor_, LOCK_EX | LOCK_NB) != 0) {
            const int reason = errno;
            close(descriptor_);
            if (reason != EWOULDBLOCK)
                throw Error("{}: cannot be locked: {}", file_.string(), std::strerror(reason));
            throw Error("{} is watched already by another -watch; its page is {}", map.string(), ReadTextFile(file_));
        }
        if (IsFileOf(descriptor_, file_))
            return;
        close(descriptor_);
    }
}

WatchLock::~WatchLock() {
    std::error_code ignored;
    std::filesystem::remove(file_, ignored);
    close(descriptor_);
}

void WatchLock::Publish(std::string_view address) const {
    if (ftruncate(descriptor_, 0) != 0 || pwrite(descriptor_, address.data(), address.size(), 0) < 0)
        throw Error("{}: cannot write: {}", file_.string(), std::strerror(errno));
}

} // namespace q3
