// GPL-2.0-or-later. A stage that runs as a process of its own.
#include "q3map2/watch/stage_process.h"

#include "common/error.h"
#include "q3map2/watch/glib_ptr.h"

#include <array>
#include <csignal>
#include <optional>
#include <utility>

#include <sys/resource.h>
#ifdef __linux__
#include <sys/prctl.h>
#endif

namespace q3 {

namespace {

constexpr guint kLastMessages = 1000; ///< ms after the end of the process until the connection must be closed
constexpr int kLowPriority = 10;      ///< of nice

ObjectPtr<GSocketListener> ListenOnLoopback(std::uint16_t &port) {
    ObjectPtr<GSocketListener> listener(g_socket_listener_new());
    const ObjectPtr<GInetAddress> loopback(g_inet_address_new_loopback(G_SOCKET_FAMILY_IPV4));
    const ObjectPtr<GSocketAddress> wanted(g_inet_socket_address_new(loopback.get(), 0));
    GSocketAddress *found = nullptr;
    ErrorOut error;
    if (!g_socket_listener_add_address(listener.get(), wanted.get(), G_SOCKET_TYPE_STREAM, G_SOCKET_PROTOCOL_TCP,
                                       nullptr, &found, &error))
        throw Error("cannot listen on 127.0.0.1: {}", error.Text());
    const ObjectPtr<GSocketAddress> address(found);
    port = g_inet_socket_address_get_port(G_INET_SOCKET_ADDRESS(address.get()));
    return listener;
}

} // namespace

/// Kept alive by each operation that is under way.
struct StageProcess::Run : std::enable_shared_from_this<Run> {
    explicit Run(Callbacks given)
        : callbacks(std::move(given)), reader([this](FeedbackMessage message) {
              if (callbacks.message)
                  callbacks.message(std::move(message));
          }) {}

    /// Its own reference for a callback of GIO; Own takes it back.
    gpointer Keep() { return new std::shared_ptr<Run>(shared_from_this()); }
    static std::shared_ptr<Run> Own(gpointer kept) {
        const std::unique_ptr<std::shared_ptr<Run>> owner(static_cast<std::shared_ptr<Run> *>(kept));
        return *owner;
    }

    void Accept();
    void Read();
    void Wait();
    void CloseConnection();
    void EndIfComplete();

    Callbacks callbacks;
    FeedbackReader reader;
    ObjectPtr<GSocketListener> listener;
    ObjectPtr<GSocketConnection> connection;
    ObjectPtr<GSubprocess> process;
    ObjectPtr<GCancellable> cancel{g_cancellable_new()};
    std::array<char, 4096> buffer{};
    LoopSource lastMessages;
    bool closed = false; ///< no more messages
    bool stopped = false;
    std::optional<StageEnd> end; ///< of the process
};

void StageProcess::Run::Accept() {
    g_socket_listener_accept_async(
        listener.get(), cancel.get(),
        [](GObject *source, GAsyncResult *result, gpointer kept) {
            const auto run = Own(kept);
            run->connection.reset(g_socket_listener_accept_finish(G_SOCKET_LISTENER(source), result, nullptr, nullptr));
            g_socket_listener_close(run->listener.get()); // one stage, one connection
            if (run->connection)
                run->Read();
            else
                run->CloseConnection();
        },
        Keep());
}

void StageProcess::Run::Read() {
    g_input_stream_read_async(
        g_io_stream_get_input_stream(G_IO_STREAM(connection.get())), buffer.data(), buffer.size(), G_PRIORITY_DEFAULT,
        cancel.get(),
        [](GObject *source, GAsyncResult *result, gpointer kept) {
            const auto run = Own(kept);
            const gssize got = g_input_stream_read_finish(G_INPUT_STREAM(source), result, nullptr);
            if (got > 0 && run->reader.Add({run->buffer.data(), std::size_t(got)}))
                run->Read();
            else
                run->CloseConnection();
        },
        Keep());
}

void StageProcess::Run::CloseConnection() {
    closed = true;
    if (connection)
        g_io_stream_close(G_IO_STREAM(connection.get()), nullptr, nullptr);
    EndIfComplete();
}

void StageProcess::Run::Wait() {
    g_subprocess_wait_async(
        process.get(), nullptr,
        [](GObject *source, GAsyncResult *result, gpointer kept) {
            const auto run = Own(kept);
            GSubprocess *const ended = G_SUBPROCESS(source);
            g_subprocess_wait_finish(ended, result, nullptr);
            const bool exited = g_subprocess_get_if_exited(ended);
            run->end = {.done = exited && g_subprocess_get_exit_status(ended) == 0,
                        .stopped = run->stopped,
                        .signal = exited ? 0 : g_subprocess_get_term_sig(ended)};
            run->lastMessages.Set(g_timeout_add(
                kLastMessages,
                [](gpointer self) -> gboolean {
                    static_cast<Run *>(self)->lastMessages.Forget();
                    g_cancellable_cancel(static_cast<Run *>(self)->cancel.get());
                    return G_SOURCE_REMOVE;
                },
                run.get()));
            run->EndIfComplete();
        },
        Keep());
}

void StageProcess::Run::EndIfComplete() {
    if (!end || !(closed || stopped))
        return;
    lastMessages.Set(0);
    if (auto call = std::exchange(callbacks.end, nullptr))
        call(*end);
}

StageProcess::StageProcess(const std::filesystem::path &program, const std::vector<std::string> &words,
                           Priority priority, Callbacks callbacks)
    : run_(std::make_shared<Run>(std::move(callbacks))) {
    std::uint16_t port = 0;
    run_->listener = ListenOnLoopback(port);
    std::vector<std::string> line{program.string(), "-connect", fmt::format("127.0.0.1:{}", port)};
    line.insert(line.end(), words.begin(), words.end());
    std::vector<const char *> pointers;
    for (const std::string &word : line)
        pointers.push_back(word.c_str());
    pointers.push_back(nullptr);
    const ObjectPtr<GSubprocessLauncher> launcher(g_subprocess_launcher_new(G_SUBPROCESS_FLAGS_STDOUT_SILENCE));
    g_subprocess_launcher_set_child_setup(
        launcher.get(),
        [](gpointer low) {
#ifdef __linux__
            prctl(PR_SET_PDEATHSIG, SIGKILL);
#endif
            if (low)
                setpriority(PRIO_PROCESS, 0, kLowPriority);
        },
        GINT_TO_POINTER(priority == Priority::Low), nullptr);
    ErrorOut error;
    run_->process.reset(g_subprocess_launcher_spawnv(launcher.get(), pointers.data(), &error));
    if (!run_->process)
        throw Error("cannot run {}: {}", program.string(), error.Text());
    run_->Accept();
    run_->Wait();
}

StageProcess::~StageProcess() {
    run_->callbacks = {};
    run_->lastMessages.Set(0);
    g_cancellable_cancel(run_->cancel.get());
    g_subprocess_force_exit(run_->process.get());
}

void StageProcess::Stop() {
    run_->stopped = true;
    g_subprocess_force_exit(run_->process.get());
}

} // namespace q3
