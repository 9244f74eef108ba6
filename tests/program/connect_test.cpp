// GPL-2.0-or-later. The stream that an editor gets (-connect).
#include "tests/program/run_program.h"

#include <libxml/parser.h>
#include <libxml/tree.h>

#include <chrono>
#include <future>
#include <memory>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

namespace q3::test {

namespace {

/// An editor: takes one connection and keeps what comes until it ends.
class Listener {
  public:
    Listener() : socket_(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
        sockaddr_in address{};
        address.sin_family = AF_INET;
        address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        socklen_t size = sizeof address;
        auto *const generic = reinterpret_cast<sockaddr *>(&address);
        EXPECT_EQ(bind(socket_, generic, size), 0);
        EXPECT_EQ(listen(socket_, 1), 0);
        EXPECT_EQ(getsockname(socket_, generic, &size), 0);
        port_ = ntohs(address.sin_port);
        received_ = std::async(std::launch::async, [this] { return Receive(); });
    }
    ~Listener() {
        if (received_.valid())
            Received();
        close(socket_);
    }
    Listener(const Listener &) = delete;
    Listener &operator=(const Listener &) = delete;

    std::string Address() const { return fmt::format("127.0.0.1:{}", port_); }
    /// Once the program has ended.
    std::string Received() {
        if (received_.wait_for(std::chrono::seconds(20)) != std::future_status::ready)
            shutdown(socket_, SHUT_RDWR); // the program never connected
        return received_.get();
    }

  private:
    std::string Receive() const {
        std::string all;
        const int connection = accept(socket_, nullptr, nullptr);
        if (connection < 0)
            return all;
        char buffer[4096];
        for (ssize_t got; (got = recv(connection, buffer, sizeof buffer, 0)) > 0;)
            all.append(buffer, std::size_t(got));
        close(connection);
        return all;
    }

