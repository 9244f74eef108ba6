// GPL-2.0-or-later. Programs that tests start: Windows.
#include "tests/support/process.h"

#include <glib.h>

#include <cstdlib>
#include <thread>
#include <utility>

#include <windows.h>

namespace q3::test {

namespace {

constexpr UINT kKilled = 0xE0000009;      ///< exit status of a process that a test ended; none of the system's own
constexpr DWORD kFirstError = 0x40000000; ///< exit statuses from here on are codes of exceptions

std::wstring Wide(const std::string &text) {
    return std::filesystem::path(text).native(); // reads UTF-8
}

/// A word of a command line as CommandLineToArgvW reads it: backslashes are doubled where a quote follows them.
std::string Quoted(const std::string &word) {
    std::string quoted = "\"";
    std::size_t slashes = 0;
    for (const char c : word) {
        if (c == '"')
            quoted.append(slashes + 1, '\\');
        slashes = c == '\\' ? slashes + 1 : 0;
        quoted += c;
    }
    return quoted.append(slashes, '\\') + '"';
}

std::wstring CommandLine(const std::vector<std::string> &command) {
    std::string line;
    for (const std::string &word : command)
        line += (line.empty() ? "" : " ") + Quoted(word);
    return Wide(line);
}

/// The environment of this process with another folder of the user, as CreateProcess wants it: each entry ends in a
/// zero, and an empty one ends them all.
std::wstring Environment(const std::string &home) {
    char **entries = g_get_environ();
    if (!home.empty())
        entries = g_environ_setenv(entries, "APPDATA", home.c_str(), TRUE);
    std::wstring block;
    for (char **entry = entries; *entry != nullptr; ++entry)
        block += Wide(*entry) + L'\0';
    g_strfreev(entries);
    return block + L'\0';
}

/// The reading and the writing end of what a program prints; null: none. It inherits the latter.
struct Ends {
    HANDLE from = nullptr, to = nullptr;
};

Ends EndsOf(OutputTo output) {
    SECURITY_ATTRIBUTES inherited{.nLength = sizeof inherited, .lpSecurityDescriptor = nullptr, .bInheritHandle = TRUE};
    Ends ends;
    if (output == OutputTo::Nowhere) { // a device that is open for reading
        const HANDLE device = CreateFileW(L"NUL", GENERIC_READ, FILE_SHARE_READ | FILE_SHARE_WRITE, &inherited,
                                          OPEN_EXISTING, 0, nullptr);
        ends.to = device == INVALID_HANDLE_VALUE ? nullptr : device;
    } else if (output == OutputTo::Pipe && CreatePipe(&ends.from, &ends.to, &inherited, 0) != 0)
        SetHandleInformation(ends.from, HANDLE_FLAG_INHERIT, 0);
    return ends;
}

} // namespace

struct Process::State {
    HANDLE from = nullptr, process = nullptr;
    std::thread watch; ///< ends the process when its time is over
};

Process::Process(const std::vector<std::string> &command, const std::filesystem::path &home, OutputTo output)
    : state_(std::make_unique<State>()) {
    const Ends ends = EndsOf(output);
    state_->from = ends.from;
    if (ends.to == nullptr)
        return;
    STARTUPINFOW start{};
    start.cb = sizeof start;
    start.dwFlags = STARTF_USESTDHANDLES;
    start.hStdOutput = start.hStdError = ends.to;
    std::wstring line = CommandLine(command), environment = Environment(home.string());
    PROCESS_INFORMATION made{};
    const BOOL started =
        CreateProcessW(Wide(command.at(0)).c_str(), line.data(), nullptr, nullptr, TRUE,
                       CREATE_UNICODE_ENVIRONMENT | CREATE_NO_WINDOW, environment.data(), nullptr, &start, &made);
    CloseHandle(ends.to);
    if (started == 0)
        return;
    CloseHandle(made.hThread);
    state_->process = made.hProcess;
    state_->watch = std::thread([process = made.hProcess] {
        if (WaitForSingleObject(process, DWORD(std::chrono::milliseconds(kMostTime).count())) == WAIT_TIMEOUT)
            TerminateProcess(process, kKilled);
    });
}

Process::~Process() {
    if (state_->process != nullptr) {
        End(0);
        Wait();
    }
    if (state_->from != nullptr)
        CloseHandle(state_->from);
}

std::string Process::Read() {
    char buffer[4096];
    DWORD got = 0;
    if (state_->from == nullptr || ReadFile(state_->from, buffer, sizeof buffer, &got, nullptr) == 0)
        got = 0;
    return {buffer, got};
}

void Process::End(int) {
    if (state_->process != nullptr)
        TerminateProcess(state_->process, kKilled);
}

Ending Process::Wait() {
    if (state_->process == nullptr)
        return {};
    state_->watch.join();
    WaitForSingleObject(state_->process, INFINITE);
    DWORD status = 0;
    GetExitCodeProcess(state_->process, &status);
    CloseHandle(std::exchange(state_->process, nullptr));
    return {.status = status < kFirstError ? int(status) : -1};
}

std::filesystem::path ThisProgram() {
    std::wstring name(32768, L'\0'); // no path of Windows is longer
    name.resize(GetModuleFileNameW(nullptr, name.data(), DWORD(name.size())));
    return name;
}

void KillThisProcess() {
    TerminateProcess(GetCurrentProcess(), kKilled);
    std::abort(); // never reached
}

bool IsOfAKilledProcess(int status) {
    return UINT(status) == kKilled;
}

} // namespace q3::test
