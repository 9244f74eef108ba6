// GPL-2.0-or-later. An editor that listens (-connect), and its parser.
#pragma once

#include <chrono>
#include <cstdint>
#include <future>
#include <string>
#include <vector>

namespace q3::test {

/// What an editor does with its connection.
struct EditorManner {
    std::chrono::milliseconds acceptAfter{0};
    bool accepts = true;
    bool reads = true;          ///< false: takes the connection and leaves it alone
    std::size_t resetAfter = 0; ///< ends the connection with a reset after so many messages; 0: never
    bool smallBuffer = false;   ///< as few bytes in flight as the system allows
};

/// An editor: takes one connection and keeps the payloads that come until it ends. As real ones do, it takes a message
/// that does not arrive as a whole for a fault.
class EditorListener {
  public:
    explicit EditorListener(EditorManner manner = {});
    ~EditorListener();
    EditorListener(const EditorListener &) = delete;
    EditorListener &operator=(const EditorListener &) = delete;

    std::string Address() const { return "127.0.0.1:" + std::to_string(port_); }
    /// The payloads, once the program has ended.
    const std::vector<std::string> &Payloads();
    /// The same as one text.
    std::string Text();

  private:
    std::vector<std::string> Receive() const;

    EditorManner manner_;
    std::intptr_t socket_; ///< what the operating system calls it; -1: closed
    int port_ = 0;
    std::vector<std::string> payloads_;
    std::future<std::vector<std::string>> received_;
};

/// An element of the stream below its root.
struct FeedbackElement {
    std::string name, level;
    std::string text;                                           ///< its own, without that of children
    std::string childName;                                      ///< empty: no child
    std::string childText;                                      ///< of the child itself
    std::vector<std::pair<std::string, std::string>> innermost; ///< names and texts of the child's children
};

/// The elements of a stream. Anything else than well-formed XML without a closed root fails the test.
std::vector<FeedbackElement> ParseFeedback(const std::string &text);

/// The text of all messages of a level.
std::string TextOfLevel(const std::vector<FeedbackElement> &elements, std::string_view level);

} // namespace q3::test
