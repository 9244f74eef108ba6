// GPL-2.0-or-later. Linux and its relatives.
#include "common/platform/platform.h"

#include <glib.h>

#include <cstdlib>
#include <system_error>

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

namespace q3 {

namespace fs = std::filesystem;

namespace {

/// Makes a rename durable. Failure is ignored: not every file system can, and the file is whole either way.
void SyncFolder(const fs::path &file) {
    const fs::path folder = file.has_parent_path() ? file.parent_path() : fs::path(".");
    const int descriptor = open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (descriptor < 0)
        return;
    fsync(descriptor);
    close(descriptor);
}

} // namespace

ProcessStart StartProcess(int argc, char **argv) {
    std::error_code failed;
    fs::path program = fs::read_symlink("/proc/self/exe", failed);
    if (failed)
        program = argv[0];
    return {{argv + 1, argv + argc}, program};
}

bool IsTerminal() {
    return isatty(STDOUT_FILENO) != 0;
}

bool HasColors() {
    const char *terminal = std::getenv("TERM");
    return IsTerminal() && (terminal == nullptr || std::string_view(terminal) != "dumb");
}

std::string UserFolder(const std::string &name) {
    const std::string home = g_get_home_dir();
    return name == "." ? home : home + "/" + name;
}

double CpuSeconds() {
    timespec now{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return double(now.tv_sec) + double(now.tv_nsec) * 1e-9;
}

double PeakMemory() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
#ifdef __APPLE__
    return double(usage.ru_maxrss); // bytes on macOS, kilobytes elsewhere
#else
    return 1024.0 * double(usage.ru_maxrss);
#endif
}

fs::path PathOf(std::string_view name) {
    return name;
}

std::FILE *OpenFile(const fs::path &path, const char *mode) {
    return std::fopen(path.c_str(), mode);
}

std::FILE *CreateTemporary(std::string &name, int mode) {
    const int descriptor = g_mkstemp_full(name.data(), O_WRONLY | O_CLOEXEC, mode);
    if (descriptor < 0)
        return nullptr;
    std::FILE *file = fdopen(descriptor, "wb");
    if (file == nullptr) {
        const int number = errno;
        close(descriptor);
        unlink(name.c_str());
        errno = number;
    }
    return file;
}

void SetPermissions(std::FILE *file, int mode) {
    fchmod(fileno(file), mode_t(mode));
}

bool SyncFile(std::FILE *file) {
    return std::fflush(file) == 0 && fsync(fileno(file)) == 0;
}

bool RenameOver(const fs::path &from, const fs::path &to) {
    if (std::rename(from.c_str(), to.c_str()) != 0)
        return false;
    SyncFolder(to);
    return true;
}

} // namespace q3
