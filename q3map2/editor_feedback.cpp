// GPL-2.0-or-later. Sends the log of a compile to an editor (-connect).
#include "q3map2/editor_feedback.h"

#include "common/text/text.h"

#include <arpa/inet.h>
#include <libxml/tree.h>
#include <libxml/xmlstring.h>
#include <netinet/tcp.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <memory>
#include <string_view>

namespace q3 {

namespace {

constexpr std::size_t kMaxPayload = 1014;
constexpr std::size_t kFlushBytes = 511;
constexpr std::chrono::seconds kMaxDelay{1};

struct FreeNode {
    void operator()(xmlNode *node) const { xmlFreeNode(node); }
};
struct FreeBuffer {
    void operator()(xmlBuffer *buffer) const { xmlBufferFree(buffer); }
};

/// Bytes that are not UTF-8 become question marks.
std::string ValidUtf8(std::string text) {
    while (!text.empty() && xmlCheckUTF8(reinterpret_cast<const xmlChar *>(text.c_str())) == 0)
        for (char &c : text)
            if (static_cast<unsigned char>(c) >= 0x80)
                c = '?';
    // XML has no way to spell most control characters.
    for (char &c : text)
        if (static_cast<unsigned char>(c) < 32 && c != '\n' && c != '\t' && c != '\r')
            c = '?';
    return text;
}

using Node = std::unique_ptr<xmlNode, FreeNode>;

Node Element(const char *name, const std::string &text, LogLevel level) {
    Node node(xmlNewNode(nullptr, BAD_CAST name));
    const std::string valid = ValidUtf8(text), number = std::to_string(int(level));
    xmlNodeAddContent(node.get(), BAD_CAST valid.c_str());
    xmlSetProp(node.get(), BAD_CAST "level", BAD_CAST number.c_str());
    return node;
}

std::string TextOf(const Node &node) {
    const std::unique_ptr<xmlBuffer, FreeBuffer> buffer(xmlBufferCreate());
    xmlNodeDump(buffer.get(), nullptr, node.get(), 0, 0);
    return reinterpret_cast<const char *>(xmlBufferContent(buffer.get()));
}

/// A message with a position in the map: a child element with a polyline or a brush.
std::string MarkElement(LogLevel level, const std::string &text, const LogMark &mark) {
    const bool isLine = !mark.line.empty();
    const Node node = Element(isLine ? "message" : "select", text, level);
    if (!isLine) {
        const std::string place = fmt::format("{} {}", mark.entity, mark.primitive);
        xmlNewTextChild(node.get(), nullptr, BAD_CAST "brush", BAD_CAST place.c_str());
        return TextOf(node);
    }
    xmlNode *line = xmlNewChild(node.get(), nullptr, BAD_CAST "polyline", nullptr);
    for (const std::array<float, 3> &p : mark.line) {
        const std::string point = fmt::format("{:f} {:f} {:f}", p[0], p[1], p[2]);
        xmlNewTextChild(line, nullptr, BAD_CAST "point", BAD_CAST point.c_str());
    }
    return TextOf(node);
}

class Connection {
  public:
    explicit Connection(int socket) : socket_(socket) { Send("<?xml version=\"1.0\"?><q3map_feedback version=\"1\">"); }
    ~Connection() {
        Flush();
        close(socket_);
    }
    Connection(const Connection &) = delete;
    Connection &operator=(const Connection &) = delete;

    void Write(LogLevel level, std::string_view text) {
        if (level != level_)
            Flush();
        level_ = level;
        text_ += text;
        if (text_.size() > kFlushBytes || std::chrono::steady_clock::now() - sent_ > kMaxDelay)
            Flush();
    }

    void Write(LogLevel level, std::string_view text, const LogMark &mark) {
        Flush();
        Send(MarkElement(level, std::string(text), mark));
    }

  private:
    void Flush() {
        if (text_.empty())
            return;
        Send(TextOf(Element("message", text_, level_)));
        text_.clear();
        sent_ = std::chrono::steady_clock::now();
    }

    void Send(std::string_view payload) {
        while (!payload.empty()) {
            const std::string_view part = payload.substr(0, kMaxPayload);
            payload.remove_prefix(part.size());
            std::string message;
            for (int shift = 0; shift < 32; shift += 8)
                message += char(part.size() >> shift & 255);
            message += part;
            for (std::string_view rest = message; !rest.empty();) {
                const ssize_t sent = send(socket_, rest.data(), rest.size(), MSG_NOSIGNAL);
                if (sent <= 0)
                    return; // the editor is gone; the compile goes on
                rest.remove_prefix(std::size_t(sent));
            }
        }
    }

    int socket_;
    LogLevel level_ = LogLevel::Normal;
    std::string text_;
    std::chrono::steady_clock::time_point sent_ = std::chrono::steady_clock::now();
};

} // namespace

void EditorFeedback::Attach(const std::string &address, Log &log) {
    const std::size_t colon = address.rfind(':');
    if (colon == std::string::npos)
        return;
    sockaddr_in peer{};
    peer.sin_family = AF_INET;
    peer.sin_port = htons(std::uint16_t(IntegerFromText(address.substr(colon + 1))));
    if (inet_pton(AF_INET, address.substr(0, colon).c_str(), &peer.sin_addr) != 1)
        return;
    const int connected = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    if (connected < 0)
        return;
    const int on = 1;
    setsockopt(connected, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
    if (connect(connected, reinterpret_cast<const sockaddr *>(&peer), sizeof peer) != 0) {
        close(connected);
        return;
    }
    const auto connection = std::make_shared<Connection>(connected);
    log.AddSink([connection](LogLevel level, std::string_view text) { connection->Write(level, text); },
                [connection](LogLevel level, std::string_view text, const LogMark &mark) {
                    connection->Write(level, text, mark);
                });
}

} // namespace q3