    int socket_;
    int port_ = 0;
    std::future<std::string> received_;
};

/// The payloads of all messages, one after the other. Each is a length of four bytes and at most 1014 bytes.
std::string Payloads(const std::string &stream) {
    std::string all;
    std::size_t at = 0;
    while (at + 4 <= stream.size()) {
        std::size_t length = 0;
        for (std::size_t i = 0; i < 4; i++)
            length |= std::size_t(static_cast<unsigned char>(stream[at + i])) << (8 * i);
        EXPECT_GE(length, 1u);
        EXPECT_LE(length, 1014u);
        EXPECT_LE(at + 4 + length, stream.size());
        all += stream.substr(at + 4, length);
        at += 4 + length;
    }
    EXPECT_EQ(at, stream.size());
    return all;
}

struct FreeDoc {
    void operator()(xmlDoc *doc) const { xmlFreeDoc(doc); }
};

struct Message {
    std::string level, text;
};

/// The messages of the stream, once its root is closed as an editor's parser sees it.
std::vector<Message> Messages(std::string payload) {
    payload += "</q3map_feedback>";
    const std::unique_ptr<xmlDoc, FreeDoc> doc(
        xmlReadMemory(payload.data(), int(payload.size()), "stream", nullptr, XML_PARSE_NOERROR | XML_PARSE_NONET));
    std::vector<Message> messages;
    EXPECT_NE(doc, nullptr) << "not well-formed:\n" << payload;
    if (!doc)
        return messages;
    const xmlNode *root = xmlDocGetRootElement(doc.get());
    EXPECT_STREQ(reinterpret_cast<const char *>(root->name), "q3map_feedback");
    const auto take = [](xmlChar *text) {
        std::string copy = text ? reinterpret_cast<const char *>(text) : "";
        xmlFree(text);
        return copy;
    };
    for (xmlNode *node = root->children; node; node = node->next) {
        EXPECT_STREQ(reinterpret_cast<const char *>(node->name), "message");
        messages.push_back({take(xmlGetProp(node, BAD_CAST "level")), take(xmlNodeGetContent(node))});
    }
    return messages;
}

std::string TextOfLevel(const std::vector<Message> &messages, std::string_view level) {
    std::string text;
    for (const Message &message : messages)
        if (message.level == level)
            text += message.text;
    return text;
}

TEST_F(ProgramTest, EditorGetsEverythingThatIsPrinted) {
    Listener editor;
    const Outcome outcome = RunWell("-connect " + editor.Address() + " -light -sh -gridsh 64 64 64 -zork<&\"> MAP");
    const auto messages = Messages(Payloads(editor.Received()));
    std::string all;
    for (const Message &message : messages) {
        EXPECT_TRUE(message.level == "1" || message.level == "2") << message.level;
        all += message.text;
    }
    EXPECT_EQ(all, outcome.text);
    EXPECT_NE(TextOfLevel(messages, "1").find("--- TraceGridSH ---"), std::string::npos);
    EXPECT_NE(TextOfLevel(messages, "2").find("Unknown argument \"-zork<&\">\""), std::string::npos);
}

TEST_F(ProgramTest, EditorGetsErrors) {
    Listener editor;
    EXPECT_EQ(Run("-light -connect " + editor.Address() + " /nowhere/x.bsp").status, 1);
    EXPECT_NE(TextOfLevel(Messages(Payloads(editor.Received())), "3").find("/nowhere/x.bsp"), std::string::npos);
}

TEST_F(ProgramTest, EditorGetsErrorsInOptions) {
    for (const std::string options :
         {"-game tetris -light MAP", "-fs_basepath /nope -light MAP", "-light MAP -threads"}) {
        Listener editor;
        const Outcome outcome = Run("-connect " + editor.Address() + " " + options);
        EXPECT_EQ(outcome.status, 1) << options;
        const std::string errors = TextOfLevel(Messages(Payloads(editor.Received())), "3");
        EXPECT_NE(errors.find("ERROR"), std::string::npos) << options;
        ASSERT_EQ(outcome.ErrorLines().size(), 1u) << outcome.text;
        EXPECT_NE(errors.find(outcome.ErrorLines().front()), std::string::npos) << errors;
    }
}

TEST_F(ProgramTest, EditorGetsNoLiveLineOfATerminal) {
    Listener editor;
    const Outcome outcome = RunOnTerminal({"-connect", editor.Address(), "-fs_basepath", (folder_ / "base").string(),
                                           "-light", "-sh", "-samplesize", "4", Map(".bsp").string()},
                                          folder_.Root());
    ASSERT_EQ(outcome.status, 0) << outcome.text;
    ASSERT_TRUE(outcome.Printed("\r          ")) << "the terminal has its live line: " << outcome.text;
    const std::string payload = Payloads(editor.Received());
    EXPECT_EQ(payload.find('\r'), std::string::npos);
    EXPECT_EQ(payload.find("&#13;"), std::string::npos) << payload;
    EXPECT_EQ(payload.find(" s left"), std::string::npos);
    EXPECT_NE(payload.find("0...1...2...3...4...5...6...7...8...9... ("), std::string::npos) << payload;
}

TEST_F(ProgramTest, EditorIsShownLeaksAndBrushes) {
    // A floor with a side twice, so that brush 0 of entity 0 is worth a look; nothing around it.
    constexpr std::string_view kMap = R"({
"classname" "worldspawn"
{
( 0 0 0 ) ( 0 64 0 ) ( 64 0 0 ) a 0 0 0 1 1
( 0 0 0 ) ( 0 64 0 ) ( 64 0 0 ) a 0 0 0 1 1
( 0 0 -8 ) ( 64 0 -8 ) ( 0 64 -8 ) a 0 0 0 1 1
( 0 0 0 ) ( 0 64 0 ) ( 0 0 64 ) a 0 0 0 1 1
( 64 0 0 ) ( 64 0 64 ) ( 64 64 0 ) a 0 0 0 1 1
( 0 0 0 ) ( 0 0 64 ) ( 64 0 0 ) a 0 0 0 1 1
( 0 64 0 ) ( 64 64 0 ) ( 0 64 64 ) a 0 0 0 1 1
}
}
{
"classname" "info_player_start"
"origin" "32 32 32"
}
)";
    folder_.Write("leak.map", kMap);
    Listener editor;
    const Outcome outcome = RunWell("-connect " + editor.Address() + " -v " + (folder_ / "leak.map").string());
    const std::string payload = Payloads(editor.Received());
    EXPECT_TRUE(outcome.Printed("Entity 0, Brush 0: "));
    const std::size_t select = payload.find("<select level=\"2\">Entity 0, Brush 0: ");
    ASSERT_NE(select, std::string::npos) << payload;
    EXPECT_LT(payload.find("<brush>0 0</brush></select>", select), payload.find("<message", select));
    // The editor closes at the trail: what leaked, and from where, comes before it.
    const std::size_t trail = payload.find("<message level=\"3\">MAP LEAKED\n<polyline><point>");
    ASSERT_NE(trail, std::string::npos) << payload;
    const std::string_view cause = "the info_player_start at 32 32 32 can be reached from outside the map";
    EXPECT_LT(payload.find(fmt::format("<select level=\"2\">Entity 1, Brush 0: {}<brush>1 0</brush></select>", cause)),
              trail);
    EXPECT_LT(payload.find("******* leaked *******"), trail);
    EXPECT_NE(payload.find("<point>32.000000 32.000000 32.000000</point></polyline></message>"), std::string::npos);
}

TEST_F(ProgramTest, NoEditorThereIsNoError) {
    for (const char *address : {"127.0.0.1:1", "nonsense", "300.1.1.1:39000", ":", "127.0.0.1:999999"})
        RunWell(fmt::format("-connect {} -info MAP", address));
}

} // namespace

} // namespace q3::test
