// GPL-2.0-or-later. Ownership of objects of GLib.
#pragma once

#include <gio/gio.h>

#include <memory>
#include <string>
#include <utility>

namespace q3 {

struct UnrefObject {
    void operator()(gpointer object) const { g_object_unref(object); }
};

/// A reference to a GObject.
template <typename T> using ObjectPtr = std::unique_ptr<T, UnrefObject>;

/// A GError that a call fills in.
class ErrorOut {
  public:
    ErrorOut() = default;
    ~ErrorOut() { g_clear_error(&error_); }
    ErrorOut(const ErrorOut &) = delete;
    ErrorOut &operator=(const ErrorOut &) = delete;
    GError **operator&() { return &error_; }
    std::string Text() const { return error_ ? error_->message : "unknown failure"; }

  private:
    GError *error_ = nullptr;
};

/// A source of the main loop, such as a timer, that ends with this object.
class LoopSource {
  public:
    LoopSource() = default;
    ~LoopSource() { Set(0); }
    LoopSource(const LoopSource &) = delete;
    LoopSource &operator=(const LoopSource &) = delete;
    /// Takes the place of the source before. 0: none.
    void Set(guint id) {
        if (const guint old = std::exchange(id_, id))
            g_source_remove(old);
    }
    /// To be called by a callback that ends its source by its return value.
    void Forget() { id_ = 0; }
    explicit operator bool() const { return id_ != 0; }

  private:
    guint id_ = 0;
};

} // namespace q3
