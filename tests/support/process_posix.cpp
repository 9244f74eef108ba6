// GPL-2.0-or-later. Programs that tests start: Linux and its relatives.
#include "tests/support/process.h"

#include <csignal>
#include <cstdlib>

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

namespace q3::test {

namespace {

[[noreturn]] void Become(std::vector<std::string> command, const std::string &home, int output) {
    dup2(output, STDOUT_FILENO);
    dup2(output, STDERR_FILENO);
    if (!home.empty())
        setenv("HOME", home.c_str(), 1);
    std::vector<char *> words;
    for (std::string &word : command)
        words.push_back(word.data());
    words.push_back(nullptr);
    alarm(unsigned(Process::kMostTime.count()));
    execv(words[0], words.data());
    _exit(127); // as a shell does if there is no such program
}

/// The reading and the writing end of what a program prints; -1: none.
struct Ends {
    int from = -1, to = -1;
};

Ends EndsOf(OutputTo output) {
    if (output == OutputTo::Nowhere) // a file that is open for reading
        return {.to = open("/dev/null", O_RDONLY | O_CLOEXEC)};
    if (output == OutputTo::Terminal) {
        const int terminal = posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC);
        if (terminal < 0 || grantpt(terminal) != 0 || unlockpt(terminal) != 0) {
            close(terminal);
            return {};
        }
        return {terminal, open(ptsname(terminal), O_RDWR | O_NOCTTY | O_CLOEXEC)};
    }
    int pipes[2];
    if (pipe2(pipes, O_CLOEXEC) != 0)
        return {};
    return {pipes[0], pipes[1]};
}

} // namespace

struct Process::State {
    int from = -1;
    pid_t child = -1; ///< -1: it has ended, or did not start
};

Process::Process(const std::vector<std::string> &command, const std::filesystem::path &home, OutputTo output)
    : state_(std::make_unique<State>()) {
    const Ends ends = EndsOf(output);
    state_->from = ends.from;
    if (ends.to < 0)
        return;
    state_->child = fork();
    if (state_->child == 0)
        Become(command, home.string(), ends.to);
    close(ends.to);
}

Process::~Process() {
    if (state_->child > 0) {
        End(SIGKILL);
        Wait();
    }
    if (state_->from >= 0)
        close(state_->from);
}

std::string Process::Read() {
    char buffer[4096];
    const ssize_t got = state_->from < 0 ? 0 : read(state_->from, buffer, sizeof buffer);
    return {buffer, got > 0 ? std::size_t(got) : 0};
}

void Process::End(int signal) {
    if (state_->child > 0)
        kill(state_->child, signal);
}

Ending Process::Wait() {
    Ending ending;
    int status = 0;
    if (state_->child > 0 && waitpid(state_->child, &status, 0) == state_->child) {
        if (WIFEXITED(status))
            ending.status = WEXITSTATUS(status);
        else if (WIFSIGNALED(status))
            ending.signal = WTERMSIG(status);
    }
    state_->child = -1;
    return ending;
}

std::filesystem::path ThisProgram() {
    return std::filesystem::read_symlink("/proc/self/exe");
}

void KillThisProcess() {
    std::raise(SIGKILL);
    std::abort(); // never reached
}

bool IsOfAKilledProcess(int status) {
    return WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL;
}

} // namespace q3::test
