// GPL-2.0-or-later. An editor that listens (-connect), and its parser.
#include "tests/program/editor_listener.h"

#include <gtest/gtest.h>

#include <map>
#include <thread>
#include <utility>

#ifdef _WIN32
#include <winsock2.h>

#include <windows.h>

#include <ws2tcpip.h>
#else
#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>
#endif

namespace q3::test {

namespace {

// ---- What sockets of Windows do otherwise ----

#ifdef _WIN32

using SystemSocket = SOCKET;

std::intptr_t MakeSocket() {
    WSADATA data{};
    EXPECT_EQ(WSAStartup(MAKEWORD(2, 2), &data), 0);
    return std::intptr_t(WSASocketW(AF_INET, SOCK_STREAM, 0, nullptr, 0, WSA_FLAG_NO_HANDLE_INHERIT));
}

void CloseSocket(std::intptr_t handle) {
    closesocket(SOCKET(handle));
}

/// Ends a call of accept that waits in another thread.
void StopListening(std::intptr_t &handle) {
    CloseSocket(std::exchange(handle, -1));
}

std::intptr_t AcceptOn(std::intptr_t handle) {
    const auto connection = std::intptr_t(accept(SOCKET(handle), nullptr, nullptr));
    if (connection >= 0) // programs that start meanwhile would keep it open
        SetHandleInformation(reinterpret_cast<HANDLE>(connection), HANDLE_FLAG_INHERIT, 0);
    return connection;
}

/// The next bytes, which stay. Messages arrive whole, so there is nothing to wait for after the first.
std::ptrdiff_t Peek(std::intptr_t handle, unsigned char *to, std::size_t size) {
    return recv(SOCKET(handle), reinterpret_cast<char *>(to), int(size), MSG_PEEK);
}

/// What is there without waiting.
std::ptrdiff_t ReceiveNow(std::intptr_t handle, char *to, std::size_t size) {
    u_long mode = 1;
    ioctlsocket(SOCKET(handle), FIONBIO, &mode);
    const int got = recv(SOCKET(handle), to, int(size), 0);
    mode = 0;
    ioctlsocket(SOCKET(handle), FIONBIO, &mode);
    return got;
}

#else

using SystemSocket = int;

std::intptr_t MakeSocket() {
    return socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
}

void CloseSocket(std::intptr_t handle) {
    close(int(handle));
}

/// Ends a call of accept that waits in another thread.
void StopListening(std::intptr_t &handle) {
    shutdown(int(handle), SHUT_RDWR);
}

std::intptr_t AcceptOn(std::intptr_t handle) {
    return accept4(int(handle), nullptr, nullptr, SOCK_CLOEXEC);
}

/// The next bytes, which stay.
std::ptrdiff_t Peek(std::intptr_t handle, unsigned char *to, std::size_t size) {
    return recv(int(handle), to, size, MSG_PEEK | MSG_WAITALL);
}

/// What is there without waiting.
std::ptrdiff_t ReceiveNow(std::intptr_t handle, char *to, std::size_t size) {
    return recv(int(handle), to, size, MSG_DONTWAIT);
}

#endif

/// setsockopt for a whole socket.
template <typename Value> void SetOption(std::intptr_t handle, int option, const Value &value) {
    setsockopt(SystemSocket(handle), SOL_SOCKET, option, reinterpret_cast<const char *>(&value), sizeof value);
}

// ---- Messages ----

constexpr std::size_t kLongestPayload = 1020;
constexpr std::string_view kRoot = "<?xml version=\"1.0\"?><q3map_feedback version=\"1\">";

/// One message with its payload; empty at the end of the stream.
std::string ReceiveMessage(std::intptr_t connection) {
    unsigned char head[4];
    const std::ptrdiff_t peeked = Peek(connection, head, sizeof head);
    if (peeked <= 0)
        return {};
    EXPECT_EQ(peeked, 4);
    const std::size_t length = head[0] | std::size_t(head[1]) << 8 | std::size_t(head[2]) << 16;
    EXPECT_EQ(head[3], 0);
    EXPECT_GE(length, 1u);
    EXPECT_LE(length, kLongestPayload);
    std::string message(4 + std::min(length, kLongestPayload), ' ');
    const std::ptrdiff_t got = ReceiveNow(connection, message.data(), message.size());
    EXPECT_EQ(got, std::ptrdiff_t(message.size())) << "a message in parts";
    return got == std::ptrdiff_t(message.size()) ? message.substr(4) : std::string();
}

/// A strict reader of the little XML that the stream is made of.
class FeedbackParser {
  public:
    explicit FeedbackParser(std::string_view text) : rest_(text) {}

