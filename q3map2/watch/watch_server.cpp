// GPL-2.0-or-later. The server of the page: for this computer alone, and for who knows its address.
#include "q3map2/watch/watch_server.h"

#include "common/error.h"

#include <libsoup/soup.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <utility>

#include <sys/random.h>
#include <unistd.h>

namespace q3 {

namespace {

constexpr std::size_t kTokenBytes = 16;
constexpr std::size_t kMostPages = 32;     ///< that are connected at a time
constexpr std::uint64_t kMostHeard = 4096; ///< bytes of a message of a page; pages have nothing to say
constexpr guint kStateDelay = 20;          ///< ms, for changes that follow each other closely
constexpr std::string_view kSocketName = "socket";

std::string RandomToken() {
    std::array<unsigned char, kTokenBytes> bytes{};
    if (getentropy(bytes.data(), bytes.size()) != 0)
        throw Error("the system gives no random numbers: {}", std::strerror(errno));
    std::string token;
    for (const unsigned char byte : bytes)
        token += fmt::format("{:02x}", byte);
    return token;
}

/// Takes as long for every wrong text of the same length.
bool IsSame(std::string_view a, std::string_view b) {
    if (a.size() != b.size())
        return false;
    unsigned difference = 0;
    for (std::size_t i = 0; i < a.size(); ++i)
        difference |= static_cast<unsigned char>(a[i]) ^ static_cast<unsigned char>(b[i]);
    return difference == 0;
}

/// All values of the header, "" without it.
std::string_view Header(SoupServerMessage *message, const char *name) {
    const char *const value = soup_message_headers_get_list(soup_server_message_get_request_headers(message), name);
    return value ? value : "";
}

/// The bytes, which stay until they are sent.
GBytes *SharedBytes(const std::shared_ptr<const std::vector<std::byte>> &bytes) {
    using Shared = std::shared_ptr<const std::vector<std::byte>>;
    return g_bytes_new_with_free_func(
        bytes->data(), bytes->size(), [](gpointer kept) { delete static_cast<Shared *>(kept); }, new Shared(bytes));
}

} // namespace

struct WatchServer::Impl {
    explicit Impl(Callbacks given) : callbacks(std::move(given)), token(RandomToken()) {}

    void Listen(int wanted);
    bool IsAllowed(SoupServerMessage *message, std::string_view path) const;
    void Respond(SoupServerMessage *message, std::string_view path) const;
    void AddPage(SoupWebsocketConnection *page);
    void Send(SoupWebsocketConnection *page) const;

