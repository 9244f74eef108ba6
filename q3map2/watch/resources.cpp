// GPL-2.0-or-later. The shaders and textures that the page needs to draw a map, made beside the stages.
#include "q3map2/watch/resources.h"

#include "common/error.h"

#include <thread>
#include <utility>

namespace q3 {

struct Resources::Job {
    Resources *owner = nullptr; ///< null: it is gone
    std::optional<std::vector<std::byte>> bytes;
    std::string error;
    std::thread thread;
};

Resources::Resources(Make make, std::function<void(const std::string &)> done)
    : make_(std::move(make)), done_(std::move(done)) {}

Resources::~Resources() {
    if (!job_)
        return;
    job_->owner = nullptr;
    if (job_->thread.joinable())
        job_->thread.join();
}

void Resources::Refresh(Reason reason) {
    if (!busy_)
        Begin(reason);
    else if (again_ != Reason::FilesChanged)
        again_ = reason;
}

void Resources::Begin(Reason reason) {
    busy_ = true;
    job_ = std::make_shared<Job>();
    job_->owner = this;
    job_->thread = std::thread([job = job_, make = make_, reason] {
        try {
            job->bytes = make(reason);
        } catch (const std::exception &error) {
            job->error = error.what();
        }
        g_idle_add(
            [](gpointer kept) -> gboolean {
                const std::unique_ptr<std::shared_ptr<Job>> holder(static_cast<std::shared_ptr<Job> *>(kept));
                const std::shared_ptr<Job> ended = *holder;
                Resources *const self = ended->owner;
                if (!self)
                    return G_SOURCE_REMOVE;
                ended->thread.join();
                self->busy_ = false;
                if (ended->bytes) {
                    const std::unique_ptr<gchar, decltype(&g_free)> digest(
                        g_compute_checksum_for_data(G_CHECKSUM_SHA256,
                                                    reinterpret_cast<const guchar *>(ended->bytes->data()),
                                                    ended->bytes->size()),
                        g_free);
                    self->latest_ = {std::make_shared<const std::vector<std::byte>>(std::move(*ended->bytes)),
                                     digest.get()};
                }
                if (const auto next = std::exchange(self->again_, std::nullopt))
                    self->Begin(*next);
                self->done_(ended->error);
                return G_SOURCE_REMOVE;
            },
            new std::shared_ptr<Job>(job));
    });
}

} // namespace q3