    std::vector<FeedbackElement> Elements() {
        std::vector<FeedbackElement> elements;
        Expect(kRoot);
        while (!rest_.empty() && !failed_)
            elements.push_back(Element());
        return elements;
    }

  private:
    void Fail(const std::string &what) {
        if (!failed_)
            ADD_FAILURE() << what << " at: " << rest_.substr(0, 200);
        failed_ = true;
    }
    void Expect(std::string_view token) {
        if (rest_.starts_with(token))
            rest_.remove_prefix(token.size());
        else
            Fail("expected " + std::string(token));
    }
    std::string Until(std::string_view characters) {
        const std::size_t end = std::min(rest_.find_first_of(characters), rest_.size());
        std::string text(rest_.substr(0, end));
        rest_.remove_prefix(end);
        return text;
    }
    /// Character data up to the next tag, entities resolved.
    std::string Text() {
        static const std::map<std::string, char> kEntities{{"lt", '<'}, {"gt", '>'}, {"amp", '&'}, {"quot", '"'}};
        std::string text = Until("<&>");
        while (rest_.starts_with('&')) {
            rest_.remove_prefix(1);
            const auto entity = kEntities.find(Until(";"));
            if (entity == kEntities.end())
                Fail("an unknown entity");
            else
                text += entity->second;
            Expect(";");
            text += Until("<&>");
        }
        for (const char c : text)
            if (static_cast<unsigned char>(c) < 32 && c != '\n' && c != '\t')
                Fail("a control character");
        return text;
    }
    std::string Name() { return Until(" >/=\""); }

    FeedbackElement Element() {
        FeedbackElement element;
        Expect("<");
        element.name = Name();
        Expect(" level=\""); // editors want it first
        element.level = Until("\"<");
        Expect("\">");
        element.text = Text();
        if (!rest_.starts_with("</")) {
            Expect("<");
            element.childName = Name();
            Expect(">");
            element.childText = Text();
            while (!rest_.starts_with("</") && !failed_) {
                Expect("<");
                const std::string name = Name();
                Expect(">");
                element.innermost.emplace_back(name, Text());
                Expect("</" + name + ">");
            }
            Expect("</" + element.childName + ">");
        }
        Expect("</" + element.name + ">");
        return element;
    }

    std::string_view rest_;
    bool failed_ = false;
};

} // namespace

EditorListener::EditorListener(EditorManner manner) : manner_(manner), socket_(MakeSocket()) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    auto *const generic = reinterpret_cast<sockaddr *>(&address);
    if (manner_.smallBuffer)
        SetOption(socket_, SO_RCVBUF, 1);
    EXPECT_EQ(bind(SystemSocket(socket_), generic, size), 0);
    EXPECT_EQ(listen(SystemSocket(socket_), 1), 0);
    EXPECT_EQ(getsockname(SystemSocket(socket_), generic, &size), 0);
    port_ = ntohs(address.sin_port);
    received_ = std::async(std::launch::async, [this] { return Receive(); });
}

EditorListener::~EditorListener() {
    Payloads();
    if (socket_ >= 0)
        CloseSocket(socket_);
}

const std::vector<std::string> &EditorListener::Payloads() {
    if (received_.valid()) {
        if (!manner_.reads || received_.wait_for(std::chrono::seconds(20)) != std::future_status::ready)
            StopListening(socket_); // nobody connected
        payloads_ = received_.get();
    }
    return payloads_;
}

std::string EditorListener::Text() {
    std::string all;
    for (const std::string &payload : Payloads())
        all += payload;
    return all;
}

std::vector<std::string> EditorListener::Receive() const {
    std::vector<std::string> all;
    const std::intptr_t listening = socket_; // which StopListening may change meanwhile
    std::this_thread::sleep_for(manner_.acceptAfter);
    const std::intptr_t connection = manner_.accepts ? AcceptOn(listening) : -1;
    if (connection < 0)
        return all;
    if (!manner_.reads)
        AcceptOn(listening); // until the listening socket is shut down
    else
        for (std::string payload; !(payload = ReceiveMessage(connection)).empty();) {
            all.push_back(payload);
            if (all.size() == manner_.resetAfter) {
                const linger now{.l_onoff = 1, .l_linger = 0};
                SetOption(connection, SO_LINGER, now);
                break;
            }
        }
    CloseSocket(connection);
    return all;
}

std::vector<FeedbackElement> ParseFeedback(const std::string &text) {
    return FeedbackParser(text).Elements();
}

std::string TextOfLevel(const std::vector<FeedbackElement> &elements, std::string_view level) {
    std::string text;
    for (const FeedbackElement &element : elements)
        if (element.name == "message" && element.level == level)
            text += element.text;
    return text;
}

} // namespace q3::test