    Callbacks callbacks;
    std::string token;
    int port = 0;
    std::array<std::string, 2> hosts; ///< names under which pages know the server
    ObjectPtr<SoupServer> server;
    std::vector<ObjectPtr<SoupWebsocketConnection>> pages;
    LoopSource stateDelay;
};

void WatchServer::Impl::Listen(int wanted) {
    const ObjectPtr<GInetAddress> loopback(g_inet_address_new_loopback(G_SOCKET_FAMILY_IPV4));
    const ObjectPtr<GSocketAddress> address(g_inet_socket_address_new(loopback.get(), guint16(wanted)));
    ErrorOut error;
    if (!soup_server_listen(server.get(), address.get(), SoupServerListenOptions(0), &error))
        throw Error("-port {}: {}", wanted, error.Text());
    GSList *const uris = soup_server_get_uris(server.get());
    port = uris ? g_uri_get_port(static_cast<GUri *>(uris->data)) : 0;
    g_slist_free_full(uris, [](gpointer uri) { g_uri_unref(static_cast<GUri *>(uri)); });
    hosts = {fmt::format("127.0.0.1:{}", port), fmt::format("localhost:{}", port)};
}

bool WatchServer::Impl::IsAllowed(SoupServerMessage *message, std::string_view path) const {
    const std::string_view host = Header(message, "Host"), origin = Header(message, "Origin");
    const bool isOurHost = std::ranges::find(hosts, host) != hosts.end();
    const bool isOurPage = std::ranges::any_of(hosts, [&](const std::string &h) { return origin == "http://" + h; });
    const std::string_view given = path.substr(0, 1 + token.size());
    const bool isOurPath = IsSame(given, "/" + token) && path.substr(given.size()).starts_with('/');
    const bool isSocket = isOurPath && path.substr(given.size() + 1) == kSocketName;
    return isOurHost && isOurPath && (isOurPage || (origin.empty() && !isSocket));
}

void WatchServer::Impl::Respond(SoupServerMessage *message, std::string_view path) const {
    SoupMessageHeaders *const headers = soup_server_message_get_response_headers(message);
    soup_message_headers_replace(headers, "Cache-Control", "no-store");
    soup_message_headers_replace(headers, "X-Content-Type-Options", "nosniff");
    soup_message_headers_replace(headers, "X-Frame-Options", "DENY");
    soup_message_headers_replace(headers, "Cross-Origin-Resource-Policy", "same-origin");
    soup_message_headers_replace(headers, "Referrer-Policy", "no-referrer"); // the address is a secret
    const std::string_view method = soup_server_message_get_method(message);
    if (method != "GET" && method != "HEAD") {
        soup_server_message_set_status(message, SOUP_STATUS_METHOD_NOT_ALLOWED, nullptr);
        return;
    }
    const auto answer = callbacks.answer(path.substr(token.size() + 2));
    if (!answer || !answer->bytes) {
        soup_server_message_set_status(message, SOUP_STATUS_NOT_FOUND, nullptr);
        return;
    }
    soup_server_message_set_status(message, SOUP_STATUS_OK, nullptr);
    soup_message_headers_set_content_type(headers, answer->type.c_str(), nullptr);
    if (method == "HEAD") {
        soup_message_headers_set_content_length(headers, goffset(answer->bytes->size()));
        return;
    }
    GBytes *const bytes = SharedBytes(answer->bytes);
    soup_message_body_append_bytes(soup_server_message_get_response_body(message), bytes);
    g_bytes_unref(bytes);
}

void WatchServer::Impl::AddPage(SoupWebsocketConnection *page) {
    if (pages.size() >= kMostPages) {
        soup_websocket_connection_close(page, SOUP_WEBSOCKET_CLOSE_GOING_AWAY, "too many pages");
        return;
    }
    pages.emplace_back(SOUP_WEBSOCKET_CONNECTION(g_object_ref(page)));
    soup_websocket_connection_set_max_incoming_payload_size(page, kMostHeard);
    g_signal_connect(page, "closed", G_CALLBACK(+[](SoupWebsocketConnection *closed, gpointer self) {
                         std::erase_if(static_cast<Impl *>(self)->pages,
                                       [&](const auto &other) { return other.get() == closed; });
                     }),
                     this);
    Send(page);
}

void WatchServer::Impl::Send(SoupWebsocketConnection *page) const {
    if (soup_websocket_connection_get_state(page) == SOUP_WEBSOCKET_STATE_OPEN)
        soup_websocket_connection_send_text(page, callbacks.state().c_str());
}

WatchServer::WatchServer(int port, Callbacks callbacks) : impl_(std::make_unique<Impl>(std::move(callbacks))) {
    impl_->server.reset(soup_server_new(nullptr, nullptr));
    SoupServer *const server = impl_->server.get();
    // Sees the headers of every request before anything else does. That of the longest path is called, so the WebSocket
    // needs its own.
    const std::string socket = fmt::format("/{}/{}", impl_->token, kSocketName);
    for (const char *const below : {static_cast<const char *>(nullptr), socket.c_str()})
        soup_server_add_early_handler(
            server, below,
            [](SoupServer *, SoupServerMessage *message, const char *path, GHashTable *, gpointer impl) {
                if (!static_cast<Impl *>(impl)->IsAllowed(message, path))
                    soup_server_message_set_status(message, SOUP_STATUS_FORBIDDEN, nullptr);
            },
            impl_.get(), nullptr);
    soup_server_add_handler(
        server, nullptr,
        [](SoupServer *, SoupServerMessage *message, const char *path, GHashTable *, gpointer impl) {
            static_cast<Impl *>(impl)->Respond(message, path);
        },
        impl_.get(), nullptr);
    soup_server_add_websocket_handler(
        server, socket.c_str(), nullptr, nullptr,
        [](SoupServer *, SoupServerMessage *, const char *, SoupWebsocketConnection *page, gpointer impl) {
            static_cast<Impl *>(impl)->AddPage(page);
        },
        impl_.get(), nullptr);
    impl_->Listen(port);
}

WatchServer::~WatchServer() {
    for (const auto &page : impl_->pages)
        g_signal_handlers_disconnect_by_data(page.get(), impl_.get());
    soup_server_disconnect(impl_->server.get());
}

std::string WatchServer::Address() const {
    return fmt::format("http://{}/{}/", impl_->hosts.front(), impl_->token);
}

std::string WatchServer::Origins() const {
    std::string text;
    for (const std::string &host : impl_->hosts)
        text += fmt::format("{}http://{} ws://{}", text.empty() ? "" : " ", host, host);
    return text;
}

void WatchServer::StateChanged() {
    if (impl_->stateDelay)
        return;
    impl_->stateDelay.Set(g_timeout_add(
        kStateDelay,
        [](gpointer self) -> gboolean {
            Impl &impl = *static_cast<Impl *>(self);
            impl.stateDelay.Forget();
            for (const auto &page : impl.pages)
                impl.Send(page.get());
            return G_SOURCE_REMOVE;
        },
        impl_.get()));
}

} // namespace q3
