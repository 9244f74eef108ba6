// GPL-2.0-or-later. An editor that listens (-connect), and its parser.
#include "tests/program/editor_listener.h"

#include <gtest/gtest.h>

#include <map>
#include <thread>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

namespace q3::test {

namespace {

constexpr std::size_t kLongestPayload = 1020;
constexpr std::string_view kRoot = "<?xml version=\"1.0\"?><q3map_feedback version=\"1\">";

/// One message with its payload; empty at the end of the stream.
std::string ReceiveMessage(int connection) {
    unsigned char head[4];
    const ssize_t peeked = recv(connection, head, sizeof head, MSG_PEEK | MSG_WAITALL);
    if (peeked <= 0)
        return {};
    EXPECT_EQ(peeked, 4);
    const std::size_t length = head[0] | std::size_t(head[1]) << 8 | std::size_t(head[2]) << 16;
    EXPECT_EQ(head[3], 0);
    EXPECT_GE(length, 1u);
    EXPECT_LE(length, kLongestPayload);
    std::string message(4 + std::min(length, kLongestPayload), ' ');
    const ssize_t got = recv(connection, message.data(), message.size(), MSG_DONTWAIT);
    EXPECT_EQ(got, ssize_t(message.size())) << "a message in parts";
    return got == ssize_t(message.size()) ? message.substr(4) : std::string();
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

EditorListener::EditorListener(EditorManner manner)
    : manner_(manner), socket_(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    auto *const generic = reinterpret_cast<sockaddr *>(&address);
    const int small = 1;
    if (manner_.smallBuffer)
        setsockopt(socket_, SOL_SOCKET, SO_RCVBUF, &small, sizeof small);
    EXPECT_EQ(bind(socket_, generic, size), 0);
    EXPECT_EQ(listen(socket_, 1), 0);
    EXPECT_EQ(getsockname(socket_, generic, &size), 0);
    port_ = ntohs(address.sin_port);
    received_ = std::async(std::launch::async, [this] { return Receive(); });
}

EditorListener::~EditorListener() {
    Payloads();
    close(socket_);
}

const std::vector<std::string> &EditorListener::Payloads() {
    if (received_.valid()) {
        if (!manner_.reads || received_.wait_for(std::chrono::seconds(20)) != std::future_status::ready)
            shutdown(socket_, SHUT_RDWR); // nobody connected
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
    std::this_thread::sleep_for(manner_.acceptAfter);
    const int connection = manner_.accepts ? accept(socket_, nullptr, nullptr) : -1;
    if (connection < 0)
        return all;
    if (!manner_.reads)
        accept(socket_, nullptr, nullptr); // until the listening socket is shut down
    else
        for (std::string payload; !(payload = ReceiveMessage(connection)).empty();) {
            all.push_back(payload);
            if (all.size() == manner_.resetAfter) {
                const linger now{.l_onoff = 1, .l_linger = 0};
                setsockopt(connection, SOL_SOCKET, SO_LINGER, &now, sizeof now);
                break;
            }
        }
    close(connection);
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
