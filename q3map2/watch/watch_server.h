// GPL-2.0-or-later. The server of the page: for this computer alone, and for who knows its address.
#pragma once

#include "q3map2/watch/glib_ptr.h"

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace q3 {

/// HTTP and WebSockets on 127.0.0.1. Each path begins with a random token of 128 bits. Requests without it, for another
/// host name (DNS rebinding) or from pages of another origin get status 403; so do WebSockets that name no origin.
/// There are no files: the names that can be asked for are those that `answer` knows.
class WatchServer {
  public:
    /// What a name stands for.
    struct Answer {
        std::string type; ///< MIME
        std::shared_ptr<const std::vector<std::byte>> bytes;
    };
    struct Callbacks {
        /// The page is the empty name; empty: there is nothing of that name now.
        std::function<std::optional<Answer>(std::string_view name)> answer;
        std::function<std::string()> state; ///< what pages are told, as JSON
    };

    /// `port` 0: a free one. Errors: Error if the port cannot be had.
    WatchServer(int port, Callbacks callbacks);
    ~WatchServer();
    WatchServer(const WatchServer &) = delete;
    WatchServer &operator=(const WatchServer &) = delete;

    /// http://127.0.0.1:PORT/TOKEN/
    std::string Address() const;
    /// The origins of the page, of HTTP and WebSockets, separated by blanks.
    std::string Origins() const;
    /// Sends the state to all pages, soon: calls that follow each other closely count as one.
    void StateChanged();

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace q3
